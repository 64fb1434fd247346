# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""until_closed.sh between roslaunch and the panel: a closed panel is told from one that failed."""
import os
from pathlib import Path
import signal
import subprocess

from support.ros_system import wait_for
import pytest

SCRIPT = Path(__file__).resolve().parents[3] / 'utils' / 'host' / 'until_closed.sh'
# As roslaunch does: what it starts has a session of its own, and gets SIGINT when it is to end.
PARENT = """
import os, signal, subprocess, sys
def end(*_):
    print('asked', flush=True)
    os.killpg(child.pid, signal.SIGINT)
signal.signal(signal.SIGTERM, end)
child = subprocess.Popen(sys.argv[1:], preexec_fn=os.setsid)
print(child.pid, flush=True)
print('ended', child.wait())
"""


def run(tmp_path, required, *command, **environment):
    """Return (what the parent saw, the status file's text); within 10 s."""
    process = start(tmp_path, required, *command, **environment)
    return finish(process, tmp_path)


def start(tmp_path, required, *command):
    return subprocess.Popen(
        ['/usr/bin/python3', '-c', PARENT, str(SCRIPT), required] + list(command),
        stdout=subprocess.PIPE, universal_newlines=True,
        env=dict(os.environ, MHRI_PANEL_STATUS=str(tmp_path / 'panel status')))


def number_of(process):
    """Return the script's number once its command has said 0; either may be first to speak."""
    return max(int(process.stdout.readline()) for _ in range(2))


def finish(process, tmp_path):
    try:
        said = process.communicate(timeout=60)[0].split('\n')
    finally:
        process.kill()
    return [line for line in said if line and not line.isdigit()], \
        (tmp_path / 'panel status').read_text().strip()


def test_closed_panel_lets_roslaunch_end(tmp_path):
    assert run(tmp_path, 'true', 'true') == (['asked', 'ended 0'], '0')


@pytest.mark.parametrize('script, status', [('exit 3', 3), ('kill -KILL $$', 137)])
def test_panel_that_failed_is_left_to_roslaunch(tmp_path, script, status):
    assert run(tmp_path, 'true', 'bash', '-c', script) == (
        ['ended {}'.format(status)], str(status))


def test_panel_that_is_not_required_ends_nothing(tmp_path):
    assert run(tmp_path, 'false', 'true') == (['ended 0'], '0')


def test_roslaunch_that_ends_is_not_asked_again(tmp_path):
    process = start(tmp_path, 'true', 'bash', '-c',
                    'trap "exit 0" INT; echo 0; while :; do sleep 0.1; done')
    child = number_of(process)
    os.killpg(child, signal.SIGINT)
    assert finish(process, tmp_path) == (['ended 0'], '0')


def test_script_that_is_killed_closes_the_panel(tmp_path):
    closed = tmp_path / 'closed'
    process = start(
        tmp_path, 'true', 'bash', '-c',
        'trap "touch \'{}\'; exit" TERM; echo 0; while :; do sleep 0.1; done'.format(closed))
    child = number_of(process)
    os.kill(child, signal.SIGKILL)
    process.communicate(timeout=60)
    wait_for(closed.exists)

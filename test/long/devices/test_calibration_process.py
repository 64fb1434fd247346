# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``mhri_joy --calibrate`` in a process with a virtual pad."""
import subprocess

import pytest

from mhri.devices.profile import parse_profile

from support.ros_system import wait_for
from support.virtual_pad import missing, PadProcess

NO_PADS = missing()


@pytest.fixture(name='terminal')
def fixture_terminal(tmp_path):
    """Return a function that starts ``mhri_joy --calibrate`` in a process with a virtual pad."""
    begun = []

    def start(*arguments):
        process = PadProcess('--calibrate', *arguments, stdin=subprocess.PIPE, paused=True,
                             env={'ROS_HOME': str(tmp_path), 'PYTHONUNBUFFERED': '1'})
        begun.append(process)
        process.pad = process.do('attach', name='Lab rat pad', vendor=0x1209)
        process.do('go_on')
        return process
    yield start
    for process in begun:
        process.end()


def ended(process):
    return process.popen.wait(60)


def asks(process, words, count=1):
    wait_for(lambda: process.said().count(words) >= count, 20.0, '{!r} in {!r}'.format(
        words, process.said()))


def enter(process):
    process.popen.stdin.write(b'\n')
    process.popen.stdin.flush()


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
def test_end_to_end(terminal, tmp_path):
    process = terminal('rat')
    asks(process, 'let go of everything')
    enter(process)
    asks(process, 'FORWARD')
    process.do('swing', number=process.pad, axis=3, value=1.0)
    asks(process, 'LEFT')
    process.do('swing', number=process.pad, axis=2, value=-1.0)
    for words, button in (('dead-man', 6), ('full speed', None), ('stops all', 1),
                          ('next robot', None), ('previous robot', None), ('selects all', None)):
        asks(process, words)
        if button is None:
            enter(process)
        else:
            process.do('click', number=process.pad, button=button)
    assert ended(process) == 0, process.said()
    path = tmp_path / 'mhri' / 'pads' / 'rat.yaml'
    assert str(path) in process.said()
    profile = parse_profile(path.read_text(encoding='utf-8'), str(path))
    assert (profile.name, profile.forward.index, profile.turn.index) == ('rat', 3, 2)
    assert profile.read([0.0, 0.0, 0.0, 1.0], [0] * 6 + [1]).forward == 1.0
    assert (profile.dead_man, profile.actions) == (6, ((1, 'stop_all'),))
    assert len(profile.match.guids) == 1
    before = path.read_text(encoding='utf-8')
    again = terminal('rat')
    assert ended(again) == 1
    assert '--force' in again.said()
    assert path.read_text(encoding='utf-8') == before
    forced = terminal('rat', '--force')
    asks(forced, 'let go of everything')


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
@pytest.mark.parametrize('arguments, said', [
    (['ps3'], 'my_ps3'), (['my pad'], "'my pad'"), (['--device', 'wii'], 'Lab rat pad')])
def test_what_is_refused_at_once(terminal, tmp_path, arguments, said):
    process = terminal(*arguments)
    assert ended(process) == 1
    assert said in process.said()
    assert 'Traceback' not in process.said()
    assert list(tmp_path.rglob('*.yaml*')) == []


@pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))
def test_ended_in_the_middle_nothing_is_written(terminal, tmp_path):
    process = terminal()
    asks(process, 'let go of everything')
    process.popen.stdin.close()
    assert ended(process) == 1
    pulled = terminal()
    asks(pulled, 'let go of everything')
    pulled.do('detach', number=pulled.pad)
    assert ended(pulled) == 1
    assert list(tmp_path.rglob('*.yaml*')) == []

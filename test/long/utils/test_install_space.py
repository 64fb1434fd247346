# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``catkin_make install`` for real, as the one command calls it, and what runs from there."""
import os
import signal
import subprocess

import pytest

from support.checkout import REPO
from support.ros_system import free_port, System, wait_for
from support.whole_run import in_new_terminal, new_checkout, Run

# The folders that are installed as they are.
SHARED = ('launch', 'resource', 'utils')
# What the setup file of a workspace sets.
WORKSPACE = ('CMAKE_PREFIX_PATH', 'PYTHONPATH', 'ROS_PACKAGE_PATH')
TIMEOUT_S = 60.0
BUILD_S = 1200.0


@pytest.fixture(scope='module')
def prefix(tmp_path_factory):
    """Return the install space of a new checkout, once a drive of it has run and was ended."""
    folder = tmp_path_factory.mktemp('install')
    with Run(folder, ['--install-space', '--sim', '1', 'gui:=none', '--master',
                      'http://127.0.0.1:{}'.format(free_port())],
             script=new_checkout(folder / 'robots'),
             before=['env', *('--unset=' + name for name in WORKSPACE)]) as run:
        wait_for(lambda: run.process.poll() is not None or 'process[bot1' in run.output, BUILD_S,
                 'the last of its nodes', poll_s=0.1)
        run.process.send_signal(signal.SIGINT)
        assert run.wait(TIMEOUT_S) == 130, run.output
    made = folder / 'robots' / 'build' / '.ws' / 'install'
    assert '{}/share/mhri/launch/mhri.launch'.format(made) in run.output
    return made


def bare():
    """Return this environment without any workspace."""
    return {name: value for name, value in os.environ.items()
            if name not in WORKSPACE}


@pytest.fixture(scope='module')
def system(prefix):
    """Return a master, and an environment that knows the prefix alone."""
    with System(adopt=False) as made:
        settings = bare()
        settings.update({name: made.env[name] for name in (
            'ROS_MASTER_URI', 'ROS_IP', 'ROS_HOME', 'ROS_LOG_DIR', 'PYTHONUNBUFFERED')})
        sourced = subprocess.run(
            ['bash', '-c', '. "$1/setup.bash"; env -0', 'bash', str(prefix)], env=settings,
            check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
        made.env.clear()
        made.env.update(line.split('=', 1) for line in sourced.split('\0') if line)
        made.env['QT_QPA_PLATFORM'] = 'offscreen'
        made.start_master()
        yield made


def test_the_doctor_runs_from_there(prefix):
    assert in_new_terminal('rosrun mhri mhri_doctor --help', prefix)[:6] == 'usage:'


def test_every_file_is_there_and_what_runs_may_run(prefix):
    share = prefix / 'share' / 'mhri'
    for path in [path for part in SHARED for path in (REPO / part).rglob('*') if path.is_file()
                 and '__pycache__' not in path.parts]:
        copy = share / path.relative_to(REPO)
        assert copy.read_bytes() == path.read_bytes()
        assert os.access(str(copy), os.X_OK) == os.access(str(path), os.X_OK), copy
    for path in (REPO / 'scripts').iterdir():
        assert os.access(str(prefix / 'lib' / 'mhri' / path.name), os.X_OK), path.name
    assert (share / 'plugin.xml').is_file() and (share / 'package.xml').is_file()


def test_python_finds_the_installed_package_alone(prefix, system):
    said = subprocess.run(
        ['/usr/bin/python3', '-c', 'import mhri.nodes.mux, mhri.screen.gui.screen, mhri.msg\n'
         'for name in ("nodes", "screen", "msg"): print(getattr(mhri, name).__file__ or "")'],
        env=system.env, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    assert said.count(str(prefix)) == 3 and str(REPO) not in said, said


def nodes(system):
    done = subprocess.run(['rosnode', 'list'], env=system.env, stdout=subprocess.PIPE,
                          universal_newlines=True)
    return done.stdout.split()


@pytest.mark.parametrize('executable, arguments, node', [
    ('mux', [], '/mux'), ('panel', ['--fresh'], '/mhri_panel')])
def test_it_runs_from_there(prefix, system, executable, arguments, node):
    process = system.start('rosrun', 'mhri', executable, *arguments)

    def registered():
        with open(process.log) as log:
            assert process.poll() is None, log.read()
        return node in nodes(system)
    wait_for(registered, TIMEOUT_S, node, poll_s=0.2)
    with open('/proc/{}/cmdline'.format(process.pid)) as file:
        command = file.read()
    assert str(prefix) in command and str(REPO) not in command
    process.terminate()
    assert process.wait(60) in (0, -15, 143)
    with open(process.log) as log:
        assert 'Traceback' not in log.read()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri beside another package in a workspace of somebody's own, as doc/systems.md says."""
import os
import shutil
import signal
import subprocess

from support.checkout import REPO
from support.ros_system import System, wait_for
from support.whole_run import new_checkout

# What the setup file of a workspace sets.
WORKSPACE = ('CMAKE_PREFIX_PATH', 'PYTHONPATH', 'ROS_PACKAGE_PATH')
BUILD_S, START_S, END_S = 1200.0, 120.0, 60.0


def built(workspace, environment):
    """Build a workspace by catkin_make; return the environment of its setup file."""
    # Python alone: the other languages take half of the time and are the same as here.
    done = subprocess.run(
        ['catkin_make', '-DPYTHON_EXECUTABLE=/usr/bin/python3'], cwd=str(workspace),
        env=dict(environment, PWD=str(workspace),
                 ROS_LANG_DISABLE='gencpp:geneus:genlisp:gennodejs'),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True, timeout=BUILD_S)
    assert done.returncode == 0, done.stdout[-5000:]
    sourced = subprocess.run(
        ['bash', '-c', '. devel/setup.bash; env -0'], cwd=str(workspace), env=environment,
        check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return dict(line.split('=', 1) for line in sourced.split('\0') if line)


def test_it_builds_and_starts_there_beside_another_package(tmp_path):
    workspace = tmp_path / 'workspace'
    new_checkout(workspace / 'src' / 'mhri')
    other = workspace / 'src' / 'crawler_robot'
    shutil.copytree(str(REPO / 'test' / 'example_robot_package'), str(other),
                    ignore=shutil.ignore_patterns('CATKIN_IGNORE'))
    with System(adopt=False) as system:
        ours = {name: value for name, value in system.env.items() if name not in WORKSPACE}
        environment = built(workspace, ours)
        system.env.clear()
        system.env.update(environment)
        assert 'crawler' in subprocess.run(
            ['rosrun', 'mhri', 'mhri_types'], env=system.env, check=True, stdout=subprocess.PIPE,
            universal_newlines=True).stdout.split()
        system.start_master()
        process = system.start('roslaunch', 'mhri', 'mhri.launch', 'gui:=none')

        def mux_runs():
            with open(process.log) as log:
                assert process.poll() is None, log.read()
            return '/mux' in subprocess.run(
                ['rosnode', 'list'], env=system.env, stdout=subprocess.PIPE,
                universal_newlines=True).stdout.split()
        wait_for(mux_runs, START_S, 'the mux of this workspace', poll_s=0.2)
        os.kill(process.pid, signal.SIGINT)
        assert process.wait(END_S) == 0

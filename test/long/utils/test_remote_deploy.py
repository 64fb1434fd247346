# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtlebot_deploy.sh against a robot that is a folder here: what is sent, linked and read again.

Over a real ssh: test_remote_network.py.
"""
import os
import subprocess

from support.checkout import REPO
import pytest

SCRIPT = REPO / 'utils' / 'host' / 'turtlebot_deploy.sh'
REMOTE = REPO / 'utils' / 'remote'
FILES = sorted(path.name for path in REMOTE.iterdir() if path.is_file())
LINK = 'mhri.launch'
# Runs what it is given on the robot; the first call only opens the connection.
SSH = '''#!/bin/bash
[ "${{*: -1}}" != true ] || exit 0
[ "$1" != -S ] || [ "$3" != -O ] || exit 0
cd {home} && HOME={home} PATH={tools}:/usr/bin:/bin exec /bin/sh -c "${{*: -1}}"
'''


class Robot:
    """A home folder, and programs of the robot's that stand before the real ones."""

    def __init__(self, folder):
        self.home, self.tools, self._bin = folder / 'home', folder / 'tools', folder / 'bin'
        for path in (self.home, self.tools, self._bin):
            path.mkdir()
        self.there = self.home / 'mhri'
        self.program(self._bin / 'ssh', SSH.format(home=self.home, tools=self.tools))
        self.env = {'PATH': '{}:/usr/bin:/bin'.format(self._bin), 'HOME': str(folder),
                    'TMPDIR': str(folder)}

    @staticmethod
    def program(path, text):
        path.write_text(text)
        path.chmod(0o755)

    def deploy(self):
        """Return (exit status, output)."""
        done = subprocess.run(
            [str(SCRIPT), 'turtle@192.0.2.7'], env=self.env, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=60)
        return done.returncode, done.stdout


@pytest.fixture
def robot(tmp_path):
    return Robot(tmp_path)


def inodes(robot):
    """Return those of the robot's files: a file that is sent again has another one."""
    return {name: (robot.there / name).stat().st_ino for name in FILES}


def is_complete(robot):
    assert sorted(path.name for path in robot.there.iterdir()) == sorted(FILES + [LINK])
    for name in FILES:
        assert (robot.there / name).read_bytes() == (REMOTE / name).read_bytes()
    assert os.readlink(str(robot.there / LINK)) == 'mhri_turtlebot2.launch'


def test_everything_is_sent_once(robot):
    status, output = robot.deploy()
    assert status == 0, output
    is_complete(robot)
    before = inodes(robot)
    status, output = robot.deploy()
    assert status == 0 and inodes(robot) == before
    is_complete(robot)


@pytest.mark.parametrize('other', [None, 'nowhere.launch', 'mhri_turtlebot3.launch', b'a copy'])
def test_link_alone_is_mended(robot, other):
    robot.deploy()
    link = robot.there / LINK
    link.unlink()
    if isinstance(other, bytes):
        link.write_bytes((REMOTE / 'mhri_turtlebot2.launch').read_bytes())
    elif other:
        link.symlink_to(other)
    before = inodes(robot)
    status, output = robot.deploy()
    assert status == 0, output
    is_complete(robot)
    assert inodes(robot) == before


@pytest.mark.parametrize('damage, names', [
    # What a disk does that is worn out, and what a full one may do.
    ('printf x | dd of=mhri_guard conv=notrunc bs=1 seek=20 2>/dev/null', 'mhri_guard'),
    (': >turtle_check.py; rm -f mhri_sensor.launch', 'mhri_sensor.launch turtle_check.py'),
    ('chmod a-x turtle_remote.sh', 'turtle_remote.sh'),
])
def test_what_is_not_as_it_was_sent_is_said(robot, damage, names):
    """The program that ends the writing goes well; what is on the disk is something else."""
    robot.program(robot.tools / 'ln', '#!/bin/sh\n/usr/bin/ln "$@" && {}\n'.format(damage))
    status, output = robot.deploy()
    assert status == 1
    assert '({})'.format(names) in output
    (robot.tools / 'ln').unlink()
    status, output = robot.deploy()
    assert status == 0 and ': {}\n'.format(names) in output
    is_complete(robot)


def test_link_that_was_not_made_is_said(robot):
    robot.program(robot.tools / 'ln', '#!/bin/sh\nexit 0\n')
    status, output = robot.deploy()
    assert status == 1 and '({})'.format(LINK) in output

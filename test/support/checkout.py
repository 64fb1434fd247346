# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A checkout to run the scripts in, and programs that stand in for those that change a machine."""
import os
from pathlib import Path
import shutil
import signal
import subprocess

import pytest

from support.paths import REPO

# What the scripts read beside themselves.
READ = ('launch', 'resource')
BUILD_INPUTS = ('CMakeLists.txt', 'package.xml', 'setup.py', 'action', 'msg', 'srv', 'scripts')

# Each stand-in writes its name and arguments to the file of calls, and then what its text says.
RECORD = '#!/bin/bash\nprintf "%s\\n" "${0##*/} $*" >>"$MHRI_CALLS"\n'
STAND_INS = {
    'sudo': '"$@"',
    'id': 'if [ "$1" = -u ]; then echo "${FAKE_UID:-0}"; else exec /usr/bin/id "$@"; fi',
    'apt-get': 'exit "${FAKE_APT_STATUS:-0}"',
    'rosdep': 'if [ "$1" = check ]; then exit "${FAKE_ROSDEP_CHECK:-0}"; fi',
    'dpkg-query': 'case " $FAKE_MISSING " in *" ${*: -1} "*) exit 1 ;; *) printf installed ;; esac',
    'hostname': 'if [ "$*" = -I ]; then echo "$FAKE_ADDRESSES "; else echo host; fi',
    'catkin_make': 'mkdir -p devel install build; touch devel/setup.bash install/setup.bash',
    'roslaunch': 'env | grep -E "^(ROS_|DISPLAY|XAUTH)" | sort >>"$MHRI_CALLS"\n'
                 'if [ -n "${FAKE_ROSLAUNCH:-}" ]; then eval "$FAKE_ROSLAUNCH"; fi',
}


class Checkout:
    """A copy of the host scripts and of what is built, with stand-ins first on the path."""

    def __init__(self, folder, name='a checkout', stand_ins=tuple(STAND_INS)):
        self.root = folder / name
        self.calls_file = folder / 'calls'
        self._bin = folder / 'bin'
        self._bin.mkdir()
        for program in stand_ins:
            self.stand_in(program, STAND_INS[program])
        shutil.copytree(str(REPO / 'utils'), str(self.root / 'utils'))
        for part in BUILD_INPUTS + READ:
            copy = shutil.copytree if (REPO / part).is_dir() else shutil.copy
            copy(str(REPO / part), str(self.root / part))
        self.os_release(folder / 'os-release', 'debian', '12')
        self.environment = {
            'PATH': '{}:/usr/bin:/bin'.format(self._bin), 'HOME': str(folder), 'DISPLAY': ':0',
            'MHRI_CALLS': str(self.calls_file), 'MHRI_OS_RELEASE': str(folder / 'os-release'),
            'MHRI_NOETIC': str(folder / 'noetic'), 'FAKE_MISSING': '', 'FAKE_UID': '0',
            'FAKE_ADDRESSES': '192.0.2.7', 'TMPDIR': str(folder)}

    def stand_in(self, name, text):
        """Write one stand-in."""
        path = self._bin / name
        path.write_text(RECORD + text + '\n')
        path.chmod(0o755)

    @staticmethod
    def os_release(path, name, version):
        path.write_text('ID={}\nVERSION_ID="{}"\n'.format(name, version))

    @property
    def script(self):
        return self.root / 'utils' / 'host' / 'mhri_run.sh'

    @property
    def calls(self):
        """Return the lines that the stand-ins wrote."""
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []

    def called(self, *names):
        """Return the calls of these programs."""
        return [line for line in self.calls if line.split()[0] in names]

    def start(self, *arguments, script=None, cwd=None, **environment):
        """Start the script; the caller waits for it."""
        return subprocess.Popen(
            [str(script or self.script)] + list(arguments), cwd=str(cwd or self.root.parent),
            env=dict(self.environment, **environment), stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))

    def run(self, *arguments, limit_s=300, **keywords):
        """Return (exit status, all output) of the script."""
        process = self.start(*arguments, **keywords)
        try:
            output = process.communicate(timeout=limit_s)[0]
        finally:
            process.kill()
        return process.returncode, output


@pytest.fixture
def checkout(tmp_path):
    """Return a :class:`Checkout`; its path has a space in it."""
    return Checkout(tmp_path)


def children_with(text):
    """Return the ids of running processes whose environment has a text in it."""
    found = []
    for entry in Path('/proc').iterdir():
        try:
            if entry.name.isdigit() and text.encode() in (entry / 'environ').read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue  # it ended meanwhile, or is somebody else's
    return [pid for pid in found if pid != os.getpid()]

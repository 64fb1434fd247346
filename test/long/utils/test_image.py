# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The Dockerfile's steps on a bare Debian 12, without Docker; its demo as an unknown user.

Takes a quarter of an hour, 3 GB and the archives of Debian and PyPI: only with ``MHRI_LONG=1``, as
root, where debootstrap is installed. Prints how long each step took.
"""
import os
import shutil
import subprocess
import time

import pytest

from support.checkout import REPO
from support.hostile import is_long

LIMIT_S = 1500
# A process tree of its own, which ends with its first process.
INSIDE = ['unshare', '--mount', '--pid', '--fork', '--kill-child', 'bash', '-c', '''
root=$1; shift
mount -t proc proc "$root/proc"
mkdir -p "$root/dev/shm"; mount -t tmpfs tmpfs "$root/dev/shm"
exec chroot "$@"''', 'bash']
USER = '4321'


def why_not():
    if not is_long():
        return 'takes a quarter of an hour: MHRI_LONG=1'
    if os.geteuid() != 0 or not shutil.which('debootstrap'):
        return 'needs root and debootstrap'
    return None


pytestmark = pytest.mark.skipif(why_not() is not None, reason=why_not() or '')


def step(name, command, **keywords):
    """Run a step of the image and print how long it took."""
    began = time.monotonic()
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, timeout=LIMIT_S,
                          errors='replace', **keywords)
    print('{}: {:.0f} s'.format(name, time.monotonic() - began))
    assert done.returncode == 0, done.stdout[-5000:]
    return done.stdout


@pytest.fixture(scope='module')
def root(tmp_path_factory):
    """Return a bare Debian 12 that resolves names and trusts as this computer does."""
    folder = tmp_path_factory.mktemp('image') / 'root'
    step('debootstrap', ['debootstrap', '--variant=minbase', 'bookworm', str(folder),
                         'http://deb.debian.org/debian'])
    for name in ('/etc/resolv.conf', '/etc/hosts'):
        if os.path.exists(name):
            shutil.copy(name, str(folder) + name)
    certificates = '/usr/local/share/ca-certificates'
    if os.path.isdir(certificates):
        shutil.copytree(certificates, str(folder) + certificates, dirs_exist_ok=True)
    yield folder
    shutil.rmtree(str(folder))


def build(root):
    """Follow the Dockerfile in a root folder; return its entry point."""
    place, entry = None, None
    ignored = shutil.ignore_patterns('build', '.git', '__pycache__')
    for line in (REPO / 'Dockerfile').read_text().splitlines():
        name, _, rest = line.partition(' ')
        if name == 'WORKDIR':
            place = rest
            (root / place.lstrip('/')).mkdir(parents=True)
        elif name == 'COPY':
            source, target = rest.split()
            shutil.copytree(str(REPO / source), str(root / place.lstrip('/') / target),
                            ignore=ignored, dirs_exist_ok=True)
        elif name == 'RUN':
            step(rest, INSIDE + [str(root), str(root), '/bin/bash', '-euo', 'pipefail', '-c',
                                 'cd {}; {}'.format(place, rest)])
        elif name == 'ENTRYPOINT':
            entry = rest.strip('[]"')
    return entry


def test_the_image_drives_robots_as_any_user(root):
    entry = build(root)
    home = root / 'home' / 'somebody'
    home.mkdir()
    os.chown(str(home), int(USER), int(USER))
    output = step('demo', INSIDE + [
        str(root), '--userspec={0}:{0}'.format(USER), str(root), 'env', '-i',
        'PATH=/usr/bin:/bin', 'HOME=/home/somebody', 'USER=somebody', entry, '--demo',
        '--screenshot', '/home/somebody/demo.png'])
    assert 'the demo succeeded' in output
    assert (home / 'demo.png').stat().st_size > 10000
    print('{} MB'.format(int(subprocess.run(
        ['du', '-sm', str(root)], stdout=subprocess.PIPE, check=True,
        universal_newlines=True).stdout.split()[0])))

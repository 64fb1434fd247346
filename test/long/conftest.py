# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A publisher and disks for recordings that go wrong; a network of a test's own."""
import os
import subprocess
import sys
import threading

import pytest

from support import bad_radio
from support.paths import SUPPORT


@pytest.fixture(scope='module')
def sender(system):
    """A publisher of numbered texts at 250 Hz, 10 kB each, as long as anybody listens."""
    import rospy
    from std_msgs.msg import String
    publisher = rospy.Publisher('/bot1/text', String, queue_size=1000)
    done = threading.Event()

    def send():
        number = 0
        while not done.wait(0.004):
            if publisher.get_num_connections():
                publisher.publish('{:08} '.format(number) + 'x' * 10000)
                number += 1
    thread = threading.Thread(target=send)
    thread.start()
    yield publisher
    done.set()
    thread.join()


@pytest.fixture
def in_own_network(request):
    """Return a function that runs the test's file as a program, for so many seconds at most.

    In a network of its own, so that the radio's addresses meet nobody else's.
    """
    why_not = bad_radio.why_not()
    if why_not is not None:
        pytest.skip(why_not)

    def run(timeout_s):
        done = subprocess.run(
            ['unshare', '--net', 'sh', '-c', 'ip link set lo up && exec "$0" "$1"', sys.executable,
             str(request.fspath)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            timeout=timeout_s, universal_newlines=True,
            env=dict(os.environ, PYTHONPATH='{}:{}'.format(
                SUPPORT.parent, os.environ['PYTHONPATH'])))
        print(done.stdout)
        assert done.returncode == 0, done.stdout[-3000:]
    return run


@pytest.fixture
def disk(tmp_path):
    """Return a function that mounts a tmpfs of some MB; unmounted at the end."""
    mounted = []

    def mount(size_mb, *options):
        path = str(tmp_path / 'disk{}'.format(len(mounted)))
        os.mkdir(path)
        done = subprocess.run(['mount', '-t', 'tmpfs', '-o', ','.join(
            ['size={}m'.format(size_mb)] + list(options)), 'tmpfs', path], stderr=subprocess.PIPE)
        if done.returncode:
            pytest.skip('no right to mount here: ' + done.stderr.decode().strip())
        mounted.append(path)
        return path
    yield mount
    for path in mounted:
        # The recorder may be looking at it.
        subprocess.run(['umount', '--lazy', path], check=True)

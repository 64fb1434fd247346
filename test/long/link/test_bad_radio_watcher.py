# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A host that only watches, wants everything and never says what comes: the operator drives on."""
import os
import random
import subprocess
import sys
import time

BAD = {'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}
LONG_S, DRIVE_S = 120.0, 15.0
# Without the watcher it is 100 %; on a busy computer a little less.
MIN_PERCENT = 70.0


def test_a_watcher_that_never_reports_does_not_take_the_radio(in_own_network):
    in_own_network(3 * LONG_S)


def watch(endpoint, folder):
    """Want everything of the robot, and report nothing."""
    from mhri.link.carried import COMMAND
    from mhri.link.frames import Beat, pack, pack_beat, unpack, unpack_about
    from mhri.link.ros.carrier import Carrier
    from mhri.link.ros.clock import boot_clock
    from mhri.link.ros.key_folder import KeyFolder
    keys = KeyFolder(folder, 'host', 'tls1')
    carrier = Carrier(connect=[endpoint], secrets=keys.read(), own='watch:gallery')
    between, about, came = carrier.between('tls1', 'watch:gallery'), [], [0]

    def hear(topic, data):
        """Note what the robot has."""
        came[0] += len(data)
        if topic == '_about':
            about.append(unpack_about(unpack(data).body))
    between.listen('up', hear)
    send, number, session = between.sender('down', '_beat', COMMAND), 0, random.getrandbits(32)
    while True:
        number += 1
        found = about[-1] if about else None
        send(pack(session, number, boot_clock(), pack_beat(
            Beat(None, found.name, tuple(range(len(found.topics)))) if found else Beat())))
        if number % 25 == 0:
            print('watched', came[0], flush=True)
        time.sleep(0.2)


def inside():
    """Be the operator; end with an AssertionError where something is not so."""
    from support.behind_radio import FAR_IP, FIRST_PORT, World
    with World(['tls'], 1) as world:
        world.start()
        world.look('tls')
        world.settle('tls')
        with subprocess.Popen([sys.executable, os.path.abspath(__file__),
                               'tls/{}:{}'.format(FAR_IP, FIRST_PORT),
                               str(world.keys['gallery'])],
                              stdout=subprocess.PIPE, universal_newlines=True) as watcher:
            try:
                while watcher.stdout.readline().split() in ([], ['watched', '0']):
                    pass
                figures, _ = world.measure('tls', BAD, 0, DRIVE_S)
            finally:
                watcher.kill()
        print('MEASURED beside a watcher that never reports it drove {:.0f} %'.format(
            figures['drove_percent']))
        assert figures['drove_percent'] > MIN_PERCENT


if __name__ == '__main__':
    if sys.argv[1:]:
        watch(*sys.argv[1:])
    else:
        inside()

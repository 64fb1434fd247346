# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's link with keys, somebody who calls it with garbage again and again, and a host.

As turtle_remote.sh --link limits the calls of each address; network namespaces.
"""
import os
from pathlib import Path
import shutil
import subprocess
import sys
import threading
import time

import pytest

from support import machines
from support.authority import Authority
from support.ros_system import wait_for

WHY_NOT = machines.why_not() or (
    None if shutil.which('nft', path=os.environ['PATH'] + ':/usr/sbin') else 'there is no nft here')
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

REMOTE = Path(__file__).resolve().parents[3] / 'utils' / 'remote'
PORT = 7447
CALLS_HZ, ATTACKED_S = 50.0, float(os.environ.get('MHRI_ATTACKED_S', '10'))
# It takes 2 to 11 s; without the limit it was not let in for 180 s.
LET_IN_S = 60.0
LIMIT = '''
HERE={} LISTEN=0.0.0.0:{} ROUTER=
warn() {{ echo "$@" >&2; exit 1; }}
. "$HERE/turtle_link.sh"
limit_callers
'''
CALL = '''
import socket, sys, time
while True:
    begun = time.monotonic()
    try:
        with socket.create_connection((sys.argv[1], int(sys.argv[2])), 0.2) as caller:
            caller.sendall(b'garbage ' * 50)
    except OSError:
        pass
    time.sleep(max(0.0, begun + 1.0 / float(sys.argv[3]) - time.monotonic()))
'''
END = '''
import sys, time
from mhri.link.carried import COMMAND
from mhri.link.ros.carrier import Carrier
from mhri.link.ros.key_folder import KeyFolder
side, folder, endpoint = sys.argv[1:]
keys = KeyFolder(folder, side, 'bot1')
ends = {'listen': [endpoint]} if side == 'robot' else {'connect': [endpoint]}
carrier = Carrier(secrets=keys.read(), own=keys.keys.own, **ends)
between = carrier.between('bot1', 'host:lab')
between.listen('down' if side == 'robot' else 'up',
               lambda topic, data: print('heard', topic, flush=True))
send = between.sender('up' if side == 'robot' else 'down', '_beat', COMMAND)
while True:
    send(b'x')
    time.sleep(0.1)
'''


def start(command, log):
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log.open('w'),
                            stderr=subprocess.STDOUT)


def test_who_calls_with_garbage_keeps_no_host_out(tmp_path):
    keys = Authority(tmp_path)
    keys.run('host', 'lab')
    keys.run('robot', 'bot1')
    robot_keys, host_keys = keys.put('bot1'), keys.put('lab')
    endpoint = 'tls/{}:{}'.format(machines.ROBOT_IP.format(11), PORT)
    processes = []
    with machines.Lan(tmp_path):
        robot, attacker = machines.Computer(11), machines.Computer(12)
        try:
            if os.environ.get('MHRI_UNLIMITED') is None:
                machines.run(*robot.command('bash', '-euc', LIMIT.format(REMOTE, PORT)))
            processes.append(start(robot.command(
                sys.executable, '-c', END, 'robot', str(robot_keys), endpoint), tmp_path / 'robot'))
            wait_for(lambda: reached(attacker), 60.0, 'the robot to listen', 0.2)
            processes.append(start(attacker.command(
                sys.executable, '-c', CALL, robot.ip, str(PORT), str(CALLS_HZ)),
                tmp_path / 'attacker'))
            threading.Event().wait(ATTACKED_S)
            begun = time.monotonic()
            processes.append(start([sys.executable, '-c', END, 'host', str(host_keys), endpoint],
                                   tmp_path / 'host'))
            wait_for(lambda: 'heard' in (tmp_path / 'host').read_text(), 400.0,
                     lambda: 'the host to be let in: {}'.format((tmp_path / 'host').read_text()))
            took_s = time.monotonic() - begun
            print('MEASURED called {:.0f} times a second: the host is let in after {:.1f} s'.format(
                CALLS_HZ, took_s))
            assert took_s < LET_IN_S
        finally:
            for process in processes:
                process.kill()
                process.wait(10)
            for computer in (robot, attacker):
                computer.close()


def reached(computer):
    return subprocess.run(computer.command(
        'bash', '-c', ': </dev/tcp/{}/{}'.format(machines.ROBOT_IP.format(11), PORT)),
        stderr=subprocess.DEVNULL).returncode == 0

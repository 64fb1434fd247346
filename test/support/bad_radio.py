#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bad radio between two network namespaces: a TUN device in each, and this process in between.

    bad_radio.py --far PID --table FILE    (the other end is in the namespace of the process PID)

Everything that goes through, TCP and UDP alike, is treated as the table says (``radio.py``). Every
line on its standard input is another table, which starts at once; the end of the input, SIGINT or
SIGTERM ends it. When a table ends it says what it really did under each row, in either direction.
Needs root and /dev/net/tun.
"""
import argparse
import ctypes
import fcntl
import json
import os
from pathlib import Path
import random
import selectors
import shutil
import signal
import struct
import subprocess
import sys
import time

import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.radio import Channel, FATES, read_table, Table, TableError  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454ca, 0x0001, 0x1000
CLONE_NEWNET = 0x40000000
DEVICE = 'radio0'
NEAR_IP, FAR_IP = '10.78.0.1', '10.78.0.2'
DIRECTIONS = ('to far', 'to near')
# So many packets of one end are read before those that are due leave.
AT_ONCE = 32
LARGEST = 65536


def why_not():
    """Return why there can be no radio here, or None."""
    if os.geteuid() != 0:
        return 'a radio of our own needs root: network namespaces and TUN devices'
    for program in ('unshare', 'nsenter', 'setpriv', 'ip'):
        if shutil.which(program) is None:
            return 'there is no {} here (packages util-linux, iproute2)'.format(program)
    probe = subprocess.run(['unshare', '--net', sys.executable, os.path.abspath(__file__),
                            '--probe'], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, universal_newlines=True)
    if probe.returncode:
        return 'no namespace or no TUN device for us here: ' + probe.stdout.strip()[-200:]
    return None


def tun(pid, device, own_ip, other_ip):
    """Return the file descriptor of a new TUN device in the network namespace of a process.

    :raises OSError: no such process, no /dev/net/tun, or not allowed
    """
    libc = ctypes.CDLL(None, use_errno=True)
    before = os.open('/proc/self/ns/net', os.O_RDONLY)
    there = os.open('/proc/{}/ns/net'.format(pid), os.O_RDONLY)
    try:
        if libc.setns(there, CLONE_NEWNET):
            raise OSError(ctypes.get_errno(), 'setns')
        end = os.open('/dev/net/tun', os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(end, TUNSETIFF, struct.pack('16sH', device.encode(), IFF_TUN | IFF_NO_PI))
        for words in (('link', 'set', device, 'addrgenmode', 'none'),
                      ('addr', 'add', own_ip, 'peer', other_ip, 'dev', device),
                      ('link', 'set', device, 'txqueuelen', '10000', 'up')):
            subprocess.run(('ip',) + words, check=True)
        return end
    finally:
        libc.setns(before, CLONE_NEWNET)
        os.close(before)
        os.close(there)


class Radio:
    """Carries packets between two TUN devices, in one thread.

    :param ends: their file descriptors, near and far
    :param rows: from ``read_table``
    """

    def __init__(self, ends, rows, seed):
        self._start(rows)
        self._channels = [Channel(self._table, random.Random('{}/{}'.format(seed, name)))
                          for name in DIRECTIONS]
        # (from, channel, to)
        self._ways = list(zip(ends, self._channels, reversed(ends)))
        self._selector = selectors.SelectSelector()  # in microseconds, where epoll has milliseconds
        for way in self._ways:
            self._selector.register(way[0], selectors.EVENT_READ, way)

    def _start(self, rows):
        self._used_s = time.process_time()
        self._table = Table(rows, time.monotonic())

    def listen(self, stream, heard):
        """Call a function when a stream can be read."""
        self._selector.register(stream, selectors.EVENT_READ, heard)

    def follow(self, rows):
        """Go over to another table; return what was done under the one before."""
        report = self.report()
        self._start(rows)
        for channel in self._channels:
            channel.follow(self._table)
        return report

    def turn(self):
        """Wait for something to do, and do it.

        :raises OSError: an end is gone
        """
        due = [channel.next_s() for channel in self._channels if channel.next_s() is not None]
        wait_s = max(0.0, min(due) - time.monotonic()) if due else None
        for key, _ in self._selector.select(wait_s):
            if callable(key.data):
                key.data()
            else:
                self._read(*key.data[:2])
        for _, channel, sink in self._ways:
            for packet in channel.take(time.monotonic()):
                os.write(sink, packet)

    @staticmethod
    def _read(source, channel):
        for _ in range(AT_ONCE):
            try:
                packet = os.read(source, LARGEST)
            except BlockingIOError:
                return
            channel.put(time.monotonic(), packet)

    def report(self):
        """Return what was done under the table so far, as plain data."""
        now_s = time.monotonic()
        begun_s = self._table.rows[0][0]
        ends_s = [at_s for at_s, _ in self._table.rows[1:]] + [now_s]
        rows = []
        for number, (at_s, values) in enumerate(self._table.rows):
            took_s = max(0.0, min(ends_s[number], now_s) - at_s)
            rows.append({'at_s': at_s - begun_s, 'took_s': took_s, 'told': values,
                         'did': {name: channel.counts[number].figures(took_s) for name, channel
                                 in zip(DIRECTIONS, self._channels)}})
        took_s = now_s - begun_s
        return {'cores': (time.process_time() - self._used_s) / took_s, 'ended_s': now_s,
                'rows': rows}


def told(values):
    """Return a row's values as a person reads them."""
    if values['down']:
        return 'down'
    rate = '{rate_mbit:g} Mbit/s, queue {queue_ms:g} ms'.format(**values) \
        if values['rate_mbit'] else 'no limit of the rate'
    return '{delay_ms:g} ms, jitter {jitter_ms:g} ms, loss {loss_percent:g} %, {}'.format(
        rate, **values)


def lines_of(report):
    """Return a report as a person reads it."""
    found = ['{:<10} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>11}'.format(
        '', 'packets', *(fate.replace('queue_', '') for fate in FATES), 'lost %', 'p50 ms',
        'p95 ms', 'bytes/s')]
    for row in report['rows']:
        found.append('from {at_s:.2f} s, for {took_s:.2f} s: {}'.format(told(row['told']), **row))
        for name, did in row['did'].items():
            delays = ['{:.1f}'.format(did[key]) if did[key] is not None else 'none'
                      for key in ('delay_p50_ms', 'delay_p95_ms')]
            found.append('  {:<8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7.2f} {:>8} {:>8} {:>11.0f}'
                         .format(name, did['packets'], *(did[fate] for fate in FATES),
                                 did['lost_percent'], *delays, did['bytes_per_s']))
    return found + ['the radio itself: {:.2f} cores'.format(report['cores'])]


class Program:
    """The radio as a process: tables in, reports out."""

    def __init__(self, options):
        self._options = options
        self._ended = False
        self._input = b''
        ends = [tun(options.near, options.device, options.near_ip, options.far_ip),
                tun(options.far, options.device, options.far_ip, options.near_ip)]
        self._radio = Radio(ends, read_table(options.table), options.seed)
        self._radio.listen(0, self._hear)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._end)
        # A signal only interrupts the waiting where a byte comes with it.
        ear, mouth = os.pipe2(os.O_NONBLOCK)
        signal.set_wakeup_fd(mouth)
        self._radio.listen(ear, lambda: os.read(ear, 64))

    def _end(self, *_):
        self._ended = True

    def _hear(self):
        """Read what came; every whole line is a table."""
        data = os.read(0, LARGEST)
        self._ended = self._ended or not data
        self._input += data
        while b'\n' in self._input:
            line, _, self._input = self._input.partition(b'\n')
            self._say(self._radio.follow(read_table(yaml.safe_load(line.decode()))))

    def _say(self, report):
        text = json.dumps(report) if self._options.json else '\n'.join(lines_of(report))
        print(text, flush=True)

    def run(self):
        """Run until told to end, and say what was done."""
        print(json.dumps({'seed': self._options.seed}) if self._options.json
              else 'seed {}'.format(self._options.seed), flush=True)
        while not self._ended:
            self._radio.turn()
        self._say(self._radio.report())


def main():
    """Run the radio, or only try whether there can be one."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--far', metavar='PID', default='self', help='in the far namespace')
    parser.add_argument('--near', metavar='PID', default='self', help='default: this process')
    parser.add_argument('--near-ip', default=NEAR_IP)
    parser.add_argument('--far-ip', default=FAR_IP)
    parser.add_argument('--device', default=DEVICE, help='name of the device on either side')
    parser.add_argument('--table', metavar='FILE', help='YAML; default: a clean cable')
    parser.add_argument('--seed', type=int, default=None, help='of loss and jitter')
    parser.add_argument('--json', action='store_true', help='say it for programs')
    parser.add_argument('--probe', action='store_true', help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.probe:
        tun('self', DEVICE, NEAR_IP, FAR_IP)
        return
    if options.seed is None:
        options.seed = random.SystemRandom().randrange(10 ** 6)
    try:
        options.table = yaml.safe_load(Path(options.table).read_text()) if options.table \
            else [{'at_s': 0}]
        Program(options).run()
    except (TableError, OSError, yaml.YAMLError, subprocess.CalledProcessError) as error:
        sys.exit('bad_radio: {}'.format(error))


class Place:
    """A network namespace of its own, held by a process until :meth:`close`."""

    def __init__(self):
        self._holder = subprocess.Popen(
            ['setpriv', '--pdeathsig', 'KILL', 'unshare', '--net', 'sleep', 'infinity'],
            stdin=subprocess.DEVNULL)
        self.pid = self._holder.pid
        comm = Path('/proc/{}/comm'.format(self.pid))
        wait_for(lambda: comm.read_text().strip() == 'sleep', 60.0, 'the namespace')
        subprocess.run(self.command('ip', 'link', 'set', 'lo', 'up'), check=True)

    def command(self, *words):
        """Return a command line that runs another in this namespace."""
        return ['nsenter', '--target', str(self.pid), '--net', '--'] + list(words)

    def close(self):
        """End it."""
        self._holder.kill()
        self._holder.wait(20)


class BadRadio:
    """The radio in a process of its own; use it as a context manager.

    :param far: a :class:`Place`
    :param near: a :class:`Place`; None: the namespace of this process
    :param rows: the first table; default: a clean cable
    """

    def __init__(self, far, near=None, rows=None, seed=1):
        near_pid = near.pid if near else os.getpid()
        self._process = subprocess.Popen(
            [sys.executable, os.path.abspath(__file__), '--json', '--seed', str(seed),
             '--near', str(near_pid), '--far', str(far.pid)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True)
        self._answer()
        if rows:
            self.follow(rows)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError('the radio ended with {}'.format(self._process.wait(20)))
        return json.loads(line)

    def follow(self, rows):
        """Go over to another table; return the report of the one before."""
        self._process.stdin.write(json.dumps(rows) + '\n')
        self._process.stdin.flush()
        return self._answer()

    def close(self):
        """End it."""
        if self._process.poll() is None:
            self._process.stdin.close()
        self._process.wait(20)
        self._process.stdout.close()


if __name__ == '__main__':
    main()

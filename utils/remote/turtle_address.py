#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtle_address.py OPTION TARGET ADDRESS...: prints the ADDRESS at which TARGET reaches us.

For turtle_remote.sh and connect_turtlebot.sh; operators do not call it. OPTION is the caller's
option with which the operator names an address. Exit status 1, and one line that says what is
wrong, if none or several would do. Needs only the standard library; runs under Python 2.7, too.
"""
import contextlib
import socket
import struct
import subprocess
import sys


class Problem(Exception):
    """There is no address, or no telling which; the text names the remedy."""


def number(address):
    """Return an IPv4 address as a number.

    :raises Problem: it is none
    """
    try:
        return struct.unpack('!I', socket.inet_pton(socket.AF_INET, address))[0]
    except (OSError, socket.error, ValueError):  # not the same in Python 2; a null character
        raise Problem('{0:.40} is not an IPv4 address such as 192.168.0.7'.format(repr(address)))


def prefix_lengths():
    """Return {own address: length of its network's prefix in bits}, as far as ``ip`` tells."""
    try:
        text = subprocess.check_output(['ip', '-o', '-4', 'addr', 'show']).decode()
    except (OSError, subprocess.CalledProcessError):
        return {}
    found = {}
    for word in text.split():
        address, slash, length = word.partition('/')
        if slash and address.count('.') == 3 and length.isdigit():
            found[address] = int(length)
    return found


def way_out(target):
    """Return the address from which this computer would talk to a target, or None."""
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as probe:
        try:
            probe.connect((target, 9))
            return probe.getsockname()[0]
        except (OSError, socket.error):  # not the same in Python 2
            return None


def choose_address(target, own, lengths, out, option):
    """Return the one of our addresses at which a target reaches us.

    :param own: our IPv4 addresses, as ``hostname -I`` has them
    :param lengths: {address: prefix length}; an address not in it counts as in a /24
    :param out: the address the system would use towards the target, or None
    :param option: the option with which the operator names one, e.g. ``--ip``
    :raises Problem: there is none, or several would do
    """
    number(target)
    # The system talks to each of its own addresses, even 127.0.0.1, from that same address.
    if out == target or target in own:
        return target
    if not own:
        raise Problem('this computer has no IPv4 address: connect it to the network of {0}, or '
                      'name one with {1} ADDR'.format(target, option))
    near = []
    for address in own:
        shift = 32 - lengths.get(address, 24)
        if number(address) >> shift == number(target) >> shift:
            near.append(address)
    if len(near) == 1:
        return near[0]
    if out in (near or own):
        return out
    if len(own) == 1:
        return own[0]
    raise Problem('which of the addresses of this computer ({0}) does {1} reach? Name it with '
                  '{2} ADDR'.format(' '.join(own), target, option))


def main(*arguments):
    """Print the address; if there is none, exit with what is wrong."""
    if len(arguments) < 2:
        sys.exit('mhri: usage: turtle_address.py OPTION TARGET ADDRESS...')
    option, target, own = arguments[0], arguments[1], arguments[2:]
    try:
        for address in own:
            number(address)
        address = choose_address(target, own, prefix_lengths(), way_out(target), option)
    except Problem as problem:
        sys.exit('mhri: {0}'.format(problem))
    sys.stdout.write('{0}\n'.format(address))


if __name__ == '__main__':
    main(*sys.argv[1:])

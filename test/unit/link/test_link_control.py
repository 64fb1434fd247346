# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which host is in control of a linked robot: link/control."""
import struct

import pytest

from mhri.link.control import (
    ASK_S, ASKED, Control, FREE, HELD, moves, pack_control_status, SILENT_S, ControlStatus, STEP_S,
    unpack_control_status)
from mhri.link.frames import FrameError
from mhri.robots.owners import ASK_FOR, may_drive, shown, TAKE_IT

LAB, DESK, GALLERY = 'host:lab', 'host:desk.2', 'watch:gallery'


def control(*held):
    """Return a control in a state, at time 10: who has it, who asked for it at 10."""
    made = Control(may_drive)
    for host in (LAB, DESK, GALLERY):
        made.on_heard(host, 10.0)
    if held:
        assert made.passes(held[0], False, True, 10.0)
    if len(held) > 1:
        assert made.ask(held[1], 10.0)
    made.events.clear()
    return made


def drives(host, at=10.1):
    return lambda made: made.passes(host, False, True, at)


def asks(host, at=10.1):
    return lambda made: made.ask(host, at)


def goes(host):
    return lambda made: made.on_gone(host)


def time_is(now, *heard):
    def pass_time(made):
        for host in heard:
            made.on_heard(host, now)
        made.tick(now)
    return pass_time


@pytest.mark.parametrize('held, event, state, holder, logged', [
    # nobody has control
    ((), drives(LAB), HELD, LAB, True),
    ((), lambda made: made.passes(LAB, False, False, 10.1), FREE, '', False),
    ((), drives(GALLERY), FREE, '', True),
    ((), asks(DESK), HELD, DESK, True),
    ((), asks(GALLERY), FREE, '', True),
    ((), goes(LAB), FREE, '', False),
    ((), time_is(20.0), FREE, '', False),
    # somebody has it
    ((LAB,), drives(LAB), HELD, LAB, False),
    ((LAB,), drives(DESK), HELD, LAB, True),
    ((LAB,), drives(GALLERY), HELD, LAB, True),
    ((LAB,), asks(LAB), HELD, LAB, False),
    ((LAB,), asks(DESK), ASKED, LAB, True),
    ((LAB,), goes(LAB), FREE, '', True),
    ((LAB,), goes(DESK), HELD, LAB, False),
    ((LAB,), time_is(10.0 + SILENT_S), HELD, LAB, False),
    ((LAB,), time_is(10.1 + SILENT_S), FREE, '', True),
    # another has asked for it
    ((LAB, DESK), asks(DESK, 10.0 + STEP_S), HELD, DESK, True),
    ((LAB, DESK), asks(DESK, 9.9 + STEP_S), ASKED, LAB, False),
    ((LAB, DESK), asks(LAB), HELD, LAB, False),
    ((LAB, DESK), drives(LAB), ASKED, LAB, False),
    ((LAB, DESK), drives(DESK), ASKED, LAB, True),
    ((LAB, DESK), goes(DESK), HELD, LAB, False),
    ((LAB, DESK), goes(LAB), FREE, '', True),
    ((LAB, DESK), time_is(10.1 + ASK_S, LAB, DESK), HELD, LAB, False),
    ((LAB, DESK), time_is(10.0 + ASK_S, LAB, DESK), ASKED, LAB, False),
])
def test_every_state_and_event(held, event, state, holder, logged):
    made = control(*held)
    event(made)
    assert (made.state, made.holder) == (state, holder)
    assert bool(made.events) is logged


def test_only_the_holders_commands_pass():
    made = control(LAB)
    assert made.passes(LAB, False, True, 10.1) and made.passes(LAB, False, False, 10.1)
    for moving in (True, False):
        assert not made.passes(DESK, False, moving, 10.1)
        assert not made.passes(GALLERY, False, moving, 10.1)


def test_after_a_change_the_new_holder_is_obeyed_from_neutral_on():
    made = control(LAB, DESK)
    assert made.ask(DESK, 11.0) == ''
    assert not made.passes(DESK, False, True, 11.1)
    assert not made.passes(LAB, False, False, 11.1)
    assert not made.passes(DESK, False, True, 11.2)
    assert made.passes(DESK, False, False, 11.3) and made.passes(DESK, False, True, 11.4)


def test_a_stop_counts_whoever_has_control_and_until_it_is_taken_back():
    made = control(LAB)
    assert made.passes(DESK, True, False, 10.1)
    assert not made.passes(LAB, False, True, 10.2)
    assert not made.passes(LAB, False, False, 10.2)
    assert made.passes(LAB, True, False, 10.2)
    assert not made.passes(DESK, False, False, 10.3)
    assert made.passes(LAB, False, False, 10.4) and made.passes(LAB, False, True, 10.5)


def test_a_watching_host_stops_nothing():
    made = control(LAB)
    assert not made.passes(GALLERY, True, False, 10.1)
    assert made.passes(LAB, False, True, 10.2)


def test_the_stop_of_one_who_has_gone_ends_when_somebody_takes_control():
    made = control(LAB)
    made.passes(LAB, True, False, 10.1)
    made.on_gone(LAB)
    assert not made.passes(DESK, False, True, 20.0)
    assert 'desk' in made.events[-1] and 'lab' in made.events[-1]
    assert made.ask(DESK, 20.0) == ''
    assert made.passes(DESK, False, False, 20.1) and made.passes(DESK, False, True, 20.2)


def test_who_drives_without_control_is_told_of_once():
    made = control(LAB)
    for number in range(100):
        made.passes(DESK, False, True, 10.0 + 0.05 * number)
    assert len(made.events) == 1 and 'desk' in made.events[0]


@pytest.mark.parametrize('row', [
    ControlStatus(), ControlStatus(LAB, DESK, True, 'a sentence', 3, 'an answer')])
def test_what_the_robot_says_comes_back(row):
    assert unpack_control_status(pack_control_status(row)) == row


@pytest.mark.parametrize('body', [
    b'', b'{}', b'[]',
    b'["","",1,"",0,""]', b'["","",true,"",true,""]', b'["../x","",true,"",0,""]',
    b'["","",true,"",0,"",1]', b'["robot:bot1","",true,"",0,""]', b'\xff' * 10])
def test_what_is_no_word_on_control(body):
    with pytest.raises(FrameError):
        unpack_control_status(body)


def test_a_peer_writes_no_escape_codes_into_the_log():
    sent = ControlStatus(said='a\x1b[2J\nb' + 'c' * 500)
    said = unpack_control_status(pack_control_status(sent)).said
    assert said.isprintable() and len(said) <= 200


@pytest.mark.parametrize('values, moving', [
    ((0.0,) * 6, False), ((-0.0,) * 6, False), ((0.0,) * 5 + (1e-9,), True),
    ((float('nan'),) + (0.0,) * 5, True), ((0.2,) + (0.0,) * 5, True)])
def test_what_moves(values, moving):
    assert moves(b'head' + struct.pack('<6d', *values)) is moving


def test_what_is_no_twist_counts_as_moving():
    assert moves(b'')


@pytest.mark.parametrize('own, may, holder, asking, names, button', [
    (LAB, True, '', '', '', ''), (LAB, True, LAB, '', '', ''), (LAB, True, LAB, DESK, 'desk', ''),
    (LAB, True, DESK, '', 'desk', ASK_FOR), (LAB, True, DESK, LAB, 'desk', TAKE_IT),
    (LAB, True, DESK, 'host:third', 'desk', ASK_FOR), (GALLERY, False, LAB, '', 'watch', '')])
def test_what_a_screen_shows(own, may, holder, asking, names, button):
    note, shown_button = shown(own, may, holder, asking)
    assert names in note and bool(note) == bool(names) and shown_button == button

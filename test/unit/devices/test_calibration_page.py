# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page on which a pad is calibrated: every event in every state, and the way to a profile."""
import itertools

import pytest

from mhri.devices.calibration_page import (
    ABSENT, ASKING, CalibrationPage, DONE, READY, SAVED, SAVING, STATES, STOPPING)
from mhri.devices.profile import parse_profile

PAD = {'kind': 'pad', 'name': 'Lab rat pad', 'guid': '0' * 31 + '1'}
GONE = {'kind': 'absent', 'reason': 'it was unplugged'}


def state(axes=(0.0, 0.0, 0.0), *pressed):
    return {'kind': 'state', 'axes': list(axes), 'buttons': [int(n in pressed) for n in range(10)]}


def push(page, *values):
    for part in (0.5, 1.0, 1.0, 0.0):
        page.on_line(state([part * value for value in values]))


def press(page, button):
    page.on_line(state((0.0, 0.0, 0.0), button))
    page.on_line(state())


def page_in(wanted):
    """Return a page in a state, reached as an operator reaches it."""
    page = CalibrationPage()
    if wanted == ABSENT:
        return page
    page.on_line(PAD)
    page.on_line(state())
    if wanted == READY:
        return page
    page.confirm()
    if wanted == STOPPING:
        return page
    page.on_stop(True)
    if wanted == ASKING:
        return page
    page.confirm()
    push(page, 0.0, -1.0, 0.0)
    push(page, -1.0, 0.0, 0.0)
    press(page, 6)
    for _ in range(5):
        page.confirm()
    if wanted == DONE:
        return page
    page.confirm()
    if wanted == SAVED:
        page.saved('Saved: here.')
    return page


EVENTS = {
    'comes': lambda page: page.on_line(PAD),
    'goes': lambda page: page.on_line(GONE),
    'stopped': lambda page: page.on_stop(True),
    'released': lambda page: page.on_stop(False),
    'confirm': CalibrationPage.confirm,
    'again': CalibrationPage.again,
    'saved': lambda page: page.saved('Saved: here.'),
    'refused': lambda page: page.refused('disk full'),
    'exists': lambda page: page.refused('it is there', True),
    'close': CalibrationPage.close,
}
CHANGES = {
    (ABSENT, 'comes'): READY, (READY, 'goes'): ABSENT, (READY, 'confirm'): STOPPING,
    (STOPPING, 'goes'): ABSENT, (STOPPING, 'stopped'): ASKING, (STOPPING, 'again'): READY,
    (ASKING, 'goes'): ABSENT, (ASKING, 'released'): READY, (DONE, 'confirm'): SAVING,
    (DONE, 'again'): READY, (SAVING, 'saved'): SAVED, (SAVING, 'refused'): DONE,
    (SAVING, 'exists'): DONE, (SAVED, 'comes'): READY, (SAVED, 'again'): READY,
    **{(before, 'close'): ABSENT for before in STATES if before != SAVING}}


@pytest.mark.parametrize('before, event', itertools.product(STATES, EVENTS))
def test_every_event_in_every_state(before, event):
    page = page_in(before)
    assert page.state == before
    EVENTS[event](page)
    assert page.state == CHANGES.get((before, event), before)
    view = page.view()
    assert view.prompt and (view.pad == '') == (page.state == ABSENT)


def test_from_a_pad_to_a_profile():
    page = page_in(DONE)
    view = page.view()
    assert [index for index, _ in view.axis_words] == [0, 1]
    assert [index for index, _ in view.button_words] == [6]
    assert 'lab_rat_pad' in view.prompt and not page.replaces
    page.confirm()
    profile = parse_profile(page.text(), 'lab_rat_pad.yaml')
    assert (profile.name, profile.forward.index, profile.turn.index) == ('lab_rat_pad', 1, 0)
    assert page.pad == (PAD['name'], PAD['guid'])
    taken = CalibrationPage(['lab_rat_pad'])
    taken.on_line(PAD)
    assert taken.name == 'my_lab_rat_pad'


def test_the_questions():
    page = page_in(ASKING)
    page.on_line(state((None, None, None)))
    page.confirm()
    assert page.view().step == 1 and page.view().problem
    page.on_line(state())
    page.confirm()
    assert (page.view().action, page.view().step) == ('', 2), 'only the stick goes on from here'
    page.again()
    assert page.view().action and page.view().step == 1


def test_a_file_that_is_there_is_replaced_only_when_asked_twice():
    page = page_in(SAVING)
    assert not page.replaces
    page.refused('there', True)
    assert page.replaces and page.view().problem == 'there'
    page.confirm()
    assert page.state == SAVING and page.replaces
    page.saved('Saved: there.')
    assert page.view().prompt == 'Saved: there.' and not page.view().problem


@pytest.mark.parametrize('line', [
    {}, {'kind': 5}, {'kind': 'state', 'axes': 5, 'buttons': []}, {'kind': 'state'},
    {'kind': 'what'}, {'kind': 'pad'}])
def test_lines_that_make_no_sense_do_no_harm(line):
    for before in STATES:
        page = page_in(before)
        page.on_line(line)
        assert page.view().prompt

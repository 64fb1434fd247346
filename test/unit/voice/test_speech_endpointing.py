# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where an utterance begins and ends, and what is made of it while it goes on."""
from dataclasses import replace

import numpy as np
import pytest

from mhri.voice.endpointing import (
    BEGIN, END, Endpointer, GO_ON, LEAD_S, MAX_UTTERANCE_S, PAUSE_S, QUIET)
from mhri.voice.io.listener import Began, Ended, Listener, Spotted
from mhri.voice.io.recogniser import compare, Fit, Hypothesis, Tuning
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S

ROOM, NOISE, SPEECH = 8.0, 300.0, 1500.0


class Sound:
    """Noise of some loudness in blocks, the same each time."""

    def __init__(self):
        self._random = np.random.RandomState(3)

    def blocks(self, seconds, rms):
        """Return so much sound of a loudness [steps of 16 bit, RMS]."""
        count = int(round(seconds / BLOCK_S))
        samples = self._random.standard_normal((count, BLOCK_BYTES // 2)) * rms
        return [row.astype('<i2').tobytes() for row in np.clip(samples, -32768, 32767)]


@pytest.fixture
def sound():
    return Sound()


def states(endpointer, blocks):
    return [endpointer.feed(block) for block in blocks]


@pytest.mark.parametrize('room', (0.0, ROOM, NOISE))
def test_an_utterance_begins_and_ends(sound, room):
    endpointer = Endpointer()
    assert set(states(endpointer, sound.blocks(3.0, room))) == {QUIET}
    begun = states(endpointer, sound.blocks(0.8, SPEECH))
    assert begun.count(BEGIN) == 1 and begun.index(BEGIN) <= 5
    assert set(begun[begun.index(BEGIN) + 1:]) == {GO_ON}
    ended = states(endpointer, sound.blocks(1.0, room))
    assert ended.count(END) == 1
    assert ended.index(END) * BLOCK_S == pytest.approx(PAUSE_S, abs=0.05)
    assert set(ended[ended.index(END) + 1:]) == {QUIET}


def test_what_came_before_the_beginning_belongs_to_it(sound):
    endpointer = Endpointer()
    blocks = sound.blocks(2.0, ROOM) + sound.blocks(0.5, SPEECH)
    for number, block in enumerate(blocks):
        if endpointer.feed(block) == BEGIN:
            lead = endpointer.lead()
            break
    assert len(lead) >= LEAD_S / BLOCK_S * BLOCK_BYTES
    assert b''.join(blocks[:number + 1]).endswith(lead)


def test_a_pause_inside_a_sentence_does_not_end_it(sound):
    endpointer = Endpointer()
    states(endpointer, sound.blocks(2.0, ROOM) + sound.blocks(0.5, SPEECH))
    assert END not in states(endpointer, sound.blocks(PAUSE_S - 0.1, ROOM)
                             + sound.blocks(0.5, SPEECH))


def test_a_click_is_no_speech(sound):
    endpointer = Endpointer()
    blocks = sound.blocks(2.0, ROOM) + sound.blocks(0.04, SPEECH) + sound.blocks(1.0, ROOM)
    assert set(states(endpointer, blocks)) == {QUIET}


def test_noise_that_begins_becomes_the_floor(sound):
    """A drill is an utterance once or twice, and then it is the room."""
    endpointer = Endpointer()
    states(endpointer, sound.blocks(2.0, ROOM))
    states(endpointer, sound.blocks(2 * MAX_UTTERANCE_S, NOISE))
    assert set(states(endpointer, sound.blocks(3.0, NOISE))) == {QUIET}
    assert BEGIN in states(endpointer, sound.blocks(0.5, SPEECH))


class FakeRecogniser:
    """Spots and recognises what it is told to."""

    def __init__(self):
        self.calls = []
        self.spots = {}
        self.found = None

    def begin(self, sound):
        self.calls.append('begin')
        return self.spots.pop(0, '')

    def go_on(self, sound):
        self.calls.append('go_on')
        return self.spots.pop(self.calls.count('go_on'), '')

    def end(self):
        self.calls.append('end')

    def recognise(self, sound):
        self.calls.append('recognise')
        return self.found


@pytest.fixture
def recogniser():
    return FakeRecogniser()


@pytest.fixture
def listener(recogniser, sound):
    ear = Listener(recogniser, lambda found: 'stop' in found.text)
    for block in sound.blocks(2.0, ROOM):
        assert ear.feed(block) == []
    assert recogniser.calls == [], 'a quiet room costs nothing'
    return ear


def events(ear, blocks):
    return [event for block in blocks for event in ear.feed(block)]


def test_one_utterance(listener, recogniser, sound):
    recogniser.found = Hypothesis('robot', 0.9)
    heard = events(listener, sound.blocks(0.6, SPEECH) + sound.blocks(1.0, ROOM))
    assert [type(event) for event in heard] == [Began, Ended]
    assert heard[1].hypothesis is recogniser.found
    assert heard[1].began_s == heard[0].at_s
    assert heard[1].at_s - heard[1].began_s == pytest.approx(0.6 + PAUSE_S - 0.08, abs=0.06)
    assert recogniser.calls.count('recognise') == 1, 'looked at once is enough'


def test_a_stop_is_said_while_it_is_spoken(listener, recogniser, sound):
    recogniser.spots = {5: 'stop'}
    heard = events(listener, sound.blocks(0.6, SPEECH))
    assert [type(event) for event in heard] == [Began, Spotted]
    assert heard[1].at_s - heard[0].at_s == pytest.approx(5 * BLOCK_S)


def test_a_stop_that_the_spotter_missed_does_not_wait_for_the_end(listener, recogniser, sound):
    recogniser.found = Hypothesis('stop', 0.9)
    heard = events(listener, sound.blocks(0.6, SPEECH) + sound.blocks(1.0, ROOM))
    assert [type(event) for event in heard] == [Began, Spotted, Ended]
    assert heard[2].at_s - heard[1].at_s == pytest.approx(PAUSE_S - 0.16, abs=0.05)


def test_what_was_looked_at_in_a_pause_is_looked_at_again(listener, recogniser, sound):
    recogniser.found = Hypothesis('robot', 0.9)
    events(listener, sound.blocks(0.5, SPEECH) + sound.blocks(0.3, ROOM))
    recogniser.found = Hypothesis('robot select all', 0.9)
    heard = events(listener, sound.blocks(0.5, SPEECH) + sound.blocks(1.0, ROOM))
    assert [event.hypothesis.text for event in heard] == ['robot select all']
    assert recogniser.calls.count('recognise') == 2


ANYTHING = [('a', 0, 49, -500), ('b', 50, 94, -900)]
FITS = {
    'as well as anything': ([('robot', 0, 49, -500), ('left', 50, 94, -900)], (0.0, 0.0, 0.0, 0)),
    'its last word worse': ([('robot', 0, 49, -500), ('left', 50, 94, -1850)],
                            (-19.0, 0.0, -10.0, 0)),
    'talk taken for silence': ([('<sil>', 0, 44, -1450), ('left(2)', 45, 94, -950)],
                               (-20.0, 0.0, 0.0, 45)),
    'what has no place': ([('(NULL)', 0, 49, -9999), ('left', 0, 94, -1400)],
                          (0.0, 0.0, 0.0, 0))}


@pytest.mark.parametrize('name', sorted(FITS))
def test_how_a_command_fits(name):
    fitted, wanted = FITS[name]
    fit = compare(fitted, ANYTHING)
    assert (fit.worst, fit.first, fit.mean, fit.start) == pytest.approx(wanted, abs=0.01)


TUNING = Tuning(worst_word=-30.0, first_word=-20.0, unspotted_wake=-12.0, all_words=-25.0,
                latest_start=40.0, stop_word=-18.0)
GOOD = Fit(worst=-10.0, second=-8.0, first=-10.0, mean=-10.0, start=30, gaps=0,
           words=(('robot', -10.0), ('stop', -8.0)))
MARGINS = [
    ({}, {}, 10.0), ({'worst': -35.0}, {}, -5.0), ({'first': -21.0}, {}, -1.0),
    ({'mean': -29.0}, {}, -4.0), ({'start': 46}, {}, -6.0),
    # With push-to-talk any word may come first; a wake word that was not spotted has to fit better.
    ({'first': -80.0}, {'woken': False}, 10.0), ({'first': -15.0}, {}, 5.0),
    ({'first': -15.0}, {'spotted': False}, -3.0)]
# A stop may come late but has to be one: "no stop everything" may fit in all but the stop itself.
STOP_MARGINS = [
    ({}, 10.0), ({'worst': -35.0}, -5.0), ({'mean': -29.0}, -4.0),
    ({'start': 90, 'first': -90.0}, 10.0), ({'words': (('stop', -30.0), ('it', -1.0))}, -12.0),
    ({'words': (('stop', -30.0), ('stop', -3.0))}, 15.0)]


@pytest.mark.parametrize('change, how, margin', MARGINS + [
    (change, {'stops': ('stop',)}, margin) for change, margin in STOP_MARGINS])
def test_every_limit_counts(change, how, margin):
    assert replace(GOOD, **change).margin(TUNING, **how) == margin


@pytest.mark.parametrize('change', [
    {'worst': -11.0}, {'second': -9.0}, {'first': -11.0}, {'mean': -11.0}, {'start': 34},
    {'gaps': 1}])
def test_every_sign_counts_together_with_the_others(change):
    assert replace(GOOD, **change).logit(TUNING) < GOOD.logit(TUNING)
    assert GOOD.logit(Tuning()) > 0.0
    poor = Fit(worst=-33.0, second=-28.0, first=-15.0, mean=-20.0, start=35, gaps=20)
    assert poor.margin(Tuning()) > 0.0 > poor.logit(Tuning()), 'within each limit, yet no command'

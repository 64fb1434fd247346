# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice as an input device: events of the process that listens into readings and wishes."""
import importlib.machinery
import os
from pathlib import Path
import socket
import sys
import time
import types

import numpy as np
import pytest

from mhri.devices.io.child import Channel
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reading
from mhri.voice.accessories import SpokenRow
from mhri.voice.grammar import STOP
from mhri.voice.io import listening, session, voice
from mhri.voice.io.recogniser import Hypothesis
from mhri.voice.io.voice import VoiceReader
from mhri.voice.language import parse_language
from mhri.voice.sound import BLOCK_BYTES
from mhri.voice.speech import NOT_SURE, STOP_RECORDING_S

PATH = Path(__file__).resolve().parents[3] / 'resource' / 'voice' / 'english.yaml'
LANGUAGE = parse_language(PATH.read_text(), str(PATH))
REST = Reading((0.0, 0.0))
FORWARD = Reading((0.0, 0.5))
OPEN = {'kind': 'open', 'device': 'x', 'notes': ['a note'], 'robots': ['bot1'], 'words': ['bot'],
        'accessories': []}
LAMP = SpokenRow('light', 'lamp', None, ('on',))


class Desk:
    """A reader whose process is this test, at a time of the test's own."""

    def __init__(self, monkeypatch):
        self.now = 50.0
        self.heard, self.acts = [], []
        self.reader = VoiceReader(LANGUAGE, str(PATH), self.heard.append, self.acts.append,
                                  lambda: self.now)
        desk = self

        class Process(Channel):
            """Ends with status 1."""

            def __init__(self, *_):
                here, desk.end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
                super().__init__(here)
                desk.process = Channel(desk.end)
                desk.process.send(OPEN)

            def end(self, timeout_s):
                return 1

        monkeypatch.setattr(voice, 'Child', Process)
        self.open()

    def open(self):
        """Open the reader; return the first reading."""
        self.reader.open()
        assert [order['source'] for order in self.orders()] == ['']
        return self.reader.read(0.0)

    def say(self, kind, **event):
        """Be the process; return the reading that follows."""
        self.process.send(dict(event, kind=kind))
        return self.reader.read(0.0)

    def ended(self, text, confidence=0.9, age_s=1.0):
        """End an utterance that began a second ago; return the reading that follows."""
        self.say('began')
        self.now += age_s
        return self.say('ended', text=text, confidence=confidence, age_s=age_s)

    def orders(self):
        """Return what the process was told."""
        return self.process.messages()

    def hang_up(self):
        """End the process."""
        self.end.close()


@pytest.fixture
def desk(monkeypatch):
    return Desk(monkeypatch)


def test_a_command_moves_for_its_time(desk):
    assert desk.reader.note == 'a note'
    assert desk.ended('robot drive forward') == FORWARD
    assert desk.heard[-1].command == 'forward 0.50' and desk.acts == []
    assert desk.reader.read(0.0) is None
    desk.now += 2.0
    assert desk.reader.read(0.0) == REST


def test_a_command_that_waited_in_a_queue_moves_nothing_and_a_stop_stops(desk):
    spoken_s = desk.now
    desk.now += 8.0
    desk.say('began')
    desk.say('ended', text='robot drive forward', confidence=0.9, age_s=1.0, spoken_s=spoken_s)
    assert not desk.heard[-1].accepted and desk.reader.read(0.0) is None
    desk.say('ended', text='stop', confidence=0.9, age_s=1.0, spoken_s=spoken_s)
    assert [act.kind for act in desk.acts] == [STOP]


def test_what_was_recognised_slowly_moves_unless_something_was_said_since(desk):
    late = {'text': 'robot drive forward', 'confidence': 0.9, 'age_s': 1.0, 'computed_s': 2.0}
    desk.now += 8.0
    desk.say('began')
    desk.say('ended', **late, spoken_s=desk.now - 2.2, spoken_on=True)
    assert not desk.heard[-1].accepted and desk.heard[-1].reason
    desk.say('began')
    assert desk.say('ended', **late, spoken_s=desk.now - 2.2) == FORWARD


def test_read_returns_as_a_motion_ends_not_as_its_patience_does(desk):
    """The zero must not wait for the next sound."""
    desk.ended('robot drive forward')
    desk.now += 1.999
    begun = time.monotonic()
    assert desk.reader.read(60.0) is None
    desk.now += 0.001
    assert desk.reader.read(60.0) == REST
    assert time.monotonic() - begun < 30.0


def test_a_spotted_stop_is_carried_out_at_once(desk):
    desk.ended('robot drive forward')
    desk.say('began')
    assert desk.say('spotted', word='stop') == REST
    assert [act.kind for act in desk.acts] == [STOP]
    assert desk.heard[-1].command == 'stop' and desk.heard[-1].accepted


def test_robot_stop_waits_for_recording_at_rest(desk):
    """Where the voice drives; where another source does, it does not wait."""
    desk.ended('robot drive forward')
    desk.say('began')
    desk.say('spotted', word='robot')
    assert desk.say('spotted', word='stop') == REST
    assert desk.acts == []
    desk.now += STOP_RECORDING_S
    desk.reader.read(0.0)
    assert [act.kind for act in desk.acts] == [STOP]
    desk.reader.set_drives(False)
    desk.say('began')
    desk.say('spotted', word='robot')
    desk.say('spotted', word='stop')
    assert len(desk.acts) == 2


def test_robots_are_told_once_and_known_when_they_are_listened_for(desk):
    desk.reader.set_robots(['bot1', 'rover'])
    desk.reader.read(0.0)
    desk.reader.read(0.0)
    assert desk.orders() == [{'robots': ['bot1', 'rover'], 'accessories': []}]
    desk.ended('robot select rover')
    assert desk.acts == []
    desk.say('open', device='x', notes=[], robots=['bot1', 'rover'], words=['bot', 'rover'],
             accessories=[])
    desk.ended('robot select rover')
    assert desk.acts[-1].robots == ('rover',)


def test_accessories_are_told_once_and_known_when_they_are_listened_for(desk):
    for _ in range(2):
        desk.reader.set_accessories([LAMP])
        desk.reader.read(0.0)
    assert [order['accessories'] for order in desk.orders()] == [[list(map(
        lambda value: list(value) if isinstance(value, tuple) else value, LAMP))]]
    desk.say(**dict(OPEN, words=['lamp', 'on'], accessories=[LAMP]))
    assert desk.ended('robot lamp on') is None
    assert (desk.acts[-1].action, desk.acts[-1].key, desk.acts[-1].choice) == (
        'accessory', 'light', 'on')
    assert desk.heard[-1].command == 'light on'


@pytest.mark.parametrize('event, reason', (
    ({'kind': 'lost', 'reason': 'pulled out'}, 'pulled out'), ({'kind': 'odd'}, 'failed')))
def test_a_device_that_is_lost(desk, event, reason):
    with pytest.raises(DeviceLost, match=reason):
        desk.say(**event)


def test_a_process_that_ends_is_a_lost_device(desk):
    desk.hang_up()
    with pytest.raises(DeviceLost, match='has ended, with 1'):
        desk.reader.read(0.0)


@pytest.mark.parametrize('want', [VoiceReader.choose_source, VoiceReader.choose_voice])
def test_another_source_or_voice_is_a_lost_device(desk, want):
    want(desk.reader, 'ann')
    with pytest.raises(DeviceLost):
        desk.reader.read(0.0)


def test_close_forgets_the_motion(desk):
    desk.ended('robot drive forward')
    desk.reader.close()
    desk.reader.close()
    assert desk.open() == REST


# The process that listens.


def test_a_voice_that_nobody_taught_is_named_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setenv('ROS_HOME', str(tmp_path))
    reader = VoiceReader(LANGUAGE, str(PATH), None, None)
    for name, said in (('ann', 'mhri_voice_teach ann'), ('../ann', '~voice')):
        reader.choose_voice(name)
        with pytest.raises(DeviceAbsent, match=said):
            reader.open()


def test_a_process_that_cannot_start_is_started_later(tmp_path, monkeypatch):
    reader = VoiceReader(LANGUAGE, str(PATH), None, None)
    reader.choose_source(str(tmp_path / 'none'))
    with monkeypatch.context() as short:
        short.setattr(sys, 'executable', '/nonexistent/python3')
        with pytest.raises(DeviceAbsent, match='cannot be started'):
            reader.open()
    # What the process says: it has looked, or has no library to listen with.
    with pytest.raises(DeviceAbsent, match='none|pocketsphinx is not installed'):
        reader.open()
    reader.close()


def test_without_pocketsphinx_or_its_model(monkeypatch, tmp_path):
    """The message names the package."""
    installed = types.ModuleType('pocketsphinx')
    installed.__spec__ = importlib.machinery.ModuleSpec('pocketsphinx', None)
    monkeypatch.setitem(sys.modules, 'pocketsphinx', installed)
    monkeypatch.setattr(listening, 'MODEL', str(tmp_path / 'none'))
    assert 'pocketsphinx-en-us' in listening.missing()
    monkeypatch.setitem(sys.modules, 'pocketsphinx', None)
    with pytest.raises(DeviceAbsent, match='python3-pocketsphinx'):
        listening.begin({'source': '/tmp/none'}, None)


def test_without_a_source_or_a_language_nothing_is_loaded(monkeypatch, tmp_path):
    monkeypatch.setattr(listening, 'missing', str)
    with pytest.raises(DeviceAbsent, match=str(tmp_path / 'none')):
        listening.begin({'source': str(tmp_path / 'none')}, None)
    path = str(tmp_path / 'sound')
    os.mkfifo(path)
    writer = os.open(path, os.O_RDWR)
    with pytest.raises(DeviceAbsent, match='none.yaml'):
        listening.begin({'source': path, 'language': str(tmp_path / 'none.yaml')}, None)
    os.close(writer)


def test_a_voice_that_is_not_understood_three_times_gets_advice(desk):
    for _ in range(3):
        desk.ended('robot drive forward', 0.2)
    assert 'push-to-talk' in desk.heard[-1].reason
    desk.ended('robot drive forward')
    desk.ended('robot drive forward', 0.2)
    assert desk.heard[-1].reason == NOT_SURE, 'one that was understood begins anew'


class SlowRecogniser:
    """Hears "robot drive forward" in everything; meanwhile more sound comes."""

    def __init__(self, source, meanwhile):
        self.source, self.meanwhile = source, meanwhile

    def begin(self, sound):
        return ''

    go_on = begin

    def end(self):
        """Do nothing."""

    def recognise(self, sound):
        self.source.blocks += self.meanwhile
        return Hypothesis('robot drive forward', 0.9)


class Blocks:
    """A source whose sound is there already."""

    def __init__(self, blocks):
        self.blocks = blocks

    def read(self, timeout_s):
        return self.blocks.pop(0) if self.blocks else b''

    def waits(self):
        return bool(self.blocks)


@pytest.mark.parametrize('more, spoken_on', [((), False), ((True,) * 20, True)])
def test_what_is_said_while_it_is_recognised_is_told_with_it(monkeypatch, more, spoken_on):
    def sound(*loud):
        noise = np.random.RandomState(1).standard_normal(BLOCK_BYTES // 2)
        return [(noise * (3000.0 if each else 8.0)).astype('<i2').tobytes() for each in loud]
    source, said = Blocks(sound(*[False] * 50, *[True] * 40, *[False] * 9)), []
    monkeypatch.setattr(session, 'Recogniser', lambda *_, **__: SlowRecogniser(
        source, sound(*[False] * 30, *more)))
    listens = session.Session(LANGUAGE, source, 'x', (), '', 0.0, said.append)
    while not said or said[-1]['kind'] != 'ended':
        listens.step()
    assert said[-1]['spoken_on'] == spoken_on and said[-1]['computed_s'] >= 0.0
    # It is listened to all the same.
    heard = len(said)
    for _ in range(100):
        listens.step()
    assert any(event['kind'] == 'began' for event in said[heard:]) == spoken_on


def test_a_wake_word_counts_for_its_own_utterance(desk):
    desk.say('began')
    desk.say('spotted', word='robot')
    desk.say('began')
    desk.say('spotted', word='stop')
    assert [act.kind for act in desk.acts] == [STOP], 'at once'

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Listening to one source: its sound through the recogniser, as events for the node."""
from collections import deque
import contextlib
import time

from mhri.devices.io.reader import DeviceLost
from mhri.voice.backlog import Backlog
from mhri.voice.endpointing import has_speech
from mhri.voice.grammar import Grammar, STOP
from mhri.voice.io.listener import Began, Ended, Listener, Spotted
from mhri.voice.io.recogniser import Dictionary, Recogniser
from mhri.voice.speech import SURE_OF_STOP

_WAIT_S = 0.2
# So much of what came while an utterance was recognised is looked at: 6 s.
_MOST_AHEAD = 300


class Session:
    """Listens to one source for the robots that are there.

    :param language: :class:`mhri.voice.language.Language`
    :param source: of :mod:`mhri.voice.io.audio`, open
    :param device: its name
    :param robots: names in the panel's order
    :param voice: path of a voice that was taught, '' for any voice
    :param opened_s: when the source was opened [s, monotonic]
    :param say: function that takes an event as a mapping, see :mod:`mhri.voice.io.listening`
    :raises RecogniserError: speech cannot be recognised here
    """

    def __init__(self, language, source, device, robots, voice, opened_s, say):
        self._language = language
        self._source = source
        self._device = device
        self._say = say
        self._dictionary = Dictionary()
        self._grammar = self._new_grammar(robots)
        self._recogniser = Recogniser(self._grammar, self._dictionary, voice=voice)
        self._listener = Listener(self._recogniser, self._is_stop)
        self._robots = None
        self._backlog = Backlog(opened_s)
        self._spoken_s = opened_s
        self._ahead = deque()
        self._say_open()

    def _new_grammar(self, robots):
        return Grammar(self._language, robots, self._dictionary.__contains__)

    def _say_open(self):
        self._say({'kind': 'open', 'device': self._device, 'notes': self._grammar.notes,
                   'robots': self._grammar.robots, 'words': self._grammar.words})

    def _is_stop(self, hypothesis):
        command = self._grammar.parse(hypothesis.text)
        return (command is not None and command.kind == STOP
                and hypothesis.confidence >= SURE_OF_STOP)

    def set_robots(self, robots):
        """Listen for other robots, as soon as nobody speaks."""
        self._robots = robots

    def step(self):
        """Take in the next block of sound, if one comes.

        :raises DeviceLost: there will be none any more
        """
        block = self._ahead.popleft() if self._ahead else self._source.read(_WAIT_S)
        if block:
            self._spoken_s = self._backlog.take(
                time.monotonic(), bool(self._ahead) or self._source.waits())
        for event in self._listener.feed(block) if block else ():
            spoken_on = isinstance(event, Ended) and self._look_ahead()
            self._say(_as_mapping(event, self._spoken_s, spoken_on))
        if self._robots is not None and not self._listener.speaking:
            robots, self._robots = self._robots, None
            self._grammar = self._new_grammar(robots)
            self._recogniser.set_grammar(self._grammar)
            self._say_open()

    def _look_ahead(self):
        """Tell whether somebody speaks in the sound that waits to be listened to."""
        # What ends the source is met again by the next read.
        with contextlib.suppress(DeviceLost):
            while len(self._ahead) < _MOST_AHEAD and self._source.waits():
                block = self._source.read(0.0)
                if not block:
                    break
                self._ahead.append(block)
        return has_speech(self._ahead, self._listener.floor_db)

    def finish(self):
        """Say what is left, and close the source."""
        for event in self._listener.finish():
            self._say(_as_mapping(event, self._spoken_s))
        self._source.close()


def _as_mapping(event, spoken_s, spoken_on=False):
    """Return what is said of an event of the listener.

    :param spoken_s: when the newest sound was spoken [s, monotonic]
    :param spoken_on: somebody speaks in what came since
    """
    if isinstance(event, Began):
        return {'kind': 'began'}
    if isinstance(event, Spotted):
        return {'kind': 'spotted', 'word': event.word}
    assert isinstance(event, Ended)
    found = event.hypothesis
    return {'kind': 'ended', 'age_s': round(event.at_s - event.began_s, 3),
            'spoken_s': round(spoken_s, 3), 'computed_s': round(event.computed_s, 3),
            'spoken_on': spoken_on,
            'text': found.text if found else '',
            'confidence': round(found.confidence, 3) if found else 0.0}

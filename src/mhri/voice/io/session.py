# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session with one source: passes its sound to the recogniser, and sends events to the node."""
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
# Maximum look-ahead in the sound received during a recognition [blocks]: 6 s.
_MAX_AHEAD = 300


class Session:
    """Listens to one source for commands to the present robots.

    :param language: :class:`mhri.voice.language.Language`
    :param source: of :mod:`mhri.voice.io.audio`, open
    :param device: its name
    :param robots: names in the panel's order
    :param voice: path of a taught voice, '' for any voice
    :param opened_s: time at which the source was opened [s, monotonic]
    :param send: called with each event as a mapping, see :mod:`mhri.voice.io.listening`
    :param accessories: of the robots, see :class:`mhri.voice.accessories.SpokenRow`
    :raises RecogniserError: speech cannot be recognised here
    """

    def __init__(self, language, source, device, robots, voice, opened_s, send, accessories=()):
        self._language = language
        self._source = source
        self._device = device
        self._send = send
        self._dictionary = Dictionary()
        self._grammar = self._new_grammar(robots, accessories)
        self._recogniser = Recogniser(self._grammar, self._dictionary, voice=voice)
        self._listener = Listener(self._recogniser, self._is_stop)
        self._next = None
        self._backlog = Backlog(opened_s)
        self._spoken_s = opened_s
        self._ahead = deque()
        self._send_open()

    def _new_grammar(self, robots, accessories):
        return Grammar(self._language, robots, self._dictionary.__contains__, accessories)

    def _send_open(self):
        self._send({'kind': 'open', 'device': self._device, 'notes': self._grammar.notes,
                    'robots': self._grammar.robots, 'words': self._grammar.words,
                    'accessories': self._grammar.accessories})

    def _is_stop(self, hypothesis):
        command = self._grammar.parse(hypothesis.text)
        return (command is not None and command.kind == STOP
                and hypothesis.confidence >= SURE_OF_STOP)

    def set_robots(self, robots, accessories):
        """Change the robots and their accessories once no utterance is open."""
        self._next = robots, accessories

    def step(self):
        """Handle the next block of sound, if any.

        :raises DeviceLost: the source has ended
        """
        block = self._ahead.popleft() if self._ahead else self._source.read(_WAIT_S)
        if block:
            self._spoken_s = self._backlog.take(
                time.monotonic(), bool(self._ahead) or self._source.waits())
        for event in self._listener.feed(block) if block else ():
            spoken_on = isinstance(event, Ended) and self._look_ahead()
            self._send(_as_mapping(event, self._spoken_s, spoken_on))
        if self._next is not None and not self._listener.speaking:
            self._grammar = self._new_grammar(*self._next)
            self._next = None
            self._recogniser.set_grammar(self._grammar)
            self._send_open()

    def _look_ahead(self):
        """Return whether the sound that waits to be processed contains speech."""
        # The next read reports the end of the source.
        with contextlib.suppress(DeviceLost):
            while len(self._ahead) < _MAX_AHEAD and self._source.waits():
                block = self._source.read(0.0)
                if not block:
                    break
                self._ahead.append(block)
        return has_speech(self._ahead, self._listener.floor_db)

    def finish(self):
        """Send the remaining events, and close the source."""
        for event in self._listener.finish():
            self._send(_as_mapping(event, self._spoken_s))
        self._source.close()


def _as_mapping(event, spoken_s, spoken_on=False):
    """Return an event of the listener as a mapping.

    :param spoken_s: time at which the newest sound was spoken [s, monotonic]
    :param spoken_on: whether the sound since then contains speech
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

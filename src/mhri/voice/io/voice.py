# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice as an input device: the recognition process, and the rules for spoken commands."""
import os
import threading
import time

from mhri.devices.io.child import Child
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, Reading
from mhri.voice.attempts import Attempts
from mhri.voice.grammar import Command, Grammar, STOP
from mhri.voice.speech import Utterance, VoiceRules
from mhri.voice.teaching import voice_path, voice_problem

# Loading the model takes a second, several on a busy computer.
_OPEN_S = 30.0
_END_S = 0.5


class VoiceReader(Reader):
    """Converts speech to axes: axes[0] left, axes[1] forward, as fractions of the speed limit.

    :param language: :class:`mhri.voice.language.Language`
    :param path: its file
    :param on_heard: called with :class:`mhri.voice.speech.Utterance` for each utterance
    :param on_act: called with each :class:`Command` for other nodes (PANEL, MODE, STOP)

    The callbacks are called on the thread of :meth:`read`, and must return at once.
    """

    kind = 'microphone'

    def __init__(self, language, path, on_heard, on_act, clock=time.monotonic):
        self._path = path
        self._source = self._opened_source = ''
        self._voice = self._opened_voice = ''
        self._on_heard = on_heard
        self._on_act = on_act
        self._clock = clock
        self._lock = threading.Lock()
        self._language = language
        self._rules = VoiceRules(language)
        self._attempts = Attempts()
        self._robots = self._accessories = ()
        self._grammar = None
        self._sent = None
        self._child = None
        self._last = None
        self._began = 0.0
        self._woken = False
        self._drives = True

    # From other threads.

    def choose_source(self, source):
        """Set the source, see :func:`mhri.voice.io.audio.open_source`; '' is the microphone."""
        self._source = str(source)

    def choose_voice(self, name):
        """Set the taught voice by its name; '' is any voice."""
        self._voice = str(name)

    def set_robots(self, robots):
        """Set the robots that can be addressed, names in the panel's order."""
        with self._lock:
            self._robots = tuple(robots)

    def set_accessories(self, rows):
        """Set the accessories of the robots, each a :class:`mhri.voice.accessories.SpokenRow`."""
        with self._lock:
            self._accessories = tuple(rows)

    def push_to_talk(self, held):
        """Handle that push-to-talk is held or released."""
        with self._lock:
            self._rules.push_to_talk(held, self._clock())

    def set_drives(self, drives):
        """Set whether the voice is the driving source."""
        self._drives = drives

    # Reader.

    def open(self):
        """Start listening; see :meth:`Reader.open`."""
        self.close()
        self._opened_source = source = self._source
        self._opened_voice = self._voice
        voice = _voice_file(self._opened_voice)
        try:
            self._child = Child('mhri.voice.io.listening',
                                **({'stdin': None} if source == '-' else {}))
        except OSError as error:
            raise DeviceAbsent('the process that listens cannot be started: {}'.format(error))
        with self._lock:
            self._rules.reset()
            self._sent = self._addressed()
        self._attempts.clear()
        self._last, self._woken = None, False
        self._order({'source': source, 'language': self._path, 'voice': voice, **self._sent})
        return self._wait_open()

    def _addressed(self):
        """Return what the process has to know; call it with the lock held."""
        return {'robots': self._robots, 'accessories': self._accessories}

    def _wait_open(self):
        """Wait until the process is listening; return the name of its source."""
        deadline = self._clock() + _OPEN_S
        while self._clock() < deadline:
            for event in self._events(deadline - self._clock()):
                if event['kind'] == 'open':
                    self._opened(event)
                    return event['device']
                raise DeviceAbsent(event['reason'])
        raise DeviceAbsent('the process that listens does not answer')

    def _opened(self, event):
        """Handle the name of the source, and the robots that can be addressed."""
        self.note = '; '.join(event['notes'])
        # The other process has looked up the words in the dictionary.
        self._grammar = Grammar(self._language, event['robots'], event['words'].__contains__,
                                event['accessories'])

    def read(self, timeout_s):
        """Wait for speech; see :meth:`Reader.read`."""
        if (self._source, self._voice) != (self._opened_source, self._opened_voice):
            raise DeviceLost('something else is to be listened to')
        with self._lock:
            addressed = self._addressed()
            wait_s = min(timeout_s, self._wait_s(self._clock()))
        if addressed != self._sent:
            self._sent = addressed
            self._order(addressed)
        for event in self._events(wait_s):
            self._take(event)
        with self._lock:
            now = self._clock()
            due, stick = self._rules.take_due_stop(now), self._rules.stick(now)
        if due:
            self._on_act(Command(STOP))
        reading = Reading(stick, (), '')
        if reading == self._last:
            return None
        self._last = reading
        return reading

    def _wait_s(self, now):
        """Return the remaining validity of the last reading [s]; call it with the lock held."""
        if self._last is None or self._rules.stick(now) != self._last.axes:
            # The state has changed between two calls.
            return 0.0
        return self._rules.next_change(now)

    def _take(self, event):
        """Handle one event of the process.

        :raises DeviceLost: the process no longer listens
        """
        kind, now = event['kind'], self._clock()
        if kind == 'open':
            self._opened(event)
        elif kind == 'began':
            self._began, self._woken = now, False
        elif kind == 'spotted':
            self._spotted(event['word'], now)
        elif kind == 'ended':
            self._ended(event, now)
        else:
            raise DeviceLost(event.get('reason', 'the process that listens failed'))

    def _spotted(self, word, now):
        """Carry out a stop while it is being spoken."""
        if word in self._language.wake_words:
            self._woken = True
            return
        with self._lock:
            possible = self._drives and (self._woken or self._rules.talking(self._began))
            at_once = self._rules.spotted_stop(now, possible)
        self._attempts.clear()
        if at_once:
            self._on_act(Command(STOP))
            self._on_heard(Utterance(word, STOP, True, '', 1.0, None))

    def _ended(self, event, now):
        """Judge an utterance."""
        text = event['text']
        began = min(now, max(self._began, now - event['age_s'] - 1.0))
        with self._lock:
            heard = self._rules.judge(text, self._grammar.parse(text), event['confidence'], began,
                                      now, now - event.get('spoken_s', now),
                                      event.get('computed_s', 0.0), event.get('spoken_on', False))
            held = self._rules.talking(began)
        if heard.act is not None:
            self._on_act(heard.act)
        self._on_heard(self._attempts.judge(heard, event['age_s'], now, held,
                                            bool(self._opened_voice)))

    def close(self):
        """End the process; see :meth:`Reader.close`."""
        with self._lock:
            self._rules.rest()
        child, self._child = self._child, None
        if child is not None:
            child.end(_END_S)

    def _order(self, order):
        """Send an order to the process.

        :raises DeviceLost: the process is gone
        """
        try:
            self._child.send(order)
        except OSError as error:
            raise DeviceLost('the process that listens is gone: {}'.format(error.strerror))

    def _events(self, timeout_s):
        """Return the events received within a time.

        :raises DeviceLost: the process has ended
        """
        try:
            return self._child.messages(timeout_s)
        except EOFError:
            raise DeviceLost('the process that listens has ended, with {}'.format(
                self._child.end(_END_S)))


def _voice_file(name):
    """Return the path of a taught voice, '' for any voice.

    :raises DeviceAbsent: no voice has that name
    """
    if not name:
        return ''
    problem = voice_problem(name)
    if problem:
        raise DeviceAbsent('~voice: ' + problem)
    path = voice_path(name, os.environ)
    if not os.path.exists(path):
        raise DeviceAbsent('there is no voice {0}: rosrun mhri mhri_voice_teach {0}; or '
                           'set ~voice to nothing'.format(name))
    return path

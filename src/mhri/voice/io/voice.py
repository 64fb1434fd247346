# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice as an input device: a process that listens, and the rules for what was heard."""
import json
import os
import select
import subprocess
import threading
import time

from mhri.devices.io import child
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, Reading
from mhri.voice.attempts import Attempts
from mhri.voice.grammar import Command, Grammar, STOP
from mhri.voice.speech import Heard, VoiceRules
from mhri.voice.teaching import voice_path, voice_problem

# Loading the model takes a second, on a busy computer several.
_OPEN_S = 30.0
_END_S = 0.5


class VoiceReader(Reader):
    """Speech read into axes: axes[0] left, axes[1] forward, as fractions of the speed limit.

    :param language: :class:`mhri.voice.language.Language`
    :param path: the file it came from
    :param on_heard: called with :class:`mhri.voice.speech.Heard` for each utterance
    :param on_act: called with each :class:`Command` that others carry out (PANEL, MODE, STOP)

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
        self._robots = ()
        self._grammar = None
        self._told = None
        self._process = None
        self._orders = None
        self._held = b''
        self._last = None
        self._began = 0.0
        self._woken = False
        self._drives = True

    # From other threads.

    def want_source(self, source):
        """Listen to this, see :func:`mhri.voice.io.audio.open_source`; '' is the microphone."""
        self._source = str(source)

    def want_voice(self, name):
        """Listen to the one whose voice was taught under this name; '' is anybody."""
        self._voice = str(name)

    def set_robots(self, robots):
        """Listen for these robots, the names in the panel's order."""
        with self._lock:
            self._robots = tuple(robots)

    def push_to_talk(self, held):
        """Note that push-to-talk is held or let go."""
        with self._lock:
            self._rules.push_to_talk(held, self._clock())

    def set_drives(self, drives):
        """Note whether the voice is the source that drives."""
        self._drives = drives

    # Reader.

    def open(self):
        """Begin to listen; see :meth:`Reader.open`."""
        self.close()
        self._opened_source = source = self._source
        self._opened_voice = self._voice
        voice = _voice_file(self._opened_voice)
        orders, self._orders = os.pipe()
        try:
            self._process = subprocess.Popen(
                child.command('mhri.voice.io.listening', str(orders)),
                stdin=None if source == '-' else subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, pass_fds=(orders,))
        except OSError as error:
            raise DeviceAbsent('the process that listens cannot be started: {}'.format(error))
        finally:
            os.close(orders)
        with self._lock:
            self._rules.reset()
            self._told = self._robots
        self._attempts.clear()
        self._held, self._last, self._woken = b'', None, False
        self._order({'source': source, 'language': self._path, 'robots': self._told,
                     'voice': voice})
        return self._wait_open()

    def _wait_open(self):
        """Wait until the process listens; return what it listens to."""
        deadline = self._clock() + _OPEN_S
        while self._clock() < deadline:
            for event in self._events(deadline - self._clock()):
                if event['kind'] == 'open':
                    self._opened(event)
                    return event['device']
                raise DeviceAbsent(event['reason'])
        raise DeviceAbsent('the process that listens does not answer')

    def _opened(self, event):
        """Take note of what is listened to, and for whom."""
        self.note = '; '.join(event['notes'])
        # Which words the dictionary has, the other process has looked up.
        self._grammar = Grammar(self._language, event['robots'], event['words'].__contains__)

    def read(self, timeout_s):
        """Wait for what is heard; see :meth:`Reader.read`."""
        if (self._source, self._voice) != (self._opened_source, self._opened_voice):
            raise DeviceLost('something else is to be listened to')
        with self._lock:
            robots = self._robots
            wait_s = min(timeout_s, self._wait_s(self._clock()))
        if robots != self._told:
            self._told = robots
            self._order({'robots': robots})
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
        """Return how long the reading stays what it was last; call it with the lock held."""
        if self._last is None or self._rules.stick(now) != self._last.axes:
            # It has changed between two calls.
            return 0.0
        return self._rules.next_change(now)

    def _take(self, event):
        """Take in one event of the process.

        :raises DeviceLost: it listens no longer
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
        """Obey a stop while it is spoken."""
        if word in self._language.wake_words:
            self._woken = True
            return
        with self._lock:
            possible = self._drives and (self._woken or self._rules.talking(self._began))
            at_once = self._rules.spotted_stop(now, possible)
        self._attempts.clear()
        if at_once:
            self._on_act(Command(STOP))
            self._on_heard(Heard(word, STOP, True, '', 1.0, None))

    def _ended(self, event, now):
        """Judge an utterance."""
        text = event['text']
        began = min(now, max(self._began, now - event['age_s'] - 1.0))
        with self._lock:
            heard = self._rules.hear(text, self._grammar.parse(text), event['confidence'], began,
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
        process, self._process = self._process, None
        orders, self._orders = self._orders, None
        if orders is not None:
            os.close(orders)
        if process is None:
            return
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()

    def _order(self, order):
        """Tell the process something.

        :raises DeviceLost: it is gone
        """
        try:
            os.write(self._orders, (json.dumps(order) + '\n').encode())
        except OSError as error:
            raise DeviceLost('the process that listens is gone: {}'.format(error.strerror))

    def _events(self, timeout_s):
        """Return the events that have come within a time.

        :raises DeviceLost: the process has ended
        """
        stream = self._process.stdout
        if not select.select([stream], [], [], max(0.0, timeout_s))[0]:
            return []
        data = os.read(stream.fileno(), 65536)
        if not data:
            raise DeviceLost('the process that listens has ended, with {}'.format(
                self._process.wait()))
        *lines, self._held = (self._held + data).split(b'\n')
        return [json.loads(line.decode()) for line in lines]


def _voice_file(name):
    """Return the path of a voice that was taught, '' for nobody's.

    :raises DeviceAbsent: there is none of that name
    """
    if not name:
        return ''
    problem = voice_problem(name)
    if problem:
        raise DeviceAbsent('~voice: ' + problem)
    path = voice_path(name, os.environ)
    if not os.path.exists(path):
        raise DeviceAbsent('nobody has taught the voice {0}: rosrun mhri mhri_voice_teach {0}; or '
                           'set ~voice to nothing'.format(name))
    return path

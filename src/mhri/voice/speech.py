# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules for spoken commands: which are carried out, and their duration."""
import math
from dataclasses import dataclass
from typing import Optional, Tuple

from mhri.voice.grammar import Command, MODE, NOBODY, PACE, PANEL, STOP, WAKE
from mhri.voice.language import Language

# axes[0] left +1, axes[1] forward +1, as in the contract.
_AXES = {'forward': (0.0, 1.0), 'backward': (0.0, -1.0), 'left': (1.0, 0.0), 'right': (-1.0, 0.0)}
REST = (0.0, 0.0)
# Push-to-talk counts if it is pressed this soon after the first word [s].
_LATE_PRESS_S = 0.3
# Time for "robot stop" to become "robot stop recording": the word, the pause after it, and the
# recognition. The robots stand still meanwhile.
STOP_RECORDING_S = 1.3
SURE = 0.5
# With push-to-talk it is a command, not talk: only commands have to be distinguished.
SURE_WHEN_HELD = 0.25
# A stop needs much less: a false one does no harm.
SURE_OF_STOP = 0.18
# An older motion is refused, whatever the cause: a hanging process, a busy computer [s]. The age
# counts from the end of the pause that ends an utterance.
MAX_AGE_S = 1.0
# The processor time of the recognition is not counted, up to this [s]: a slow computer is late, but
# nothing has waited. In that case the operator must not have said anything else since.
MAX_COMPUTED_S = 2.5
# Reasons for refusing unrecognised speech.
UNCLEAR = NO_COMMAND, NOT_SURE = 'no command', 'not sure enough'


@dataclass(frozen=True)
class Utterance:
    """A recognised utterance and its result, as in ``mhri/Heard``.

    ``act`` is the command for other nodes (PANEL, MODE or STOP), None without one.
    """

    text: str
    command: str = ''
    accepted: bool = False
    reason: str = ''
    confidence: float = 0.0
    act: Optional[Command] = None


class VoiceRules:
    """Decides the effect of spoken commands. Times are monotonic seconds of one clock.

    Every command except a stop requires the wake word at its beginning, the wake word alone shortly
    before, or push-to-talk at its beginning. A stop is always carried out, a motion only within
    :data:`MAX_AGE_S` plus the time of its recognition. A motion lasts at most ``lasts_s`` of the
    language, limited to 2 s, unless it is repeated.

    :param language: :class:`mhri.voice.language.Language`
    """

    def __init__(self, language: Language) -> None:
        self._language = language
        self.reset()

    def reset(self) -> None:
        """Return to the initial state: at rest, initial speed, no wake word."""
        self._fraction = self._language.motion.fraction
        self._pressed: Optional[float] = None
        self._released: Optional[float] = None
        self.rest()

    def rest(self) -> None:
        """Stop moving, and drop the pending stop and wake word."""
        self._direction: Optional[str] = None
        self._until = -math.inf
        self._woken_until = -math.inf
        self._stop_due: Optional[float] = None
        self._stopped_at = -math.inf

    @property
    def fraction(self) -> float:
        """The speed of motions, as a fraction of the operator's speed limit."""
        return self._fraction

    def stick(self, now: float) -> Tuple[float, float]:
        """Return (left, forward) as fractions of the speed limit; (0.0, 0.0) at rest."""
        if self._direction is None or now >= self._until:
            self._direction = None
            return REST
        left, forward = _AXES[self._direction]
        return left * self._fraction, forward * self._fraction

    def next_change(self, now: float) -> float:
        """Return the time until the stick or a pending stop changes by itself [s], or inf."""
        times = [self._until] if self.stick(now) != REST else []
        times += [] if self._stop_due is None else [self._stop_due]
        return max(0.0, min(times) - now) if times else math.inf

    def push_to_talk(self, held: bool, now: float) -> None:
        """Handle push-to-talk; ``held`` is valid for ``push_to_talk_s`` of the language."""
        if not held:
            if self._pressed is not None and self._released is None:
                self._released = now
        elif self._pressed is None or not self._held_at(now):
            self._pressed, self._released = now, None
            self._held_until = now + self._language.push_to_talk_s
        else:
            self._held_until = now + self._language.push_to_talk_s

    def _held_at(self, when: float) -> bool:
        """Return whether push-to-talk was held at a time."""
        if self._pressed is None or when < self._pressed:
            return False
        end = self._held_until if self._released is None else min(self._released, self._held_until)
        return when <= end

    def talking(self, began: float) -> bool:
        """Return whether push-to-talk counts for an utterance that began at a time."""
        return self._held_at(began) or self._held_at(began + _LATE_PRESS_S)

    # Results of the spotter, during an utterance.

    def spotted_stop(self, now: float, recording_possible: bool) -> bool:
        """Stop moving at once; return whether stop-all is due at once as well.

        :param recording_possible: whether the wake word came before, and the voice drives:
            stop-all then waits for the end of "robot stop recording", at most
            :data:`STOP_RECORDING_S`
        """
        due = self._stop_due
        self.rest()
        self._stopped_at = now
        if recording_possible and due is None:
            self._stop_due = now + STOP_RECORDING_S
            return False
        return True

    def take_due_stop(self, now: float) -> bool:
        """Return True once when a pending stop-all has become due."""
        if self._stop_due is None or now < self._stop_due:
            return False
        self._stop_due = None
        return True

    # Results of the recogniser, for whole utterances.

    def judge(self, text: str, command: Optional[Command], confidence: float, began: float,
              now: float, age_s: float = 0.0, computed_s: float = 0.0,
              spoken_on: bool = False) -> Utterance:
        """Judge an utterance; return :class:`Utterance`.

        :param text: the words, '' if nothing fits
        :param command: :class:`Command` or None
        :param confidence: [0, 1] of the recogniser; 0.5 and more means a command, with push-to-talk
            0.25 and more
        :param began: time at which the utterance began
        :param age_s: time since its end
        :param computed_s: processor time of its recognition, part of ``age_s``
        :param spoken_on: whether there was speech since, not processed yet
        """
        waiting, self._stop_due = self._stop_due is not None, None
        window, self._woken_until = self._woken_until, -math.inf
        heard = Utterance(text, command.words if command else '', confidence=confidence)
        problem = (self._problem(command, confidence, began, window) or _no_such_robot(command)
                   or _too_old(command, age_s, computed_s, spoken_on))
        recorder = command is not None and command.action == 'stop_recording'
        hidden = (confidence >= SURE_OF_STOP
                  and any(word in self._language.stop for word in text.split()))
        if (waiting and not (recorder and not problem)) or (problem and hidden):
            return self._stopped(heard, now)
        if command is None or problem:
            return _refused(heard, problem)
        return self._carry_out(heard, command, now, age_s)

    def _problem(self, command: Optional[Command], confidence: float, began: float,
                 window: float) -> str:
        """Return why an utterance is refused, '' if it is not."""
        if command is None:
            return NO_COMMAND
        if command.kind == STOP:
            return '' if confidence >= SURE_OF_STOP else NOT_SURE
        sure = SURE_WHEN_HELD if self.talking(began) else SURE
        if not confidence >= sure:  # also for NaN
            return NOT_SURE
        if not (command.woken or began <= window or self.talking(began)):
            return 'no wake word: say "{}" first, or hold push-to-talk'.format(
                self._language.wake_words[0])
        if command.acts and self._stopped_at >= began:
            return 'a stop was heard in it'
        return ''

    def _stopped(self, heard: Utterance, now: float) -> Utterance:
        self.rest()
        self._stopped_at = now
        return Utterance(heard.text, STOP, True, '', heard.confidence, Command(STOP))

    def _carry_out(self, heard: Utterance, command: Command, now: float, age_s: float) -> Utterance:
        """Carry out an accepted command."""
        if command.kind == STOP:
            return self._stopped(heard, now)
        words, act = heard.command, None
        if command.kind == WAKE:
            self._woken_until = now - age_s + self._language.wake_window_s
        elif command.kind in (PANEL, MODE):
            act = command
        elif command.kind == PACE:
            self._pace(command.action)
            if self.stick(now) != REST:
                self._until = now + self._language.motion.lasts_s
            words = '{} {:.2f}'.format(words, self._fraction)
        else:
            self._drive(command, now)
            words = '{} {:.2f}'.format(words, self._fraction)
        return Utterance(heard.text, words, True, '', heard.confidence, act)

    def _pace(self, pace: str) -> None:
        """Change the speed by one step."""
        motion = self._language.motion
        step = motion.step if pace == 'faster' else -motion.step
        self._fraction = max(motion.lowest, min(motion.highest, self._fraction + step))

    def _drive(self, command: Command, now: float) -> None:
        """Start or continue a motion."""
        motion = self._language.motion
        if command.manner in ('faster', 'slower'):
            self._pace(command.manner)
        self._direction = command.action
        self._until = now + (motion.little_s if command.manner == 'little' else motion.lasts_s)


def _no_such_robot(command: Optional[Command]) -> str:
    """Return the problem of an unassigned robot number, else ''."""
    return 'no robot has that number' if command is not None and command.kind == NOBODY else ''


def _too_old(command: Optional[Command], age_s: float, computed_s: float,
             spoken_on: bool) -> str:
    """Return the problem of a motion or an accessory that was said too long ago, else ''."""
    if command is None or not command.acts or age_s <= MAX_AGE_S:
        return ''
    if age_s - min(computed_s, MAX_COMPUTED_S) > MAX_AGE_S:
        return 'said {:.1f} s ago: this computer is too {}, say it again'.format(
            age_s, 'slow' if computed_s > MAX_COMPUTED_S else 'busy')
    return 'said {:.1f} s ago, and more since: say it again'.format(age_s) if spoken_on else ''


def _refused(heard: Utterance, reason: str) -> Utterance:
    return Utterance(heard.text, heard.command, False, reason, heard.confidence)

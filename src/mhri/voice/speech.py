# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a spoken command may do: the rules between what was heard and what is carried out."""
import math
from dataclasses import dataclass
from typing import Optional, Tuple

from mhri.voice.grammar import Command, DRIVE, MODE, NOBODY, PACE, PANEL, STOP, WAKE
from mhri.voice.language import Language

# axes[0] left +1, axes[1] forward +1, as the contract has it.
_AXES = {'forward': (0.0, 1.0), 'backward': (0.0, -1.0), 'left': (1.0, 0.0), 'right': (-1.0, 0.0)}
REST = (0.0, 0.0)
# Who presses push-to-talk a moment after the first word is meant as well.
_LATE_PRESS_S = 0.3
# For so long "robot stop" may become "robot stop recording": the word, the pause after it, and the
# time to recognise it. The robots stand still meanwhile.
STOP_RECORDING_S = 1.3
SURE = 0.5
# Who holds push-to-talk means a command: talk need not be told from it, only one from another.
SURE_WHEN_HELD = 0.25
# A stop is believed much sooner: one too many does no harm.
SURE_OF_STOP = 0.18
# What has waited for so long moves nothing, whatever kept it: the pipe of a process that hung, a
# busy computer [s]. It counts from the end of the pause that ends an utterance.
MAX_AGE_S = 1.0
# Not counted is what the processor took to recognise it, up to this [s]: a slow computer hears
# late, but nothing has waited. Then nothing must have been said since that is not listened to yet.
MAX_COMPUTED_S = 2.5
# Why a voice that is not understood is refused.
UNCLEAR = NO_COMMAND, NOT_SURE = 'no command', 'not sure enough'


@dataclass(frozen=True)
class Heard:
    """What was heard and what was made of it, as ``mhri/Heard`` says it.

    ``act`` is the command that others have to carry out (PANEL, MODE or STOP), None without one.
    """

    text: str
    command: str = ''
    accepted: bool = False
    reason: str = ''
    confidence: float = 0.0
    act: Optional[Command] = None


class VoiceRules:
    """Decides what spoken commands do. Times are seconds of one clock that never goes back.

    Motion, and all but a stop, needs the wake word in front, the wake word alone shortly before, or
    push-to-talk at the beginning. A stop is obeyed always, motion within :data:`MAX_AGE_S` only,
    beside what it takes to recognise it. Nothing moves for longer than the language's ``lasts_s``,
    at most 2 s, unless it is said again.

    :param language: :class:`mhri.voice.language.Language`
    """

    def __init__(self, language: Language) -> None:
        self._language = language
        self.reset()

    def reset(self) -> None:
        """Forget everything: at rest, first speed, nobody woke it."""
        self._fraction = self._language.motion.fraction
        self._pressed: Optional[float] = None
        self._released: Optional[float] = None
        self.rest()

    def rest(self) -> None:
        """Stand still, and forget what was about to happen."""
        self._direction: Optional[str] = None
        self._until = -math.inf
        self._woken_until = -math.inf
        self._stop_due: Optional[float] = None
        self._stopped_at = -math.inf

    @property
    def fraction(self) -> float:
        """What a drive uses of the operator's speed limit."""
        return self._fraction

    def stick(self, now: float) -> Tuple[float, float]:
        """Return (left, forward) as fractions of the speed limit; (0.0, 0.0) at rest."""
        if self._direction is None or now >= self._until:
            self._direction = None
            return REST
        left, forward = _AXES[self._direction]
        return left * self._fraction, forward * self._fraction

    def next_change(self, now: float) -> float:
        """Return how long until the stick or a pending stop changes by itself [s]; or inf."""
        times = [self._until] if self.stick(now) != REST else []
        times += [] if self._stop_due is None else [self._stop_due]
        return max(0.0, min(times) - now) if times else math.inf

    def push_to_talk(self, held: bool, now: float) -> None:
        """Note that push-to-talk is held, or let go; held counts for ``push_to_talk_s``."""
        if not held:
            if self._pressed is not None and self._released is None:
                self._released = now
        elif self._pressed is None or not self._held_at(now):
            self._pressed, self._released = now, None
            self._held_until = now + self._language.push_to_talk_s
        else:
            self._held_until = now + self._language.push_to_talk_s

    def _held_at(self, when: float) -> bool:
        """Tell whether push-to-talk was held at a time."""
        if self._pressed is None or when < self._pressed:
            return False
        end = self._held_until if self._released is None else min(self._released, self._held_until)
        return when <= end

    def talking(self, began: float) -> bool:
        """Tell whether push-to-talk counts for an utterance that began at a time."""
        return self._held_at(began) or self._held_at(began + _LATE_PRESS_S)

    # What the spotter hears while it is spoken.

    def spotted_stop(self, now: float, recording_possible: bool) -> bool:
        """Stand still at once; return whether stop-all is due at once as well.

        :param recording_possible: the words before were the wake word, and the voice is what
            drives: stop-all then waits for the end of "robot stop recording", at most
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
        """Return True once when a stop-all that waited has become due."""
        if self._stop_due is None or now < self._stop_due:
            return False
        self._stop_due = None
        return True

    # What the recogniser makes of a whole utterance.

    def hear(self, text: str, command: Optional[Command], confidence: float, began: float,
             now: float, age_s: float = 0.0, computed_s: float = 0.0,
             spoken_on: bool = False) -> Heard:
        """Judge an utterance; return :class:`Heard`.

        :param text: the words, '' if they fit nothing
        :param command: :class:`Command` or None
        :param confidence: [0, 1] of the recogniser; 0.5 and more means a command, with push-to-talk
            0.25 and more
        :param began: when the utterance began
        :param age_s: how long ago it ended
        :param computed_s: how much of that the processor took to recognise it
        :param spoken_on: something was said since, not listened to yet
        """
        waiting, self._stop_due = self._stop_due is not None, None
        window, self._woken_until = self._woken_until, -math.inf
        heard = Heard(text, command.words if command else '', confidence=confidence)
        problem = (self._problem(command, confidence, began, window) or _meant_nobody(command)
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
        """Say why an utterance is not obeyed; '' if it is."""
        if command is None:
            return NO_COMMAND
        if command.kind == STOP:
            return '' if confidence >= SURE_OF_STOP else NOT_SURE
        sure = SURE_WHEN_HELD if self.talking(began) else SURE
        if not confidence >= sure:  # A confidence that is no number is none.
            return NOT_SURE
        if not (command.woken or began <= window or self.talking(began)):
            return 'no wake word: say "{}" first, or hold push-to-talk'.format(
                self._language.wake_words[0])
        if command.kind in (DRIVE, PACE) and self._stopped_at >= began:
            return 'a stop was heard in it'
        return ''

    def _stopped(self, heard: Heard, now: float) -> Heard:
        self.rest()
        self._stopped_at = now
        return Heard(heard.text, STOP, True, '', heard.confidence, Command(STOP))

    def _carry_out(self, heard: Heard, command: Command, now: float, age_s: float) -> Heard:
        """Obey a command that nothing speaks against."""
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
        return Heard(heard.text, words, True, '', heard.confidence, act)

    def _pace(self, pace: str) -> None:
        """Change the speed by one step."""
        motion = self._language.motion
        step = motion.step if pace == 'faster' else -motion.step
        self._fraction = max(motion.lowest, min(motion.highest, self._fraction + step))

    def _drive(self, command: Command, now: float) -> None:
        """Begin a motion, or go on with it."""
        motion = self._language.motion
        if command.manner in ('faster', 'slower'):
            self._pace(command.manner)
        self._direction = command.action
        self._until = now + (motion.little_s if command.manner == 'little' else motion.lasts_s)


def _meant_nobody(command: Optional[Command]) -> str:
    """Say that no robot is meant; '' where one may be."""
    return 'no robot has that number' if command is not None and command.kind == NOBODY else ''


def _too_old(command: Optional[Command], age_s: float, computed_s: float,
             spoken_on: bool) -> str:
    """Say that a motion was said too long ago; '' where it was not."""
    if command is None or command.kind not in (DRIVE, PACE) or age_s <= MAX_AGE_S:
        return ''
    if age_s - min(computed_s, MAX_COMPUTED_S) > MAX_AGE_S:
        return 'said {:.1f} s ago: this computer is too {}, say it again'.format(
            age_s, 'slow' if computed_s > MAX_COMPUTED_S else 'busy')
    return 'said {:.1f} s ago, and more since: say it again'.format(age_s) if spoken_on else ''


def _refused(heard: Heard, reason: str) -> Heard:
    return Heard(heard.text, heard.command, False, reason, heard.confidence)

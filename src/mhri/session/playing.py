# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Playback of a session: position, speed, and the clock of a screen that shows it."""
from typing import Callable, Iterable, List, Tuple

#: factors of the recorded speed
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
# A seek begins this long before its target [s], so that silent robots are detected: longer than the
# allowed silence of a robot, and than the time to accept a new stamp.
RUN_UP_S = 1.5
# Older messages this close together [s] form one group with one time; maximum number of groups.
TOGETHER_S, MAX_GROUPS = 0.3, 6
# If the player publishes no state for this long [s], the clock stops.
_TRUSTED_S = 0.5
# After a jump back, everything received before is at least this old [s].
_AGES_S = 60.0


class Playing:
    """The position and speed of playback; the caller passes the time [s, monotonic].

    It pauses at the end of the session; play() then starts from the beginning. Not thread-safe.

    :param length_s: length of the session [s]
    """

    def __init__(self, length_s: float) -> None:
        self.length_s = max(0.0, length_s)
        self.playing = False
        self.speed = 1.0
        self._position_s = 0.0
        self._since = 0.0

    def position_s(self, now: float) -> float:
        """Return the position from the start [s]; pause at the end."""
        if self.playing:
            passed_s = max(0.0, now - self._since) * self.speed
            self._position_s = min(self.length_s, self._position_s + passed_s)
            self._since = now
            self.playing = self._position_s < self.length_s
        return self._position_s

    def play(self, now: float) -> None:
        """Play; at the end, start from the beginning."""
        if self.position_s(now) >= self.length_s:
            self._position_s = 0.0
        self.playing, self._since = self.length_s > 0.0, now

    def pause(self, now: float) -> None:
        """Pause."""
        self.position_s(now)
        self.playing = False

    def set_speed(self, speed: float, now: float) -> None:
        """Set the speed to the nearest of :data:`SPEEDS`."""
        self.position_s(now)
        self.speed = min(SPEEDS, key=lambda one: abs(one - speed))

    def seek(self, position_s: float, now: float) -> None:
        """Go to a position, limited to [0, length]; keep playing or pausing."""
        self._position_s, self._since = min(max(0.0, position_s), self.length_s), now


def age_groups(times: Iterable[float], begin: float) -> List[Tuple[float, List[int]]]:
    """Return groups of messages to publish: [(time, indices into ``times``)], the oldest first.

    Messages from shortly before ``begin`` get the time ``begin``. Older ones are grouped if close
    together; the oldest groups are merged until at most :data:`MAX_GROUPS` are left.

    :param times: time of each message [s]
    """
    groups: List[Tuple[float, List[int]]] = []
    for time_s, place in sorted((time_s, place) for place, time_s in enumerate(times)):
        time_s = begin if begin - time_s < TOGETHER_S else time_s
        if not groups or time_s - groups[-1][0] >= TOGETHER_S:
            groups.append((time_s, []))
        groups[-1][1].append(place)
    while len(groups) > MAX_GROUPS:
        groups[:2] = [(groups[1][0], groups[0][1] + groups[1][1])]
    return groups


def other_speed(speed: float, steps: int) -> float:
    """Return the speed a number of steps faster (positive) or slower, within :data:`SPEEDS`."""
    place = SPEEDS.index(min(SPEEDS, key=lambda one: abs(one - speed))) + steps
    return SPEEDS[min(max(0, place), len(SPEEDS) - 1)]


class ReplayClock:
    """The clock of the session, by which a screen computes the age of messages.

    It runs at the speed of playback, stops during a pause, and never goes back: a jump back makes
    all earlier messages old. Calls may come from any thread; a race costs an error of some
    milliseconds.

    :param real: function that returns real time [s, monotonic]
    """

    def __init__(self, real: Callable[[], float]) -> None:
        self._real = real
        # (received at, position, maximum position, speed, offset to clock time, jumps, start)
        self._anchor = (real(), 0.0, 0.0, 0.0, 0.0, -1, 0.0)
        self._last = 0.0

    def update(self, start: float, position_s: float, until_s: float, speed: float,
               jumps: int) -> None:
        """Handle the player's state.

        :param start: start of the session [s since 1970]
        :param until_s: maximum position before the next state
        :param speed: 0 during a pause
        :param jumps: number of jumps so far; a new jump makes earlier messages old
        """
        offset_s, known = self._anchor[4:6]
        if jumps != known and position_s + offset_s < self._last:
            offset_s = self._last + _AGES_S - position_s
        self._anchor = (self._real(), position_s, max(position_s, until_s), speed, offset_s, jumps,
                        start)

    def _now_s(self) -> float:
        """Return the position in the session [s]."""
        heard_at, position_s, until_s, speed, *_ = self._anchor
        return min(until_s, position_s + speed * min(
            max(0.0, self._real() - heard_at), _TRUSTED_S))

    def __call__(self) -> float:
        """Return the clock time [s], never less than before."""
        self._last = max(self._last, self._now_s() + self._anchor[4])
        return self._last

    def wall(self) -> float:
        """Return the time of day of the session [s since 1970]."""
        return self._anchor[6] + self._now_s()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Playing a session: where it is, how fast it goes, and the time that a screen of it counts by."""
from typing import Callable, Iterable, List, Tuple

#: times as fast as it was
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
# A seek begins so long before its aim [s], so that what is silent then is known to be: longer than
# a robot may be silent, and than a new stamp needs to be believed.
RUN_UP_S = 1.5
# Of what is older than that, so much [s] apart is told as of one time; so often at most.
TOGETHER_S, MOST_GROUPS = 0.3, 6
# Without a word of the player for so long [s], its time stands still.
_TRUSTED_S = 0.5
# After a jump back everything heard before is older than anything may be [s].
_AGES_S = 60.0


class Playing:
    """Whether a session plays, where and how fast; time is passed in [s, monotonic].

    At its end it pauses; to play from there begins again. Not thread-safe.

    :param length_s: how long it is
    """

    def __init__(self, length_s: float) -> None:
        self.length_s = max(0.0, length_s)
        self.playing = False
        self.speed = 1.0
        self._position_s = 0.0
        self._since = 0.0

    def position_s(self, now: float) -> float:
        """Return where it is, from the start; it has paused if that is the end."""
        if self.playing:
            passed_s = max(0.0, now - self._since) * self.speed
            self._position_s = min(self.length_s, self._position_s + passed_s)
            self._since = now
            self.playing = self._position_s < self.length_s
        return self._position_s

    def play(self, now: float) -> None:
        """Go on; at the end, from the beginning."""
        if self.position_s(now) >= self.length_s:
            self._position_s = 0.0
        self.playing, self._since = self.length_s > 0.0, now

    def pause(self, now: float) -> None:
        """Stand still."""
        self.position_s(now)
        self.playing = False

    def set_speed(self, speed: float, now: float) -> None:
        """Go so many times as fast as it was, the nearest of :data:`SPEEDS`."""
        self.position_s(now)
        self.speed = min(SPEEDS, key=lambda one: abs(one - speed))

    def seek(self, position_s: float, now: float) -> None:
        """Go to a position in [0, length]; it plays on if it did."""
        self._position_s, self._since = min(max(0.0, position_s), self.length_s), now


def age_groups(times: Iterable[float], begin: float) -> List[Tuple[float, List[int]]]:
    """Return [(time, places in ``times``)]: what a screen is to hear as of when, the oldest first.

    What was said a moment before ``begin`` counts as of then. Of what is older, several that fell
    silent together are one group; of more than :data:`MOST_GROUPS` the oldest are one.

    :param times: when each was said [s]
    """
    groups: List[Tuple[float, List[int]]] = []
    for time_s, place in sorted((time_s, place) for place, time_s in enumerate(times)):
        time_s = begin if begin - time_s < TOGETHER_S else time_s
        if not groups or time_s - groups[-1][0] >= TOGETHER_S:
            groups.append((time_s, []))
        groups[-1][1].append(place)
    while len(groups) > MOST_GROUPS:
        groups[:2] = [(groups[1][0], groups[0][1] + groups[1][1])]
    return groups


def other_speed(speed: float, steps: int) -> float:
    """Return the speed so many steps faster (positive) or slower, within :data:`SPEEDS`."""
    place = SPEEDS.index(min(SPEEDS, key=lambda one: abs(one - speed))) + steps
    return SPEEDS[min(max(0, place), len(SPEEDS) - 1)]


class ReplayClock:
    """Seconds of the session, for a screen that asks how old something is.

    They go as fast as the session plays, stand still while it pauses, and never go back: a jump
    back makes everything old that was heard before. Calls may come from any thread; a torn read is
    off by some milliseconds.

    :param real: function that returns seconds, monotonic
    """

    def __init__(self, real: Callable[[], float]) -> None:
        self._real = real
        # (heard at, position, the furthest, speed, what is added to be clock time, jumps, start)
        self._anchor = (real(), 0.0, 0.0, 0.0, 0.0, -1, 0.0)
        self._last = 0.0

    def hear(self, start: float, position_s: float, until_s: float, speed: float,
             jumps: int) -> None:
        """Take in the player's word.

        :param start: of the session [s since 1970]
        :param until_s: it goes no further than this before the next word
        :param speed: 0 while it pauses
        :param jumps: how often it has jumped; what was heard before counts no more
        """
        offset_s, known = self._anchor[4:6]
        if jumps != known and position_s + offset_s < self._last:
            offset_s = self._last + _AGES_S - position_s
        self._anchor = (self._real(), position_s, max(position_s, until_s), speed, offset_s, jumps,
                        start)

    def _now_s(self) -> float:
        """Return the position in the session."""
        heard_at, position_s, until_s, speed, *_ = self._anchor
        return min(until_s, position_s + speed * min(
            max(0.0, self._real() - heard_at), _TRUSTED_S))

    def __call__(self) -> float:
        """Return seconds that never go back."""
        self._last = max(self._last, self._now_s() + self._anchor[4])
        return self._last

    def wall(self) -> float:
        """Return the time of day of the session [s since 1970]."""
        return self._anchor[6] + self._now_s()

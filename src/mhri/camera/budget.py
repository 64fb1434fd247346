# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Allocates the network to the cameras: driven robots first, thumbnails last.

To keep a limit [bit/s], a stream is unlimited, thinned (one picture at a time over a connection
that is then closed, :mod:`mhri.camera.ros.samples`) or paused. The least important is thinned
first: thumbnails down to one picture in five seconds, then the enlarged picture down to
:data:`LOOKED_AT_MIN_HZ`; then thumbnails are paused, the most expensive first. The picture of a
driven robot is never limited, even if it alone exceeds the limit.
"""
from dataclasses import dataclass, replace
import math
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

DRIVEN = 'driven'
LOOKED_AT = 'looked at'
REST = 'rest'
IMPORTANCES = (DRIVEN, LOOKED_AT, REST)

#: rates of a thinned stream [Hz]; at higher ones a connection per picture costs more than it saves
SAMPLED_HZ = (5.0, 2.0, 1.0, 0.5, 0.2)
LOOKED_AT_MIN_HZ = 5.0
# Overhead of requesting one picture [bit] (measured: 3.7 to 5.3 kB), including the part of the next
# one sent before the publisher detects the end of the connection.
_ASKING_BITS = 4e4
_SENT_FOR_ONE = 1.1
# Thinning must save at least half.
_SAVES = 2.0
# Hysteresis of the rates: figures are rounded up to this many steps per octave, one that falls by
# less than this fraction is kept, and a better rate must fit for this long [s].
_IN_OCTAVE = 8
_FALLS = 0.2
_CALM_S = 5.0
# Assumed until a stream has been measured: VGA as jpeg.
_TYPICAL_BITS = 3.3e5
_TYPICAL_HZ = 30.0
# A raw picture is at least this many times larger than the same picture as jpeg.
_COMPRESSED = 8.0


@dataclass(frozen=True)
class Grant:
    """The rate and transport granted to the feed of one picture.

    ``rate_hz``: maximum rate [Hz], None: unlimited, 0: no pictures and no connection.
    ``sampled``: thinned on the network, too: one picture at a time, each over its own connection;
    else all are received and only this many decoded. ``lighter``: use the best transport available,
    whatever the operator chose. ``words``: a note for the operator, '' if nothing is limited.
    """

    rate_hz: Optional[float] = None
    sampled: bool = False
    lighter: bool = False
    words: str = ''


AS_IT_COMES = Grant()
UNSEEN = Grant(0.0)


class Figures(NamedTuple):
    """Measured figures of a stream.

    ``bits``: size of a message [bit]; ``native_hz``: rate of the camera [Hz]; both are None until
    measured, 0 for a silent camera. ``heavy``: raw by choice, though available compressed.
    """

    bits: Optional[float] = None
    native_hz: Optional[float] = None
    heavy: bool = False


@dataclass(frozen=True)
class Picture:
    """One picture with a place on the screen, and the :class:`Figures` of its stream.

    ``name``: the robot's; ``importance``: one of :data:`IMPORTANCES`; ``visible``: false if
    hidden.
    """

    name: str
    importance: str = REST
    visible: bool = True
    bits: Optional[float] = None
    native_hz: Optional[float] = None
    heavy: bool = False

    def cost(self, rate_hz: float) -> float:
        """Return the load on the network [bit/s] at a rate [Hz, infinite: unlimited]."""
        bits = _TYPICAL_BITS if self.bits is None else self.bits
        if math.isinf(rate_hz):
            return bits * (_TYPICAL_HZ if self.native_hz is None else self.native_hz)
        return (_SENT_FOR_ONE * bits + _ASKING_BITS) * rate_hz

    def steps(self, thumbnail_hz: float) -> List[float]:
        """Return its possible rates, best first: unlimited, then rates that save enough."""
        full = self.cost(math.inf)
        most = min(thumbnail_hz if self.importance == REST else math.inf, SAMPLED_HZ[0])
        rates = [rate for rate in sorted({most, *SAMPLED_HZ}, reverse=True) if rate <= most]
        return [math.inf] + [rate for rate in rates if self.cost(rate) * _SAVES <= full]


@dataclass(frozen=True)
class Plan:
    """The rates of all pictures.

    ``grants``: {name: :class:`Grant`}; ``bits_per_s``: their planned load together; ``note``: a
    sentence if the limit cannot be kept, else ''.
    """

    grants: Dict[str, Grant]
    bits_per_s: float = 0.0
    note: str = ''


@dataclass
class _Held:
    """A picture's present rate [Hz], and the time since which a better one fits [s], or None."""

    importance: str
    rate_hz: float
    better_since: Optional[float] = None


class BudgetPlanner:
    """Plans the rates repeatedly, so that they drop at once and rise slowly."""

    def __init__(self) -> None:
        self._held: Dict[str, _Held] = {}
        self._light: Set[str] = set()
        self._figures: Dict[str, Tuple[Optional[float], Optional[float]]] = {}

    def plan(self, pictures: Iterable[Picture], limit_bits_per_s: float, thumbnail_hz: float,
             now: float) -> Plan:
        """Return the :class:`Plan` of this moment; call it about once a second.

        :param pictures: each name once
        :param limit_bits_per_s: load allowed for all together; 0: no limit
        :param thumbnail_hz: maximum rate of the pictures of :data:`REST`
        :param now: [s, monotonic]
        """
        pictures = list(pictures)
        seen = [self._steady(picture) for picture in pictures if picture.visible]
        if any(None in self._figures.get(picture.name, ())
               and None not in (picture.bits, picture.native_hz) for picture in seen):
            # Discard a plan based on assumed figures at once.
            self._held = {}
        self._figures = {picture.name: (picture.bits, picture.native_hz) for picture in seen}
        if limit_bits_per_s <= 0.0:
            self._held, self._light = {}, set()
            rates = {picture.name: math.inf for picture in seen}
        else:
            seen = self._lightened(seen, limit_bits_per_s, thumbnail_hz)
            rates = self._calm(seen, limit_bits_per_s, thumbnail_hz, now)
        grants = {picture.name: UNSEEN for picture in pictures}
        grants.update((picture.name, self._grant(picture, rates[picture.name], thumbnail_hz))
                      for picture in seen)
        return Plan(grants, sum(picture.cost(rates[picture.name]) for picture in seen),
                    _note(seen, limit_bits_per_s))

    def _steady(self, picture: Picture) -> Picture:
        """Return a picture whose figures rise at once and fall only in large steps."""
        bits, native_hz = self._figures.get(picture.name, (None, None))
        return replace(picture, bits=_steady(picture.bits, bits),
                       native_hz=_steady(picture.native_hz, native_hz))

    def _lightened(self, seen: List[Picture], limit: float, thumbnail_hz: float) -> List[Picture]:
        """Return the pictures with raw ones compressed that would otherwise be thinned.

        A picture stays compressed until its robot is driven, or nothing is limited any more.
        """
        rates = _targets(seen, limit, thumbnail_hz)
        self._light = {
            picture.name for picture in seen if picture.importance != DRIVEN and (
                picture.name in self._light
                or picture.heavy and not math.isinf(rates[picture.name]))}
        return [replace(picture, bits=picture.bits / _COMPRESSED)
                if picture.heavy and picture.bits and picture.name in self._light else picture
                for picture in seen]

    def _calm(self, seen: Sequence[Picture], limit: float, thumbnail_hz: float,
              now: float) -> Dict[str, float]:
        """Return the rates: lowered at once, raised after a better one has fitted for a while."""
        most = _targets(seen, limit, thumbnail_hz)
        held = {}
        for picture in seen:
            name = picture.name
            now_has = self._held.get(name)
            if (now_has is None or now_has.importance != picture.importance
                    or now_has.rate_hz not in (0.0, *picture.steps(thumbnail_hz))):
                now_has = _Held(picture.importance, most[name])
            if most[name] <= now_has.rate_hz:
                now_has.rate_hz, now_has.better_since = most[name], None
            elif now_has.better_since is None:
                now_has.better_since = now
            elif now - now_has.better_since >= _CALM_S:
                now_has.rate_hz, now_has.better_since = most[name], None
            held[name] = now_has
        self._held = held
        return {name: one.rate_hz for name, one in held.items()}

    def _grant(self, picture: Picture, rate_hz: float, thumbnail_hz: float) -> Grant:
        """Return the :class:`Grant` of a rate."""
        lighter = picture.name in self._light
        wanted_hz = thumbnail_hz if picture.importance == REST else math.inf
        words = ''
        if rate_hz == 0.0:
            words = 'paused: camera budget'
        elif rate_hz < wanted_hz:
            words = 'thinned to {:g} Hz: camera budget'.format(rate_hz)
        elif lighter:
            words = 'compressed: camera budget'
        if math.isinf(rate_hz):
            return Grant(None if math.isinf(wanted_hz) else wanted_hz, False, lighter, words)
        return Grant(rate_hz, rate_hz > 0.0, lighter, words)


def _steady(figure: Optional[float], before: Optional[float]) -> Optional[float]:
    """Return a figure rounded up, or the previous value if it has fallen only a little."""
    if not figure:
        return figure
    if before is not None and (1.0 - _FALLS) * before <= figure <= before:
        return before
    return math.pow(2.0, math.ceil(_IN_OCTAVE * math.log2(figure)) / _IN_OCTAVE)


def _targets(seen: Sequence[Picture], limit: float, thumbnail_hz: float) -> Dict[str, float]:
    """Return the best rates [Hz] within a limit [bit/s]."""
    driven, looked_at, rest = ([picture for picture in seen if picture.importance == importance]
                               for importance in IMPORTANCES)
    rates = {picture.name: math.inf for picture in driven}
    left = limit - sum(picture.cost(math.inf) for picture in driven)
    # Thumbnails at their minimum take precedence over an enlarged picture above its minimum.
    alive = sum(picture.cost(picture.steps(thumbnail_hz)[-1]) for picture in rest)
    enough = sum(min(picture.cost(rate) for rate in picture.steps(thumbnail_hz)
                     if rate >= LOOKED_AT_MIN_HZ) for picture in looked_at)
    rates.update(_share(looked_at, max(left - alive, min(left, enough)), thumbnail_hz))
    left -= sum(picture.cost(rates[picture.name]) for picture in looked_at)
    rates.update(_share(rest, left, thumbnail_hz))
    return rates


def _share(pictures: Sequence[Picture], bits_per_s: float,
           thumbnail_hz: float) -> Dict[str, float]:
    """Distribute bits: cheap pictures get all they can use, expensive ones get equal parts.

    If even the minimum rates do not fit, pause the most expensive, of equal ones the last.
    """
    steps = {picture.name: picture.steps(thumbnail_hz) for picture in pictures}
    least = {picture.name: picture.cost(steps[picture.name][-1]) for picture in pictures}
    rates = {picture.name: 0.0 for picture in pictures}
    kept = sorted(pictures, key=lambda picture: least[picture.name])
    while kept and sum(least[picture.name] for picture in kept) > bits_per_s:
        kept.pop()
    left = bits_per_s - sum(least[picture.name] for picture in kept)
    kept.sort(key=lambda picture: picture.cost(math.inf))
    for index, picture in enumerate(kept):
        part = least[picture.name] + left / (len(kept) - index)
        rate = next((rate for rate in steps[picture.name] if picture.cost(rate) <= part),
                    steps[picture.name][-1])
        rates[picture.name] = rate
        left -= picture.cost(rate) - least[picture.name]
    return rates


def _note(seen: Sequence[Picture], limit: float) -> str:
    """Return a note if the driven robots' pictures alone exceed the limit, else ''."""
    driven = sum(picture.cost(math.inf) for picture in seen if picture.importance == DRIVEN)
    if limit <= 0.0 or driven <= limit:
        return ''
    return 'the pictures of the driven robots alone take {:.1f} Mbit/s; the camera budget is ' \
        '{:g}'.format(driven / 1e6, limit / 1e6)

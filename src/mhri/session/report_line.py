# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time line of a report: what the template ``time_line.svg`` draws, and where."""
from dataclasses import dataclass
from typing import Callable, Dict, Iterable, List, Tuple

from mhri.recording.folder import ERROR, first_words
from mhri.recording.recording import duration_text
from mhri.session.report import Report
from mhri.session.timeline import EVENT, Span

_WIDE, _LEFT, _ROW, _TOP = 1000.0, 110.0, 26.0, 46.0
_TROUBLE, _ATTENTION = '#c65300', '#a86e00'
_STEPS_S = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200, 86400)
# Size of a label [px of 1000]: from its mark to the text, of a character, to the next mark.
_TO_TEXT, _CHARACTER, _GAP = 13.0, 6.6, 6.0
# With room for fewer characters a mark has only its number.
_MIN_WORDS = 8


@dataclass(frozen=True)
class Bar:
    """A rectangle [px]; ``look`` is its class in the page's style."""

    look: str
    x: float
    y: float
    width: float
    height: float
    colour: str = ''


@dataclass(frozen=True)
class LineDrawing:
    """The drawing [px], ``low`` being the lower edge of the rows.

    ``names`` are (y, text), ``flags`` (x, title, text), ``strokes`` (x, colour, title), ``axis``
    (x, text).
    """

    width: float
    height: float
    low: float
    bars: List[Bar]
    names: List[Tuple[float, str]]
    flags: List[Tuple[float, str, str]]
    strokes: List[Tuple[float, str, str]]
    axis: List[Tuple[float, str]]
    to_text: float = _TO_TEXT


def drawn_line(report: Report) -> LineDrawing:
    """Return the time line: when robots were driven and heard, stops, marks, trouble."""
    length_s = max(report.line.length_s, 1e-3)
    scale = (_WIDE - _LEFT - 14.0) / length_s
    low = _TOP + _ROW * max(1, len(report.robots))

    def x(at_s: float) -> float:
        return round(_LEFT + min(max(at_s, 0.0), length_s) * scale, 1)

    def bars(look: str, spans: Iterable[Span], y: float, height: float,
             colour: str = '') -> List[Bar]:
        return [Bar(look, x(span.begin_s), y,
                    max(1.0, round(x(span.end_s) - x(span.begin_s), 1)), height, colour)
                for span in _merged(spans, 0.7 / scale)]
    found, names = bars('stopped', report.line.stopped, _TOP - 4, low - _TOP + 8), []
    for place, robot in enumerate(report.robots):
        top = _TOP + _ROW * place
        names.append((top + 17, '{} {}'.format(robot.number, _cut(robot.name, 12))))
        if robot.survey.first_s is not None:
            found += bars('heard', [Span(robot.survey.first_s, length_s)], top + 11, 3)
        found += bars('task', robot.survey.on_tasks or (), top + 5, 15, robot.colour)
        found += bars('driven', robot.driven, top + 5, 15, robot.colour)
        found += bars('silent', robot.survey.silences, top + 5, 15)
    return LineDrawing(_WIDE, low + 30, low, found, names, _flags(report, x), _strokes(report, x),
                       _axis(length_s, x))


def _merged(spans: Iterable[Span], gap_s: float) -> List[Span]:
    """Return spans, merged if the gap between them is too small to see."""
    found: List[Span] = []
    for span in spans:
        if found and span.begin_s - found[-1].end_s < gap_s:
            found[-1] = Span(found[-1].begin_s, max(found[-1].end_s, span.end_s))
        else:
            found.append(Span(span.begin_s, span.end_s))
    return found


def _strokes(report: Report, x: Callable[[float], float]) -> List[Tuple[float, str, str]]:
    """Return a stroke for each trouble; of coinciding ones the first."""
    found: Dict[int, Tuple[float, str, str]] = {}
    for tick in report.line.ticks:
        if tick.kind == EVENT:
            at = x(tick.at_s)
            found.setdefault(round(at), (
                at, _TROUBLE if tick.severity == ERROR else _ATTENTION,
                '{} {}'.format(tick.robot, tick.text)[:80]))
    return list(found.values())


def _flags(report: Report, x: Callable[[float], float]) -> List[Tuple[float, str, str]]:
    """Return a flag for each mark, with as many of its words as fit before the next one."""
    places = {x(mark.ros - report.line.start): mark for mark in report.marks}
    found = []
    for at, end in zip(sorted(places), [*sorted(places)[1:], _WIDE]):
        mark = places[at]
        room = int((end - at - _TO_TEXT - _GAP) / _CHARACTER)
        found.append((at, mark.words[:80], first_words(mark.label, room) if room >= _MIN_WORDS
                      else mark.number if len(mark.number) <= room else ''))
    return found


def _axis(length_s: float, x: Callable[[float], float]) -> List[Tuple[float, str]]:
    step_s = next((step for step in _STEPS_S if length_s / step <= 10), _STEPS_S[-1])
    count = min(int(length_s / step_s), 1000)
    return [(x(step_s * number), duration_text(step_s * number)) for number in range(count + 1)]


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[:most - 1] + '\u2026'

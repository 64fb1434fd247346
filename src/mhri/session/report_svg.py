# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time line of a report, as SVG for its HTML page."""
from html import escape
from typing import Callable, Iterable, List

from mhri.recording.folder import ERROR, first_words
from mhri.recording.recording import duration_text
from mhri.session.report import Report
from mhri.session.timeline import EVENT, Span

_WIDE, _LEFT, _ROW, _TOP = 1000.0, 110.0, 26.0, 46.0
_STOP, _ATTENTION, _INK = '#c65300', '#a86e00', '#222'
_STEPS_S = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200, 86400)
# Size of a label [px of 1000]: from its mark to the text, of a character, to the next mark.
_TO_TEXT, _CHARACTER, _GAP = 13.0, 6.6, 6.0
# With room for fewer characters a mark has only its number.
_MIN_WORDS = 8


def time_line_svg(report: Report) -> str:
    """Return the time line: when robots were driven and heard, stops, marks, trouble."""
    length_s = max(report.line.length_s, 1e-3)
    scale = (_WIDE - _LEFT - 14.0) / length_s
    low = _TOP + _ROW * max(1, len(report.robots))

    def x(at_s: float) -> float:
        return _LEFT + min(max(at_s, 0.0), length_s) * scale

    def bars(spans: Iterable[Span], top: float, high: float, look: str) -> List[str]:
        return ['<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" {}/>'.format(
            x(span.begin_s), top, max(1.0, x(span.end_s) - x(span.begin_s)), high, look)
            for span in _merged(spans, 0.7 / scale)]
    parts = bars(report.line.stopped, _TOP - 4, low - _TOP + 8, 'fill="{}" opacity=".22"'.format(
        _STOP))
    for place, robot in enumerate(report.robots):
        top = _TOP + _ROW * place
        parts.append('<text x="0" y="{:.1f}">{} {}</text>'.format(
            top + 17, robot.number, escape(_cut(robot.name, 12))))
        first_s = robot.survey.first_s
        if first_s is not None:
            parts += bars([Span(first_s, length_s)], top + 11, 3, 'fill="#bbb"')
        parts += bars(robot.survey.on_tasks or (), top + 5, 15,
                      'fill="{0}" fill-opacity=".3" stroke="{0}"'.format(robot.colour))
        parts += bars(robot.driven, top + 5, 15, 'fill="{}"'.format(robot.colour))
        parts += bars(robot.survey.silences, top + 5, 15,
                      'fill="#fff" stroke="{}" stroke-dasharray="3 2"'.format(_STOP))
    parts += _ticks(report, x) + _axis(length_s, x, low)
    return '<svg viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="time line">{}</svg>'.format(
        _WIDE, low + 30, ''.join(parts))


def _merged(spans: Iterable[Span], gap_s: float) -> List[Span]:
    """Return spans, merged if the gap between them is too small to see."""
    found: List[Span] = []
    for span in spans:
        if found and span.begin_s - found[-1].end_s < gap_s:
            found[-1] = Span(found[-1].begin_s, max(found[-1].end_s, span.end_s))
        else:
            found.append(Span(span.begin_s, span.end_s))
    return found


def _ticks(report: Report, x: Callable[[float], float]) -> List[str]:
    """Return marks with trouble below them; coinciding ticks are drawn once."""
    parts, seen = _flags(report, x), set()
    for tick in report.line.ticks:
        at = x(tick.at_s)
        if tick.kind == EVENT and round(at) not in seen:
            seen.add(round(at))
            parts.append('<path d="M{:.1f} 34v8" stroke="{}" stroke-width="3"><title>{}</title>'
                         '</path>'.format(at, _STOP if tick.severity == ERROR else _ATTENTION,
                                          escape('{} {}'.format(tick.robot, tick.text)[:80])))
    return parts


def _flags(report: Report, x: Callable[[float], float]) -> List[str]:
    """Return a flag for each mark, with as many of its words as fit before the next one."""
    places = {round(x(mark.ros - report.line.start), 1): mark for mark in report.marks}
    parts = []
    for at, end in zip(sorted(places), [*sorted(places)[1:], _WIDE]):
        mark = places[at]
        parts.append('<path d="M{:.1f} 32v-20l10 4l-10 4" fill="{}" stroke="{}" '
                     'stroke-width="1.5"><title>{}</title></path>'.format(
                         at, _INK, _INK, escape(mark.words[:80])))
        room = int((end - at - _TO_TEXT - _GAP) / _CHARACTER)
        text = first_words(mark.label, room) if room >= _MIN_WORDS else \
            mark.number if len(mark.number) <= room else ''
        parts += ['<text x="{:.1f}" y="20" font-size="12">{}</text>'.format(
            at + _TO_TEXT, escape(text))] if text else []
    return parts


def _axis(length_s: float, x: Callable[[float], float], low: float) -> List[str]:
    step_s = next((step for step in _STEPS_S if length_s / step <= 10), _STEPS_S[-1])
    count = min(int(length_s / step_s), 1000)
    return ['<path d="M{0:.1f} {1:.1f}v5" stroke="#888"/><text x="{0:.1f}" y="{2:.1f}" '
            'text-anchor="middle" class="quiet">{3}</text>'.format(
                x(step_s * number), low + 4, low + 22, duration_text(step_s * number))
            for number in range(count + 1)]


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[:most - 1] + '\u2026'

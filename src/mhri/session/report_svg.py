# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawings on the page of a report: time line and map, as SVG inside of HTML."""
from html import escape
import math
from typing import Callable, Iterable, List, Sequence

import numpy as np

from mhri.recording.folder import ERROR
from mhri.session.report import Report
from mhri.session.sheet import lines_m, Sheet, Spot, Way
from mhri.session.timeline import duration_text, EVENT, MARK, Span

_WIDE, _LEFT, _ROW, _TOP = 1000.0, 110.0, 26.0, 46.0
_STOP, _ATTENTION, _INK = '#c65300', '#a86e00', '#222'
_STEPS_S = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200, 86400)
# Marks that are nearer than this share a name [px of 1000].
_NEAR = 16.0


def time_line_svg(report: Report) -> str:
    """Return the time line: who was driven and heard when, stops, marks, trouble."""
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
        parts += bars((span for span in report.line.driven if span.robot == robot.name),
                      top + 5, 15, 'fill="{}"'.format(robot.colour))
        parts += bars(robot.survey.silences, top + 5, 15,
                      'fill="#fff" stroke="{}" stroke-dasharray="3 2"'.format(_STOP))
    parts += _ticks(report, x) + _axis(length_s, x, low)
    return '<svg viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="time line">{}</svg>'.format(
        _WIDE, low + 30, ''.join(parts))


def _merged(spans: Iterable[Span], gap_s: float) -> List[Span]:
    """Return spans with those made one that nobody could tell apart."""
    found: List[Span] = []
    for span in spans:
        if found and span.begin_s - found[-1].end_s < gap_s:
            found[-1] = Span(found[-1].begin_s, max(found[-1].end_s, span.end_s))
        else:
            found.append(Span(span.begin_s, span.end_s))
    return found


def _ticks(report: Report, x: Callable[[float], float]) -> List[str]:
    """Return marks with their names, and trouble below them; one where several are."""
    parts, named, seen = [], -math.inf, set()
    names = iter([mark.id for mark in report.marks])
    for tick in report.line.ticks:
        at = x(tick.at_s)
        name = next(names, '') if tick.kind == MARK else ''
        if (tick.kind, round(at)) in seen:
            continue
        seen.add((tick.kind, round(at)))
        if tick.kind == MARK:
            parts.append('<path d="M{:.1f} 21l5 6l-5 6l-5 -6z" fill="#fff" stroke="{}" '
                         'stroke-width="1.5"><title>{}</title></path>'.format(
                             at, _INK, escape(tick.text[:80])))
            if at - named > _NEAR + 7 * len(name):
                parts.append('<text x="{:.1f}" y="14" text-anchor="middle">{}</text>'.format(
                    at, escape(_cut(name, 8))))
                named = at
        elif tick.kind == EVENT:
            parts.append('<path d="M{:.1f} 34v8" stroke="{}" stroke-width="3"><title>{}</title>'
                         '</path>'.format(at, _STOP if tick.severity == ERROR else _ATTENTION,
                                          escape('{} {}'.format(tick.robot, tick.text)[:80])))
    return parts


def _axis(length_s: float, x: Callable[[float], float], low: float) -> List[str]:
    step_s = next((step for step in _STEPS_S if length_s / step <= 10), _STEPS_S[-1])
    count = min(int(length_s / step_s), 1000)
    return ['<path d="M{0:.1f} {1:.1f}v5" stroke="#888"/><text x="{0:.1f}" y="{2:.1f}" '
            'text-anchor="middle" class="quiet">{3}</text>'.format(
                x(step_s * number), low + 4, low + 22, duration_text(step_s * number))
            for number in range(count + 1)]


def map_svg(sheet: Sheet, picture: str, ways: Sequence[Way], spots: Sequence[Spot]) -> str:
    """Return the map with the ways of the robots.

    :param picture: of the ground, as a data URI
    """
    unit = max(sheet.width, sheet.height) / 1000.0
    parts = ['<image href="{}" width="{}" height="{}" preserveAspectRatio="none" '
             'style="image-rendering:pixelated"/>'.format(picture, sheet.width, sheet.height)]
    for way in ways:
        lines = [sheet.pixels(piece) for piece in way.pieces if len(piece)]
        for line in lines:
            parts.append('<polyline points="{}" fill="none" stroke="{}" stroke-width="{:.1f}" '
                         'stroke-linejoin="round"/>'.format(_points(line), way.colour, 3 * unit))
        if lines:
            parts += _ends(way, lines, unit)
    for spot in spots:
        x, y = sheet.pixels(np.array([(spot.x_m, spot.y_m)]))[0]
        parts.append('<path d="M{0:.1f} {1:.1f}l{2:.1f} {2:.1f}l-{2:.1f} {2:.1f}l-{2:.1f} -{2:.1f}'
                     'z" fill="#fff" stroke="{3}" stroke-width="{4:.1f}"/>'.format(
                         x, y - 9 * unit, 9 * unit, _INK, 2 * unit))
        parts.append(_text(x + 14 * unit, y - 8 * unit, spot.name, unit, ''))
    length_m = lines_m(sheet)
    low = sheet.height - 20 * unit
    parts.append('<path d="M{0:.1f} {1:.1f}h{2:.1f}" stroke="{3}" stroke-width="{4:.1f}"/>'.format(
        20 * unit, low, length_m / sheet.px_m, _INK, 4 * unit))
    parts.append(_text(20 * unit, low - 9 * unit, '{:g} m'.format(length_m), unit, ''))
    return ('<svg class="map" viewBox="0 0 {} {}" role="img" aria-label="map">{}</svg>'.format(
        sheet.width, sheet.height, ''.join(parts)))


def _ends(way: Way, lines: Sequence[np.ndarray], unit: float) -> List[str]:
    """Return where a robot began, a ring, and where it was last, a disc with its number."""
    (from_x, from_y), (to_x, to_y) = lines[0][0], lines[-1][-1]
    return ['<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" fill="#fff" stroke="{}" '
            'stroke-width="{:.1f}"/>'.format(from_x, from_y, 7 * unit, way.colour, 3 * unit),
            '<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" fill="{}"><title>{}</title></circle>'
            .format(to_x, to_y, 13 * unit, way.colour, escape(way.name)),
            _text(to_x, to_y + 6 * unit, str(way.number), unit,
                  ' text-anchor="middle" style="fill:#fff;stroke:none"')]


def _text(x: float, y: float, text: str, unit: float, more: str) -> str:
    return '<text x="{:.1f}" y="{:.1f}" font-size="{:.1f}"{}>{}</text>'.format(
        x, y, 18 * unit, more, escape(_cut(text, 12)))


def _points(line: np.ndarray) -> str:
    return ' '.join('{:.1f},{:.1f}'.format(x, y) for x, y in line.tolist())


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[:most - 1] + '\u2026'

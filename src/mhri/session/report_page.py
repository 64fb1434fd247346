# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of a report: one self-contained HTML file for screen and print."""
from html import escape
from typing import List, Mapping, Sequence, Tuple

from mhri.recording.folder import CAMERA_RATE, INFO, SessionMark, words_of_still
from mhri.recording.recording import duration_text
from mhri.session.report import (
    date_text, events_shown, MAX_EVENTS, MAX_MARKS, Report, ROBOT_HEADS, seconds_text)
from mhri.session.flags import place_of
from mhri.session.report_svg import time_line_svg
from mhri.session.survey import Stopped
from mhri.session.timeline import stops

_STYLE = '''
body{font:15px/1.5 system-ui,sans-serif;max-width:62em;margin:2em auto;padding:0 1.5em;color:#222;
background:#fff}
h1{font-size:1.9em;line-height:1.2;margin:0}h2{font-size:1.2em;margin:2em 0 .5em;
border-bottom:2px solid #222;break-after:avoid}h3{font-size:1em;margin:1.2em 0 .3em;
break-after:avoid}p{margin:.4em 0}
dl.figures{display:flex;flex-wrap:wrap;gap:.4em 2.4em;margin:1.2em 0 0}dl.figures div{min-width:5em}
dt{color:#555;font-size:.87em}dd{margin:0;font-size:1.5em;font-variant-numeric:tabular-nums}
table{border-collapse:collapse;width:100%;margin:.3em 0}td,th{padding:.25em 1.2em .25em 0;
text-align:left;vertical-align:top;border-bottom:1px solid #ddd}
td:last-child{overflow-wrap:anywhere}table.robots td{white-space:nowrap}
th{font-weight:600;color:#555;font-size:.87em}td{font-variant-numeric:tabular-nums}
td:first-child,td.time{white-space:nowrap}tr{break-inside:avoid}
svg{width:100%;height:auto;display:block}svg text{font-family:system-ui,sans-serif;fill:#222}
svg text:not([font-size]){font-size:13px}svg text.quiet{fill:#555;font-size:12px}
img.map{border:1px solid #bbb;max-width:100%;max-height:46em}
.quiet{color:#555;font-size:.93em}.warning{color:#8a5a00}.error{color:#a84500;font-weight:600}
.bad{color:#a84500;font-weight:600}.chip{display:inline-block;width:.8em;height:.8em;
border-radius:50%;margin-right:.5em}
.mark{break-inside:avoid;margin:1em 0;padding:0 0 1em;border-bottom:1px solid #ddd}
.mark p.note{font-size:1.13em}.stills{display:flex;flex-wrap:wrap;gap:.6em;margin-top:.5em}
figure{margin:0;break-inside:avoid}figure img{width:18.5em;max-width:100%;display:block;
border:1px solid #bbb}figcaption{color:#555;font-size:.87em}
@media print{body{margin:0;max-width:none;padding:0;font-size:10.5pt;
print-color-adjust:exact;-webkit-print-color-adjust:exact}td,th{padding-right:.8em}}@page{margin:16mm}
'''


def page_of(report: Report, map_picture: str, stills: Mapping[str, str],
            map_note: str = '') -> str:
    """Return the page.

    :param map_picture: a data URI, '' without a map
    :param stills: {name in the session: data URI} of the readable stills
    :param map_note: a sentence below the map, e.g. with its file name
    """
    title = date_text(report.wall) or report.name
    parts = [
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        '<title>Session of {}</title><style>{}</style></head><body>'.format(
            escape(title), _STYLE),
        '<h1>Session of {}</h1>'.format(escape(title)), _about(report), _figures(report),
        '<h2>Time line</h2>', time_line_svg(report),
        '<p class="quiet">Bars: driven; pale bars: on tasks. Grey line: heard from; dashed: '
        'silent. Shaded: everything '
        'was stopped. Flags: marks. Strokes above the rows: warnings and trouble.</p>']
    if map_picture:
        parts += ['<h2>Map</h2>', '<img class="map" alt="map" src="{}">'.format(map_picture),
                  _map_note(report, map_note)]
    parts += [*_robots(report), *_marks(report, stills), *_stops(report), *_sensors(report)]
    for heading, rows in report.drills:
        parts += ['<h2>Drill: {}</h2>'.format(escape(heading)), table((), rows)]
    parts += [*_events(report), *_problems(report), '</body></html>\n']
    return '\n'.join(parts)


def _about(report: Report) -> str:
    info = report.info
    cameras = 'pictures {} times a second'.format(info.rate_hz) \
        if info.recorded == CAMERA_RATE else {'all': 'all pictures', 'stills': 'stills only'}.get(
            info.recorded, str(info.recorded))
    words = ['recorded' + (' on {}'.format(info.host) if info.host else '')
             + (' by mhri {}'.format(info.mhri) if info.mhri else ''), cameras,
             'folder {}'.format(report.name)]
    return '<p class="quiet">{}</p>'.format(escape('; '.join(words)))


def _figures(report: Report) -> str:
    trouble = sum(event.severity != INFO and not stops(event) for event in report.line.events)
    distance_m = sum(robot.survey.distance_m for robot in report.robots)
    found = (('length', duration_text(report.line.length_s)), ('robots', len(report.robots)),
             ('distance', '{:.1f} m'.format(distance_m)), ('marks', len(report.marks)),
             ('stops', len(report.line.stopped)), ('warnings and trouble', trouble))
    return '<dl class="figures">{}</dl>'.format(''.join(
        '<div><dt>{}</dt><dd>{}</dd></div>'.format(name, escape(str(value)))
        for name, value in found))


def _map_note(report: Report, note: str) -> str:
    if report.placed:
        text = 'Paths in frame "{}".'.format(report.info.frame)
        missing = [robot.name for robot in report.robots
                   if robot.name not in report.placed and robot.survey.pieces]
        if missing:
            text += ' Not placed on the map, and not drawn: {}.'.format(', '.join(missing))
    else:
        text = 'No robot was placed on a map: each path is by its own odometry.'
    return ('<p class="quiet">{} Ring: where it began; disc: where it was last; gap: nothing was '
            'received from it. {}</p>').format(escape(text), escape(note))


class Html(str):
    """A table cell that is already HTML."""


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], look: str = '') -> str:
    """Return a table of texts or :class:`Html`, '' without rows.

    :param look: attributes of the table
    """
    def row(kind: str, cells: Sequence[str]) -> str:
        return '<tr>{}</tr>'.format(''.join('<{0}>{1}</{0}>'.format(
            kind, cell if isinstance(cell, Html) else escape(cell)) for cell in cells))

    lines = [row('th', heads)] * bool(heads) + [row('td', cells) for cells in rows]
    return '<table{}>{}</table>'.format(look, ''.join(lines)) if rows else ''


def _robots(report: Report) -> List[str]:
    rows = [(Html('<span class="chip" style="background:{}"></span>{} {}'.format(
        robot.colour, robot.number, escape(robot.name[:40]))),
        *(cell[:40] for cell in robot.cells())) for robot in report.robots]
    return ['<h2>Robots</h2>', table(('robot', *ROBOT_HEADS), rows, ' class="robots"'),
            '<p class="quiet">Distance by odometry. Driven: selected for driving. On tasks: driven '
            'by itself. Silent: nothing heard for more than a second. Round trip: of the link, the '
            'middle one and what 95 % stayed below.</p>'] if rows else []


def _marks(report: Report, stills: Mapping[str, str]) -> List[str]:
    parts = []
    if report.marks:
        parts.append('<h2>Marks</h2>')
        parts += [_mark(report, mark, stills) for mark in report.marks[:MAX_MARKS]]
        if len(report.marks) > MAX_MARKS:
            parts.append('<p class="bad">The first {} of {} marks; the others are in the '
                         'session.</p>'.format(MAX_MARKS, len(report.marks)))
    others = [_figure(stills[name], '{} {}'.format(
        report.clock(ros - report.line.start), words_of_still(name)))
        for ros, name in report.extra_stills if name in stills]
    if others:
        parts += ['<h2>Stills</h2><div class="stills">', *others, '</div>']
    return parts


def _mark(report: Report, mark: SessionMark, stills: Mapping[str, str]) -> str:
    at_s = mark.ros - report.line.start
    poses = ['{} at {:.2f}, {:.2f} m'.format(robot, *place[:2]) for robot, place in (
        (robot, place_of(pose)) for robot, pose in list(mark.poses.items())[:20]) if place]
    figures = [_figure(stills[name], words_of_still(name))
               for name in mark.stills if name in stills]
    lost = sum(name not in stills for name in mark.stills)
    return ('<div class="mark"><h3>{} &middot; {} &middot; {} from the start</h3>'
            '<p class="note">{}</p><p class="quiet">{}</p>{}{}</div>').format(
        'Mark {}{}'.format(escape(mark.number[:40]),
                           ' &middot; ' + escape(mark.robot[:40]) if mark.robot else ''),
        escape(report.clock(at_s)), duration_text(at_s),
        escape(mark.note[:2000]), escape('; '.join(poses)),
        '<div class="stills">{}</div>'.format(''.join(figures)) if figures else '',
        '<p class="bad">{} not shown: missing, no picture, or too many</p>'.format(
            'one still is' if lost == 1 else '{} stills are'.format(lost)) if lost else '')


def _figure(uri: str, words: str) -> str:
    return '<figure><img src="{}" alt="{}"><figcaption>{}</figcaption></figure>'.format(
        uri, escape(words), escape(words))


def _stops(report: Report) -> List[str]:
    if not report.line.stopped:
        return []
    parts = ['<h2>Stops</h2>']
    for stop in report.stops:
        parts.append('<h3>STOP ALL at {}, for {}{}</h3>'.format(
            escape(report.clock(stop.span.begin_s)), seconds_text(stop.span.lasts_s),
            '' if stop.released else ', not released before the end of the session'))
        parts.append(table(('robot', 'by its recorded odometry', 'what the screen said'), [
            (name, _proof(recorded), said[:300]) for name, recorded, said in stop.proofs]))
    if len(report.line.stopped) > len(report.stops):
        parts.append('<p class="bad">The first {} of {} stops.</p>'.format(
            len(report.stops), len(report.line.stopped)))
    return parts


def _sensors(report: Report) -> List[str]:
    rows = [(report.clock(row.span.begin_s), row.span.robot[:60], row.text[:200],
             seconds_text(row.span.lasts_s) + ('' if row.over else ', until the end'))
            for row in report.sensors]
    return ['<h2>Sensors beyond their limits</h2>',
            table(('time', 'robot', 'what', 'for'), rows)] if rows else []


def _proof(recorded: Stopped) -> str:
    words = recorded.words()
    return words if recorded.proved else Html('<span class="bad">{}</span>'.format(escape(words)))


def _events(report: Report) -> List[str]:
    shown = events_shown(report.line.events)
    if not shown:
        return []
    rows: List[Tuple[str, ...]] = []
    for event in shown:
        tone = event.severity if event.severity in ('warning', 'error') else ''
        words = {'error': 'TROUBLE: ', 'warning': 'warning: '}.get(
            tone, '') if not stops(event) else ''
        rows.append((report.clock(event.ros - report.line.start), event.robot[:60],
                     event.kind[:20], Html('<span class="{}">{}{}</span>'.format(
                         tone, words, escape(event.text[:500])))))
    parts = ['<h2>What happened</h2>', table(('time', 'robot', 'kind', 'what'), rows)]
    if len(shown) < len(report.line.events):
        parts.append('<p class="bad">{} of {} lines: a page has {} at most, warnings and trouble '
                     'before others.</p>'.format(len(shown), len(report.line.events),
                                                 MAX_EVENTS))
    return parts


def _problems(report: Report) -> List[str]:
    if not report.problems:
        return []
    return ['<h2>Missing from this report</h2>', '<ul>{}</ul>'.format(''.join(
        '<li>{}</li>'.format(escape(problem[:500])) for problem in report.problems))]

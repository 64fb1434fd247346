# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of a drill: one self-contained HTML file with tables and a map of the paths."""
from html import escape
from typing import Any, List, Mapping, Sequence

from mhri.base.robot_colours import colour_of
from mhri.drill.results import heads_of
from mhri.drill.scenario import Target
from mhri.session.drill_results import rows_of
from mhri.session.report_page import table

_MARGIN_M, _WIDTH_PX = 0.3, 720
_STYLE = ('body{font:16px/1.5 sans-serif;max-width:46em;margin:2em auto;padding:0 1em;color:#222}'
          'table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em 1em .2em 0;'
          'text-align:left;border-bottom:1px solid #ddd;font-variant-numeric:tabular-nums}'
          'svg{width:100%;height:auto;background:#fafafa;border:1px solid #ddd}'
          'small{color:#555}')
NOTE = ('Terms after Olsen and Goodrich (2003), Olsen and Wood (2004) and Crandall et al. (2005); '
        'tasks after the standard test methods for response robots of ASTM E54.09 and NIST. '
        'Nothing here is certified.')


def _picture(result: Mapping[str, Any], walls: Sequence[Sequence[float]],
             targets: Sequence[Target]) -> str:
    """Return a plan of the building with every robot's path, as SVG."""
    xs = [wall[place] for wall in walls for place in (0, 2)]
    ys = [wall[place] for wall in walls for place in (1, 3)]
    left, top = min(xs) - _MARGIN_M, max(ys) + _MARGIN_M
    wide, high = max(xs) - left + _MARGIN_M, top - min(ys) + _MARGIN_M
    found = {each['target'] for each in result['targets_found']}

    def at(x: float, y: float) -> str:
        return '{:.2f},{:.2f}'.format(x - left, top - y)
    parts = ['<polyline points="{} {}" stroke="#444" stroke-width=".05"/>'.format(
        at(*wall[:2]), at(*wall[2:])) for wall in walls]
    for number, (name, robot) in enumerate(result['robots'].items(), 1):
        parts.append('<polyline points="{}" fill="none" stroke="{}" stroke-width=".04"/>'.format(
            ' '.join(at(x, y) for x, y in robot['trail']), colour_of(number, dark=False)))
        for x, y in robot['trail'][:1]:
            parts.append('<text x="{:.2f}" y="{:.2f}" font-size=".25" font-family="sans-serif" '
                         'text-anchor="middle" fill="{}">{}</text>'.format(
                             x - left, top - y - 0.12, colour_of(number, dark=False),
                             escape(name)))
    for target in targets:
        x, y = at(target.x_m, target.y_m).split(',')
        parts.append('<circle cx="{}" cy="{}" r=".12" fill="{}" stroke="#222" stroke-width=".03">'
                     '<title>{}</title></circle>'.format(
                         x, y, '#009e73' if target.name in found else '#fff', escape(target.name)))
    parts.insert(0, '<rect width="100%" height="100%" fill="#fafafa"/>')
    return '<svg viewBox="0 0 {:.2f} {:.2f}" width="{}">{}</svg>'.format(
        wide, high, _WIDTH_PX, ''.join(parts))


def page_of(result: Mapping[str, Any], walls: Sequence[Sequence[float]],
            targets: Sequence[Target], earlier: Sequence[Mapping[str, Any]] = ()) -> str:
    """Return the page of a run.

    :param result: from :func:`mhri.drill.results.result_of`
    :param walls: x1, y1, x2, y2 [m] of each wall of the building
    :param earlier: runs of the same drill, for comparison
    """
    robots: List[Sequence[str]] = [
        (name, robot['type'], '{:.1f} s'.format(robot['driven_s']),
         '{:.1f} s'.format(robot['neglected_s']), '{:.1f} m'.format(robot['distance_m']),
         str(robot['contacts'])) for name, robot in result['robots'].items()]
    reactions = [(each['robot'], each['fault'], '{:.1f} s'.format(each['at_s']),
                  '{} after {:.2f} s'.format(each['how'], each['after_s']) if each['how']
                  else 'none') for each in result['reactions']]
    found = [(each['target'], each['robot'], '{:.1f} s'.format(each['at_s']))
             for each in result['targets_found']]
    title = escape(result['title'])
    return '\n'.join((
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{}</title>'.format(title),
        '<style>{}</style><h1>{}</h1>'.format(_STYLE, title),
        '<p>{} after {:.1f} s, driven by a {}.</p>'.format(
            escape(result['ended'].capitalize()), result['time_s'], escape(result['operator'])),
        table(heads_of(result, earlier), rows_of([result, *earlier])),
        _picture(result, walls, targets),
        '<p><small>From above; a name is where the robot began, a full circle a target '
        'that was found.</small></p>',
        table(('robot', 'type', 'driven', 'neglected', 'distance', 'contacts'), robots),
        table(('target', 'found by', 'at'), found),
        table(('robot', 'fault', 'at', 'reaction'), reactions),
        '<p><small>{}</small></p></html>'.format(escape(NOTE)), ''))

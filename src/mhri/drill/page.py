# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the page of a drill says: the values of the template ``drill.html``."""
from typing import Any, Dict, Mapping, Sequence

from mhri.base.robot_colours import colour_of
from mhri.drill.results import heads_of
from mhri.drill.scenario import Target
from mhri.session.drill_results import rows_of

#: the template of the page
TEMPLATE = 'drill.html'
_MARGIN_M, _NAME_ABOVE_M = 0.3, 0.12


def values_of(result: Mapping[str, Any], walls: Sequence[Sequence[float]],
              targets: Sequence[Target], earlier: Sequence[Mapping[str, Any]] = ()
              ) -> Dict[str, Any]:
    """Return the values of the page of a run.

    :param result: from :func:`mhri.drill.results.result_of`
    :param walls: x1, y1, x2, y2 [m] of each wall of the building
    :param earlier: runs of the same drill, for comparison
    """
    return dict(
        result=result, heads=heads_of(result, earlier), figures=rows_of([result, *earlier]),
        plan=_plan(result, walls, targets),
        robots=[(name, robot['type'], '{:.1f} s'.format(robot['driven_s']),
                 '{:.1f} s'.format(robot['neglected_s']), '{:.1f} m'.format(robot['distance_m']),
                 robot['contacts']) for name, robot in result['robots'].items()],
        found=[(each['target'], each['robot'], '{:.1f} s'.format(each['at_s']))
               for each in result['targets_found']],
        reactions=[(each['robot'], each['fault'], '{:.1f} s'.format(each['at_s']),
                    '{} after {:.2f} s'.format(each['how'], each['after_s']) if each['how']
                    else 'none') for each in result['reactions']])


def _plan(result: Mapping[str, Any], walls: Sequence[Sequence[float]],
          targets: Sequence[Target]) -> Dict[str, Any]:
    """Return the plan of the building with every robot's path, in metres from its top left."""
    xs = [wall[place] for wall in walls for place in (0, 2)]
    ys = [wall[place] for wall in walls for place in (1, 3)]
    left, top = min(xs) - _MARGIN_M, max(ys) + _MARGIN_M
    found = {each['target'] for each in result['targets_found']}

    def points(*places: Sequence[float]) -> str:
        return ' '.join('{:.2f},{:.2f}'.format(x - left, top - y) for x, y in places)
    return dict(
        width=round(max(xs) - left + _MARGIN_M, 2), height=round(top - min(ys) + _MARGIN_M, 2),
        walls=[points(wall[:2], wall[2:]) for wall in walls],
        trails=[(name, colour_of(number, dark=False), points(*robot['trail']),
                 round(robot['trail'][0][0] - left, 2),
                 round(top - robot['trail'][0][1] - _NAME_ABOVE_M, 2))
                for number, (name, robot) in enumerate(result['robots'].items(), 1)
                if robot['trail']],
        targets=[(target.name, round(target.x_m - left, 2), round(top - target.y_m, 2),
                  target.name in found) for target in targets])

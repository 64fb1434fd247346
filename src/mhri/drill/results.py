# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The result of a drill: as a file, as a table, and in comparison with other runs."""
from dataclasses import asdict
from datetime import datetime
import math
import statistics
from typing import Any, Dict, List, Mapping, Sequence, Tuple

import yaml

from mhri.drill.referee import LEFT, Referee
from mhri.drill.scenario import Scenario
from mhri.session.drill_results import FORMAT, rows_of


def _share(part: float, whole: float) -> Any:
    return round(part / whole, 3) if whole > 0.0 else None


def _mean(values: Sequence[float]) -> Any:
    return round(statistics.mean(values), 2) if values else None


def result_of(scenario: Scenario, referee: Referee, wall_s: float, operator: str) -> Dict[str, Any]:
    """Return the result of a run as plain values; unknown figures are None.

    :param wall_s: start time [s since 1970]
    :param operator: "person" or "script"
    """
    tallies = {name: referee.tally(name) for name in scenario.robots}
    driven = sum(tally.driven_s for tally in tallies.values())
    neglected = sum(tally.neglected_s for tally in tallies.values())
    active = sum(tally.active_s for tally in tallies.values())
    tolerances = [each for tally in tallies.values() for each in tally.tolerances_s]
    reactions = [each.after_s for each in referee.reactions if each.after_s is not None]
    return {
        'format': FORMAT, 'drill': scenario.name, 'title': scenario.title, 'begun': wall_s,
        'operator': operator, 'ended': referee.over() or LEFT,
        'time_s': round(referee.elapsed_s, 2), 'targets': len(scenario.targets),
        'found': len(referee.found), 'contacts': sum(each.contacts for each in tallies.values()),
        'distance_m': round(sum(each.distance_m for each in tallies.values()), 2),
        'driven_s': round(driven, 2), 'neglected_s': round(neglected, 2),
        'attention': _share(driven, driven + neglected), 'fan_out': _share(active, driven),
        'neglect_tolerance_s': _mean(tolerances), 'reaction_s': _mean(reactions),
        'stops': len(referee.stops_s),
        'targets_found': [asdict(found) for found in referee.found],
        'reactions': [asdict(reaction) for reaction in referee.reactions],
        'robots': {name: {
            'type': kind, 'driven_s': round(tally.driven_s, 2),
            'neglected_s': round(tally.neglected_s, 2), 'active_s': round(tally.active_s, 2),
            'distance_m': round(tally.distance_m, 2), 'contacts': tally.contacts,
            'least_gap_m': round(tally.least_gap_m, 3) if math.isfinite(tally.least_gap_m)
            else None,
            'trail': [[round(x, 2), round(y, 2)] for x, y in tally.trail]}
            for (name, tally), kind in zip(tallies.items(), scenario.types)}}


def as_yaml(result: Mapping[str, Any]) -> str:
    """Return the text of ``drill.yaml``."""
    text: str = yaml.safe_dump(dict(result), default_flow_style=None, sort_keys=False, width=100)
    return text


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> List[str]:
    """Return the lines of a text table with columns of minimum width."""
    widths = [max(len(row[place]) for row in (head, *rows)) for place in range(len(head))]
    return ['  '.join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
            for row in (head, *rows)]


def heads_of(result: Mapping[str, Any], earlier: Sequence[Mapping[str, Any]]) -> Tuple[str, ...]:
    """Return the headings of a table of a run and earlier ones: operator and time."""
    return ('', 'this run ({})'.format(result['operator']), *('{} {}'.format(
        each['operator'], '{:%Y-%m-%d %H:%M}'.format(datetime.fromtimestamp(each['begun']))
        if each['begun'] else 'rehearsed') for each in earlier))


def lines_of(result: Mapping[str, Any],
             earlier: Sequence[Mapping[str, Any]] = ()) -> List[str]:
    """Return a run as lines of text.

    :param earlier: runs of the same drill, for comparison
    """
    lines = ['{}: {} after {:.1f} s'.format(result['title'], result['ended'], result['time_s'])]
    lines += table(heads_of(result, earlier), rows_of([result, *earlier]))
    lines += ['{target}: found by {robot} after {at_s:.1f} s'.format(**found)
              for found in result['targets_found']]
    for each in result['reactions']:
        lines.append('{}, {} at {:.1f} s: {}'.format(
            each['robot'], each['fault'], each['at_s'],
            '{} after {:.2f} s'.format(each['how'], each['after_s']) if each['how']
            else 'no reaction'))
    for name, robot in result['robots'].items():
        lines.append('{}: driven {driven_s:.1f} s, neglected {neglected_s:.1f} s, {distance_m:.1f} '
                     'm, {contacts} contacts'.format(name, **robot))
    return lines


def compared(results: Sequence[Mapping[str, Any]], names: Sequence[str]) -> List[str]:
    """Return several runs side by side, as lines of text."""
    return table(('', *names), [('drill', *(str(result['drill']) for result in results)),
                                ('driven by', *(str(result['operator']) for result in results)),
                                *rows_of(results)])

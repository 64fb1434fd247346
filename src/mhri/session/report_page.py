# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the page of a report says: the values of the template ``report.html``."""
from typing import Any, Dict, List, Mapping, Tuple

from mhri.recording.folder import CAMERA_RATE, INFO, SessionMark, words_of_still
from mhri.recording.recording import duration_text
from mhri.session.flags import place_of
from mhri.session.report import (
    date_text, events_shown, MAX_EVENTS, MAX_MARKS, Report, ROBOT_HEADS, seconds_text)
from mhri.session.report_line import drawn_line
from mhri.session.timeline import stops

#: the template of the page
TEMPLATE = 'report.html'


def values_of(report: Report, map_picture: str, stills: Mapping[str, str],
              map_note: str = '') -> Dict[str, Any]:
    """Return the values of the page.

    :param map_picture: a data URI, '' without a map
    :param stills: {name in the session: data URI} of the readable stills
    :param map_note: a sentence below the map, e.g. with its file name
    """
    return dict(
        report=report, title=date_text(report.wall) or report.name, about=_about(report),
        figures=_figures(report), line=drawn_line(report), map_picture=map_picture,
        map_words=_map_words(report), map_note=map_note, robot_heads=ROBOT_HEADS, stills=stills,
        events=events_shown(report.line.events), max_marks=MAX_MARKS, max_events=MAX_EVENTS,
        duration_text=duration_text, seconds_text=seconds_text, words_of_still=words_of_still,
        poses_text=_poses_text, stops=stops)


def _about(report: Report) -> str:
    info = report.info
    cameras = 'pictures {} times a second'.format(info.rate_hz) \
        if info.recorded == CAMERA_RATE else {'all': 'all pictures', 'stills': 'stills only'}.get(
            info.recorded, str(info.recorded))
    return '; '.join((
        'recorded' + (' on {}'.format(info.host) if info.host else '')
        + (' by mhri {}'.format(info.mhri) if info.mhri else ''), cameras,
        'folder {}'.format(report.name)))


def _figures(report: Report) -> List[Tuple[str, Any]]:
    trouble = sum(event.severity != INFO and not stops(event) for event in report.line.events)
    distance_m = sum(robot.survey.distance_m for robot in report.robots)
    return [('length', duration_text(report.line.length_s)), ('robots', len(report.robots)),
            ('distance', '{:.1f} m'.format(distance_m)), ('marks', len(report.marks)),
            ('stops', len(report.line.stopped)), ('warnings and trouble', trouble)]


def _map_words(report: Report) -> str:
    if not report.placed:
        return 'No robot was placed on a map: each path is by its own odometry.'
    missing = [robot.name for robot in report.robots
               if robot.name not in report.placed and robot.survey.pieces]
    return 'Paths in frame "{}".'.format(report.info.frame) + (
        ' Not placed on the map, and not drawn: {}.'.format(', '.join(missing)) if missing else '')


def _poses_text(mark: SessionMark) -> str:
    """Return where the robots were at a mark."""
    return '; '.join('{} at {:.2f}, {:.2f} m'.format(robot, *place[:2]) for robot, place in (
        (robot, place_of(pose)) for robot, pose in list(mark.poses.items())[:20]) if place)

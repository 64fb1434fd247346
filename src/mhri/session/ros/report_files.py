# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of a report: page, map and world file, each written atomically."""
import base64
from contextlib import suppress
from dataclasses import replace
import os

import numpy as np

from mhri.base.io.files import whole
from mhri.base.io.pages import page
from mhri.base.opencv import cv2
from mhri.graph.ros.resources import resource_path
from mhri.recording.recording import ros_home
from mhri.session.report import is_still, MAX_MARKS, MAX_STILLS, spots_of, ways_of
from mhri.session.report_page import TEMPLATE, values_of
from mhri.session.sheet import bounds_points, drawn, ground, sheet_of

PAGE, MAP, WORLD = 'report.html', 'map.png', 'map.pgw'
# Stills are scaled down to this size [px]; larger files are not read [bytes].
_STILL_PX, _STILL_BYTES = 800, 20 * 10 ** 6
_QUALITY = 82
# Maximum deviation of the simplified line from the path [px].
_WITHIN_PX = 0.7


class NoPicture(ValueError):
    """A picture cannot be encoded; the text has its size."""


def folder_for(name, env):
    """Return the default folder of a session's report, next to the sessions."""
    return os.path.join(ros_home(env), 'mhri', 'reports', name)


def write_report(report, grid, session, folder):
    """Write page, map and world file into a folder, created if missing; return their paths.

    Files of an earlier report are replaced.

    :param grid: the map, None if the session has none
    :param session: path of the session, for its stills
    :raises OSError: a file cannot be written
    """
    paths, picture, note = [], '', ''
    try:
        picture, note, files = _map_of(report, grid)
        paths = [_write(folder, name, data) for name, data in files]
    except NoPicture as error:
        report = replace(report, problems=report.problems + ('the map: {}'.format(error),))
    text = page(resource_path('pages'), TEMPLATE, values_of(
        report, picture, _stills(report, session), note))
    return [_write(folder, PAGE, text.encode('utf-8', 'replace'))] + paths


def _map_of(report, grid):
    """Return the map as a data URI, a note on its files, and the files: [(name, bytes)].

    :raises NoPicture: the map cannot be encoded
    """
    ways = ways_of(report.robots, 0.0)
    spots = spots_of(report.marks, report.placed, report.info.frame)
    if grid is None and not ways and not spots:
        return '', '', []
    sheet = sheet_of(grid, bounds_points(ways, spots))
    ways = ways_of(report.robots, _WITHIN_PX * sheet.px_m)
    picture = _encoded('.png', drawn(sheet, ground(sheet, grid), ways, spots))
    note = 'As a file: {} with its world file {}, {:.4g} mm a pixel.'.format(
        MAP, WORLD, 1e3 * sheet.px_m)
    return _uri('png', picture), note, [
        (MAP, picture), (WORLD, sheet.world_file().encode('ascii'))]


def _write(folder, name, data):
    path = os.path.join(folder, name)
    with whole(path) as part:
        with open(part, 'wb') as stream:
            stream.write(data)
    return path


def _encoded(ending, picture, options=()):
    try:
        done, data = cv2.imencode(ending, picture, list(options))
    except cv2.error:
        done = False
    if not done:
        raise NoPicture('a picture of {} x {} pixels cannot be encoded'.format(
            *picture.shape[1::-1]))
    return data.tobytes()


def _uri(kind, data):
    return 'data:image/{};base64,{}'.format(kind, base64.b64encode(data).decode('ascii'))


def _stills(report, session):
    """Return {name: data URI} of the readable stills; the page reports the number of others."""
    names = [name for mark in report.marks[:MAX_MARKS] for name in mark.stills]
    names += [name for _, name in report.extra_stills]
    found = {}
    for name in dict.fromkeys(names):
        picture = _picture(os.path.join(session, name)) if is_still(name) else None
        if picture is not None:
            with suppress(NoPicture):
                found[name] = _uri('jpeg', _encoded('.jpg', picture, (cv2.IMWRITE_JPEG_QUALITY,
                                                                      _QUALITY)))
        if len(found) == MAX_STILLS:
            break
    return found


def _picture(path):
    """Return a still, scaled down for the page; None if it is not a readable picture."""
    try:
        # A hostile session may name files outside its folder, or pipes; read neither.
        if os.path.islink(path) or not os.path.isfile(path) \
                or os.path.getsize(path) > _STILL_BYTES:
            return None
        picture = cv2.imdecode(np.fromfile(path, np.uint8), cv2.IMREAD_COLOR)
    except (OSError, cv2.error):
        return None
    if picture is None:
        return None
    scale = _STILL_PX / max(picture.shape[:2])
    if scale >= 1.0:
        return picture
    # The short side of a very long picture may round to 0.
    return cv2.resize(picture, tuple(max(1, round(scale * side)) for side in picture.shape[1::-1]),
                      interpolation=cv2.INTER_AREA)

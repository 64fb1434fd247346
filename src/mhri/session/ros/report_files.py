# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of a report: page, map and world file, each written whole or not at all."""
import base64
from contextlib import contextmanager, suppress
from dataclasses import replace
import os

import numpy as np

from mhri.base.opencv import cv2
from mhri.recording.recording import ros_home
from mhri.session.report import is_still, MOST_MARKS, MOST_STILLS, spots_of, ways_of
from mhri.session.report_page import page_of
from mhri.session.report_svg import map_svg
from mhri.session.sheet import bounds_points, drawn, ground, sheet_of

PAGE, MAP, WORLD = 'report.html', 'map.png', 'map.pgw'
# Stills are made no larger than this, and none is read that is [px, bytes].
_STILL_PX, _STILL_BYTES = 800, 20 * 10 ** 6
_QUALITY = 82
# A line on the map may leave the way by so many pixels.
_WITHIN_PX = 0.7


class NoPicture(ValueError):
    """A picture that cannot be encoded: how large it is."""


def folder_for(name, env):
    """Return where the report of a session goes unless somebody says where: beside sessions."""
    return os.path.join(ros_home(env), 'mhri', 'reports', name)


@contextmanager
def whole(path):
    """Give a path to write to, which becomes ``path`` at the end, and is gone after a failure."""
    root, ending = os.path.splitext(path)
    part = '{}.part{}'.format(root, ending)
    try:
        yield part
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def write_report(report, grid, session, folder):
    """Write page, map and world file into a folder, which is made; return their paths.

    What is there from an earlier report is replaced.

    :param grid: the map, None without any
    :param session: path of the session, for its stills
    :raises OSError: they cannot be written
    """
    os.makedirs(folder, exist_ok=True)
    paths, drawing, note = [], '', ''
    try:
        drawing, note, files = _map_of(report, grid)
        paths = [_write(folder, name, data) for name, data in files]
    except NoPicture as error:
        report = replace(report, problems=report.problems + ('the map: {}'.format(error),))
    page = page_of(report, drawing, _stills(report, session), note)
    return [_write(folder, PAGE, page.encode('utf-8', 'replace'))] + paths


def _map_of(report, grid):
    """Return the drawing of the map, what is said of its files, and these: [(name, bytes)].

    :raises NoPicture: it cannot be encoded
    """
    ways = ways_of(report.robots, 0.0)
    spots = spots_of(report.marks, report.placed, report.info.frame)
    if grid is None and not ways and not spots:
        return '', '', []
    sheet = sheet_of(grid, bounds_points(ways, spots))
    ways = ways_of(report.robots, _WITHIN_PX * sheet.px_m)
    base = ground(sheet, grid)
    note = 'As a file: {} with its world file {}, {:.4g} mm a pixel.'.format(
        MAP, WORLD, 1e3 * sheet.px_m)
    return map_svg(sheet, _uri('png', _encoded('.png', base)), ways, spots), note, [
        (MAP, _encoded('.png', drawn(sheet, base, ways, spots))),
        (WORLD, sheet.world_file().encode('ascii'))]


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
    """Return {name: data URI} of the stills that are pictures; the page says how many are not."""
    names = [name for mark in report.marks[:MOST_MARKS] for name in mark.stills]
    names += [name for _, name in report.extra_stills]
    found = {}
    for name in dict.fromkeys(names):
        picture = _picture(os.path.join(session, name)) if is_still(name) else None
        if picture is not None:
            with suppress(NoPicture):
                found[name] = _uri('jpeg', _encoded('.jpg', picture, (cv2.IMWRITE_JPEG_QUALITY,
                                                                      _QUALITY)))
        if len(found) == MOST_STILLS:
            break
    return found


def _picture(path):
    """Return a still, none larger than a page needs; None where it is no picture."""
    try:
        # Neither what lies elsewhere nor a pipe, whatever the session names.
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
    # A side of a very long picture may come to nothing.
    return cv2.resize(picture, tuple(max(1, round(scale * side)) for side in picture.shape[1::-1]),
                      interpolation=cv2.INTER_AREA)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of the map's menus: pairs (text, function), as in :mod:`mhri.driving.gui.robot_menu`."""
from functools import partial

from mhri.base.geometry import Pose
from mhri.driving.gui.robot_menu import driven
from mhri.map import gesture


def senders(scene, clicked=''):
    """Return the robots that could be sent: pairs (text, names), the clicked one first.

    :param clicked: the robot clicked last on the map, '' without one
    """
    found, selected = [], scene.selected
    if scene.robot(clicked) is not None and (clicked,) != selected:
        found.append((clicked + ' (clicked)' if selected else clicked, (clicked,)))
    if selected:
        found.append((driven(selected) if found else ' and '.join(selected), selected))
    if not found:
        found += [(' and '.join(names), names) for names in [scene.targets()] if names]
    return found


def place_menu(pane, x_m, y_m):
    """Return the rows of a position without a robot.

    :param pane: :class:`mhri.map.gui.map_pane.MapPane`
    """
    view = pane.view
    mark = view.scene.mark_at(x_m, y_m, view.near_m())
    rows = _place_rows(pane, Pose(x_m, y_m, 0.0)) if mark is None else _mark_rows(pane, mark)
    if view.scene.fence:
        rows.append(('Take the fence away', partial(pane.fence_drawn.emit, [])))
    return rows


def robot_rows(pane, name):
    """Return the rows of a robot that concern its place on the map."""
    robot = pane.view.scene.robot(name)
    if robot is None or robot.lost:
        return [] if robot is None else [
            ('Take {} off the map'.format(name), partial(pane.robot_placed.emit, name, None))]
    rows = [('Place {}{}'.format(name, '' if robot.pose is None else ' anew'),
             partial(pane.choose_tool, gesture.PLACE, (name,)))]
    if robot.pose is not None:
        rows += [('Fit {} ...'.format(name), partial(pane.offer_fits, name)),
                 ('Take {} off the map'.format(name),
                  partial(pane.robot_placed.emit, name, None))]
    return rows


def _mark_rows(pane, mark):
    """Return the rows of a mark."""
    rows = [('Send {} to {}'.format(text, mark.name), partial(
        pane.goal_drawn.emit, list(names), mark.pose, mark.pose.heading_rad != 0.0))
            for text, names in senders(pane.view.scene, pane.clicked)]
    return rows + [('Take {} away'.format(mark.name), partial(pane.mark_set.emit, mark.name, None))]


def _place_rows(pane, pose):
    """Return the rows of an empty position."""
    found = senders(pane.view.scene, pane.clicked)
    rows = [('Send {} here'.format(text), partial(pane.goal_drawn.emit, list(names), pose, False))
            for text, names in found]
    if found:
        text, names = found[0]
        rows += [('Draw a route for {}'.format(text),
                  partial(pane.choose_tool, gesture.ROUTE, names)),
                 ('Place {}'.format(names[0]), partial(pane.choose_tool, gesture.PLACE, names[:1]))]
    return rows + [('Draw a fence', partial(pane.choose_tool, gesture.FENCE)),
                   ('Put a mark here', partial(
                       pane.name_field.ask, pose, pane.view.canvas.pixel(pose.x_m, pose.y_m)))]


def fit_rows(pane, name):
    """Return the targets of a fit: the map, and the scan of each other placed robot."""
    scene = pane.view.scene
    if not name or scene.robot(name) is None:
        return []
    rows = [('Fit {} to the map'.format(name), partial(pane.fit_requested.emit, name, ''))]
    for other in scene.robots:
        if other.pose is not None and other.name != name and not other.lost:
            rows.append(('Fit {} to what {} sees'.format(name, other.name),
                         partial(pane.fit_requested.emit, name, other.name)))
    return rows

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What can be done at a place of the map, for its menu: pairs (words, function)."""
from mhri.base.mocap import Pose
from mhri.map import gesture


def _who(names):
    return ' and '.join(names)


def menu_rows(pane, x_m, y_m):
    """Return what can be done at a place.

    :param pane: :class:`mhri.map.gui.map_pane.MapPane`
    """
    view, names = pane.view, list(pane.targets())
    robot = view.scene.at(x_m, y_m, view.near_m())
    mark = view.scene.mark_at(x_m, y_m, view.near_m())
    rows = []
    if robot is not None:
        rows += _robot_rows(pane, robot, [name for name in names if name != robot.name])
    if mark is not None:
        rows += _mark_rows(pane, mark, names)
    if robot is None and mark is None:
        rows += _place_rows(pane, Pose(x_m, y_m, 0.0), names)
    if view.scene.fence:
        rows.append(('Take the fence away', lambda: pane.fence_drawn.emit([])))
    return rows


def _robot_rows(pane, robot, others):
    """Return what can be done with a robot."""
    rows = [('Look at {}'.format(robot.name), lambda: pane.look_requested.emit(robot.name))]
    if others:
        rows.append(('{} after {}'.format(_who(others), robot.name),
                     lambda: pane.leader_chosen.emit(others, robot.name)))
    if robot.task:
        rows.append(('End the task of {}'.format(robot.name),
                     lambda: pane.end_requested.emit([robot.name])))
    rows.append(('Place {} anew'.format(robot.name),
                 lambda: pane.take(gesture.PLACE, robot.name)))
    rows += fit_rows(pane, robot.name)
    rows.append(('Take {} off the map'.format(robot.name),
                 lambda: pane.robot_placed.emit(robot.name, None)))
    return rows


def _mark_rows(pane, mark, names):
    """Return what can be done with a mark."""
    rows = [('Send {} to {}'.format(_who(names), mark.name),
             lambda: pane.goal_drawn.emit(names, mark.pose, mark.pose.heading_rad != 0.0))
            ] if names else []
    return rows + [('Take {} away'.format(mark.name), lambda: pane.mark_set.emit(mark.name, None))]


def _place_rows(pane, pose, names):
    """Return what can be done where nothing is."""
    rows = []
    if names:
        rows = [('Send {} here'.format(_who(names)),
                 lambda: pane.goal_drawn.emit(names, pose, False)),
                ('Draw a route for {}'.format(_who(names)), lambda: pane.take(gesture.ROUTE)),
                ('Place {}'.format(names[0]), lambda: pane.take(gesture.PLACE, names[0]))]
    return rows + [('Draw a fence', lambda: pane.take(gesture.FENCE)),
                   ('Put a mark here', lambda: pane.name_field.ask(
                       pose, pane.view.canvas.pixel(pose.x_m, pose.y_m)))]


def fit_rows(pane, name):
    """Return to what a robot can be fitted: the map, and what each other placed robot sees."""
    scene = pane.view.scene
    if not name or scene.robot(name) is None:
        return []
    rows = [('Fit {} to the map'.format(name), lambda: pane.fit_requested.emit(name, ''))]
    for other in scene.robots:
        if other.pose is not None and other.name != name:
            rows.append(('Fit {} to what {} sees'.format(name, other.name),
                         lambda other=other: pane.fit_requested.emit(name, other.name)))
    return rows

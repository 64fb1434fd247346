# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Client of mhri_tasks for the map: places of robots, marks, fence, running tasks.

Subscribes ``/mhri_tasks/places`` (``mhri/Places``) and ``/mhri_tasks/list`` (``mhri/TaskList``); it
accepts only the node that serves ``/mhri_tasks/set_place``. Calls that, ``/mhri_tasks/fit_place``,
``/mhri_tasks/set_fence`` and ``/mhri_tasks/set_mark`` on its own thread.
"""
from dataclasses import replace
import math
import time

from geometry_msgs.msg import Point32, Pose2D

from mhri.base.geometry import Pose
from mhri.base.text import tidy_text
from mhri.graph.ros.node_client import NodeClient
from mhri.map.scene import MapMark, PlacesView, Placing, UnderWay
from mhri.msg import Places, TaskList
from mhri.srv import FitPlace, SetFence, SetMark, SetPlace

# mhri_tasks publishes at 1 Hz: it counts as silent after this time without a message [s].
SILENT_S = 2.5
# Timeout of a call; a fit takes a while [s].
CALL_S = 1.0
_PLACE = '/mhri_tasks/set_place'
_LONGEST = 300


def _pose(message):
    """Return a ``geometry_msgs/Pose2D`` as a pose, None if a number is missing."""
    pose = Pose(message.x, message.y, message.theta)
    return pose if pose.is_finite() else None


def _placing(message):
    return Placing(_pose(message.odometry), tidy_text(message.text, _LONGEST),
                   message.age_s if math.isfinite(message.age_s) else None, message.by)


def places_view(message):
    """Return a ``mhri/Places`` as a value, without entries that are not finite."""
    marks = [(mark.name, _pose(mark.pose)) for mark in message.marks]
    return PlacesView(
        tidy_text(message.header.frame_id, _LONGEST),
        {place.robot: _placing(place) for place in message.robots},
        tuple(MapMark(tidy_text(name, _LONGEST), pose) for name, pose in marks if pose),
        tuple((corner.x, corner.y) for corner in message.fence
              if math.isfinite(corner.x) and math.isfinite(corner.y)), True)


class PlacesClient:
    """The state of mhri_tasks for the map, and requests to it; only :meth:`open` blocks.

    Answers come by ``on_answer(done, sentence)``, on the worker.

    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._places = (PlacesView(), -math.inf)
        self._runs = ()
        self._opened = False
        self._node = NodeClient('map_calls', _PLACE, CALL_S)

    def open(self):
        """Subscribe (blocking: calls the master)."""
        if not self._opened:
            self._opened = True
            self._node.subscribe('/mhri_tasks/places', Places, self._on_places)
            self._node.subscribe('/mhri_tasks/list', TaskList, self._on_list)
            self._node.start()

    def _on_places(self, message):
        self._places = places_view(message), self._clock()

    def _on_list(self, message):
        self._runs = tuple(UnderWay(run.task, run.parameters, tuple(
            robot.robot for robot in run.robots)) for run in message.runs)

    def view(self):
        """Return the present :class:`PlacesView`; ages grow while no message comes."""
        view, heard_at = self._places
        passed_s = self._clock() - heard_at
        if passed_s == math.inf:
            return view
        robots = {name: place if place.age_s is None else replace(
            place, age_s=place.age_s + passed_s) for name, place in view.robots.items()}
        return replace(view, robots=robots, answers=passed_s <= SILENT_S)

    def runs(self):
        """Return the running tasks, :class:`UnderWay` values."""
        return self._runs if self.view().answers else ()

    def set_place(self, robot, pose, on_answer):
        """Place a robot by hand; ``pose`` None undoes that."""
        self._do(on_answer, _PLACE, SetPlace, robot, pose is not None, _message(pose))

    def fit_place(self, robot, other, on_answer):
        """Align a robot's scan with the map ('') or with the scan of another robot."""
        self._do(on_answer, '/mhri_tasks/fit_place', FitPlace, robot, other)

    def set_fence(self, corners, on_answer):
        """Draw the fence; no corners: remove it."""
        self._do(on_answer, '/mhri_tasks/set_fence', SetFence,
                 [Point32(x, y, 0.0) for x, y in corners])

    def set_mark(self, name, pose, on_answer):
        """Set a mark; ``pose`` None removes it."""
        self._do(on_answer, '/mhri_tasks/set_mark', SetMark, name, pose is not None,
                 _message(pose))

    def _do(self, on_answer, name, kind, *words):
        def answered(answer):
            if answer is None:
                on_answer(False, 'the task service does not answer')
            else:
                on_answer(answer.success, tidy_text(answer.message, _LONGEST))
        self._node.request(answered, name, kind, *words)

    def close(self, forget=False):
        """Close without blocking; ``forget``: unregister every topic as well, in the background."""
        self._node.close(forget)


def _message(pose):
    """Return a pose as a ``geometry_msgs/Pose2D``, zeros for None."""
    return Pose2D(pose.x_m, pose.y_m, pose.heading_rad) if pose is not None else Pose2D()

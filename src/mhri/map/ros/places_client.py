# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map's side of mhri_tasks: where robots are placed, marks, fence, tasks under way.

Subscribes ``/mhri_tasks/places`` (``mhri/Places``) and ``/mhri_tasks/list`` (``mhri/TaskList``); it
believes only the node that serves ``/mhri_tasks/set_place``. Calls that, ``/mhri_tasks/fit_place``,
``/mhri_tasks/set_fence`` and ``/mhri_tasks/set_mark`` on a thread of its own.
"""
from dataclasses import replace
import math
import time

from geometry_msgs.msg import Point32, Pose2D

from mhri.base.mocap import Pose
from mhri.base.text import tidy_text
from mhri.graph.ros.node_client import NodeClient
from mhri.map.scene import MapMark, PlacesView, Placing, UnderWay
from mhri.msg import Places, TaskList
from mhri.srv import FitPlace, SetFence, SetMark, SetPlace

# It speaks at 1 Hz: a word later than this is not coming [s].
SILENT_S = 2.5
# A call waits so long for the service; a fit takes its time [s].
CALL_S = 1.0
_PLACE = '/mhri_tasks/set_place'
_LONGEST = 300


def _pose(message):
    """Return a ``geometry_msgs/Pose2D`` as a pose, None where a number is missing."""
    pose = Pose(message.x, message.y, message.theta)
    return pose if pose.is_finite() else None


def _placing(message):
    return Placing(_pose(message.odometry), tidy_text(message.text, _LONGEST),
                   message.age_s if math.isfinite(message.age_s) else None, message.by)


def places_view(message):
    """Return a ``mhri/Places`` as a value; what is not finite is left out."""
    marks = [(mark.name, _pose(mark.pose)) for mark in message.marks]
    return PlacesView(
        tidy_text(message.header.frame_id, _LONGEST),
        {place.robot: _placing(place) for place in message.robots},
        tuple(MapMark(tidy_text(name, _LONGEST), pose) for name, pose in marks if pose),
        tuple((corner.x, corner.y) for corner in message.fence
              if math.isfinite(corner.x) and math.isfinite(corner.y)), True)


class PlacesClient:
    """What mhri_tasks says of the map, and requests to it; all but :meth:`open` returns at once.

    Answers are told by ``on_answer(done, sentence)``, on the worker.

    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._places = (PlacesView(), -math.inf)
        self._runs = ()
        self._opened = False
        self._node = NodeClient('map_calls', _PLACE, CALL_S)

    def open(self):
        """Listen from now on (blocking: it asks the master)."""
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
        """Return the :class:`PlacesView` of this moment; ages go on while nothing is heard."""
        view, heard_at = self._places
        passed_s = self._clock() - heard_at
        if passed_s == math.inf:
            return view
        robots = {name: place if place.age_s is None else replace(
            place, age_s=place.age_s + passed_s) for name, place in view.robots.items()}
        return replace(view, robots=robots, answers=passed_s <= SILENT_S)

    def runs(self):
        """Return the tasks that are under way, :class:`UnderWay` values."""
        return self._runs if self.view().answers else ()

    def set_place(self, robot, pose, on_answer):
        """Place a robot by hand; ``pose`` None takes that back."""
        self._do(on_answer, _PLACE, SetPlace, robot, pose is not None, _message(pose))

    def fit_place(self, robot, other, on_answer):
        """Align what a robot's laser sees with the map ('') or with that of another robot."""
        self._do(on_answer, '/mhri_tasks/fit_place', FitPlace, robot, other)

    def set_fence(self, corners, on_answer):
        """Draw the fence; no corners: take it away."""
        self._do(on_answer, '/mhri_tasks/set_fence', SetFence,
                 [Point32(x, y, 0.0) for x, y in corners])

    def set_mark(self, name, pose, on_answer):
        """Put a mark there; ``pose`` None takes it away."""
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
        """End; returns at once. ``forget``: unregister every topic as well, in the background."""
        self._node.close(forget)


def _message(pose):
    """Return a pose as a ``geometry_msgs/Pose2D``, zeros for None."""
    return Pose2D(pose.x_m, pose.y_m, pose.heading_rad) if pose is not None else Pose2D()

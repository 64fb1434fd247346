# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The services to place robots by hand and to draw on the map.

Interfaces: serves ``/mhri_tasks/set_place``, ``/mhri_tasks/fit_place``, ``/mhri_tasks/set_fence``
and ``/mhri_tasks/set_mark``; each explains a refusal in a sentence.
"""
import threading

import rospy

from mhri.base.geometry import Pose
from mhri.graph.ros.master_api import MasterError
from mhri.map.drawn import pose_problem
from mhri.map.fit import fit, FitError, NO_POINTS
from mhri.map.grid import GridError
from mhri.map.places import HAND
from mhri.sensors.brake import SCAN_OLD_S
from mhri.srv import (
    FitPlace, FitPlaceResponse, SetFence, SetFenceResponse, SetMark, SetMarkResponse, SetPlace,
    SetPlaceResponse)

# Timeout for the first scan of a laser that is subscribed for a fit [s].
SCAN_WITHIN_S = 2.0
# A robot that moves or turns by more during a fit is not at rest [m or rad].
STANDS_WITHIN = 0.02


class PlaceServices:
    """Serves these services, each call on its own thread.

    :param seen: :class:`mhri.tasks.ros.sensed_robots.SensedRobots`
    :param keeper: :class:`mhri.map.ros.place_keeper.PlaceKeeper`
    :param map_source: :class:`mhri.map.ros.map_source.MapSource`
    :param is_busy: function from a robot's name: whether it is on a task
    :param worker: runs calls to the master
    """

    def __init__(self, seen, keeper, map_source, is_busy, worker):
        self._seen = seen
        self._keeper = keeper
        self._map = map_source
        self._is_busy = is_busy
        self._worker = worker
        self._fitting = threading.Lock()
        self._patience = threading.Event()

    def start(self):
        """Start the services (blocking: calls the master)."""
        for name, kind, handler in (('set_place', SetPlace, self._set_place),
                                    ('fit_place', FitPlace, self._fit_place),
                                    ('set_fence', SetFence, self._set_fence),
                                    ('set_mark', SetMark, self._set_mark)):
            rospy.Service('/mhri_tasks/' + name, kind, handler)

    def _answer(self, response, problem, done):
        """Return a response, and store the change."""
        if not problem:
            self._worker.do(self._keeper.keep)
        return response(not problem, problem or done)

    def _robot_problem(self, name):
        """Return why a robot cannot be placed now, '' if it can."""
        if self._seen.get(name) is None:
            return 'the drive service does not know {!r}: add it to the list of robots'.format(
                name[:64])
        if self._is_busy(name):
            return '{} is on a task: stop that first'.format(name)
        return ''

    def _set_place(self, request):
        name, pose = request.robot, _pose(request.pose)
        problem = self._robot_problem(name)
        if not problem and not request.placed:
            self._keeper.take_back(name)
            return self._answer(SetPlaceResponse, '', '{} is not placed by hand'.format(name))
        problem = problem or pose_problem(pose) or self._named(name, self._keeper.put(name, pose))
        return self._answer(SetPlaceResponse, problem, '{} is placed by hand'.format(name))

    @staticmethod
    def _named(name, problem):
        return '{}: {}'.format(name, problem) if problem else ''

    def _set_mark(self, request):
        pose = _pose(request.pose) if request.there else None
        problem = self._keeper.draw(lambda drawn: drawn.set_mark(request.name, pose))
        return self._answer(SetMarkResponse, problem, 'mark {} is {}'.format(
            request.name[:64], 'there' if request.there else 'taken away'))

    def _set_fence(self, request):
        corners = [(corner.x, corner.y) for corner in request.corners]
        problem = self._keeper.draw(lambda drawn: drawn.set_fence(corners))
        return self._answer(SetFenceResponse, problem, 'the fence has {} corners'.format(
            len(corners)) if corners else 'there is no fence')

    def _fit_place(self, request):
        if not self._fitting.acquire(blocking=False):
            return FitPlaceResponse(False, 'another robot is being fitted: try again')
        try:
            problem = self._robot_problem(request.robot) or self._fit_problem(request)
            if problem:
                return FitPlaceResponse(False, problem)
            return self._fitted(request)
        except (FitError, GridError) as error:
            return FitPlaceResponse(False, '{} does not fit: {}'.format(request.robot, error))
        except (MasterError, OSError) as error:
            return FitPlaceResponse(False, 'the ROS master does not answer: {}'.format(error))
        finally:
            self._fitting.release()

    def _fit_problem(self, request):
        """Return why a robot cannot be fitted, '' if it can be tried."""
        place = self._keeper.place(request.robot)
        if place.by != HAND:
            return '{} has to be placed by hand first: it is {}'.format(
                request.robot, place.text if place.by else 'not placed')
        if not request.other and not self._map.is_there:
            return 'there is no map to fit it to: name another robot'
        if request.other == request.robot:
            return 'it cannot be fitted to itself'
        if request.other and not (self._seen.get(request.other) and
                                  self._keeper.place(request.other).is_fresh):
            return '{!r} is not placed'.format(request.other[:64])
        return ''

    def _fitted(self, request):
        """Fit a robot, and place it there."""
        name, other = request.robot, request.other
        self._seen.open([name] + ([other] if other else []))
        odometry, points = self._points(name)
        rough = self._keeper.place(name).pose(odometry)
        if other:
            # From the other robot, in the frame of the map.
            pose, around = self._points(other)
            place = self._keeper.place(other).pose(pose)
            if rough is None or place is None:
                raise FitError('it is not placed any more')
            found = fit(points, rough, around=(around, place))
        else:
            found = fit(points, rough, grid=self._map.grid())
        if not _stands(odometry, self._seen.get(name).pose):
            raise FitError('it is moving: stop it first')
        problem = self._named(name, self._keeper.put(name, found.pose, odometry))
        return self._answer(FitPlaceResponse, problem, '{}: {}'.format(name, found.text))

    def _points(self, name):
        """Return (odometry pose, laser points) of a robot, once received.

        :raises FitError: its laser publishes nothing
        """
        robot = self._seen.get(name)
        for _ in range(int(SCAN_WITHIN_S / 0.05)):
            age_s = robot.ages()['scan_age_s']
            if age_s is not None and age_s < SCAN_OLD_S and len(robot.points()):
                return robot.pose, robot.points()
            self._patience.wait(0.05)
        raise FitError('the laser of {} says nothing'.format(name) if robot.has_laser else
                       NO_POINTS)


def _pose(message):
    return Pose(message.x, message.y, message.theta)


def _stands(one, other):
    return max(abs(one.x_m - other.x_m), abs(one.y_m - other.y_m),
               abs(one.heading_rad - other.heading_rad)) < STANDS_WITHIN

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the host's side of a link tells the doctor, as the parameter ``~link``."""
import importlib.metadata
import os
import threading

from catkin_pkg.package import InvalidPackage, parse_package
import rospkg
import rospy

from mhri.graph.ros.master_api import MasterError

_LOOK_S = 1.0


def versions():
    """Return {'mhri': version, 'zenoh': version} of this side; '' for what is not known."""
    found = {'mhri': '', 'zenoh': ''}
    try:
        found['mhri'] = parse_package(os.path.join(
            rospkg.RosPack().get_path('mhri'), 'package.xml')).version
    except (InvalidPackage, OSError, rospkg.ResourceNotFound):
        pass  # then there is nothing to compare
    try:
        found['zenoh'] = importlib.metadata.version('eclipse-zenoh')
    except importlib.metadata.PackageNotFoundError:
        pass  # installed without its description
    return found


class Note:
    """The parameter ``~link``: a dictionary, see :class:`mhri.doctor.facts.LinkNote`.

    It goes when the node is ended in order, and stays where it failed or was killed: then it tells
    that there should be a link.

    :param endpoint: whom this side calls, or where it listens
    :param router: that is a router
    """

    def __init__(self, endpoint, router):
        self._name = rospy.get_name() + '/link'
        self._note = {'endpoint': endpoint, 'router': router, 'heard': 'never'}

    def failed(self, trouble, problem):
        """Say why the side cannot start: ``trouble`` is ``library``, ``keys`` or ``endpoint``."""
        rospy.set_param(self._name, dict(self._note, trouble=trouble, problem=str(problem)))

    def follow(self, side, watch, secret):
        """Keep it as things are; returns at once.

        :param side: :class:`mhri.link.ros.host_side.HostSide`
        :param watch: :class:`mhri.graph.ros.master_watch.MasterWatch`
        :param secret: with keys
        """
        self._note.update(secret=secret, own=versions())
        threading.Thread(target=self._run, args=(side, watch), name='note', daemon=True).start()
        rospy.on_shutdown(self._take_back)

    def _run(self, side, watch):
        told, pause = None, threading.Event()
        while not rospy.is_shutdown():
            if side.heard():
                self._note.update(heard='yes', peer=side.versions())
            elif self._note['heard'] == 'yes':
                self._note['heard'] = 'no'
            if self._note != told:
                try:
                    watch.set_parameter(self._name, dict(self._note))
                    told = dict(self._note)
                except MasterError:
                    pass  # again the next time
            pause.wait(_LOOK_S)

    def _take_back(self):
        try:
            rospy.delete_param(self._name)
        except (KeyError, OSError, rospy.ROSException):
            pass  # the master has ended, or forgotten it

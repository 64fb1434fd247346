# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report of the host side of a link to the doctor, as the parameter ``~link``."""
import importlib.metadata
import os
import threading

from catkin_pkg.package import InvalidPackage, parse_package
import rospkg
import rospy

from mhri.graph.ros.master_api import MasterError

_LOOK_S = 1.0


def versions():
    """Return {'mhri': version, 'zenoh': version} of this side; '' if unknown."""
    found = {'mhri': '', 'zenoh': ''}
    try:
        found['mhri'] = parse_package(os.path.join(
            rospkg.RosPack().get_path('mhri'), 'package.xml')).version
    except (InvalidPackage, OSError, rospkg.ResourceNotFound):
        pass  # version unknown
    try:
        found['zenoh'] = importlib.metadata.version('eclipse-zenoh')
    except importlib.metadata.PackageNotFoundError:
        pass  # installed without its description
    return found


class Note:
    """The parameter ``~link``: a dictionary, see :class:`mhri.doctor.facts.LinkNote`.

    It is deleted at a regular end of the node, and remains if the node fails or is killed, to show
    that there should be a link.

    :param endpoint: endpoint that this side connects to, or listens on
    :param router: whether that is a router
    """

    def __init__(self, endpoint, router):
        self._name = rospy.get_name() + '/link'
        self._note = {'endpoint': endpoint, 'router': router, 'heard': 'never'}

    def failed(self, trouble, problem):
        """Publish why the side cannot start.

        :param trouble: ``library``, ``endpoint``, or the cause of a :class:`KeysError`
        """
        rospy.set_param(self._name, dict(self._note, trouble=trouble, problem=str(problem)))

    def follow(self, side, watch, secret):
        """Keep it up to date, on a thread.

        :param side: :class:`mhri.link.ros.host_side.HostSide`
        :param watch: :class:`mhri.graph.ros.master_watch.MasterWatch`
        :param secret: whether the link has keys
        """
        self._note.update(secret=secret, own=versions())
        threading.Thread(target=self._run, args=(side, watch), name='note', daemon=True).start()
        rospy.on_shutdown(self._take_back)

    def _run(self, side, watch):
        published, pause = None, threading.Event()
        while not rospy.is_shutdown():
            if side.is_live():
                self._note.update(heard='yes', peer=side.versions())
            elif self._note['heard'] == 'yes':
                self._note['heard'] = 'no'
            if self._note != published:
                try:
                    watch.set_parameter(self._name, dict(self._note))
                    published = dict(self._note)
                except MasterError:
                    pass  # retried in the next period
            pause.wait(_LOOK_S)

    def _take_back(self):
        try:
            rospy.delete_param(self._name)
        except (KeyError, OSError, rospy.ROSException):
            pass  # the master has ended, or has lost the parameter

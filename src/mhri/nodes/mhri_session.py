# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_session``: runs :class:`mhri.session.ros.session.Session`.

``mhri_session --stand-by`` does so in a process that another one, already loaded, replaces if it is
killed (:mod:`mhri.graph.ros.stand_by`); it goes on with the recording. Parameters: ``~record``
(begin to record at once; default false), ``~cameras`` ("all", "stills", or pictures a second;
default all), ``~cameras_out_of_sight`` (default false), ``~folder`` (default
``$ROS_HOME/mhri/sessions``),
``~ring_s`` (30) and ``~ring_mb`` (64), ``~warn_free_mb`` (1000), ``~stop_free_mb`` (256),
``~bag_s`` (60, at most).
"""
import sys

import rospy

from mhri.base.config import ConfigError, shown
from mhri.graph.ros import log, parameters
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.rospy_inside import ended_by_hand
from mhri.graph.ros.stand_by import stand_by
from mhri.recording.folder import BAG_S, CAMERA_ALL, CAMERA_STILLS
from mhri.recording.recording import MB, RecordingLimits
from mhri.session.ros.session import Session, SessionOptions
from mhri.session.ros.session_node import SessionNode


def number(name, default, least):
    """Return a parameter that is a number.

    :raises ConfigError: it is none, or less than the least
    """
    value = rospy.get_param(name, default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value >= least:
        raise ConfigError(rospy.resolve_name(name), '', 'expected a number from {:g} up, got '
                          '{}'.format(least, shown(value)))
    return float(value)


def cameras():
    """Return ``~cameras`` as text.

    :raises ConfigError: it says nothing of cameras
    """
    value = rospy.get_param('~cameras', CAMERA_ALL)
    if value in (CAMERA_ALL, CAMERA_STILLS):
        return value
    try:
        rate_hz = float(value)
    except (TypeError, ValueError):
        rate_hz = 0.0
    if isinstance(value, bool) or not 0.0 < rate_hz <= 1000.0:
        raise ConfigError(rospy.resolve_name('~cameras'), '', 'expected all, stills, or pictures a '
                          'second, got {}'.format(shown(value)))
    return str(rate_hz)


def options():
    """Return the :class:`SessionOptions` of the parameters.

    :raises ConfigError: names the parameter that cannot be used
    """
    limits = RecordingLimits(warn_free_bytes=round(number('~warn_free_mb', 1000.0, 0.0) * MB),
                             stop_free_bytes=round(number('~stop_free_mb', 256.0, 0.0) * MB))
    return SessionOptions(
        cameras(), parameters.flag('~cameras_out_of_sight', False),
        parameters.text('~folder', ''), number('~ring_s', 30.0, 0.0),
        number('~ring_mb', 64.0, 0.0),
        bag_s=min(number('~bag_s', BAG_S, 1.0), BAG_S), limits=limits)


def main():
    """Run until shut down, and close what is recorded; exit with 1 for a wrong parameter."""
    types, _ = robot_types()
    stand_by('the session')
    limit_peers()
    init_node('mhri_session')
    log.install()
    by_hand = ended_by_hand()
    try:
        node = SessionNode(Session, types, options(), parameters.flag('~record', False))
    except ConfigError as error:
        sys.exit('the session cannot be recorded: {}'.format(error))
    MasterWatch().start()
    node.run()
    if by_hand():
        sys.exit('the session was ended by rosnode kill')

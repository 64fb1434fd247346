# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_session``: runs :class:`mhri.session.ros.session.Session`.

With ``--stand-by`` its process is replaced by another one, already loaded, if it is killed or
crashes (:mod:`mhri.graph.ros.stand_by`); that one continues the recording. Parameters:
``~record`` (start recording at once; default false), ``~cameras`` ("all", "stills", or pictures per
second; default all), ``~cameras_out_of_sight`` (default false), ``~folder`` (default
``$ROS_HOME/mhri/sessions``), ``~ring_s`` (30) and ``~ring_mb`` (64), ``~warn_free_mb`` (1000),
``~stop_free_mb`` (256), ``~bag_s`` (60, at most).
"""
import sys

import rospy

from mhri.base.config import ConfigError, shown
from mhri.graph.ros import parameters
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.shutdown import start_node
from mhri.graph.ros.stand_by import stand_by
from mhri.recording.folder import BAG_S, CAMERA_ALL, CAMERA_STILLS
from mhri.recording.recording import MB, RecordingLimits
from mhri.session.ros.session import Session, SessionOptions
from mhri.session.ros.session_node import SessionNode


def cameras():
    """Return ``~cameras`` as text.

    :raises ConfigError: the value is invalid
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

    :raises ConfigError: a parameter cannot be used; the text names it
    """
    warn_mb, stop_mb = (parameters.number(name, default, 0.0) for name, default in (
        ('~warn_free_mb', 1000.0), ('~stop_free_mb', 256.0)))
    limits = RecordingLimits(warn_free_bytes=round(warn_mb * MB),
                             stop_free_bytes=round(stop_mb * MB))
    return SessionOptions(
        cameras(), parameters.flag('~cameras_out_of_sight', False),
        parameters.text('~folder', ''), parameters.number('~ring_s', 30.0, 0.0),
        parameters.number('~ring_mb', 64.0, 0.0),
        bag_s=min(parameters.number('~bag_s', BAG_S, 1.0), BAG_S), limits=limits)


def main():
    """Run until shut down, then close the recording; exit with 1 for an invalid parameter."""
    types, _ = robot_types()
    stand_by('the session')
    by_hand = start_node('mhri_session')
    try:
        node = SessionNode(Session, types, options(), parameters.flag('~record', False))
    except ConfigError as error:
        sys.exit('the session cannot be recorded: {}'.format(error))
    MasterWatch().start()
    node.run()
    if by_hand():
        sys.exit('the session was ended by rosnode kill')

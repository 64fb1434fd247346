# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replaces an older mux: the newer one shuts it down if it is running, and has its state.

If two muxes have the same name, the master ends the older one. A mux with another name would go on
publishing to the same topic, so the newer one requests its shutdown.
"""
import json
import time
import xmlrpc.client

import rospy

from mhri.driving.drive import LOST
from mhri.driving.ros.wish_topic import WISH
from mhri.graph.ros.master_api import ERRORS, MasterApi, MasterError, TimedTransport
from mhri.graph.ros.service_owner import STOP_SERVICE

TIMEOUT_S = 1.5
SOURCES_PARAMETER, KEPT_PARAMETER = '/mux/sources', '/mux/kept'
#: key in the memory for the state of the next drive
KEPT = 'drive'


def has_address_of_last(memory):
    """Return whether this mux got the XML-RPC address of the one before it; store its own.

    Subscribers would not connect to it: the standby process keeps the old connections open, and
    rospy and roscpp ignore an announcement of the address to which they are connected. The kernel
    chooses the port, the same one about once in 10,000 times.

    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the previous mux
    """
    own = rospy.get_node_uri()
    same = memory.recall('address') == own
    memory.keep('address', own)
    return same


def end_other_muxes():
    """Shut down every other node that serves ``/mux/set_stop_all``.

    Only a mux has that service; other publishers of velocities (a test, a bag) are left alone.
    """
    api = MasterApi(rospy.get_name(), timeout_s=2.0)
    try:
        services = dict(api.call('getSystemState')[2])
        for name in services.get(STOP_SERVICE, []):
            uri = api.node_uri(name)
            if name != rospy.get_name() and uri:
                rospy.logwarn('another mux is running as %s: asking it to end', name)
                _end(api, name, uri)
    except (MasterError,) + ERRORS as error:
        rospy.logwarn('an older mux may still be running: %s', error)


def _end(api, name, uri):
    """Shut down one mux, and wait briefly until the master has unregistered it."""
    xmlrpc.client.ServerProxy(uri, transport=TimedTransport(TIMEOUT_S)).shutdown(
        rospy.get_name(), 'a newer mux has started')
    deadline = time.monotonic() + TIMEOUT_S
    while time.monotonic() < deadline:
        if name not in dict(api.call('getSystemState')[2]).get(STOP_SERVICE, []):
            return
        time.sleep(0.05)


def callers_of_before():
    """Return the addresses of the nodes that publish the operator's wish already (blocking).

    :raises MasterError: the master cannot be reached
    """
    return MasterApi(rospy.get_name(), timeout_s=2.0).publisher_uris(WISH)


def recalled(memory, stop_file, use, callers=callers_of_before):
    """Return the state kept by the previous drive, with a stop from memory or file.

    It is in the memory, or in a parameter if the process that holds the memory has ended, too.

    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the previous mux
    :param stop_file: :class:`mhri.driving.io.stop_file.StopFile`
    :param use: called with a state; raises an error if that is malformed
    :param callers: returns who may be a caller of before
    """
    kept = memory.recall(KEPT)
    try:
        if kept is None:
            text = rospy.get_param(KEPT_PARAMETER, '')
            # A mux that was here before has written both, but a launch empties this one.
            lost = not text and rospy.has_param(SOURCES_PARAMETER) and callers()
            kept = {'forgotten': True} if lost else json.loads(text or '{}')
        kept = dict(kept)
        use(kept)
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        rospy.logwarn('%s cannot be used (%r): everything is stopped, and nobody is in control',
                      KEPT_PARAMETER, error)
        kept = dict(LOST)
    try:
        stopped = stop_file.stopped()
    except OSError as error:
        stopped = True
        rospy.logwarn('stop-all may have been in force, so it is now: %s', error)
    kept['stop'] = bool(kept.get('stop') or stopped)
    if kept['stop']:
        rospy.logwarn('stop-all was in force when the last mux ended: it still is')
    return kept


def keep(memory, watch, kept):
    """Store the state for the next drive.

    :param watch: :class:`mhri.graph.ros.master_watch.MasterWatch`
    """
    memory.keep(KEPT, kept)
    # A stop has a file of its own, which is written before a release is answered.
    watch.keep_parameter(KEPT_PARAMETER, json.dumps(
        {name: value for name, value in kept.items() if name != 'stop'}))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A second mux starts no fight: the newer one ends the older.

If two muxes have the same name, the master ends the older one. A mux with another name would go on
publishing to the same topic, so the newer one asks it to end.
"""
import time
import xmlrpc.client

import rospy

from mhri.graph.ros.in_force import STOP_SERVICE
from mhri.graph.ros.master_api import ERRORS, MasterApi, MasterError, TimedTransport

PATIENCE_S = 1.5


def end_other_muxes():
    """Ask every other node that serves ``/mux/set_stop_all`` to shut down.

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
    """Ask one mux to end, and wait a little until the master has dropped it."""
    xmlrpc.client.ServerProxy(uri, transport=TimedTransport(PATIENCE_S)).shutdown(
        rospy.get_name(), 'a newer mux has started')
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if name not in dict(api.call('getSystemState')[2]).get(STOP_SERVICE, []):
            return
        time.sleep(0.05)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replaces an older mux: the newer one has another address, and shuts it down if it is running.

If two muxes have the same name, the master ends the older one. A mux with another name would go on
publishing to the same topic, so the newer one requests its shutdown.
"""
import time
import xmlrpc.client

import rospy

from mhri.graph.ros.master_api import ERRORS, MasterApi, MasterError, TimedTransport
from mhri.graph.ros.service_owner import STOP_SERVICE

TIMEOUT_S = 1.5


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

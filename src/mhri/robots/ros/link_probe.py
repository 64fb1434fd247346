# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sends a request to a robot's node once a second, and times the answer.

The request is ``getPid`` of the ROS slave API, over a connection kept open, so that the time is
one round trip without connection setup.
"""
import http.client
import threading
import time
from urllib.parse import urlsplit
import xmlrpc.client

import rospy

PERIOD_S = 1.0
TIMEOUT_S = 3.0


class LinkProbe:
    """A thread that measures round trips.

    :param name: the robot
    :param uri_of: function that returns the XML-RPC address of a node on the robot, or None
    :param on_round_trip: called with the time [s], or None if no answer came, on the thread
    """

    def __init__(self, name, uri_of, on_round_trip):
        self._uri_of = uri_of
        self._on_round_trip = on_round_trip
        self._ended = threading.Event()
        self._connection = None
        self._uri = None
        threading.Thread(target=self._run, name='link ' + name, daemon=True).start()

    def close(self):
        """Stop the thread; returns at once."""
        self._ended.set()

    def _run(self):
        while not self._ended.wait(PERIOD_S):
            uri = self._uri_of()
            if uri is not None:
                self._on_round_trip(self._ask(uri))
        self._hang_up()

    def _ask(self, uri):
        """Return the round trip [s], or None."""
        body = xmlrpc.client.dumps((rospy.get_name(),), 'getPid')
        try:
            if uri != self._uri or self._connection is None:
                self._connect(uri)
            begun = time.monotonic()
            self._connection.request('POST', '/', body, {'Content-Type': 'text/xml'})
            answer = self._connection.getresponse()
            answer.read()
            took = time.monotonic() - begun
        except (OSError, ValueError, http.client.HTTPException) as error:
            rospy.logdebug('%s does not answer: %s', uri, error)
            self._hang_up()
            return None
        if answer.will_close:
            self._hang_up()
        return took

    def _connect(self, uri):
        self._hang_up()
        parts = urlsplit(uri)
        self._connection = http.client.HTTPConnection(parts.hostname, parts.port,
                                                      timeout=TIMEOUT_S)
        self._connection.connect()
        self._uri = uri

    def _hang_up(self):
        if self._connection is not None:
            self._connection.close()
            self._connection = None

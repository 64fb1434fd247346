# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calls the ROS master directly, with a timeout on every call.

rospy's own master proxy has no timeout: an unreachable master (silent, not refusing) blocks the
caller for minutes.
"""
import contextlib
import http.client
from urllib.parse import urlsplit
import xml.parsers.expat
import xmlrpc.client

import rosgraph

DEFAULT_PORT = 11311
ERRORS = (OSError, xmlrpc.client.Error, http.client.HTTPException)
# xmlrpc also raises these if another program answers there: no XML, no text, not three values.
_NONSENSE = (xml.parsers.expat.ExpatError, ValueError, TypeError, LookupError, AttributeError,
             ArithmeticError)


class MasterError(Exception):
    """The master is unreachable, or refused the call; the text has the reason and the address."""


def uri_problem(uri):
    """Return why a text is not the URI of a master, '' if it is."""
    try:
        parts = urlsplit(uri.strip())
        port = parts.port
    except ValueError as error:
        return str(error)
    if parts.scheme != 'http' or not parts.hostname or uri != uri.strip():
        return 'it has the form http://<address>:{}'.format(DEFAULT_PORT)
    return '' if port else 'it names no port; the usual one is {}'.format(DEFAULT_PORT)


def master_uri():
    """Return the URI of the master.

    :raises MasterError: ``ROS_MASTER_URI`` (or the remapping ``__master``) is not one
    """
    uri = rosgraph.get_master_uri()
    problem = uri_problem(uri)
    if problem:
        raise MasterError('ROS_MASTER_URI is {!r}: {}'.format(uri[:200], problem))
    return uri


class TimedTransport(xmlrpc.client.Transport):
    """HTTP with a socket timeout [s]."""

    def __init__(self, timeout_s):
        super().__init__()
        self._timeout_s = timeout_s

    def make_connection(self, host):
        """Return the (kept) connection, with the timeout set."""
        connection = super().make_connection(host)
        connection.timeout = self._timeout_s
        return connection


class MasterApi:
    """Calls to the master (http://wiki.ros.org/ROS/Master_API), one at a time, not thread-safe.

    :param caller_id: caller id of the calls
    :param timeout_s: timeout of one call [s]
    :param uri: the master; default ``ROS_MASTER_URI``
    :raises MasterError: that is not a URI
    """

    def __init__(self, caller_id, timeout_s=1.0, uri=None):
        self.uri = uri or master_uri()
        self._caller_id = caller_id
        self._proxy = xmlrpc.client.ServerProxy(self.uri, transport=TimedTransport(timeout_s))

    def call(self, method, *args):
        """Call a method of the master and return the value of its answer.

        :raises MasterError: no answer in time, or an answer that is not "success"
        """
        with self._errors():
            code, message, value = getattr(self._proxy, method)(self._caller_id, *args)
        if code != 1:
            raise MasterError('the ROS master at {} refused {}: {}'.format(
                self.uri, method, message))
        return value

    def call_many(self, calls):
        """Send several calls as one request.

        :param calls: [(method, arg, ...)]
        :returns: their values in order; None if the master refused the single call
        :raises MasterError: no answer in time, or an unintelligible one
        """
        batch = xmlrpc.client.MultiCall(self._proxy)
        for method, *args in calls:
            getattr(batch, method)(self._caller_id, *args)
        with self._errors():
            return [value if code == 1 else None for code, _, value in batch()]

    @contextlib.contextmanager
    def _errors(self):
        """Convert all errors of a call into :exc:`MasterError`."""
        try:
            yield
        except ERRORS as error:
            raise MasterError('no answer from the ROS master at {}: {}'.format(
                self.uri, str(error)[:200]))
        except _NONSENSE as error:
            raise MasterError('what answers at {} is not a ROS master: {}'.format(
                self.uri, repr(error)[:200]))

    def publisher_uris(self, topic):
        """Return the URIs of the nodes that publish a topic.

        :raises MasterError: the master cannot be reached
        """
        nodes = dict(self.call('getSystemState')[0]).get(topic, ())
        uris = self.call_many([('lookupNode', node) for node in nodes]) if nodes else []
        return [uri for uri in uris if uri]

    def node_uri(self, name):
        """Return the registered URI of a node, None if it is not registered.

        :raises MasterError: the master cannot be reached
        """
        return self.call_many([('lookupNode', name)])[0]

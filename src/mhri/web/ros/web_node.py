# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The node ``mhri_web``: the server of the page, its links, and what joins it to the graph.

Serves ``/mhri_web/give`` (``mhri/GiveLink``) and ``/mhri_web/take`` (``mhri/TakeLink``); for the
other interfaces see :mod:`mhri.web.ros.feed` and :mod:`mhri.web.ros.outputs`.
"""
import concurrent.futures
import os
import secrets
import socket

import rospy

from mhri.graph.ros.addresses import own_addresses
from mhri.graph.ros.resources import resource_path
from mhri.recording.recording import ros_home
from mhri.srv import GiveLink, GiveLinkResponse, TakeLink, TakeLinkResponse
from mhri.web.io.certificate import CertificateError, page_files, read_rows, server_context
from mhri.web.io.recorded import Recorded
from mhri.web.io.server import TYPES, WebServer
from mhri.web.links import LinkBook, LinkError
from mhri.web.ros.feed import Feed
from mhri.web.ros.outputs import RosOutputs

TOKEN_BYTES = 16


def new_token():
    """Return 128 random bits that may stand in a URL."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def files_of_page():
    """Return {name: bytes} of the files in ``resource/web``."""
    return page_files(resource_path('web'), TYPES)


def chosen_host(addresses, wanted):
    """Return the address at which others reach this computer, '' if there is none.

    :param wanted: what the operator's system is known by: ``ROS_IP`` or ``ROS_HOSTNAME``
    """
    reached = [address for address in addresses if not address.startswith('127.')]
    return wanted if wanted in reached else next(iter(reached), '')


class WebNode:
    """The node, after ``rospy.init_node``.

    :param port: of the page for others, by HTTPS; 0: any
    :param local_port: of the page on this computer alone, by HTTP; 0: any
    """

    def __init__(self, port, local_port):
        folder = os.path.join(ros_home(os.environ), 'mhri', 'web')
        links = os.path.join(folder, 'links.json')
        self._outputs = RosOutputs(links, lambda watched: self._feed.want(watched))
        addresses = own_addresses()
        self._host = chosen_host(addresses, os.environ.get('ROS_IP', ''))
        places = [('127.0.0.1', local_port, None)]
        try:
            context = server_context(folder, sorted({
                'localhost', '127.0.0.1', socket.gethostname().lower(), *addresses}))
            places.append(('0.0.0.0', port, context))
        except CertificateError as error:
            self._outputs.problem = str(error)
            rospy.logerr('the page is on this computer alone: %s', error)
        recorded = Recorded()
        self._server = WebServer(LinkBook(new_token, read_rows(links)), files_of_page(),
                                 self._outputs, places, recorded.routes, (recorded.close,))
        self._feed = Feed(self._server.hub)

    def start(self):
        """Start serving (blocking: calls the master)."""
        rospy.on_shutdown(self.close)
        self._server.start()
        ports, problems = self._server.ports, [text for text in self._server.problems if text]
        if len(ports) > 1 and ports[1] and self._host:
            self._outputs.address = 'https://{}:{}'.format(self._host, ports[1])
        elif not self._outputs.problem:
            self._outputs.problem = problems[0] if problems else 'this computer has no network'
        self._feed.start()
        rospy.Service('/mhri_web/give', GiveLink, self._give)
        rospy.Service('/mhri_web/take', TakeLink, self._take)
        rospy.loginfo('the page is at %s, and at %s on this computer',
                      self._outputs.address or 'no address', self.local_address)

    @property
    def local_address(self):
        """The address of the page on this computer, without a token."""
        return 'http://127.0.0.1:{}'.format(self._server.ports[0] or 0)

    def give(self, *words):
        """Return (link, URL) of a new link; the arguments are those of ``mhri/GiveLink``.

        :raises LinkError: a value is invalid
        """
        link, token = self._server.hub.do(self._server.hub.give, *words)
        return link, '{}/t/{}'.format(self._outputs.address or self.local_address, token)

    def _give(self, request):
        try:
            link, url = self.give(request.label, request.role, request.may_stop, request.head,
                                  request.hours)
        except (LinkError, concurrent.futures.TimeoutError) as error:
            return GiveLinkResponse(False, str(error) or 'the server is busy', '', '')
        return GiveLinkResponse(True, '', link.id, url)

    def _take(self, request):
        try:
            self._server.hub.do(self._server.hub.take, request.id)
        except (LinkError, concurrent.futures.TimeoutError) as error:
            return TakeLinkResponse(False, str(error) or 'the server is busy')
        return TakeLinkResponse(True, '')

    def close(self):
        """Let go of the stick and close every page."""
        self._server.stop()
        self._feed.close()
        self._outputs.close()

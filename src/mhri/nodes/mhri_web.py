# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_web``: the page for watching, the tablet and the headset.

Runs :class:`mhri.web.ros.web_node.WebNode`. Parameters: ``~port`` (8443, HTTPS) and
``~local_port`` (8080, HTTP on this computer alone); 0 for any free one. With ``--demo`` it is no
node: it serves the page's demo on this computer, prints its link, and needs neither a master nor
robots.
"""
import argparse
import signal
import sys
import threading

import rospy

from mhri.base.config import ConfigError
from mhri.graph.ros import parameters
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.shutdown import start_node
from mhri.web.io.hub import Outputs
from mhri.web.io.server import WebServer
from mhri.web.links import LinkBook, WATCH
from mhri.web.ros.web_node import files_of_page, new_token, WebNode

PORT, LOCAL_PORT = 8443, 8080
DEMO_HOURS = 24.0


def demo():
    """Serve the page without ROS until Ctrl-C."""
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    server = WebServer(LinkBook(new_token), files_of_page(), Outputs(),
                       [('127.0.0.1', LOCAL_PORT, None)]).start()
    if not server.ports[0]:
        sys.exit('port {}: {}'.format(LOCAL_PORT, server.problems[0]))
    _, token = server.hub.do(server.hub.give, 'demo', WATCH, False, False, DEMO_HOURS)
    print('http://127.0.0.1:{}/t/{}?demo'.format(server.ports[0], token), flush=True)
    ended.wait()
    server.stop()


def main():
    """Run until shut down; exit with 1 for an invalid parameter."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--demo', action='store_true', help='print a link to the demo of the page')
    if parser.parse_args(rospy.myargv()[1:]).demo:
        demo()
        return
    by_hand = start_node('mhri_web')
    try:
        ports = [round(parameters.number(name, default, 0, 65535)) for name, default in (
            ('~port', PORT), ('~local_port', LOCAL_PORT))]
    except ConfigError as error:
        sys.exit('the page cannot be served: {}'.format(error))
    WebNode(*ports).start()
    MasterWatch().start()
    rospy.spin()
    if by_hand():
        sys.exit('the page was ended by rosnode kill')

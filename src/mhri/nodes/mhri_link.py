# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_link``: links a robot on a ROS master of its own to the host's master.

One runs on the robot's master, ``mhri_link --side robot --name bot1 --listen tcp/0.0.0.0:7447``,
and one for each robot on the host's, ``mhri_link --side host --name bot1 --connect
tcp/192.168.0.7:7447``. Either may listen or connect; ``udp/`` in place of ``tcp/`` drops what is
lost in place of repeating it. Neither needs the other to be there, at the start or later.

It is called ``/<name>/mhri_link`` on both masters.
"""
import argparse
import os
import sys

import rospy

from mhri.core.link.carried import SHARED_FRAMES, split_frames
from mhri.core.robots.names import name_problem, tidy_name
from mhri.ros.diagnostics import publish_diagnostics
from mhri.ros.graph import log
from mhri.ros.graph.handshake import limit_handshakes
from mhri.ros.graph.master_watch import MasterWatch
from mhri.ros.link.carrier import Carrier, CarrierError, LibraryMissing
from mhri.ros.link.host_side import HostSide
from mhri.ros.link.robot_side import RobotSide
from mhri.ros.resources import robot_types


def robot_name(text):
    """Return the name of a robot.

    :raises argparse.ArgumentTypeError: it is none
    """
    problem = name_problem(text)
    if problem:
        raise argparse.ArgumentTypeError('{!r}: {}'.format(text[:40], problem))
    return text


def parse(words):
    """Return the options of a command line; ends with status 2 and a line where they are wrong."""
    parser = argparse.ArgumentParser(
        prog='mhri_link', description='Link a robot on a ROS master of its own to the host.')
    parser.add_argument('--side', choices=('robot', 'host'), required=True,
                        help='whose master this node is on')
    parser.add_argument('--name', type=robot_name, required=True, help='the robot')
    parser.add_argument('--listen', default='', metavar='ENDPOINTS',
                        help='where the other side may call, e.g. tcp/0.0.0.0:7447')
    parser.add_argument('--connect', default='', metavar='ENDPOINTS',
                        help='whom to call, e.g. tcp/192.168.0.7:7447')
    parser.add_argument('--namespace', help='on the robot: its namespace on its own master, by '
                        'default its name; / for a robot without one')
    parser.add_argument('--shared-frames', default=' '.join(SHARED_FRAMES),
                        help='on the robot: frames that do not get its name (default: %(default)s)')
    options = parser.parse_args(words)
    if not (options.listen or options.connect):
        parser.error('give --listen or --connect, e.g. --connect tcp/192.168.0.7:7447')
    return options


def main():
    """Run until shut down; without the library, or with a wrong endpoint, exit with 1 and why."""
    options = parse(rospy.myargv()[1:])
    limit_handshakes()
    if rospy.get_namespace() == '/':
        # Started by hand. On the host it has to be a node of the robot; rospy knows its namespace
        # from the start only.
        os.execv(sys.argv[0], sys.argv + ['__ns:=/' + options.name])
    rospy.init_node('mhri_link', disable_rostime=True)
    log.install()
    try:
        carrier = Carrier(options.name, options.listen.split(), options.connect.split())
    except (CarrierError, LibraryMissing) as error:
        rospy.logfatal('%s', error)
        sys.exit(1)
    watch = MasterWatch().start()
    if options.side == 'host':
        side = HostSide(options.name, carrier, watch.set_parameter)
        publish_diagnostics({'link to ' + options.name: side.fill})
    else:
        types, errors = robot_types()
        for error in errors:
            rospy.logwarn('robot type left out: %s', error)
        namespace = tidy_name(options.namespace if options.namespace is not None
                              else options.name)
        side = RobotSide(options.name, carrier, '/' + namespace if namespace else '', types,
                         split_frames(options.shared_frames))
        publish_diagnostics({'link to the host': side.fill})
    rospy.on_shutdown(side.close)
    side.start()
    rospy.spin()
    carrier.close()

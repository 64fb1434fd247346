# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_link``: links a robot with its own ROS master to the host's master.

One instance runs on the robot's master, ``mhri_link --side robot --name bot1 --listen
tls/0.0.0.0:7447``, and one per robot on the host's, ``mhri_link --side host --name bot1 --connect
tls/192.168.0.7:7447``. Either may listen or connect. Both run without the other end, at the start
and later.

If neither end can reach the other, both connect to a router, with ``--router 192.0.2.1:7447``
instead of ``--listen`` and ``--connect``: a ``zenohd``, or ``mhri_link --side router --listen
0.0.0.0:7447``, which needs no ROS master.

With keys (``utils/host/mhri_keys.sh``) the endpoints are ``tls/``, and peers without a key, or with
a revoked one, are rejected. Replaced keys take effect within seconds. Messages are sent as
encrypted datagrams if the network passes them, to the UDP port of the same number. Without keys the
endpoints are ``tcp/``, and only this computer is linked with, unless ``--keys off`` says that the
network is trusted: every computer on it can drive.

Its node is ``/<name>/mhri_link`` on both masters.
"""
import argparse
import logging
import os
import signal
import socket
import sys

import rospy

from mhri.base.names import name_problem, tidy_name
from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.shutdown import start_node
from mhri.link.carried import SHARED_FRAMES, split_frames
from mhri.link.keys import check_open, endpoint, host_of, KeysError
from mhri.link.records import IN_SESSIONS, KEEPS
from mhri.link.ros.carrier import (
    Carrier, CarrierError, LibraryMissing, load_library, MAX_FROM_ROBOT, MAX_TO_ROBOT)
from mhri.link.ros.host_side import HostSide
from mhri.link.ros.keeper import keeper_of, MAX_MB
from mhri.link.ros.key_folder import AUTO, find_folder, KeyFolder, OFF, watch_keys
from mhri.link.ros.note import Note
from mhri.link.ros.refused_peers import log_refused_peers
from mhri.robots.owners import is_host


def robot_name(text):
    """Parse the name of a robot.

    :raises argparse.ArgumentTypeError: the name is invalid
    """
    problem = name_problem(text)
    if problem:
        raise argparse.ArgumentTypeError('{!r}: {}'.format(text[:40], problem))
    return text


def megabytes(text):
    """Parse a number of MB from 10 to 1,000,000.

    :raises argparse.ArgumentTypeError: the number is invalid
    """
    if not (text.isdigit() and len(text) < 8 and 10 <= int(text) <= 1000000):
        raise argparse.ArgumentTypeError('{!r} is not a number of MB from 10 to 1000000'.format(
            text[:40]))
    return int(text)


def parse(words):
    """Parse a command line; exit with status 2 and a message if it is invalid."""
    parser = argparse.ArgumentParser(
        prog='mhri_link', description='Link a robot on a ROS master of its own to the host.')
    parser.add_argument('--side', choices=('robot', 'host', 'router'), required=True,
                        help='whose master this node runs on; router: on none, between the two')
    parser.add_argument('--name', type=robot_name, help='the robot')
    parser.add_argument('--listen', default='', metavar='ENDPOINTS',
                        help='where to accept connections, e.g. 0.0.0.0:7447')
    parser.add_argument('--connect', default='', metavar='ENDPOINTS',
                        help='where to connect, e.g. 192.168.0.7:7447')
    parser.add_argument('--router', default='', metavar='ENDPOINT', help='a router to which both '
                        'sides connect, instead of --listen and --connect')
    parser.add_argument('--namespace', help='on the robot: its namespace on its own master '
                        '(default: its name); / for none')
    parser.add_argument('--shared-frames', default=' '.join(SHARED_FRAMES),
                        help='frames that do not get its name as prefix, the same on both sides '
                        '(default: %(default)s)')
    parser.add_argument('--keys', default=AUTO, metavar='FOLDER',
                        help='folder of the keys, or off, on a network that you trust: then anyone '
                        'who reaches --listen may drive. Default: where mhri_keys.sh puts them; '
                        'without keys only addresses of this computer are allowed')
    parser.add_argument('--host', default=host_of(socket.gethostname()), metavar='NAME',
                        help='on a host without keys: its name on the link, which no other host '
                        'of the robot may have (default: %(default)s)')
    parser.add_argument('--keep', choices=KEEPS, default=IN_SESSIONS,
                        help='on the host: what the robot records while it is out of reach: states '
                        'during a session, states always, or pictures as well, always '
                        '(default: %(default)s)')
    parser.add_argument('--keep-mb', type=megabytes, default=MAX_MB, metavar='MB',
                        help='on the robot: space for these recordings; the oldest are deleted '
                        '(default: %(default)s)')
    options = parser.parse_args(words)
    if not is_host(options.host):
        parser.error('--host: {!r} is not a name such as host:lab'.format(options.host[:60]))
    check(parser, options)
    return options


def check(parser, options):
    """Exit with status 2 and a message if options contradict each other."""
    if options.side == 'router':
        if not options.listen or options.connect or options.router or options.name:
            parser.error('a router takes only --listen, e.g. --listen 0.0.0.0:7447')
        return
    if not options.name:
        parser.error('name the robot with --name')
    if options.router and (options.listen or options.connect):
        parser.error('--router replaces --listen and --connect')
    if not (options.listen or options.connect or options.router):
        parser.error('give --listen, --connect or --router, e.g. --connect 192.168.0.7:7447')


def called_ends(options, secret):
    """Return (endpoints to listen on, endpoints to connect to).

    :param secret: whether keys are in place
    :raises KeysError: without keys and ``--keys off``, an endpoint is of another computer, or can
        be reached by one
    """
    listen, connect = [[endpoint(word, secret) for word in words.split()]
                       for words in (options.listen, options.connect or options.router)]
    if not secret and options.keys != OFF:
        check_open(listen + connect)
    return listen, connect


def refuses(words):
    """Print why a link with these options would not listen; return the exit status, else 0."""
    options = parse(words)
    try:
        called_ends(options, bool(find_folder(options.keys)))
    except KeysError as error:
        print(error)
        return 2
    return 0


def call(options):
    """Return (:class:`KeyFolder` or None, :class:`Carrier`).

    :raises CarrierError: an endpoint cannot be used
    :raises KeysError: the keys cannot be used
    :raises LibraryMissing: zenoh is not installed
    """
    folder = find_folder(options.keys)
    ends = called_ends(options, bool(folder))
    keys = KeyFolder(folder, options.side, options.name, bool(options.router)) if folder else None
    secrets = keys.read() if keys else None
    if keys:
        log_refused_peers(load_library(), options.name or options.side)
    place = 'router' if options.side == 'router' else 'routed' if options.router else 'peer'
    return keys, Carrier(*ends, secrets=secrets, place=place, own=keys.keys.own if keys else '',
                         max_bytes=MAX_TO_ROBOT if options.side == 'robot' else MAX_FROM_ROBOT)


def known_types():
    """Return {name: RobotType} of the installed types; errors are logged."""
    types, errors = robot_types()
    for error in errors:
        rospy.logwarn('robot type left out: %s', error)
    return types


def robot_side(options, carrier, own):
    """Return the robot's side of the link, which accepts hosts.

    :param own: the name in the robot's key, None without keys
    """
    # It compresses pictures with OpenCV, 28 MB that the host's side, one per robot, need not load.
    from mhri.link.ros.link_server import LinkServer
    keeper_of(options.name).max_mb = options.keep_mb
    namespace = tidy_name(options.namespace if options.namespace is not None else options.name)
    return LinkServer(options.name, carrier, own, '/' + namespace if namespace else '',
                      known_types(), split_frames(options.shared_frames))


def route(options):
    """Run the router until a signal; exit with 1 and the reason if the keys cannot be used."""
    try:
        keys, carrier = call(options)
    except (CarrierError, KeysError, LibraryMissing) as error:
        sys.exit('mhri_link: {}'.format(error))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    print('mhri_link: routing on {}, {}'.format(
        options.listen, 'with keys only' if keys else 'without keys'), flush=True)
    if keys:
        watch_keys(keys, carrier)
    try:
        signal.pause()
    finally:
        carrier.close()


def main():
    """Run until shut down; exit with 1 and the reason without zenoh or with a wrong endpoint."""
    options = parse(rospy.myargv()[1:])
    if options.side == 'router':
        route(options)
        return
    start_node('mhri_link', '/' + options.name, disable_rostime=True)
    note = Note(options.router or options.connect or options.listen, bool(options.router))
    try:
        keys, carrier = call(options)
    except (CarrierError, KeysError, LibraryMissing) as error:
        rospy.logfatal('%s', error)
        if options.side == 'host':
            note.failed('library' if isinstance(error, LibraryMissing) else
                        error.cause if isinstance(error, KeysError) else 'endpoint', error)
        sys.exit(1)
    if keys:
        rospy.loginfo('%s: linked with keys only; this side has the key of %s', options.name,
                      keys.keys.own)
    else:
        rospy.logwarn('%s: linked without keys: anyone who reaches the endpoint can drive the '
                      'robot (mhri_keys.sh makes keys)', options.name)
    watch = MasterWatch().start()
    own = keys.keys.own if keys else None
    if options.side == 'host':
        host = own or options.host
        side = HostSide(options.name, carrier.between(options.name, host), watch.set_parameter,
                        host, bool(keys), known_types(), split_frames(options.shared_frames),
                        options.keep)
        title = 'link to ' + options.name
        note.follow(side, watch, bool(keys))
    else:
        side = robot_side(options, carrier, own)
        title = 'link to the host'
    publish_diagnostics({title: lambda status: carrier.fill(side.fill(status))})
    rospy.on_shutdown(side.close)
    side.start()
    if keys:
        watch_keys(keys, carrier)
    rospy.spin()
    carrier.close()
    # A zenoh thread that waits for Python during Python's exit would abort the process.
    logging.shutdown()
    os._exit(0)

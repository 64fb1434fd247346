# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_link``: links a robot on a ROS master of its own to the host's master.

One runs on the robot's master, ``mhri_link --side robot --name bot1 --listen tcp/0.0.0.0:7447``,
and one for each robot on the host's, ``mhri_link --side host --name bot1 --connect
tcp/192.168.0.7:7447``. Either may listen or connect; ``udp/`` in place of ``tcp/`` drops what is
lost in place of repeating it. Neither needs the other to be there, at the start or later.

Where neither reaches the other, both call a router that both reach, with ``--router
192.0.2.1:7447`` in place of ``--listen`` and ``--connect``: a ``zenohd``, or ``mhri_link --side
router --listen 0.0.0.0:7447``, which needs no ROS master.

With keys (``utils/host/mhri_keys.sh``) the endpoints are ``tls/`` or ``quic/``, and who has none,
or one that was withdrawn, is not let in. Keys that are replaced take effect within seconds. By
``tls/`` what is said goes as sealed datagrams where those pass, to the UDP port of that number.
Without keys it listens to this computer alone, unless ``--keys off`` says that whoever reaches it
may drive.

It is called ``/<name>/mhri_link`` on both masters.
"""
import argparse
import logging
import os
import signal
import socket
import sys

import rospy

from mhri.base.names import name_problem, tidy_name
from mhri.graph.ros import log
from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import robot_types
from mhri.link.carried import SHARED_FRAMES, split_frames
from mhri.link.keys import check_open, endpoint, host_of, KeysError, marked
from mhri.link.records import IN_SESSIONS, KEEPS
from mhri.link.ros.carrier import (
    Carrier, CarrierError, LibraryMissing, load_library, MAX_FROM_ROBOT, MAX_TO_ROBOT)
from mhri.link.ros.computer import facts
from mhri.link.ros.host_side import HostSide
from mhri.link.ros.keeper import keeper_of, MOST_MB
from mhri.link.ros.key_folder import AUTO, find_folder, KeyFolder, OFF, watch_keys
from mhri.link.ros.knocks import tell_knocks
from mhri.link.ros.note import Note
from mhri.robots.owners import is_host


def robot_name(text):
    """Return the name of a robot.

    :raises argparse.ArgumentTypeError: it is none
    """
    problem = name_problem(text)
    if problem:
        raise argparse.ArgumentTypeError('{!r}: {}'.format(text[:40], problem))
    return text


def megabytes(text):
    """Return a number of MB from 10 to 1,000,000.

    :raises argparse.ArgumentTypeError: it is none
    """
    if not (text.isdigit() and len(text) < 8 and 10 <= int(text) <= 1000000):
        raise argparse.ArgumentTypeError('{!r} is no number of MB from 10 to 1000000'.format(
            text[:40]))
    return int(text)


def parse(words):
    """Return the options of a command line; ends with status 2 and a line where they are wrong."""
    parser = argparse.ArgumentParser(
        prog='mhri_link', description='Link a robot on a ROS master of its own to the host.')
    parser.add_argument('--side', choices=('robot', 'host', 'router'), required=True,
                        help='whose master this node is on; router: on none, it stands between')
    parser.add_argument('--name', type=robot_name, help='the robot')
    parser.add_argument('--listen', default='', metavar='ENDPOINTS',
                        help='where the other side may call, e.g. tcp/0.0.0.0:7447')
    parser.add_argument('--connect', default='', metavar='ENDPOINTS',
                        help='whom to call, e.g. tcp/192.168.0.7:7447')
    parser.add_argument('--router', default='', metavar='ENDPOINT', help='a router that both sides '
                        'call, in place of --listen and --connect')
    parser.add_argument('--namespace', help='on the robot: its namespace on its own master, by '
                        'default its name; / for a robot without one')
    parser.add_argument('--shared-frames', default=' '.join(SHARED_FRAMES),
                        help='frames that do not get its name, the same on both sides (default: '
                        '%(default)s)')
    parser.add_argument('--keys', default=AUTO, metavar='FOLDER',
                        help='where the keys are, or off: whoever reaches --listen may drive. By '
                        'default where mhri_keys.sh puts them; without any --listen is refused, '
                        'but on this computer alone')
    parser.add_argument('--host', default=host_of(socket.gethostname()), metavar='NAME',
                        help='on a host without keys: its name on the link (default: %(default)s); '
                        'a mark of the computer is added')
    parser.add_argument('--keep', choices=KEEPS, default=IN_SESSIONS,
                        help='on the host: the robot records what is missed here while a session '
                        'is recorded (session), always (states), or always and with pictures; '
                        'default: %(default)s')
    parser.add_argument('--keep-mb', type=megabytes, default=MOST_MB, metavar='MB',
                        help='on the robot: so much of what hosts missed is kept, the newest '
                        '(default: %(default)s)')
    options = parser.parse_args(words)
    if not is_host(options.host):
        parser.error('--host: {!r} is no name such as host:lab'.format(options.host[:60]))
    check(parser, options)
    return options


def check(parser, options):
    """End with status 2 and a line where options do not go together."""
    if options.side == 'router':
        if not options.listen or options.connect or options.router or options.name:
            parser.error('a router has --listen alone, e.g. --listen 0.0.0.0:7447')
        return
    if not options.name:
        parser.error('give the robot with --name')
    if options.router and (options.listen or options.connect):
        parser.error('--router stands in place of --listen and --connect')
    if not (options.listen or options.connect or options.router):
        parser.error('give --listen, --connect or --router, e.g. --connect tcp/192.168.0.7:7447')


def called_ends(options, secret):
    """Return (endpoints to listen on, endpoints to call).

    :param secret: keys are in place
    :raises KeysError: others reach one of the first, without keys, and ``--keys off`` is not said
    """
    listen, connect = [[endpoint(word, secret) for word in words.split()]
                       for words in (options.listen, options.connect or options.router)]
    if not secret and options.keys != OFF:
        check_open(listen)
    return listen, connect


def refuses(words):
    """Say why a link with these options would not listen; return the exit status, 0 if it would."""
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
    :raises KeysError: the keys cannot
    :raises LibraryMissing: there is no zenoh
    """
    folder = find_folder(options.keys)
    ends = called_ends(options, bool(folder))
    keys = KeyFolder(folder, options.side, options.name, bool(options.router)) if folder else None
    secrets = keys.read() if keys else None
    if keys:
        tell_knocks(load_library(), options.name or options.side)
    place = 'router' if options.side == 'router' else 'routed' if options.router else 'peer'
    return keys, Carrier(*ends, secrets=secrets, place=place, own=keys.keys.own if keys else '',
                         max_bytes=MAX_TO_ROBOT if options.side == 'robot' else MAX_FROM_ROBOT)


def known_types():
    """Return {name: RobotType} of those that are installed here; the log names what is wrong."""
    types, errors = robot_types()
    for error in errors:
        rospy.logwarn('robot type left out: %s', error)
    return types


def robot_side(options, carrier, own):
    """Return what lets hosts in on the robot.

    :param own: the name in the robot's key, None without keys
    """
    # Packs pictures with OpenCV, 28 MB that the host's side, one for each robot, does without.
    from mhri.link.ros.reception import Reception
    keeper_of(options.name).most_mb = options.keep_mb
    namespace = tidy_name(options.namespace if options.namespace is not None else options.name)
    return Reception(options.name, carrier, own, '/' + namespace if namespace else '',
                     known_types(), split_frames(options.shared_frames))


def route(options):
    """Be the router until a signal comes; with keys that cannot be used end with 1 and why."""
    try:
        keys, carrier = call(options)
    except (CarrierError, KeysError, LibraryMissing) as error:
        sys.exit('mhri_link: {}'.format(error))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    print('mhri_link: routing on {}, {}'.format(
        options.listen, 'by keys alone' if keys else 'without keys'), flush=True)
    if keys:
        watch_keys(keys, carrier)
    try:
        signal.pause()
    finally:
        carrier.close()


def main():
    """Run until shut down; without the library, or with a wrong endpoint, exit with 1 and why."""
    options = parse(rospy.myargv()[1:])
    if options.side == 'router':
        route(options)
        return
    limit_peers()
    if rospy.get_namespace() == '/':
        # Started by hand. On the host it has to be a node of the robot; rospy knows its namespace
        # from the start only.
        os.execv(sys.argv[0], sys.argv + ['__ns:=/' + options.name])
    init_node('mhri_link', disable_rostime=True)
    log.install()
    note = Note(options.router or options.connect or options.listen, bool(options.router))
    try:
        keys, carrier = call(options)
    except (CarrierError, KeysError, LibraryMissing) as error:
        rospy.logfatal('%s', error)
        if options.side == 'host':
            note.failed('library' if isinstance(error, LibraryMissing) else
                        'keys' if isinstance(error, KeysError) else 'endpoint', error)
        sys.exit(1)
    if keys:
        rospy.loginfo('%s: linked by keys alone; here is the key of %s', options.name,
                      keys.keys.own)
    else:
        rospy.logwarn('%s: linked without keys: whoever reaches the endpoint can drive the robot '
                      '(mhri_keys.sh makes keys)', options.name)
    watch = MasterWatch().start()
    own = keys.keys.own if keys else None
    if options.side == 'host':
        host = own or marked(options.host, facts())
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
    # A thread of zenoh that waits for Python while Python ends aborts the process.
    logging.shutdown()
    os._exit(0)

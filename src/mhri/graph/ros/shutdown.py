# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Start of a node, and its shutdown by a signal at any time, even during the start."""
import atexit
import os
import signal
import socket
import sys
import threading

import rospy

from mhri.graph.ros import log
from mhri.graph.ros.master_api import master_uri, MasterError
from mhri.graph.ros.master_watch import log_without_master
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.rospy_inside import end_by_own_name, ended_by_hand, name_in

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Maximum delay of Python's exit by a shutdown [s] (mhri.graph.ros.log ends the program itself), and
# the shorter time before the node exists.
_PATIENCE_S, _UNBORN_S = 10.0, 2.0


def start_node(name, namespace='/', **options):
    """Start the node of a program: neither peers nor its log can block it, and it ends in time.

    :param namespace, options: those of :func:`init_node`
    :returns: function that returns whether it was ended by ``rosnode kill``, see
        :func:`mhri.graph.ros.rospy_inside.ended_by_hand`
    """
    limit_peers()
    init_node(name, namespace, **options)
    log.install()
    return ended_by_hand()


def init_node(name, namespace='/', **options):
    """Call ``rospy.init_node``; SIGINT, SIGTERM and SIGHUP then shut the node down on a thread.

    :param namespace: of the node, whatever ``ROS_NAMESPACE`` says; None for a robot's node, which
        is where it was started

    rospy does so in the signal handler, on the main thread. If that thread is calling the master,
    or holds a lock that a shutdown hook needs, it would deadlock; if it is about to sleep, as
    ``rospy.spin`` does for half a second at a time, robots would drive on for that long. Closing
    the terminal (SIGHUP) would end the node without its last messages.

    A node that is not up 2 s after a signal has published nothing yet, and is ended immediately.
    The program exits with the reason if ``ROS_MASTER_URI`` cannot be used.
    """
    try:
        master_uri()
    except MasterError as error:
        sys.exit('{} cannot start: {}'.format(name, error))
    # Python writes the number of a signal there at once, on whichever thread.
    receives, sends = socket.socketpair()
    sends.setblocking(False)
    signal.set_wakeup_fd(sends.detach(), warn_on_full_buffer=False)
    for number in _ENDS:
        signal.signal(number, lambda *_: None)
    there, begun, over = threading.Event(), threading.Event(), threading.Event()

    def shut_down():
        number = receives.recv(1)[0]
        while number not in _ENDS:
            number = receives.recv(1)[0]
        begun.set()
        if not there.wait(_UNBORN_S):
            # Without a master, rospy.init_node waits for ever and holds what a shutdown needs.
            os._exit(128 + number)
        rospy.signal_shutdown('signal-{}'.format(number))
        over.set()

    threading.Thread(target=shut_down, name='ending', daemon=True).start()
    end_by_own_name()
    # Python's exit must wait for a shutdown in progress. Until then the thread reads signals.
    atexit.register(lambda: begun.is_set() and over.wait(_PATIENCE_S) and receives.close())
    given = name_in(namespace) if namespace else None
    rospy.init_node(name, disable_signals=True, **options)
    if given and given != rospy.get_namespace():
        _take_parameters(given + rospy.get_name().rpartition('/')[2])
    log_without_master()
    there.set()


def _take_parameters(given):
    """Copy the node's parameters from where a launch file set them: a limit must not get lost.

    Those of the command line stay. '' is left out: what is kept for a next process begins so.
    """
    typed = {word[1:].partition(':=')[0] for word in sys.argv if word.startswith('_')}
    values = rospy.get_param(given, None)
    for key in set(values) - typed if isinstance(values, dict) else ():
        if values[key] != '':
            rospy.set_param('~' + key, values[key])

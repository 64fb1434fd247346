# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a node ends that is told to by a signal: at any moment, also while it starts."""
import atexit
import os
import signal
import socket
import threading

import rospy

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# A shutdown keeps Python's end for this long at most [s]; the program itself is ended by
# mhri.graph.ros.log, and before the node is there after the shorter time.
_PATIENCE_S, _UNBORN_S = 10.0, 2.0


def init_node(name, **options):
    """Call ``rospy.init_node``; SIGINT, SIGTERM and SIGHUP then shut the node down on a thread.

    rospy does so in the handler of the signal, on the main thread. Where that asks the master just
    then, or holds a lock that a shutdown hook takes, it would wait for itself for ever; where it is
    about to fall asleep, as ``rospy.spin`` does for half a second at a time, robots would drive on
    so long. Closing the terminal (SIGHUP) would end the node without its last words.

    A node that is not there 2 s after a signal has said nothing yet, and ends as it is.
    """
    # Python writes the number of a signal there at once, on whichever thread.
    hears, speaks = socket.socketpair()
    speaks.setblocking(False)
    signal.set_wakeup_fd(speaks.detach(), warn_on_full_buffer=False)
    for number in _ENDS:
        signal.signal(number, lambda *_: None)
    there, begun, over = threading.Event(), threading.Event(), threading.Event()

    def shut_down():
        number = hears.recv(1)[0]
        while number not in _ENDS:
            number = hears.recv(1)[0]
        begun.set()
        if not there.wait(_UNBORN_S):
            # Without a master, rospy.init_node waits for ever and holds what a shutdown needs.
            os._exit(128 + number)
        rospy.signal_shutdown('signal-{}'.format(number))
        over.set()

    threading.Thread(target=shut_down, name='ending', daemon=True).start()
    # What it has begun, it finishes: Python's end would cut it off. Until then it hears.
    atexit.register(lambda: begun.is_set() and over.wait(_PATIENCE_S) and hears.close())
    rospy.init_node(name, disable_signals=True, **options)
    there.set()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen whose terminal takes nothing (Ctrl-S, a pipe that nobody reads) goes on all the same."""
import os
import signal
import subprocess
import sys
import time

import rospy

from mhri.msg import RobotSelect
from support import graph
from support.ros_system import stuck_terminal, System, wait_for


def logged(system):
    """Return the files that a screen has logged to, as one text."""
    folder, text = system.env['ROS_LOG_DIR'], ''
    for name in os.listdir(folder):
        if 'panel' in name:
            with open(os.path.join(folder, name), encoding='utf-8') as stream:
                text += stream.read()
    return text


def start_panel(system, terminal):
    """Start the real one; it has something to say before it has a node, and later."""
    settings = os.path.join(system.home, 'panel.json')
    with open(settings, 'w', encoding='ascii') as stream:
        stream.write('no settings')
    rospy.set_param('/bot1/robot_type', 'generic')
    rospy.set_param('/bot1/mhri/window', 'no.such.Window')
    # Without such a folder Qt says so, and nobody can keep that from the terminal.
    os.mkdir(os.path.join(system.home, 'run'), 0o700)
    return subprocess.Popen(
        [sys.executable, '-c', 'from mhri.nodes.panel import main; main()', '--settings', settings,
         '--select', 'bot1'], env=dict(system.env, XDG_RUNTIME_DIR=system.home + '/run'),
        stdin=subprocess.DEVNULL, stdout=terminal, stderr=terminal)


def test_its_gui_thread_waits_for_no_terminal():
    """That thread repeats the selection, twice a second."""
    with System() as system, stuck_terminal() as terminal:
        system.screen()
        system.start_master()
        rospy.init_node('stuck_terminal_test', disable_signals=True)
        system.node('mux', '__name:=mux')
        selections = []
        rospy.Subscriber(graph.SELECT, RobotSelect,
                         lambda message: selections.append((time.monotonic(), message.robots)))
        panel = start_panel(system, terminal)
        try:
            wait_for(lambda: selections and selections[-1][1] == ['bot1'], what='the screen')
            wait_for(lambda: 'no.such' in logged(system), what='what it says of the window')
            said = time.monotonic()
            wait_for(lambda: sum(at > said for at, _ in selections) > 5, what='its selection')
            panel.send_signal(signal.SIGTERM)
            assert panel.wait(60) == 0
        finally:
            panel.kill()
            panel.wait()
            rospy.signal_shutdown('done')

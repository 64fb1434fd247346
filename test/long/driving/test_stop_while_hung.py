# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""STOP by a real click and real keys while a view of the real panel blocks the GUI thread."""
import contextlib
import json
import os
import subprocess
import sys
import threading
import time

import pytest

from mhri.screen.presenters.stop_watch_process import STOPPED
from support import graph
from support.ros_system import child_processes, insist, System, wait_for
from support.stuck_panel import HANGS

SUPPORT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'support')
TIMEOUT_S = 60.0
# At the longest; what is to be seen while it hangs has been by then.
HANG_S = 60.0


def xdotool(*words):
    """Do something by hand; return the words of the answer."""
    return subprocess.run(('xdotool',) + tuple(map(str, words)), stdout=subprocess.PIPE,
                          universal_newlines=True, timeout=TIMEOUT_S).stdout.split()


def pass_time(span_s):
    """Let some time pass, which is part of what happens here."""
    time.sleep(span_s)


class Desk:
    """An operator before a panel that can be made to hang, with a robot that a pedal drives."""

    def __init__(self, system, folder):
        import rospy
        from sensor_msgs.msg import Joy
        from std_msgs.msg import Bool
        from mhri.msg import ControlMode
        from support.velocity import VelocityEnd
        self._folder = str(folder)
        self._axes, self.done = [0.0, 0.0], threading.Event()
        self._stops = []
        self.robot = VelocityEnd('/bot1/cmd_vel')
        rospy.Subscriber(graph.STOP_ALL, Bool, self._on_stop, tcp_nodelay=True)
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._joy = rospy.Publisher(graph.PEDAL, Joy, queue_size=1, tcp_nodelay=True)
        self._thread = threading.Thread(target=self._press_pedal, daemon=True)
        self._thread.start()
        self.panel = system.start(sys.executable, os.path.join(SUPPORT, 'stuck_panel.py'),
                                  self._folder, '--fresh', '--select', 'bot1')
        self.window = wait_for(lambda: xdotool('search', '--onlyvisible', '--name', '^mhri$'),
                               TIMEOUT_S, 'the window', poll_s=0.1)[0]
        self._mode.publish(source='pedal')
        self.watch = wait_for(self._find_watch, TIMEOUT_S, 'the watch', poll_s=0.1)

    def _find_watch(self):
        """Return the process of the watch once its line to the mux is up."""
        return next((process for process in child_processes('stop_watch', self.panel.pid)
                     if process.connections()), None)

    def _press_pedal(self):
        from sensor_msgs.msg import Joy
        while not self.done.wait(0.02):
            self._joy.publish(Joy(axes=list(self._axes)))

    def _on_stop(self, message):
        self._stops.append((time.monotonic(), message.data))

    def stopped_at(self, since):
        """Return when stop-all was first in force after a time [s, monotonic], or None."""
        return next((at for at, stopped in list(self._stops) if stopped and at >= since), None)

    def path(self, name):
        return os.path.join(self._folder, name)

    def is_stuck(self):
        return os.path.exists(self.path('stuck'))

    def place(self):
        """Return where the stop button is, once it is shown [px]."""
        def read():
            with contextlib.suppress(OSError), open(self.path('place')) as file:
                return json.load(file)
        return wait_for(read, TIMEOUT_S, 'the stop button to be shown', poll_s=0.05)

    def drive(self):
        """Drive the robot, from neutral on.

        Once the screen is back it does itself what was pressed while it hung: that stop is released
        here as well.
        """
        def drives():
            self._axes[1] = 0.0
            if not self.release():
                return False
            begun = time.monotonic()
            self._axes[1] = 0.5
            return wait_for(lambda: any(forward for _, forward, _ in self.robot.after(begun)), 1.0,
                            'the robot to move', poll_s=0.01)
        insist(drives, 'the pedal to drive the robot', TIMEOUT_S, poll_s=0.1)

    def release(self):
        """Release stop-all; tell whether it is."""
        import rospy
        from std_srvs.srv import SetBool
        return rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(False).success

    def hang(self, how):
        """Let the view hang; return once it has for 0.5 s: the lease of the robot still runs."""
        with open(self.path('todo'), 'w') as file:
            file.write(str(HANG_S))
        os.rename(self.path('todo'), self.path(how))
        wait_for(self.is_stuck, TIMEOUT_S, 'the view to hang')
        pass_time(0.5)
        assert not self._stops[-1][1]

    def wait_stop(self, since):
        """Wait for stop-all, which must come while the view hangs; return when."""
        when = wait_for(lambda: self.stopped_at(since), TIMEOUT_S, 'stop-all')
        assert self.is_stuck(), 'stop-all came only when the view hung no more'
        return when

    def recover(self):
        """End the hang, with the pedal at rest."""
        self._axes[1] = 0.0
        open(self.path('end'), 'w').close()
        wait_for(lambda: not self.is_stuck(), TIMEOUT_S, 'the end of the hang')
        os.remove(self.path('end'))
        # By then the screen has done itself what was pressed, and shows that it is stopped.
        pass_time(0.6)
        if os.path.exists(self.path('place')):
            os.remove(self.path('place'))
        wait_for(lambda: self.release() and os.path.exists(self.path('place')), TIMEOUT_S,
                 'the release', poll_s=0.2)

    def said(self):
        """Return what the panel has logged."""
        with open(self.panel.log, errors='replace') as log:
            return log.read()


@pytest.fixture(scope='module')
def desk(tmp_path_factory):
    import rospy
    with System() as system:
        system.screen()
        system.start_master()
        # As the node of the pedal: it may choose the mode.
        rospy.init_node('mhri_pedal', disable_signals=True)
        system.node('mux', '__name:=mux')
        system.env['ROS_NAMESPACE'] = '/bot1'
        system.start(sys.executable, os.path.join(SUPPORT, 'plain_robot.py'), 'cmd_vel', 'odom',
                     '__name:=base')
        del system.env['ROS_NAMESPACE']
        made = Desk(system, tmp_path_factory.mktemp('desk'))
        yield made
        made.done.set()
        rospy.signal_shutdown('done')


def click(place):
    """Press the left button and let it go at once."""
    xdotool('mousemove', *place, 'mousedown', 1, 'mouseup', 1)


@pytest.mark.parametrize('how, by', zip(sorted(HANGS), ['click', 'keys']))
def test_stop_works_while_a_view_hangs(desk, how, by):
    xdotool('windowfocus', '--sync', desk.window)
    desk.drive()
    place = desk.place()
    desk.hang(how)
    told = desk.said().count(STOPPED)
    pressed = time.monotonic()
    if by == 'click':
        click(place)
    else:
        xdotool('key', 'shift+space')
    stopped = desk.wait_stop(pressed)
    zero = wait_for(lambda: next((at for at, forward, turn in desk.robot.after(pressed)
                                  if not forward and not turn), None), TIMEOUT_S, 'the zero')
    last = max(at for at, forward, _ in desk.robot.received if forward)
    print('\nMEASURED screen hung ({}), STOP by {}: in force after {:.0f} ms, the robot has its '
          'zero after {:.0f} ms (last command {:.0f} ms after the press)'.format(
              how, by, *(1e3 * (at - pressed) for at in (stopped, zero, last))))
    desk.recover()
    wait_for(lambda: desk.said().count(STOPPED) > told, TIMEOUT_S,
             'the panel to say so')


def test_the_watch_ends_with_the_panel(desk):
    System.kill(desk.panel, family=False)
    wait_for(lambda: not desk.watch.is_running(), TIMEOUT_S, 'the watch to end')

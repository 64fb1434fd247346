# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the page does on the ROS graph; nothing here blocks the server's loop.

Publishes ``/mux_in/web`` (``sensor_msgs/Joy``: axes[0] left, axes[1] ahead, axes[2] sideways,
left; each -1 to 1), one for each valid frame of the viewer that holds the stick, and one zero when
it lets go; ``/mhri_web/head`` (``mhri/Accessory``: the robot looked at; ``value`` pan and tilt
[rad]) and ``/mhri_web/state`` (``mhri/WebState``, latched). Calls ``/mux/set_stop_all``.
"""
import threading
import time

import rospy
from sensor_msgs.msg import Joy

from mhri.driving.ros.stop_line import LOOK_S, StopLine
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.worker import Worker
from mhri.msg import Accessory, WebLink, WebState, WebViewer
from mhri.web.io.certificate import keep_rows
from mhri.web.io.hub import Outputs

# Lines of the log in a second.
MAX_LINES = 5


class RosOutputs(Outputs):
    """The outputs of the node.

    :param path: the file of the links
    :param on_watched: called with whether anybody watches, on change
    """

    def __init__(self, path, on_watched):
        self._path, self._on_watched = path, on_watched
        self._watched = False
        self.address = self.problem = ''
        self._lines = []
        self._joy = NonBlockingPublisher('/mux_in/web', Joy)
        self._head = NonBlockingPublisher('/mhri_web/head', Accessory)
        self._state = rospy.Publisher('/mhri_web/state', WebState, queue_size=1, latch=True)
        self._line = StopLine(rospy.get_name())
        self._stop = threading.Event()
        self._stopper = Worker('web_stop', self._keep_stopping, LOOK_S).start()

    def stick(self, turn, ahead, sideways):
        """Publish the stick."""
        message = Joy(axes=[turn, ahead, sideways], buttons=[])
        message.header.stamp = rospy.Time.now()
        self._joy.publish(message)

    def stop(self, who):
        """Engage stop-all; repeat the request until the drive answers."""
        self._stop.set()
        self._stopper.do(self._keep_stopping)

    def _keep_stopping(self):
        """Send a stop that is not answered yet; else connect in advance."""
        if not self._stop.is_set():
            self._line.connect()
        elif self._line.call(True)[0]:
            self._stop.clear()

    def head(self, robot, pan, tilt):
        """Ask the operator's screen to turn the head of a robot [rad]."""
        self._head.publish(Accessory([robot], 'head', '', [pan, tilt]))

    def show(self, links, viewers, pictures_hz, looked_at):
        """Publish the state."""
        message = WebState(address=self.address, problem=self.problem, pictures_hz=pictures_hz,
                           looked_at=looked_at)
        message.header.stamp = rospy.Time.now()
        message.links = [WebLink(link.id, link.label, link.role, link.may_stop, link.head,
                                 rospy.Time.from_sec(link.expires_s)) for link in links]
        message.viewers = [
            WebViewer(viewer.name, viewer.link.id, viewer.link.label, viewer.address,
                      rospy.Time.from_sec(viewer.since_s), holds, viewer.pacing.rate_hz(),
                      viewer.pacing.thinned()) for viewer, holds in viewers]
        self._state.publish(message)
        if self._watched != (pictures_hz > 0.0):
            self._watched = not self._watched
            self._on_watched(self._watched)

    def keep(self, rows):
        """Keep the links in the file."""
        try:
            keep_rows(self._path, rows)
        except OSError as error:
            self.log('the links are not kept: {}'.format(error))

    def log(self, text):
        """Log a line, unless there were many just now."""
        now = time.monotonic()
        self._lines = [at for at in self._lines if at > now - 1.0]
        if len(self._lines) < MAX_LINES:
            self._lines.append(now)
            rospy.logwarn('%s', text)

    def close(self):
        """Stop the thread; return at once."""
        self._stopper.stop()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns a robot's camera where the wearer of a headset looks, as a drag in the picture does.

Subscribes ``/mhri_web/head`` (``mhri/Accessory``: the robot looked at, and how far the headset is
turned to the left and up [rad]), of the node that serves ``/mhri_web/give`` alone. Each message
becomes one request to the drive at once, on the thread that receives it: the drive decides, and
releases the head when they cease.
"""
import time

from mhri.accessories.controls import aim_share, head_of, why_not
from mhri.base.accessories import HELD, POSITION
from mhri.base.part import Part
from mhri.base.views import ScreenView

# Without a newer view the screen hangs: nothing is passed on. After how long another message begins
# a new use, which is an event [s].
HANG_S, AGAIN_S = 1.0, 10.0


class HeadPresenter(Part):
    """Passes on where a headset looks.

    :param use: function of (robots, key, choice, value) that uses an accessory, from any thread
    :param note: function of (kind, text, robot, data) that reports an event, on the GUI thread
    :param holds: function of (robot, key) that says whether the operator holds an accessory: the
        operator comes first
    :param clock: returns monotonic seconds
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        # Imported here, so that the rest can be tested without ROS.
        from mhri.graph.ros.node_client import NodeClient
        from mhri.msg import Accessory
        part = cls(context.backend.use_accessory, context.note, context.parts['accessories'].holds)
        part.client = NodeClient('headset', '/mhri_web/give')
        part.client.do(lambda: part.client.subscribe('/mhri_web/head', Accessory, part.on_head))
        part.client.start()
        return part

    def __init__(self, use, note, holds, clock=time.monotonic):
        self._use, self._note, self._holds, self._clock = use, note, holds, clock
        self._view, self._viewed_at = ScreenView(), -HANG_S
        self._replay = False
        # The (robot, its head) that a headset turned last, and when; the one that was reported.
        self._turned, self._turned_at, self._reported = None, 0.0, None
        self.client = None

    def on_head(self, message):
        """Handle where a headset looks (``mhri/Accessory``); on any thread."""
        view, now = self._view, self._clock()
        robot = next((one for one in view.robots if [one.name] == message.robots), None)
        head = head_of(robot.accessories) if robot else None
        if head is None or self._replay or now - self._viewed_at >= HANG_S \
                or head.spec.mode != POSITION or why_not(view, robot, head) \
                or not len(head.value) == len(message.value) == HELD[head.spec.kind] \
                or self._holds(robot.name, head.spec.key):
            return
        self._use([robot.name], head.spec.key, '', aim_share(head, *message.value))
        self._turned, self._turned_at = (robot.name, head.spec.key), now

    def show_view(self, view):
        """Store the current :class:`mhri.base.views.ScreenView`; report what began to turn."""
        self._view, self._viewed_at = view, self._clock()
        turned = self._turned if self._viewed_at - self._turned_at < AGAIN_S else None
        if turned not in (None, self._reported):
            self._note('accessory.used', '{} follows a headset'.format(turned[1]), turned[0],
                       {'key': turned[1]})
        self._reported = turned

    def disable(self):
        """Turn nothing: the screen shows a replay."""
        self._replay = True

    def close(self, forget=False):
        """Stop listening."""
        if self.client is not None:
            self.client.close(forget)

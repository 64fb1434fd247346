# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the mux learns from the gates: the stop they remember, the operator, a sign of life."""
import rospy

from mhri.base.pulse import Neighbour
from mhri.driving.stop_echo import StopEcho
from mhri.graph.ros.in_force import InForce, TAKE_SERVICE
from mhri.graph.ros.rospy_inside import caller_of
from mhri.msg import GatesState


class GatesWatch:
    """Subscribes ``/gates/state`` (``mhri/GatesState``), and believes only the gates in force.

    :param on_state: called on rospy's threads with (the mux must stop, operator if that is a new
        one, else '', ``mhri/DriveSettings``)
    :param is_stopped: returns whether the mux is stopped
    :param hold: called when the gates are others than before, and by :meth:`look` when they have
        been silent for 0.9 s
    :param strangers: :class:`mhri.graph.ros.in_force.Strangers`, for who poses as the gates
    """

    def __init__(self, on_state, is_stopped, hold, strangers, clock):
        self._on_state = on_state
        self._is_stopped = is_stopped
        self._clock = clock
        self._echo = StopEcho()
        #: caller id of the operator in control, as the gates said last; '' for nobody
        self.operator = ''
        self._force = InForce(TAKE_SERVICE, strangers.refuse, lambda caller: hold())
        self._hold = hold
        self._neighbour = Neighbour('the gates')

    def start(self):
        """Begin to listen."""
        self._force.subscribe('/gates/state', GatesState, self._on_message, queue_size=1,
                              tcp_nodelay=True)
        self._force.start()

    def stop(self):
        """End the thread; returns at once."""
        self._force.stop()

    def in_control(self, caller):
        """Tell whether a node may be the operator in control, by what the gates have said."""
        return self.operator in ('', caller)

    def words(self):
        """Return what is known about the gates, in words."""
        return self._neighbour.words(self._clock())

    def look(self, now):
        """Look whether the gates are heard; call it at least every 0.4 s."""
        news = self._neighbour.look(now)
        if news and self._neighbour.silent:
            self._hold()
        if news:
            rospy.logwarn('%s', news)

    def on_release(self):
        """Note that the operator has released the stop at this mux."""
        self._echo.on_release(self._clock())

    def _on_message(self, message):
        self._neighbour.beat(caller_of(message), self._clock())
        took, self.operator = message.operator != self.operator, message.operator
        self._on_state(
            self._echo.must_stop(message.stop_all, self._is_stopped(), self._clock()),
            message.operator if took else '', message.settings)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the gates say about themselves: ``/gates/state`` and ``/diagnostics``."""
import threading
import time

from diagnostic_msgs.msg import DiagnosticStatus
import rospy

from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.msg import GatesState

PERIOD_S = 0.5
# Changes in quick succession are told together.
LEAST_S = 0.02


class GatesSpeaker:
    """A thread that publishes ``mhri/GatesState``, latched, on change and at 2 Hz.

    :param read: :meth:`mhri.driving.ros.gates.Gates.read`
    :param mux_heard: function telling whether the mux was heard within the last second
    :param beat: called whenever it has published
    """

    def __init__(self, read, mux_heard, beat=lambda: None, clock=time.monotonic):
        self._read = read
        self._mux_heard = mux_heard
        self._beat = beat
        self._clock = clock
        self._changed = threading.Event()
        self._publisher = rospy.Publisher('/gates/state', GatesState, queue_size=1, latch=True,
                                          tcp_nodelay=True)

    def start(self):
        """Begin; returns at once."""
        threading.Thread(target=self._run, name='gates_state', daemon=True).start()
        publish_diagnostics({'gates': self._diagnose})
        return self

    def on_change(self):
        """Publish soon; returns at once."""
        self._changed.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait(PERIOD_S)
            self._changed.clear()
            try:
                self._publisher.publish(self.message())
            except rospy.ROSException:
                return  # the node has just ended
            self._beat()
            time.sleep(LEAST_S)

    def message(self):
        """Return the ``mhri/GatesState`` of this moment."""
        facts = self._read()
        since, now = facts.pop('since'), time.time()
        message = GatesState(**facts)
        message.header.stamp = rospy.Time.from_sec(now)
        message.mux_heard = self._mux_heard()
        if message.operator:
            message.since = rospy.Time.from_sec(now - (self._clock() - since))
        return message

    def _diagnose(self, status):
        """Fill the diagnostic status of the gates."""
        message = self.message()
        standing = [gate.name for gate in message.robots if gate.obeys and gate.stands]
        if message.refused:
            status.summary(DiagnosticStatus.WARN, 'refused: ' + message.refused[0])
        elif message.mux and not message.mux_heard:
            status.summary(DiagnosticStatus.ERROR, 'the mux is silent')
        elif message.stop_all:
            status.summary(DiagnosticStatus.WARN, 'stop-all is in force')
        else:
            status.summary(DiagnosticStatus.OK, 'in control: ' + (message.operator or 'nobody'))
        status.add('mux', message.mux or 'none')
        status.add('operator', message.operator or 'nobody')
        status.add('kept standing', ', '.join(standing) or 'none')
        for line in message.refused:
            status.add('refused', line)
        for gate in message.robots:
            status.add(gate.name, '{}{}, {}'.format(gate.obeys or 'obeys nobody', gate.stands and
                                                    ' ({})'.format(gate.stands),
                                                    gate.topic or 'not reached'))
        return status

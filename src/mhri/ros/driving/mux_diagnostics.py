# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the mux tells ``/diagnostics``: who drives, what is waited for, what was refused."""
from diagnostic_msgs.msg import DiagnosticStatus

from mhri.ros.diagnostics import publish_diagnostics


class MuxDiagnostics:
    """Publishes ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` at 1 Hz.

    :param arbiter: read under ``lock``
    :param suspender: :class:`mhri.ros.driving.suspender.Suspender`
    """

    def __init__(self, arbiter, lock, suspender, clock, config):
        self._arbiter = arbiter
        self._lock = lock
        self._suspender = suspender
        self._clock = clock
        self._config = config
        self._refused_before = 0
        self._done = None

    def start(self):
        """Begin publishing, on a thread of its own."""
        self._done = publish_diagnostics({'driving': self._driving, 'sources': self._sources})

    def stop(self):
        """End publishing; returns at once."""
        if self._done:
            self._done.set()

    def _driving(self, status):
        """Fill the status of the driving rule."""
        with self._lock:
            arbiter = self._arbiter
            state, waits = arbiter.state, arbiter.waits_for(self._clock())
            linear, angular = arbiter.limits
            refused = dict(arbiter.refused)
            status.add('mode', arbiter.mode)
            status.add('last cause', arbiter.cause)
        total = sum(refused.values())
        if total > self._refused_before:
            status.summary(DiagnosticStatus.WARN, '{} unusable messages in the last second'.format(
                total - self._refused_before))
        elif state == 'stopped':
            status.summary(DiagnosticStatus.WARN, 'stop-all is in force')
        else:
            status.summary(DiagnosticStatus.OK, state)
        self._refused_before = total
        status.add('state', state)
        status.add('waits for', waits or 'nothing')
        status.add('speed limit', '{:.2f} m/s, {:.2f} rad/s'.format(linear, angular))
        status.add('refused', total)
        for kind in sorted(refused):
            status.add('refused: ' + kind.replace('_', ' '), refused[kind])
        return status

    def _sources(self, status):
        """Fill the status of the sources."""
        with self._lock:
            ignored = dict(self._arbiter.ignored)
            active = self._arbiter.mode
        status.summary(DiagnosticStatus.OK, 'driving with ' + active)
        for source in self._config.sources:
            words = 'active' if source.name == active else 'ignored {} messages'.format(
                ignored.get(source.name, 0))
            service = source.suspend_service
            if service:
                words += '; {}: {}'.format(service, self._suspender.state(service))
            status.add(source.name, words)
        return status

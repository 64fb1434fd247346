# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics of the mux on ``/diagnostics``: operator, missing input, refused messages."""
from diagnostic_msgs.msg import DiagnosticStatus

from mhri.base.reasons import Reason, STOPPED
from mhri.graph.ros.diagnostics import publish_diagnostics


class MuxDiagnostics:
    """Publishes ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` at 1 Hz.

    :param drive: :class:`mhri.driving.drive.Drive`, read under ``lock``
    :param topics: {source: :class:`mhri.driving.ros.source_topic.SourceTopic`}
    :param words: {'suspend': function that returns the state of a service, 'strangers': function
        that returns the refused nodes}
    """

    def __init__(self, drive, lock, clock, config, topics, words):
        self._drive = drive
        self._lock = lock
        self._clock = clock
        self._config = config
        self._topics = topics
        self._words = words
        self._refused_before = 0
        self._done = None

    def start(self):
        """Start publishing on a separate thread."""
        self._done = publish_diagnostics({'driving': self._driving, 'sources': self._sources})

    def stop(self):
        """Stop publishing; return at once."""
        if self._done:
            self._done.set()

    def _driving(self, status):
        """Fill in the status of the driving rules."""
        with self._lock:
            arbiter, relay = self._drive.arbiter, self._drive.relay
            state, waits = arbiter.state, self._drive.waits_for(self._clock())
            linear, angular = arbiter.limits
            refused = dict(arbiter.refused)
            status.add('mode', arbiter.mode)
            status.add('last cause', arbiter.cause)
            status.add('operator', self._drive.lease.operator or 'nobody')
            tasks = {'refused: ' + kind: count for kind, count in relay.refused.items()}
            tasks.update(('held back: ' + kind, count) for kind, count in relay.held.items())
            robots = [(name, rule.obeys, self._drive.stop_reason(name))
                      for name, rule in self._drive.robots.items()]
        total = sum(refused.values())
        if total > self._refused_before:
            status.summary(DiagnosticStatus.WARN, '{} unusable messages in the last second'.format(
                total - self._refused_before))
        elif state == 'stopped':
            status.summary(DiagnosticStatus.WARN, Reason(STOPPED).what)
        else:
            status.summary(DiagnosticStatus.OK, state)
        self._refused_before = total
        status.add('dead-man buttons', 'must be held' if self._config.dead_man else
                   'turned off by the parameter dead_man')
        for kind, count in sorted(tasks.items()):
            status.add('tasks ' + kind, count)
        for name, obeys, stands in robots:
            status.add(name, '{}{}'.format(obeys or 'obeys nobody', stands and ' ({})'.format(
                Reason(stands).what)))
        for words in self._words['strangers']():
            status.add('refused', words)
        status.add('state', state)
        status.add('waits for', waits or 'nothing')
        status.add('speed limit', '{:.2f} m/s, {:.2f} rad/s'.format(linear, angular))
        status.add('refused', total)
        for kind in sorted(refused):
            status.add('refused: ' + kind.replace('_', ' '), refused[kind])
        return status

    def _sources(self, status):
        """Fill in the status of the sources."""
        with self._lock:
            ignored = dict(self._drive.arbiter.ignored)
            active = self._drive.mode
            owners = {name: self._drive.owner(name) for name in self._topics}
            refusal = self._topics[active].refusal
        status.summary(DiagnosticStatus.WARN if refusal else DiagnosticStatus.OK,
                       'driving with ' + active + (': ' + refusal if refusal else ''))
        for source in self._config.sources:
            words = 'active' if source.name == active else 'ignored {} messages'.format(
                ignored.get(source.name, 0))
            service = source.suspend_service
            if service:
                words += '; {}: {}'.format(service, self._words['suspend'](service))
            status.add(source.name, words)
            if owners[source.name]:
                status.add(source.name + ': listened to', owners[source.name])
        return status

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the mux publishes on ``/diagnostics``: who drives, what it waits for, what it refused."""
from diagnostic_msgs.msg import DiagnosticStatus

from mhri.graph.ros.diagnostics import publish_diagnostics


class MuxDiagnostics:
    """Publishes ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` at 1 Hz.

    :param arbiter: read under ``lock``
    :param topics: {source: :class:`mhri.driving.ros.source_topic.SourceTopic`}
    :param words: {'gates': function that returns a sentence, 'suspend': one that returns the state
        of a service, 'tasks': one that returns {words: count}, 'strangers': one that returns who
        was not believed}
    """

    def __init__(self, arbiter, lock, clock, config, topics, words):
        self._arbiter = arbiter
        self._lock = lock
        self._clock = clock
        self._config = config
        self._topics = topics
        self._words = words
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
        status.add('dead-man buttons', 'must be held' if self._config.dead_man else
                   'turned off by the parameter dead_man')
        status.add('gates', self._words['gates']())
        for kind, count in sorted(self._words['tasks']().items()):
            status.add('tasks ' + kind, count)
        for words in self._words['strangers']():
            status.add('not believed', words)
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
            ownership = self._topics[source.name].ownership
            if ownership.owner:
                status.add(source.name + ': listened to', ownership.owner)
        return status

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's ``/diagnostics``: links of robots, and rejected senders."""
from diagnostic_msgs.msg import DiagnosticStatus

from mhri.base.views import LIVE
from mhri.graph.ros.diagnostics import publish_diagnostics


class PanelDiagnostics:
    """Publishes ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` at 1 Hz.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param strangers: :class:`mhri.graph.ros.service_owner.RejectedSenders`
    """

    def __init__(self, operator, strangers):
        self._operator = operator
        self._strangers = strangers
        self._done = None

    def start(self):
        """Start to publish, on its own thread."""
        self._done = publish_diagnostics({'robots': self._robots})
        return self

    def stop(self):
        """Stop; return at once."""
        self._done.set()

    def _robots(self, status):
        """Fill the status of the robots in the list."""
        views = [self._operator.robot_view(name) for name in self._operator.selection.robots]
        lost = [view.name for view in views if view.selected and view.link != LIVE]
        if lost:
            status.summary(DiagnosticStatus.WARN, 'selected but not live: ' + ', '.join(lost))
        else:
            status.summary(DiagnosticStatus.OK, '{} robots, {} selected'.format(
                len(views), sum(view.selected for view in views)))
        for view in views:
            status.add(view.name, '{}, {}{}'.format(
                view.type_label or 'type unknown', view.link,
                ', ' + view.note if view.note else ''))
            feeds = self._operator.feeds(view.name)
            for words, count in sorted(feeds.refused().items()) if feeds else ():
                status.add('{}: {} refused'.format(view.name, words), count)
        for words in self._strangers.words():
            status.add('rejected', words)
        return status

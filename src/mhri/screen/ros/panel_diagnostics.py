# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's ``/diagnostics``: its robots' links, and whom it did not believe."""
from diagnostic_msgs.msg import DiagnosticStatus

from mhri.base.views import LIVE
from mhri.graph.ros.diagnostics import publish_diagnostics


class PanelDiagnostics:
    """Publishes ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` at 1 Hz.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param clients: the clients of gates and mux, whose ``strangers`` were not believed
    """

    def __init__(self, operator, *clients):
        self._operator = operator
        self._clients = clients
        self._done = None

    def start(self):
        """Begin publishing, on a thread of its own."""
        self._done = publish_diagnostics({'robots': self._robots})
        return self

    def stop(self):
        """End; returns at once."""
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
        for client in self._clients:
            for words in client.strangers.words():
                status.add('not believed', words)
        return status

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the referee of a drill to the screen; everything here runs on the GUI thread."""
from mhri.base.part import Part
from mhri.base.views import ROS_CONNECTED
from mhri.drill.gui.drill_line import DrillLine
from mhri.drill.ros.state import DrillClient
from mhri.drill.view import drill_changes, drill_texts


class DrillPresenter(Part):
    """The drill on one screen, live or replayed: its line and its events.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param note: function of (kind of event, sentence)
    :param client: :class:`mhri.drill.ros.state.DrillClient`
    :param wall: function that returns the time of day [s], in a replay that of the recording
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen, context.note, DrillClient(), context.backend.wall)

    def __init__(self, screen, note, client, wall):
        self.line, self._note = DrillLine(screen.foot), note
        screen.words_column.insertWidget(0, self.line)
        self._client, self._wall = client, wall
        self._started = False
        self._seen = None

    def show_view(self, view):
        """Handle the current :class:`mhri.base.views.ScreenView`."""
        if not self._started and view.ros == ROS_CONNECTED:
            self._started = True
            self._client.start()
        drill, now = self._client.view(), self._wall()
        if drill is None:
            return
        self.line.show_drill(drill_texts(drill, now), drill.about, drill.silent(now))
        for kind, text in drill_changes(self._seen, drill):
            self._note(kind, text)
        self._seen = drill

    def close(self, forget=False):
        """Unsubscribe."""
        self._client.close()

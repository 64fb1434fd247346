# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the page of faults to simulated robots; everything here runs on the GUI thread."""
from mhri.base.part import Part, SETUP
from mhri.drill.gui.faults_page import FaultsPage, TITLE


class FaultPresenter(Part):
    """Adds the page with the first simulated robot; with only real robots it is never shown.

    :param add: function of (job, title, page, order, icon) that adds a section to the drawer
    :param client: :class:`mhri.drill.ros.faults_client.FaultsClient`
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        # Imported here, so that the rest can be tested without ROS.
        from mhri.drill.ros.faults_client import FaultsClient
        return cls(context.screen.arrangement.add_section, FaultsClient())

    def __init__(self, add, client):
        self._add = add
        self._client = client
        self.page = None

    def show_view(self, view):
        """Handle the current :class:`mhri.base.views.ScreenView`."""
        self._client.follow([robot.name for robot in view.robots])
        simulated = self._client.simulated()
        if self.page is None:
            if not simulated:
                return
            self._add_page()
        self.page.show_robots(simulated)
        for news in self._client.take_news():
            self.page.show_answer(*news)

    def _add_page(self):
        self.page = FaultsPage()
        self.page.asked.connect(self._client.ask)
        self.page.shown.connect(self._client.watch)
        self._add(SETUP, TITLE, self.page, 40, 'triangle-alert')

    def close(self, forget=False):
        """Stop polling."""
        self._client.close()

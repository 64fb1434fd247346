# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the list of faults with the simulated robots; everything here runs on the GUI thread."""
from mhri.base.part import Part
from mhri.drill.gui.faults_page import FaultsPage, TITLE


class FaultHost(Part):
    """Adds the list once there is a simulated robot: with real ones alone nobody sees it.

    :param add: takes (title, page) where there is room for it
    :param client: :class:`mhri.drill.ros.faults_client.FaultsClient`
    """

    @classmethod
    def of(cls, context):
        """Create it; its page goes below the doctor's, if there is one."""
        # Imported here so that the rest can be tested without ROS.
        from mhri.drill.ros.faults_client import FaultsClient
        doctor = context.parts.get('doctor')
        return cls(doctor.page.add_part if doctor else context.screen.arrangement.add_page,
                   FaultsClient())

    def __init__(self, add, client):
        self._add = add
        self._client = client
        self.page = None

    def show_view(self, view):
        """Take in the :class:`mhri.base.views.PanelView` of this moment."""
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
        self._add(TITLE, self.page)

    def close(self):
        """Ask nobody any more."""
        self._client.close()

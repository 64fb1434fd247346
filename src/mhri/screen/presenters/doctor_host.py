# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the doctor's page with the examination; everything here runs on the GUI thread."""
from mhri.doctor.gui.doctor_page import DoctorPage


class DoctorHost:
    """Opens the page on request, and shows the result.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    """

    def __init__(self, operator, screen):
        self._operator = operator
        self._screen = screen
        self.page = DoctorPage()
        screen.arrangement.add_page('Doctor', self.page)
        self.page.examine_requested.connect(self._examine)
        screen.doctor_requested.connect(self.open)

    def open(self):
        """Show the page, and examine."""
        self._screen.arrangement.show_page(self.page)
        self._examine()

    def _examine(self):
        self.page.show_busy()
        self._operator.examine()

    def show(self, findings, took_s):
        """Show the findings; a sentence in place of the list says why there are none."""
        if isinstance(findings, str):
            self.page.show_failure(findings)
        else:
            self.page.show_findings(findings, took_s)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the doctor's page with the examination, which runs on its own thread."""
import queue
import threading
import time

import rospy

from mhri.base.part import Part, SETUP
from mhri.doctor.gui.doctor_page import DoctorPage
from mhri.doctor.ros.examination import examine


class DoctorPresenter(Part):
    """Opens the page on request, and shows the findings.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen)

    def __init__(self, screen):
        self._screen = screen
        self._found = queue.Queue()
        self.page = DoctorPage()
        screen.arrangement.add_section(SETUP, 'Doctor', self.page, 30, 'stethoscope')
        self.page.examine_requested.connect(self._examine)
        screen.doctor_requested.connect(self.open)

    def open(self):
        """Show the page, and start an examination."""
        self._screen.arrangement.show_page(self.page)
        self._examine()

    def _examine(self):
        self.page.show_busy()
        threading.Thread(target=self._work, name='doctor', daemon=True).start()

    def _work(self):
        """Examine network, master and robots (blocking)."""
        begun = time.monotonic()
        try:
            found = examine()
        except Exception as error:  # guards the thread: the page shows the failure
            rospy.logerr('the examination failed: %r', error)
            found = 'the examination failed: {}'.format(error)
        self._found.put((found, time.monotonic() - begun))

    def show_view(self, view):
        """Show the result of an examination that has ended."""
        while not self._found.empty():
            findings, took_s = self._found.get()
            if isinstance(findings, str):
                self.page.show_failure(findings)
            else:
                self.page.show_findings(findings, took_s)

    def disable(self):
        """Disable the doctor's button."""
        self._screen.doctor_button.setEnabled(False)

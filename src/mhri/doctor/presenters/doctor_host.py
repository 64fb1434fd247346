# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the doctor's page with the examination; everything here runs on the GUI thread."""
import queue
import threading
import time

import rospy

from mhri.base.part import Part
from mhri.doctor.gui.doctor_page import DoctorPage
from mhri.doctor.ros.examination import examine


class DoctorHost(Part):
    """Opens the page on request, and shows the result.

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
        screen.arrangement.add_page('Doctor', self.page)
        self.page.examine_requested.connect(self._examine)
        screen.doctor_requested.connect(self.open)

    def open(self):
        """Show the page, and examine."""
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
        except Exception as error:  # the guard of this thread: the operator is told what failed
            rospy.logerr('the examination failed: %r', error)
            found = 'the examination failed: {}'.format(error)
        self._found.put((found, time.monotonic() - begun))

    def show_view(self, view):
        """Show what was found meanwhile."""
        while not self._found.empty():
            findings, took_s = self._found.get()
            if isinstance(findings, str):
                self.page.show_failure(findings)
            else:
                self.page.show_findings(findings, took_s)

    def disable(self):
        """Examine nothing."""
        self._screen.doctor_button.setEnabled(False)

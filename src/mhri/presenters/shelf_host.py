# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the list of sessions with the sessions on the disk; everything is on the GUI thread."""
from mhri.gui.session.sessions_page import SessionsPage, TITLE
from mhri.ros.session.session_shelf import SessionShelf


class ShelfHost:
    """The page of recorded sessions of one screen.

    :param screen: :class:`mhri.gui.screen.screen.ScreenWidget`
    :param shelf: :class:`mhri.ros.session.session_shelf.SessionShelf`
    """

    def __init__(self, screen, shelf=None):
        self._shelf = shelf or SessionShelf()
        self.page = SessionsPage()
        screen.arrangement.add_page(TITLE, self.page)
        self._connect()

    def _connect(self):
        """Wire what is asked for."""
        self.page.shown.connect(self._shelf.look)
        self.page.replay_requested.connect(self._shelf.replay)
        self.page.report_requested.connect(self._shelf.report)
        self.page.cancel_requested.connect(self._shelf.cancel)

    def show(self):
        """Show what has come meanwhile; call it with each drawing."""
        while not self._shelf.news.empty():
            kind, value = self._shelf.news.get()
            if kind == 'rows':
                self.page.show_rows(value)
            elif kind == 'progress':
                self.page.show_progress(value)
            elif kind == 'told':
                self.page.show_note(value)
            else:
                self.page.show_progress(None)
                if value:
                    self.page.show_note('the report is {}'.format(value))

    def close(self):
        """End the report under way."""
        self._shelf.close()

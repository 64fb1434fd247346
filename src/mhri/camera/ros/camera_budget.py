# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Applies the camera budget to the feeds of a screen."""
import time
from typing import NamedTuple

from mhri.camera.budget import BudgetPlanner, DRIVEN, Picture
from mhri.camera.ros.camera_feed import CameraFeed

PERIOD_S = 1.0


class PictureRequest(NamedTuple):
    """A picture or a point cloud with a place on the screen.

    ``robot``: its name, for a cloud with a word added; ``importance``: one of
    :data:`mhri.camera.budget.IMPORTANCES`, DRIVEN for a selected robot; ``visible``: false if
    hidden (tile closed, minimised, on another page).
    """

    robot: str
    importance: str
    feed: CameraFeed
    visible: bool = True


class CameraBudget:
    """Shares the network among the pictures of one screen; use it on one thread.

    :param settings: function that returns the :class:`mhri.screen.settings.PanelSettings`
    """

    def __init__(self, settings, clock=time.monotonic):
        self._settings = settings
        self._clock = clock
        self._planner = BudgetPlanner()
        self._requests = []
        self._grants = {}
        self._due = clock()
        #: a sentence while the driven robots' pictures alone exceed the budget, else ''
        self.note = ''

    def settle(self, requests):
        """Pass every feed its grant; return them, {robot: Grant}.

        Call it at every redraw: it plans once a second, and at once when a picture opens or the
        importance changes. That takes about a millisecond for a dozen pictures, without any master
        or network call.

        :param requests: a :class:`PictureRequest` for every feed that is open, each name once
        """
        requests, now = list(requests), self._clock()
        if requests == self._requests and now < self._due:
            return self._grants
        self._requests, self._due = requests, now + PERIOD_S
        settings = self._settings()
        pictures = [Picture(robot, importance, visible, *feed.figures())
                    for robot, importance, feed, visible in requests]
        plan = self._planner.plan(pictures, settings.camera_budget_mbit_s * 1e6,
                                  settings.thumbnail_hz, now)
        for request in requests:
            request.feed.grant(plan.grants[request.robot])
        # Assumed figures do not justify a note.
        guessed = any(None in (picture.bits, picture.native_hz) for picture in pictures
                      if picture.visible and picture.importance == DRIVEN)
        self.note, self._grants = '' if guessed else plan.note, plan.grants
        return self._grants

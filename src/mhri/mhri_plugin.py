# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen as an rqt plugin, over :mod:`mhri.screen.presenters.screen_presenter`."""
import json

import rospy
from rqt_gui_py.plugin import Plugin

from mhri.screen.presenters.fresh_start import FreshStart
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.screen.ros.backend import ScreenBackend
from mhri.screen.saved_state import numbers_of, without_robots

# In the perspective: the settings, and those of simulated runs.
_KEY, _SIMULATED_KEY = 'state', 'simulated_state'


class MhriPlugin(Plugin):
    """Hosted by rqt, which has already initialised the ROS node (http://wiki.ros.org/rqt).

    It accepts ``--args --robots "bot1 bot2"``: names to add to the list; ``--fresh`` and
    ``--simulated`` as the executable ``panel`` does.
    """

    def __init__(self, context):
        super().__init__(context)
        self.setObjectName('MhriPlugin')
        self._presenter = ScreenPresenter(ScreenBackend())
        if context.serial_number() > 1:
            self._presenter.screen.setWindowTitle('{} ({})'.format(
                self._presenter.screen.windowTitle(), context.serial_number()))
        context.add_widget(self._presenter.screen)
        words = list(context.argv())
        self._simulated = '--simulated' in words
        self._presenter.start(
            words[words.index('--robots') + 1].split() if '--robots' in words[:-1] else ())
        self._fresh = FreshStart(self._presenter) if '--fresh' in words else None

    def save_settings(self, plugin_settings, instance_settings):
        """Save robots, limits, mode and window positions in rqt's perspective."""
        if self._fresh is not None and not self._fresh.is_changed:
            return
        state = self._presenter.save_state()
        instance_settings.set_value(
            _SIMULATED_KEY if self._simulated else _KEY,
            json.dumps(without_robots(state) if self._simulated else state))

    def restore_settings(self, plugin_settings, instance_settings):
        """Restore them; log the unusable parts of a perspective."""
        try:
            state = json.loads(instance_settings.value(
                _SIMULATED_KEY if self._simulated else _KEY, '{}'))
            if self._fresh is not None:
                state = numbers_of(state)
            if self._simulated:
                state = without_robots(state)
            problems = self._presenter.restore_state(state)
        except (ValueError, TypeError, RecursionError) as error:
            problems = (str(error),)
        if problems:
            rospy.logwarn('left out of the saved settings: %s', '; '.join(problems)[:500])
        self._presenter.screen.arrangement.begin_text_size()

    def shutdown_plugin(self):
        """Stop the robots before the plugin is unloaded."""
        self._presenter.close(forget=True)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen as an rqt plugin: a thin adapter over :mod:`mhri.screen.presenters.screen_host`."""
import json

import rospy
from rqt_gui_py.plugin import Plugin

from mhri.screen.presenters.screen_host import ScreenHost
from mhri.screen.ros.backend import ScreenBackend

_KEY = 'state'


class MhriPlugin(Plugin):
    """Hosted by rqt, which has initialised the ROS node before (http://wiki.ros.org/rqt).

    It takes ``--args --robots "bot1 bot2"``: names to add to the list.
    """

    def __init__(self, context):
        super().__init__(context)
        self.setObjectName('MhriPlugin')
        self._host = ScreenHost(ScreenBackend())
        if context.serial_number() > 1:
            self._host.screen.setWindowTitle('{} ({})'.format(
                self._host.screen.windowTitle(), context.serial_number()))
        context.add_widget(self._host.screen)
        words = list(context.argv())
        self._host.start(words[words.index('--robots') + 1].split() if '--robots' in words[:-1]
                         else ())

    def save_settings(self, plugin_settings, instance_settings):
        """Keep robots, limits, mode and places of windows in rqt's perspective."""
        instance_settings.set_value(_KEY, json.dumps(self._host.save_state()))

    def restore_settings(self, plugin_settings, instance_settings):
        """Take them back; log the unusable parts of a perspective."""
        try:
            problems = self._host.restore_state(json.loads(instance_settings.value(_KEY, '{}')))
        except (ValueError, TypeError, RecursionError) as error:
            problems = (str(error),)
        if problems:
            rospy.logwarn('left out of the saved settings: %s', '; '.join(problems)[:500])

    def shutdown_plugin(self):
        """Stop the robots before the plugin goes."""
        self._host.close(forget=True)

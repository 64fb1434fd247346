# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a plugin sees of rqt, which is not packaged everywhere."""
import sys
import types

from python_qt_binding.QtCore import QObject


class Settings(dict):
    """As qt_gui's Settings: set_value and value."""

    def set_value(self, key, value):
        """Keep a value."""
        self[key] = value

    def value(self, key, default=None):
        """Return what was kept."""
        return self.get(key, default)


class Context:
    """As rqt's plugin context."""

    def __init__(self, *argv):
        self.widgets = []
        self._argv = list(argv)

    def argv(self):
        """Return the arguments of the plugin."""
        return self._argv

    def serial_number(self):
        """Return which of several plugins of a kind it is."""
        return 1

    def add_widget(self, widget):
        """Take the plugin's window."""
        self.widgets.append(widget)


class Plugin(QObject):
    """As ``rqt_gui_py.plugin.Plugin``."""

    def __init__(self, context):
        super().__init__()


def plugin_class(monkeypatch):
    """Return mhri's plugin, over this stand-in, and a list that gets the presenter of each."""
    package, module = types.ModuleType('rqt_gui_py'), types.ModuleType('rqt_gui_py.plugin')
    module.Plugin = Plugin
    monkeypatch.setitem(sys.modules, 'rqt_gui_py', package)
    monkeypatch.setitem(sys.modules, 'rqt_gui_py.plugin', module)
    monkeypatch.delitem(sys.modules, 'mhri.mhri_plugin', raising=False)
    from mhri import mhri_plugin
    make, made = mhri_plugin.ScreenPresenter, []
    monkeypatch.setattr(mhri_plugin, 'ScreenPresenter',
                        lambda *words: made.append(make(*words)) or made[-1])
    return mhri_plugin.MhriPlugin, made

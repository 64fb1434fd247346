# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RViz in place of a cloud: with a stand-in for its binding, which is not to be had everywhere.

What is tested is what the adapter asks of the binding, not that RViz draws anything.
"""
import json
import sys
import types

import numpy as np
import pytest
from python_qt_binding.QtWidgets import QWidget

from mhri.screen.presenters import rviz_cloud
from mhri.sensors.gui.cloud_view import CloudView
from mhri.sensors.point_cloud import Cloud

CLOUD = Cloud(np.ones((5, 3), 'f4'), frame_id='laser', sent=5)


class Feed:
    """A feed whose robot publishes a topic of clouds, or none."""

    def __init__(self, topic='/bot1/points'):
        self.cloud_topic = topic


class Frame(QWidget):
    """Takes note of what it is asked for, in order."""

    made = []

    def __init__(self):
        super().__init__()
        self.asked = []
        self.made.append(self)

    def __getattr__(self, name):
        return lambda *args: self.asked.append((name, *args))


class Reader:
    """Reads into a dict."""

    def readString(self, config, text):  # noqa: N802
        config.update(json.loads(text))


@pytest.fixture
def binding(monkeypatch):
    """Install a stand-in for rviz and its binding."""
    package, module = types.ModuleType('rviz'), types.ModuleType('rviz.bindings')
    package.__spec__ = types.SimpleNamespace(name='rviz')
    module.VisualizationFrame, module.YamlConfigReader, module.Config = Frame, Reader, dict
    package.bindings = module
    monkeypatch.setitem(sys.modules, 'rviz', package)
    monkeypatch.setitem(sys.modules, 'rviz.bindings', module)
    monkeypatch.setattr(Frame, 'made', [])
    return module


@pytest.fixture
def view(operator):
    widget = CloudView()
    widget.resize(700, 500)
    operator.show(widget)
    return widget


def test_rviz_instead_and_back(view, operator, binding, heard):
    held = rviz_cloud.RvizCloud(view, Feed())
    assert view.rviz_button.isVisible() and not Frame.made
    view.show_value(CLOUD)
    operator.click(view.rviz_button)
    frame, = Frame.made
    assert frame.isVisible() and not view.canvas.isVisible() and frame.parent() is view
    assert [asked[0] for asked in frame.asked] == [
        'setSplashPath', 'initialize', 'load', 'setMenuBar', 'setStatusBar',
        'setHideButtonVisibility']
    manager = dict(frame.asked[2][1])['Visualization Manager']
    assert manager['Global Options']['Fixed Frame'] == 'laser'
    assert [display['Topic'] for display in manager['Displays'] if 'Topic' in display] == [
        '/bot1/points']
    drawn = heard(view.drawn)
    operator.wait_until(lambda: view.idle)
    operator.settle()
    drawn.clear()
    view.show_value(CLOUD)
    assert view.idle and not drawn
    operator.click(view.rviz_button)
    assert view.canvas.isVisible() and not frame.isVisible()
    operator.wait_until(lambda: drawn)
    del held


def test_a_binding_that_fails_leaves_the_drawn_cloud(view, operator, binding, monkeypatch):
    def fail():
        raise RuntimeError('no OpenGL')
    monkeypatch.setattr(binding, 'VisualizationFrame', fail)
    held = rviz_cloud.RvizCloud(view, Feed())
    view.show_value(CLOUD)
    operator.click(view.rviz_button)
    assert view.canvas.isVisible() and not view.rviz_button.isChecked()
    assert 'no OpenGL' in view.status_label.text()
    del held

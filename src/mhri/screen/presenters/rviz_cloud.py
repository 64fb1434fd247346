# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RViz's own widget as an alternative cloud view, if rviz and its Python binding are installed.

Sources for the binding: rviz_python_tutorial/myviz.py and src/python_bindings/sip of rviz
(Noetic). It needs a GPU or a software OpenGL, and subscribes to the cloud itself.
"""
from importlib import import_module
from importlib.util import find_spec
import json

# Loaded only on request: it takes a second or more, and much memory.
_PACKAGE, _BINDING = 'rviz', 'rviz.bindings'


def is_installed():
    """Return whether the package ``rviz`` is found; loading it may still fail."""
    return find_spec(_PACKAGE) is not None


def config_text(topic, frame_id):
    """Return an RViz configuration that shows one cloud, in JSON, a subset of YAML.

    :param topic: topic of type ``sensor_msgs/PointCloud2``
    :param frame_id: frame of the cloud, also the fixed frame, so that no tf is needed
    """
    displays = [
        {'Class': 'rviz/Grid', 'Name': 'Grid', 'Enabled': True},
        {'Class': 'rviz/PointCloud2', 'Name': 'Cloud', 'Enabled': True, 'Topic': topic,
         'Queue Size': 1, 'Style': 'Points', 'Size (Pixels)': 2}]
    return json.dumps({'Visualization Manager': {
        'Displays': displays, 'Global Options': {'Fixed Frame': frame_id, 'Frame Rate': 15},
        'Tools': [{'Class': 'rviz/MoveCamera'}]}})


def make_frame(topic, frame_id):
    """Return RViz's widget with one cloud, without menus or bars (on the GUI thread, slow).

    :raises Exception: any error of the binding on loading or drawing
    """
    rviz = import_module(_BINDING)
    frame = rviz.VisualizationFrame()
    frame.setSplashPath('')
    frame.initialize()
    reader, config = rviz.YamlConfigReader(), rviz.Config()
    reader.readString(config, config_text(topic, frame_id))
    frame.load(config)
    frame.setMenuBar(None)
    frame.setStatusBar(None)
    frame.setHideButtonVisibility(False)
    return frame


class RvizCloud:
    """Offers RViz in a cloud view, and switches on request.

    :param view: :class:`mhri.sensors.gui.cloud_view.CloudView`
    :param feed: :class:`mhri.sensors.ros.cloud_feed.CloudFeed` with the topic for RViz
    """

    def __init__(self, view, feed):
        self._view = view
        self._feed = feed
        view.rviz_chosen.connect(self._on_chosen)
        view.offer_rviz(is_installed())

    def _on_chosen(self, chosen):
        """Switch, or show the reason for a failure."""
        if not chosen:
            self._view.show_instead(None)
            return
        topic = self._feed.cloud_topic
        if not topic or self._view.frame_id is None:
            self._view.refuse_rviz('RViz shows clouds as sent: none has come yet')
            return
        try:
            self._view.show_instead(make_frame(topic, self._view.frame_id))
        except Exception as error:  # another program's library: anything can be missing
            self._view.refuse_rviz('cannot show RViz here: {}'.format(error))

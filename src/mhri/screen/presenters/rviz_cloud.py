# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RViz's own widget in place of a drawn cloud, if rviz and its Python binding are installed.

Sources for the binding: rviz_python_tutorial/myviz.py and src/python_bindings/sip of rviz
(Noetic). It needs a GPU or a software OpenGL, and subscribes to the cloud itself.
"""
from importlib import import_module
from importlib.util import find_spec
import json

# rviz is loaded only on request: that takes a second or more, and much memory.
_PACKAGE, _BINDING = 'rviz', 'rviz.bindings'


def is_installed():
    """Tell whether Python finds a package ``rviz``; it may still fail to load."""
    return find_spec(_PACKAGE) is not None


def config_text(topic, frame_id):
    """Return the configuration of an RViz that shows one cloud, as YAML (of which JSON is a part).

    :param topic: of type ``sensor_msgs/PointCloud2``
    :param frame_id: of the cloud, in which it is shown, so that no tf is needed
    """
    displays = [
        {'Class': 'rviz/Grid', 'Name': 'Grid', 'Enabled': True},
        {'Class': 'rviz/PointCloud2', 'Name': 'Cloud', 'Enabled': True, 'Topic': topic,
         'Queue Size': 1, 'Style': 'Points', 'Size (Pixels)': 2}]
    return json.dumps({'Visualization Manager': {
        'Displays': displays, 'Global Options': {'Fixed Frame': frame_id, 'Frame Rate': 15},
        'Tools': [{'Class': 'rviz/MoveCamera'}]}})


def make_frame(topic, frame_id):
    """Return RViz's widget with one cloud and nothing around it (on the GUI thread, slow).

    :raises Exception: whatever the binding raises if it cannot be loaded or cannot draw
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
    """Offers RViz in a view of clouds, and switches when it is chosen.

    :param view: :class:`mhri.sensors.gui.cloud_view.CloudView`
    :param feed: :class:`mhri.sensors.ros.cloud_feed.CloudFeed`, whose topic RViz should show
    """

    def __init__(self, view, feed):
        self._view = view
        self._feed = feed
        view.rviz_chosen.connect(self._on_chosen)
        view.offer_rviz(is_installed())

    def _on_chosen(self, chosen):
        """Switch, or say why not."""
        if not chosen:
            self._view.show_instead(None)
            return
        topic = self._feed.topic()
        if not topic or self._view.frame_id is None:
            self._view.refuse_rviz('RViz shows clouds as sent: none has come yet')
            return
        try:
            self._view.show_instead(make_frame(topic, self._view.frame_id))
        except Exception as error:  # another program's library: anything can be missing
            self._view.refuse_rviz('cannot show RViz here: {}'.format(error))

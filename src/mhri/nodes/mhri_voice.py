# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_voice``: spoken commands, through :class:`InputNode`.

Publishes ``/mux_in/voice`` (``sensor_msgs/Joy``: axes[0] left, axes[1] forward, fractions of the
speed limit), serves ``/mhri_voice/set_suspended`` (``mhri/SetSuspended``); the other interfaces are
those of :mod:`mhri.voice.ros.voice`. Parameters:

- ``~source``: what to listen to: '' (default) the default microphone, ``microphone:<part of its
  name>``, ``<path>.wav``, the path of a FIFO with raw sound (16 kHz, mono, 16 bit little endian),
  or ``-``, the same from the standard input; takes effect within two seconds
- ``~voice``: the operator, by the name given to ``mhri_voice_teach``; '' (default) for any voice;
  takes effect within two seconds
- ``~language``: a file below ``resource/voice`` without its ending, or a path (default: english)
"""
import sys

import rospy

from mhri.base.config import ConfigError, short
from mhri.devices.ros.input_node import InputNode
from mhri.graph.ros import log, parameters
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import read_text, resource_path
from mhri.voice.io.voice import VoiceReader
from mhri.voice.language import parse_language
from mhri.voice.ros.voice import VoiceLink


def main():
    """Run until shut down; exit with 1 if the language's file cannot be used."""
    limit_peers()
    init_node('mhri_voice')
    log.install()
    try:
        name = parameters.text('~language', 'english')
        path = name if '/' in name else resource_path('voice', name + '.yaml')
        language = parse_language(read_text(path), path)
    except (ConfigError, OSError) as error:
        sys.exit('mhri_voice cannot start: {}'.format(short(error)))
    link = VoiceLink()
    reader = VoiceReader(language, path, link.on_heard, link.on_act)
    node = InputNode(reader, '/mux_in/voice', '~set_suspended')
    LiveParameter('~source', '', reader.want_source, node.resumed).start()
    LiveParameter('~voice', '', reader.want_voice, node.resumed).start()
    link.start(reader, node.resumed)
    node.start()
    rospy.spin()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a device of ``resource/inputs.yaml`` as a node."""
from dataclasses import dataclass, field
from importlib import import_module
import sys
from typing import Any, Callable, Mapping

import rospy

from mhri.base.config import ConfigError, parse_yaml, short
from mhri.devices.io.reader import Reader
from mhri.devices.ros.input_node import InputNode
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.resources import read_text, resource_path
from mhri.graph.ros.shutdown import start_node
from mhri.graph.ros.stand_by import stand_by


@dataclass(frozen=True)
class Device:
    """A device, and the settings of its node.

    :param reader: :class:`mhri.devices.io.reader.Reader`
    :param parameters: {name of a parameter, e.g. ``~device``: function of its text ('' by
        default)}, called again within two seconds of a change while the node is resumed
    :param node: class of the node
    :param start: called with the node before it serves
    """

    reader: Reader
    parameters: Mapping[str, Callable[[str], None]] = field(default_factory=dict)
    node: Any = InputNode
    start: Callable[[InputNode], None] = lambda node: None


def find_device(key, text, origin):
    """Return (topic, function that makes the device) of a row.

    :param text: of ``resource/inputs.yaml``, which is ``origin``
    :raises ConfigError: the row is missing or wrong
    """
    row = parse_yaml(text, origin).section(key)
    topic, name = row.text('topic'), row.text('device')
    row.close()
    module, _, attribute = name.rpartition('.')
    try:
        return topic, getattr(import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise row.error('device', 'cannot be loaded: {}'.format(error))


def run(key):
    """Run the node ``mhri_<key>`` until it is shut down; exit with 1 if it cannot start."""
    name, origin = 'mhri_' + key, resource_path('inputs.yaml')
    try:
        topic, make = find_device(key, read_text(origin), origin)
        stand_by(name)
        start_node(name)
        made = make()
    except (ConfigError, OSError) as error:
        sys.exit('{} cannot start: {}'.format(name, short(error)))
    device = made if isinstance(made, Device) else Device(made)
    node = device.node(device.reader, topic, '~set_suspended')
    for parameter, apply in device.parameters.items():
        LiveParameter(parameter, '', apply, node.resumed).start()
    device.start(node)
    node.start()
    rospy.spin()

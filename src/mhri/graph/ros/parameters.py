# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads parameters of a node, and refuses values of a wrong type."""
import math

import rospy

from mhri.base.config import ConfigError, shown


def text(name, default):
    """Return a parameter that is text.

    :raises ConfigError: it is not text
    """
    return _of_type(name, default, str, 'text')


def flag(name, default):
    """Return a parameter that is true or false.

    :raises ConfigError: it is neither
    """
    return _of_type(name, default, bool, 'true or false')


def number(name, default, low, high=math.inf):
    """Return a parameter that is a number within two bounds, as a float.

    :raises ConfigError: it is not a number, or out of bounds
    """
    value = rospy.get_param(name, default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
        raise _error(name, 'a number from {:g} {}'.format(
            low, 'up' if high == math.inf else 'to {:g}'.format(high)), value)
    return float(value)


def choice(name, options):
    """Return a parameter that is one of some texts, the first if it is not set.

    :raises ConfigError: it is not one of them
    """
    value = rospy.get_param(name, options[0])
    if value not in options:
        raise _error(name, ' or '.join(options), value)
    return value


def _of_type(name, default, kind, words):
    value = rospy.get_param(name, default)
    if not isinstance(value, kind):
        raise _error(name, words, value)
    return value


def _error(name, words, value):
    return ConfigError(rospy.resolve_name(name), '', 'expected {}, got {}'.format(
        words, shown(value)))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads parameters of a node, which anybody may have set to anything; refuses a wrong type."""
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


def _of_type(name, default, kind, words):
    value = rospy.get_param(name, default)
    if not isinstance(value, kind):
        raise ConfigError(rospy.resolve_name(name), '', 'expected {}, got {}'.format(
            words, shown(value)))
    return value

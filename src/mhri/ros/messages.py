# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Message classes by the name of their ROS type, from packages that may not be installed."""
import functools
import importlib
import operator

import rospy


class MessageMissing(LookupError):
    """A message type whose package is not installed here; says which."""


def message_class(kind):
    """Return the class of a ROS type such as ``std_msgs/Bool``.

    :raises MessageMissing: its package is not installed, or has no such message
    """
    package, _, name = kind.partition('/')
    try:
        module = importlib.import_module(package + '.msg')
    except ImportError:
        raise MessageMissing('{} is not installed here'.format(package)) from None
    try:
        return getattr(module, name)
    except AttributeError:
        raise MessageMissing('{} has no message {}'.format(package, name)) from None


@functools.lru_cache(maxsize=None)
def bytes_of(kind):
    """Return a class with which a topic of this message class is heard as bytes (``_buff``).

    Unlike ``rospy.AnyMsg`` it refuses publishers of another type, and the master knows the type.
    """
    return type(kind.__name__, (rospy.AnyMsg,), {
        '__slots__': (), '_md5sum': kind._md5sum, '_type': kind._type,
        '_full_text': kind._full_text})


def read_field(message, field):
    """Return a field of a message by its dotted name.

    :raises AttributeError: there is no such field
    """
    return operator.attrgetter(field)(message)


def with_field(message, field, value):
    """Return the message with one field set, by its dotted name.

    :raises AttributeError: there is no such field
    """
    outer, _, inner = field.rpartition('.')
    part = read_field(message, outer) if outer else message
    read_field(part, inner)
    setattr(part, inner, value)
    return message

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Message classes by the name of their ROS type, from packages that may not be installed."""
import functools
import importlib
import importlib.util
import operator
import os
import re
import sys

_KIND = re.compile(r'[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*\Z')


class MessageMissing(LookupError):
    """The package of a message type is not installed; the text names the type."""


def message_class(kind, place='msg'):
    """Return the class of a ROS type such as ``std_msgs/Bool``.

    The name may come from a robot or a bag, so only packages of messages are imported.

    :param place: "srv" for the class of a service
    :raises MessageMissing: its package is not installed, or has no such message
    """
    if not _KIND.match(kind):
        raise MessageMissing('{!r} is not the name of a message type'.format(kind))
    package, _, name = kind.partition('/')
    try:
        if not _has_messages(package, place):
            raise ImportError(package)
        module = importlib.import_module('{}.{}'.format(package, place))
    except (ImportError, ValueError):
        raise MessageMissing('{} is not installed here'.format(package)) from None
    # Slow to import, with numpy: the doctor starts without it.
    import genpy
    found = getattr(module, name, None)
    base = genpy.Message if place == 'msg' else object
    if not (isinstance(found, type) and issubclass(found, base)
            and getattr(found, '_type', '') == kind):
        raise MessageMissing('{} has no {} {}'.format(
            package, 'message' if place == 'msg' else 'service', name))
    return found


def _has_messages(package, place):
    """Return whether a package has messages or services, without importing it: that runs its code.

    :raises ValueError: it is a module without a spec
    """
    spec = importlib.util.find_spec(package)
    paths = getattr(sys.modules.get(package), '__path__', None) \
        or getattr(spec, 'submodule_search_locations', None) or ()
    return any(os.path.isfile(os.path.join(path, place, '__init__.py')) for path in paths)


@functools.lru_cache(maxsize=1000)
def installed_class(kind, md5sum):
    """Return the class of a ROS type in the version with an MD5 sum.

    :raises MessageMissing: the type is not installed, or in another version
    """
    found = message_class(kind)
    if found._md5sum != md5sum:
        raise MessageMissing('{} is of another version here'.format(kind))
    return found


@functools.lru_cache(maxsize=None)
def bytes_of(kind):
    """Return a class that receives messages of a message class as bytes (``_buff``).

    Unlike ``rospy.AnyMsg`` it refuses publishers of another type, and registers the type.
    """
    # Slow to import: the doctor looks up types without it.
    import rospy
    return type(kind.__name__, (rospy.AnyMsg,), {
        '__slots__': (), '_md5sum': kind._md5sum, '_type': kind._type,
        '_full_text': kind._full_text})


def read_field(message, field):
    """Return a field of a message by its dotted name, or an element of an array: ``data[0]``.

    :raises AttributeError: there is no such field or element
    """
    if field[-1:] != ']':
        return operator.attrgetter(field)(message)
    field, index = _element(field)
    try:
        return operator.attrgetter(field)(message)[index]
    except (IndexError, TypeError):
        raise AttributeError('{} has no element {}'.format(field, index)) from None


def _element(field):
    """Return (field, index) of an element such as ``data[0]``."""
    field, _, index = field[:-1].rpartition('[')
    return field, int(index)


def with_field(message, field, value):
    """Return the message with one field set, by its dotted name.

    An array gets as many elements as it needs for ``data[3]``, 0 but for this one.

    :raises AttributeError: there is no such field
    """
    if field[-1:] == ']':
        field, index = _element(field)
        found = list(read_field(message, field))
        value = found + [0] * (index - len(found)) + [value] \
            if len(found) <= index else found[:index] + [value] + found[index + 1:]
    outer, _, inner = field.rpartition('.')
    part = read_field(message, outer) if outer else message
    read_field(part, inner)
    setattr(part, inner, value)
    return message

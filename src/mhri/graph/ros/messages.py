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
    """A message type whose package is not installed here; says which."""


def message_class(kind):
    """Return the class of a ROS type such as ``std_msgs/Bool``.

    The name may come from a robot or a bag: nothing is imported but packages of messages.

    :raises MessageMissing: its package is not installed, or has no such message
    """
    if not _KIND.match(kind):
        raise MessageMissing('{!r} is not the name of a message type'.format(kind))
    package, _, name = kind.partition('/')
    try:
        if not _has_messages(package):
            raise ImportError(package)
        module = importlib.import_module(package + '.msg')
    except (ImportError, ValueError):
        raise MessageMissing('{} is not installed here'.format(package)) from None
    # Slow to import, with numpy: the doctor begins without it.
    import genpy
    found = getattr(module, name, None)
    if not (isinstance(found, type) and issubclass(found, genpy.Message) and found._type == kind):
        raise MessageMissing('{} has no message {}'.format(package, name))
    return found


def _has_messages(package):
    """Tell whether a package has messages, without importing it: an import runs its code.

    :raises ValueError: it is a module without a place
    """
    spec = importlib.util.find_spec(package)
    places = getattr(sys.modules.get(package), '__path__', None) \
        or getattr(spec, 'submodule_search_locations', None) or ()
    return any(os.path.isfile(os.path.join(place, 'msg', '__init__.py')) for place in places)


@functools.lru_cache(maxsize=1000)
def installed_class(kind, md5sum):
    """Return the class of a ROS type in the very version that an MD5 sum names.

    :raises MessageMissing: it is not installed here, or in another version
    """
    found = message_class(kind)
    if found._md5sum != md5sum:
        raise MessageMissing('{} is of another version here'.format(kind))
    return found


@functools.lru_cache(maxsize=None)
def bytes_of(kind):
    """Return a class with which a topic of this message class is heard as bytes (``_buff``).

    Unlike ``rospy.AnyMsg`` it refuses publishers of another type, and the master knows the type.
    """
    # Slow to import: the doctor looks types up without it.
    import rospy
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

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is at the other end of a subscription."""


def caller_of(message):
    """Return the caller id of whoever sent a message, '' where that is not known."""
    return (message._connection_header or {}).get('callerid', '')


def link_of(message):
    """Return something that is the same object for all messages of one connection."""
    return message._connection_header


def publishers(subscriber):
    """Return the caller ids of the publishers that are connected to a ``rospy.Subscriber``."""
    impl = subscriber.impl
    return {link.callerid_pub for link in (impl.connections if impl else ())}

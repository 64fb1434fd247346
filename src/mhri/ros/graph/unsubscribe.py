# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ends a subscription without leaving anything behind."""


def unsubscribe(subscriber):
    """Unregister a ``rospy.Subscriber`` (blocking: it asks the master).

    rospy leaves the epoll handle of the topic in a cycle of references, so that it stays open until
    the garbage collector comes to its oldest generation (ros_comm issue 2373; the project is
    archived): hundreds of them where views are toggled. So it is closed here.
    """
    impl = subscriber.impl
    subscriber.unregister()
    if impl is not None and impl.closed:
        impl.connection_poll.poller.close()

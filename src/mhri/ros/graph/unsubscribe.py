# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ends a subscription without leaving anything behind."""
from mhri.ros.graph.rospy_inside import close_poller


def unsubscribe(subscriber):
    """Unregister a ``rospy.Subscriber`` (blocking: it asks the master).

    rospy leaves the epoll handle of the topic open until the garbage collector comes to its oldest
    generation: hundreds of them where views are toggled. So it is closed here.
    """
    impl = subscriber.impl
    subscriber.unregister()
    close_poller(impl)

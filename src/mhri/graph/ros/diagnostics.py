# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node's ``/diagnostics``: diagnostic_updater at 1 Hz, on a thread that outlives the master."""
import threading

import diagnostic_updater
import rospy

from mhri.graph.ros.log_throttle import quiet_repeats


def publish_diagnostics(tasks):
    """Publish ``diagnostic_msgs/DiagnosticArray`` on ``/diagnostics`` once a second until shutdown.

    :param tasks: {name: function that fills a ``DiagnosticStatusWrapper`` and returns it}
    :returns: a ``threading.Event``; set it to end them earlier
    """
    # Every node of mhri calls this.
    quiet_repeats()
    updater = diagnostic_updater.Updater()
    updater.setHardwareID('mhri')
    for name, task in tasks.items():
        updater.add(name, task)
    done = threading.Event()
    rospy.on_shutdown(done.set)

    def run():
        """Update until the node ends.

        Do not call update(), which subscribes to a parameter at the master each time: a node that
        is shutting down would thereby register its name again, and end the node that took the name
        over.
        """
        while not done.wait(1.0):
            updater.force_update()
        if not rospy.is_shutdown():
            updater.publisher.unregister()

    threading.Thread(target=run, name='diagnostics', daemon=True).start()
    return done

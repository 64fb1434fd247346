# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A parameter that takes effect while the node runs."""
import threading

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError

PERIOD_S = 1.0


class LiveParameter:
    """Reads a parameter from the master once a second, on its own thread, while wanted.

    :param name: e.g. ``~device``
    :param default: its value if it is not set
    :param apply: function called with the value, at first and after every change
    :param wanted: ``threading.Event``; the parameter is read only while it is set
    """

    def __init__(self, name, default, apply, wanted):
        self._name = rospy.resolve_name(name)
        self._value = self._default = default
        self._apply = apply
        self._wanted = wanted

    def start(self):
        """Apply the current value, and start watching; call it after ``rospy.init_node``."""
        self._value = rospy.get_param(self._name, self._default)
        self._apply(self._value)
        threading.Thread(target=self._run, name=self._name, daemon=True).start()
        return self

    def _run(self):
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        done = threading.Event()
        rospy.on_shutdown(done.set)
        while not done.is_set():
            self._wanted.wait()
            try:
                self._look(api)
            except MasterError as error:
                # Keep the last value; MasterWatch reports the lost master.
                rospy.logdebug('%s: %s', self._name, error)
            done.wait(PERIOD_S)

    def _look(self, api):
        """Read the parameter once.

        :raises MasterError: the master does not answer
        """
        known, value = api.call_many([('hasParam', self._name), ('getParam', self._name)])
        value = value if known else self._default
        # Compare the texts: NaN is not equal to itself, and 1 is equal to true.
        if repr(value) != repr(self._value):
            self._value = value
            self._apply(value)
            rospy.loginfo('%s is %s now', self._name, repr(value)[:200])

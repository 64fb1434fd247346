# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Suspends and resumes the input nodes when the mode changes; never blocks."""
import threading

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.srv import SetSuspended

RETRY_S = 1.0


class _Caller:
    """Calls one ``set_suspended`` on its own thread, so that no node delays another.

    A request is kept until the node has answered. A node to be resumed that is not running is
    called again every second; one to be suspended needs no call, since it starts suspended.
    """

    def __init__(self, service):
        self._service = service
        self._api = MasterApi(rospy.get_name(), timeout_s=1.0)
        self._wish = None
        self._changed = threading.Condition()
        self.state = 'not asked yet'
        threading.Thread(target=self._run, name='suspend ' + service, daemon=True).start()

    def wish(self, suspended):
        """Set the request; return at once."""
        with self._changed:
            self._wish = suspended
            self._changed.notify()

    def _run(self):
        while not rospy.is_shutdown():
            with self._changed:
                if self._wish is None:
                    self._changed.wait()
                suspended = self._wish
            settled = suspended is None or self._call(suspended)
            with self._changed:
                if self._wish == suspended and settled:
                    self._wish = None
                elif self._wish == suspended:
                    self._changed.wait(RETRY_S)

    def _call(self, suspended):
        """Call the service once; return whether the request is done."""
        try:
            # rospy's proxy would log an error each time the service does not exist.
            if not self._api.call_many([('lookupService', self._service)])[0]:
                self.state = 'its node is not running'
                return suspended
            answer = rospy.ServiceProxy(self._service, SetSuspended)(suspended)
        except (rospy.ServiceException, rospy.ROSException, MasterError, OSError) as error:
            self.state = 'its node is not running'
            rospy.logdebug('%s: %s', self._service, error)
            return suspended
        self.state = answer.message
        if not answer.success:
            rospy.logwarn_throttle(10.0, '{}: {}'.format(self._service, answer.message))
        return answer.success


class Suspender:
    """The ``set_suspended`` services of all input nodes.

    :param services: names of services of type ``mhri/SetSuspended``
    :param awake: the services that are never suspended
    """

    def __init__(self, services, awake=()):
        self._awake = frozenset(awake)
        self._callers = {service: _Caller(service) for service in services}
        self._active = None

    def state(self, service):
        """Describe the state of an input node."""
        return self._callers[service].state

    def activate(self, service):
        """Resume one service (None for no service) and suspend all the others."""
        self._active = service
        for name, caller in self._callers.items():
            caller.wish(name != service and name not in self._awake)

    def resume_again(self):
        """Resume the active node again: it is silent, and may have been restarted."""
        if self._active is not None:
            self._callers[self._active].wish(False)

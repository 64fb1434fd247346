# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An input device that allows others to drive; it is read in every mode."""
from mhri.devices.ros.input_node import InputNode
from mhri.srv import SetSuspendedRequest, SetSuspendedResponse


class EnablingNode(InputNode):
    """An :class:`InputNode` that resumes by itself and cannot be suspended.

    The mux suspends every input node except that of the mode in force. An enabling pedal must be
    read in all of them: suspended, it would fall silent, and that holds the robots. So the node
    answers the request with success, since the mux repeats a refused one, and the message says that
    reading goes on. To do without the pedal, end the node or change the mux's configuration; no
    single call can do it in a running session.
    """

    def start(self):
        """Begin to serve, resumed; call it after ``rospy.init_node``."""
        super().start()
        self._on_set_suspended(SetSuspendedRequest(suspended=False))

    def _on_set_suspended(self, request):
        if request.suspended:
            return SetSuspendedResponse(
                True, 'an enabling pedal is read in every mode: ' + self.words())
        return super()._on_set_suspended(request)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An input device that allows others to drive, and is therefore read whatever the mode is."""
from mhri.ros.devices.input_node import InputNode
from mhri.srv import SetSuspendedRequest, SetSuspendedResponse


class EnablingNode(InputNode):
    """An :class:`InputNode` that resumes by itself and cannot be suspended.

    The mux suspends every input node but that of the mode in force. An enabling pedal has to be
    read in all of them: suspended, it would fall silent, and that holds the robots. So the wish is
    answered with success, since the mux repeats what was refused, and the message says that reading
    goes on. Whoever wants to do without the pedal ends the node or changes the mux's configuration,
    never a running session by one call.
    """

    def start(self):
        """Open for business, resumed; call it after ``rospy.init_node``."""
        super().start()
        self._on_set_suspended(SetSuspendedRequest(suspended=False))

    def _on_set_suspended(self, request):
        if request.suspended:
            return SetSuspendedResponse(
                True, 'an enabling pedal is read in every mode: ' + self.words())
        return super()._on_set_suspended(request)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_input``: a device of ``resource/inputs.yaml``, by its key, as a node."""
import sys

import rospy

from mhri.devices.ros.device import run


def main():
    """Run until shut down."""
    keys = rospy.myargv(sys.argv)[1:2]
    if not keys:
        sys.exit('usage: mhri_input KEY, of a row in inputs.yaml')
    run(keys[0])

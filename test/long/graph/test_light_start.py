# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What starts with every system loads no picture library; the drive does, before it begins."""
import subprocess
import sys

import pytest


@pytest.mark.parametrize('node, loads', [('mux', 1), ('tasks', 0), ('mhri_session', 0)])
def test_a_node_of_every_system_starts_without_opencv(node, loads):
    """Loading it later would stop the loop that drives for longer than it may hang."""
    assert subprocess.call([sys.executable, '-c', 'import sys, mhri.nodes.{}; sys.exit("cv2" in '
                            'sys.modules)'.format(node)]) == loads

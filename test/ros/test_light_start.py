# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What starts again in the middle of a drive, or with every system, loads no picture library."""
import subprocess
import sys

import pytest


@pytest.mark.parametrize('node', ['mux', 'gates', 'tasks', 'mhri_session'])
def test_a_node_of_every_system_starts_without_opencv(node):
    assert subprocess.call([sys.executable, '-c', 'import sys, mhri.nodes.{}; sys.exit("cv2" in '
                            'sys.modules)'.format(node)]) == 0

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is started again in the middle of a drive loads no picture library first."""
import subprocess
import sys

import pytest


@pytest.mark.parametrize('node', ['mux', 'gates', 'tasks'])
def test_a_node_on_the_driving_path_starts_without_opencv(node):
    assert subprocess.call([sys.executable, '-c', 'import sys, mhri.nodes.{}; sys.exit("cv2" in '
                            'sys.modules)'.format(node)]) == 0

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Programs that cannot start say why and what to do, in one line."""
import os
import subprocess
import sys

import pytest

from support.paths import GUARD
from support.ros_system import node_words

NODES = ('mux', 'tasks', 'mhri_joy', 'mhri_session', 'panel', 'mhri_guard')


def refused(node, **env):
    """Return the lines with which a program ends."""
    done = subprocess.run(
        [sys.executable, GUARD] if node == 'mhri_guard' else node_words(node),
        env={**os.environ, **env}, timeout=60, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True)
    assert done.returncode == 1, done.stdout
    return done.stdout.splitlines()


@pytest.mark.parametrize('uri', ['localhost:11311', 'https://robot:11311', 'http://robot'])
@pytest.mark.parametrize('node', NODES)
def test_a_malformed_uri_of_the_master_is_named(node, uri):
    line, = refused(node, ROS_MASTER_URI=uri)
    assert 'ROS_MASTER_URI' in line and uri in line and '11311' in line


@pytest.mark.parametrize('display', ['', ':4711'])
def test_a_screen_without_a_display_says_so(display):
    line, = refused('panel', ROS_MASTER_URI='http://localhost:1', DISPLAY=display,
                    WAYLAND_DISPLAY='', QT_QPA_PLATFORM='xcb')
    assert 'DISPLAY' in line and display in line and 'ssh -X' in line

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which displays are shown on another computer, so that nobody trusts a key that is held there."""
import pytest

from mhri.base.remote_display import FORWARDED, remote_kind, VNC

USUAL = frozenset(('BIG-REQUESTS', 'XInputExtension', 'XKEYBOARD', 'XTEST'))


@pytest.mark.parametrize('display', [
    ':0', ':10', ':1.0', 'unix:0', 'unix/:0', 'localhost:0', '127.0.0.1:9.0', '[::1]:0', '',
    'nonsense', '/private/tmp/com.apple.launchd.x/org.xquartz:0'])
def test_a_display_of_this_computer(display):
    assert remote_kind(display, USUAL) == ''


@pytest.mark.parametrize('display', [
    # As ssh sets it, with and without X11UseLocalhost.
    'localhost:10.0', 'localhost:11', '127.0.0.1:10.0', '[::1]:12.0', 'lab-pc:10.0',
    'lab-pc:0', '192.168.1.7:0.0', 'host.docker.internal:0', 'tcp/lab-pc:0', 'LOCALHOST:10'])
def test_a_display_over_the_network(display):
    assert remote_kind(display, USUAL) == FORWARDED


@pytest.mark.parametrize('display', [':1', 'localhost:10.0'])
def test_a_vnc_is_known_by_its_extension(display):
    assert remote_kind(display, USUAL | {'VNC-EXTENSION'}) == VNC

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Names of robots."""
import pytest

from mhri.base.names import name_problem, tidy_name, topic_of


@pytest.mark.parametrize('name', ['bot1', 'a', 'B_2', 'robot_', 'x' * 64])
def test_good_names(name):
    """One segment of a ROS name."""
    assert name_problem(name) is None


@pytest.mark.parametrize('name, reason', [
    ('', 'type the name'), ('1bot', 'begins with a letter'), ('_bot', 'begins with a letter'),
    ('bot 1', 'a space'), ('bot-1', '"-"'), ('lab/bot1', '"/"'), ('/bot1', '"/"'),
    ('böt', '"ö"'), ('öbot', 'begins with a letter'), ('bot1\n', 'invisible'),
    ('bot\u200b', 'invisible'), ('bot\u0661', '"\u0661"'), ('x' * 65, 'at most 64'),
    ('bot;reboot', '";"'), ('~bot', 'begins with'), ('mux', 'of mhri itself'), ('bot$(x)', '"$"')])
def test_bad_names_and_their_reason(name, reason):
    """The reason stands next to the field."""
    assert reason in name_problem(name)


@pytest.mark.parametrize('text, name', [
    (' bot1 ', 'bot1'), ('/bot1', 'bot1'), ('bot1/', 'bot1'), (' /bot1/ ', 'bot1'), ('', ''),
    ('/', ''), ('a/b', 'a/b')])
def test_tidy_name(text, name):
    """What the user most likely meant."""
    assert tidy_name(text) == name


@pytest.mark.parametrize('topic, full', [
    ('cmd_vel', '/bot1/cmd_vel'), ('camera/rgb/image_raw', '/bot1/camera/rgb/image_raw'),
    ('/cmd_vel', '/cmd_vel'), ('/camera/scan', '/camera/scan')])
def test_topic_of(topic, full):
    """Relative to the namespace, as names in ROS are, unless it begins with a slash."""
    assert topic_of('bot1', topic) == full

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one command, for real: nothing stands in for anything but the robots, which are simulated."""
import re
import signal
import subprocess

import cv2

from support.ros_system import wait_for
from support.whole_run import new_master, node_uri, publishers, Run, SCRIPT, START_S


def test_the_demo_drives_robots_without_hands_and_keeps_the_operators_settings(tmp_path):
    settings = tmp_path / 'config' / 'mhri' / 'panel.json'
    settings.parent.mkdir(parents=True)
    settings.write_text('{"state": {"mode": "joy"}}\n')
    with Run(tmp_path, ['--demo', '--screenshot', 'drive.png']) as run:
        status = run.wait(START_S)
    print('\n' + '\n'.join(line for line in run.output.splitlines() if 'bot' in line))
    assert status == 0, run.output
    for robot in ('bot1', 'bot2', 'bot3', 'bot4'):
        assert re.search(r'\b{}\b'.format(robot), run.output), run.output
    picture = cv2.imread(str(tmp_path / 'drive.png'))
    assert picture is not None and picture.shape[0] >= 400 and picture.shape[1] >= 600
    assert picture.std() > 5
    pictures = ['drive{}.png'.format(end) for end in (
        '', '_bot_window', '_depth', '_map', '_panel', '_stopped')]
    assert sorted(path.name for path in tmp_path.glob('*.png')) == pictures
    manual = subprocess.run([str(SCRIPT), '--help'], stdout=subprocess.PIPE).stdout.decode()
    assert [name for name in pictures if name[5:-4] not in manual] == []
    assert settings.read_text() == '{"state": {"mode": "joy"}}\n'
    assert list(settings.parent.iterdir()) == [settings]


def test_ctrl_c_takes_everything_down(tmp_path):
    uri, proxy = new_master()
    with Run(tmp_path, ['--sim', '1', '--master', uri]) as run:
        wait_for(lambda: node_uri(proxy, '/mux') and node_uri(proxy, '/mhri_panel'), START_S,
                 'mux and panel')
        wait_for(lambda: publishers(proxy, '/bot1/odom'), START_S, 'the robot')
        assert 'Xvfb' in run.output
        run.process.send_signal(signal.SIGINT)
        assert run.wait(120) == 130, run.output
    assert 'leftover process' not in run.output

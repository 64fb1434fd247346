# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A short drill on the graph: the scripted operator drives it, the referee measures it."""
from pathlib import Path
import subprocess
import sys
import unittest

from mhri.drill.ros.files import result_in
from support.ros_system import System, wait_for

TIMEOUT_S = 300.0
PLAN = """
name: short
wall_height: 2.0
wall_colour: [200, 200, 200]
floor_colour: [100, 100, 100]
walls: [[[0, 0], [6, 0], [6, 2], [0, 2], [0, 0]]]
landmarks: []
starts: [[0.6, 1.0, 0.0]]
"""
DRILL = """
title: Short
about: Drive to the end.
plan: short.yaml
robots: [turtlebot2]
targets: [{name: the end, x: 4.5, y: 1.0, range: 0.6}]
faults: [{robot: bot1, fault: person, value: 0.8, at: 1.5, for: 3}]
limit_s: 120
routes: {bot1: [[4.5, 1.0]]}
"""


class DrillTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.system = System()
        cls.home = Path(cls.system.home)
        cls.drill = cls.home / 'short.yaml'
        cls.drill.write_text(DRILL)
        (cls.home / 'plans').mkdir()
        cls.plan = cls.home / 'plans' / 'short.yaml'
        cls.plan.write_text(PLAN)
        cls.system.start_master()

    @classmethod
    def tearDownClass(cls):
        cls.system.close()

    def run_drill(self, *arguments):
        return subprocess.run(
            [sys.executable, '-c', 'from mhri.nodes.mhri_drill import main; main()', *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
            env=self.system.env, timeout=TIMEOUT_S)

    def test_a_drill_from_the_first_push_to_the_page(self):
        launched = self.system.launch(
            'mhri.launch', 'gui:=none', 'inputs:=none', 'sim:=1', 'sim_types:=turtlebot2',
            'sim_plan:={}'.format(self.plan), 'drill:={}'.format(self.drill),
            'drill_args:=--scripted')
        wait_for(lambda: launched.poll() is not None, TIMEOUT_S,
                 lambda: Path(launched.log).read_text()[-3000:], poll_s=0.2)
        said = Path(launched.log).read_text()
        self.assertIn('the end', said, said[-3000:])
        self.assertNotIn('has died', said)
        folder, = (self.home / 'mhri' / 'drills').iterdir()
        result = result_in(str(folder))
        self.assertEqual((result['found'], result['operator']), (1, 'script'))
        self.assertGreater(result['distance_m'], 3.0)
        self.assertIn('<svg', (folder / 'drill.html').read_text())
        again = self.run_drill('--compare', str(folder), str(folder / 'drill.yaml'))
        self.assertEqual(again.returncode, 0, again.stdout)
        self.assertEqual(again.stdout.count('1 of 1'), 2)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_drill``: the referee of a drill, and its scripted operator.

``mhri_run.sh --drill NAME`` starts everything; by itself it referees a drill whose robots are
already running. The drill starts with the first deflection of the stick, and ends when all targets
are found, when the time is up, or with this program. The exit status is 0 if all were found, 1 if
not, 2 for an unusable drill.
"""
import argparse
import sys
import time

import rospy

from mhri.base.config import ConfigError, short
from mhri.base.io.pages import page
from mhri.base.robot_types import resolve_robot_type
from mhri.drill.page import TEMPLATE, values_of
from mhri.drill.referee import ALL_FOUND, Referee, TruePose
from mhri.drill.rehearsal import LIMITS, Rehearsal
from mhri.drill.results import compared, lines_of, result_of
from mhri.drill.ros.files import earlier, folder_of, names, result_in, scenario_named, write
from mhri.drill.ros.scripted_hands import ScriptedHands
from mhri.drill.ros.state import DrillPublisher
from mhri.drill.ros.watch import FaultCaller, OperatorWatch
from mhri.drill.scenario import on_links
from mhri.graph.ros.resources import read_text, resource_path, robot_types
from mhri.graph.ros.shutdown import init_node
from mhri.msg import DrillState
from mhri.nodes.sim_robot import body_type, building_key
from mhri.sim.plan import parse_plan
from mhri.sim.world import look_in, world_path

LOOK_HZ = 20.0
# The robots start with the drill; on a slow machine that takes a while [s].
START_S = 180.0
# Time for the last message to be sent [s].
FLUSH_S = 0.2


def parse(argv):
    """Return the options of a command line without ROS remappings."""
    parser = argparse.ArgumentParser(
        prog='mhri_drill', description='Practise with simulated robots, and measure it.')
    parser.add_argument('drill', nargs='?', help='one of: {}; or a file of your own'.format(
        ', '.join(names())))
    parser.add_argument('--scripted', action='store_true', help='let the scripted operator drive')
    parser.add_argument('--rehearse', action='store_true',
                        help='the scripted operator drives without ROS, in a few seconds')
    parser.add_argument('--delay', type=float, default=0.0, metavar='S',
                        help='delay of every link each way [s], 0 to 5')
    parser.add_argument('--path', action='store_true',
                        help='with --rehearse: steer by the committed path on the picture')
    parser.add_argument('--compare', nargs='+', metavar='RUN',
                        help='print the results of several runs side by side: their folders')
    parser.add_argument('--arguments', action='store_true',
                        help='print what mhri.launch needs for the drill, a line each')
    options = parser.parse_args(argv)
    if not options.compare and not options.drill:
        parser.error('name a drill: {}'.format(', '.join(names())))
    if not 0.0 <= options.delay <= 5.0:
        parser.error('--delay: expected 0 to 5 s, got {:g}'.format(options.delay))
    return options


class Drill:
    """A scenario with its building and the bodies of its robots.

    :raises ConfigError: the scenario cannot be used
    :raises OSError: a file cannot be read
    """

    def __init__(self, name):
        self.scenario, self.plan_path = scenario_named(name)
        self.plan = parse_plan(read_text(self.plan_path), self.plan_path)
        if len(self.plan.starts) < len(self.scenario.types):
            raise ConfigError(self.plan_path, 'starts', 'expected one for each robot')
        self.bodies = {robot: self._body(robot, kind) for robot, kind in zip(
            self.scenario.robots, self.scenario.types)}

    @staticmethod
    def _body(robot, kind):
        """Return (body, limits) of a type by its name in ``sim.launch``."""
        name, _, model = kind.partition('_')
        template, errors = resolve_robot_type(robot_types()[0], robot, {
            'robot_type': name, **({'robot_model': model} if model else {})})
        if errors:
            raise errors[0]
        return body_type(robot, template), template.limits

    def referee(self):
        """Return a new :class:`Referee`."""
        return Referee(self.scenario, {robot: body.radius_m for robot, (body, _) in
                                       self.bodies.items()}, self.plan.distance, self.plan.walls)

    def rehearse(self, delay_s, with_path):
        """Return the result of a run without ROS."""
        return Rehearsal(self.scenario, self.plan, self.bodies, delay_s,
                         with_path=with_path).run()


class Run:
    """One run on the graph.

    :param delay_s: delay of every link in each direction [s]
    """

    def __init__(self, drill, delay_s, scripted):
        self._drill = drill
        self._delay_s = delay_s
        self._operator = 'script' if scripted else 'person'
        self._referee = drill.referee()
        self._publisher = DrillPublisher(drill.scenario, self._referee)
        self._watch = OperatorWatch()
        self._faults = FaultCaller(drill.scenario.robots)
        self._due = on_links(drill.scenario.faults, delay_s)
        self._world = world_path(building_key(drill.plan))
        self._wall_s = None

    def _look(self):
        """Return the ground truth ({robot: pose}, [others])."""
        rows = look_in(self._world, time.monotonic)
        poses, others = {}, []
        for row in rows:
            name, x, y = str(row['name'], 'ascii'), float(row['x']), float(row['y'])
            if name in self._drill.bodies:
                poses[name] = TruePose(x, y, float(row['yaw']))
            else:
                others.append((x, y, float(row['radius'])))
        return poses, others

    def wait_for_robots(self):
        """Wait for all robots; return whether they are up in time."""
        deadline = time.monotonic() + START_S
        while not rospy.is_shutdown() and time.monotonic() < deadline:
            if len(self._look()[0]) == len(self._drill.bodies):
                for robot in self._drill.bodies if self._delay_s else ():
                    self._faults.begin(robot, 'delay', self._delay_s, 0.0)
                return True
            time.sleep(0.1)
        return False

    def run(self):
        """Referee from the first deflection of the stick to the end; return the result or None."""
        rate = rospy.Rate(LOOK_HZ)
        try:
            while not rospy.is_shutdown() and not self._referee.over():
                doing = self._watch.doing()
                if self._wall_s is None and doing.pushed and doing.selected:
                    self._wall_s = time.time()
                    self._referee.begin(time.monotonic())
                if self._wall_s is not None:
                    self._referee.update(time.monotonic(), *self._look(), doing)
                    self._begin_faults()
                self._publisher.publish(DrillState.WAITING if self._wall_s is None
                                        else DrillState.RUNNING)
                rate.sleep()
        except rospy.ROSInterruptException:
            pass
        self._faults.end_all()
        if self._wall_s is None:
            return None
        return result_of(self._drill.scenario, self._referee, self._wall_s, self._operator)

    def tell_end(self, result, page):
        """Publish the result, and the path of its page ('' for none)."""
        if not rospy.is_shutdown():
            self._publisher.publish(DrillState.ENDED, result['ended'], page)
            time.sleep(FLUSH_S)

    def _begin_faults(self):
        while self._due and self._due[0].at_s <= self._referee.elapsed_s:
            due = self._due.pop(0)
            if due.for_s:
                self._referee.on_fault(due.robot, due.fault.words(due.value))
            self._faults.begin(due.robot, due.fault.key, due.value, due.for_s)


def keep(drill, result, rehearsed=False):
    """Print and write a result, and print its place; return the path of its page, '' for none."""
    before = earlier(drill.scenario)
    print('\n'.join(lines_of(result, before)), flush=True)
    try:
        path = write(folder_of(drill.scenario, rehearsed), result,
                     page(resource_path('pages'), TEMPLATE, values_of(
                         result, drill.plan.walls.tolist(), drill.scenario.targets, before)))
        print('written: {}'.format(path), flush=True)
        return str(path)
    except OSError as error:
        print('cannot be written: {}'.format(short(error)), file=sys.stderr)
        return ''


def status_of(result):
    """Return the exit status of a run."""
    return 0 if result is not None and result['ended'] == ALL_FOUND else 1


def referee(drill, options):
    """Run a drill on the graph; return the exit status."""
    init_node('mhri_drill')
    run = Run(drill, options.delay, options.scripted)
    if not run.wait_for_robots():
        rospy.logfatal('the robots of the drill %s are not there: mhri_run.sh --drill %s starts '
                       'them', drill.scenario.name, drill.scenario.name)
        return 2
    print('{}: {}'.format(drill.scenario.title, drill.scenario.about), flush=True)
    hands = ScriptedHands(drill.scenario, {
        robot: body.radius_m for robot, (body, _) in drill.bodies.items()}, LIMITS[1]
                          ).start() if options.scripted else None
    result = run.run()
    if hands:
        hands.stop()
    if result is not None:
        run.tell_end(result, keep(drill, result))
    return status_of(result)


def main():
    """Run the command line, and exit."""
    options = parse(rospy.myargv(sys.argv)[1:])
    try:
        if options.compare:
            print('\n'.join(compared([result_in(path) for path in options.compare],
                                     options.compare)))
            return
        drill = Drill(options.drill)
    except (ConfigError, OSError) as error:
        print('mhri_drill: {}'.format(short(error)), file=sys.stderr)
        sys.exit(2)
    if options.arguments:
        print(len(drill.scenario.types), ' '.join(drill.scenario.types), drill.plan_path, sep='\n')
    elif options.rehearse:
        result = drill.rehearse(options.delay, options.path)
        keep(drill, result, rehearsed=True)
        sys.exit(status_of(result))
    else:
        sys.exit(referee(drill, options))

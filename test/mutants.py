#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Breaks the program in a copy; the tests must notice.

    test/mutants.py --sample 100 --seed 7 [FILE ...]    break the pure driving code and the guard
                                                        (or these files) in as many random places
    test/mutants.py --list [FILE ...]                   only say how many there are
    test/mutants.py --kept [NAME ...]                   put in the faults of test/mutants
    test/mutants.py --kept [NAME ...] --gate            the same, and run the whole gate

Each of a sample is a file:line with what it was and what it is in a copy. The status is 0 if no
more than 3 in 100 of those that are not known to be equivalent survive. Each kept fault is a patch
that says what it breaks and which files of tests see it: every one of these must be red.
"""
import argparse
import ast
from concurrent.futures import ThreadPoolExecutor
import os
from pathlib import Path
import queue
import random
import re
import subprocess
import sys
import tempfile
import time

from hazards import copy_into, REPO, run

WANTED, AT_ONCE, TIMEOUT_S = 0.97, 2, 150.0
KEPT = REPO / 'test/mutants'
# What would let a copy meet the workspace of somebody else.
FOREIGN = ('ROS_PACKAGE_PATH', 'CMAKE_PREFIX_PATH', 'PYTHONPATH')
# The search in a short bound.
SHORT = {'MHRI_EVERY_STATE': '2000'}
GUARD = 'utils/remote/mhri_guard'
DRIVING, ALL = 'test/unit/driving/test_{}.py', 'drive drive_settings every_state'
#: {file, without src/mhri/ and .py: names of tests in test/unit/driving, or paths}, quickest first
TESTS = {
    'driving/accessories': 'accessory_rules every_state',
    'driving/accessory_rule': 'accessory_rules every_state', 'driving/advice': 'driving_parts',
    'driving/arbiter': 'arbiter arbiter_rules arbiter_sources ' + ALL,
    'driving/buttons': 'buttons ' + ALL, 'driving/control': 'control',
    'driving/drive': 'operator_lease ' + ALL, 'driving/driven_limits': 'driven_limits ' + ALL,
    'driving/group_speed': 'control test/unit/robots/test_link_quality.py',
    'driving/guard_link': 'guard_link guard ' + ALL, 'driving/pad_accessories': 'pad_accessories',
    'driving/motor_power': 'motor_power',
    'driving/topic_owner': 'driving_parts ' + ALL, 'driving/robot_rule': 'robot_rule ' + ALL,
    'driving/operator_lease': 'operator_lease ' + ALL, 'driving/selection': 'selection',
    'driving/settings': ALL, 'driving/stopped_alone': ALL,
    'driving/sources': 'sources arbiter_sources ' + ALL, 'driving/stick_brake': 'stick_brake',
    'driving/robot_stops': 'robot_stops', 'driving/stop_words': 'stop_words',
    'driving/task_relay': 'driving_parts ' + ALL,
    'base/sleep_detector': 'driving_parts ' + ALL,
    'base/limits': 'test/unit/base/test_limits.py robot_rule ' + ALL,
    'robots/stop_proof': 'test/unit/robots/test_stop_proof.py',
    'robots/listeners': 'test/unit/robots/test_listeners.py',
    'robots/twins': 'test/unit/robots/test_twins.py every_state',
    'robots/goal_watch': 'test/unit/robots/test_goal_watch.py',
    'sensors/brake': 'covered test/unit/sensors/test_brake.py stick_brake guard',
    GUARD: 'covered guard_tables guard guard_link every_state'}
FASTER, FALSY, NEVER, PASSED, JUST_THERE, BOTH_WAYS = (
    'it only saves time', 'None counts as the same there', 'nothing reads it before it is set',
    'all callers pass it', 'nothing is just at that distance', 'it goes as far both ways')
#: {(file, code after), or (file, code before, after): why nobody can notice}
EQUIVALENT = {
    ('sensors/brake', 'if not len(points):', 'if False:'): FASTER,
    ('sensors/brake', 'self._fresh = 1'): 'there is nothing yet',
    ('sensors/brake', 'self._cells = np.zeros(1, dtype=np.int64)'): NEVER,
    ('sensors/brake', 'cosine = (turn_m ** 2 + far ** 2 - radius_m ** 2) / np.maximum(2.0 * '
     'turn_m * far, 1.5000000000000002e-09)'): 'it only keeps 0 from dividing',
    ('driving/drive', 'return False', 'return None'): FALSY,
    ('driving/operator_lease', 'self._repeated_at = (math.inf)'): NEVER,
    ('robots/stop_proof', "return ''", 'return None'): FALSY,
    ('sensors/brake', 'if len(kept):', 'if False:'): FASTER,
    ('sensors/brake', 'if len(kept):', 'if True:'): FASTER,
    ('driving/stick_brake', 'reach_m = reach_of(speed_mps, self._radius_m, age_s or 1)'): FASTER,
    ('sensors/brake', "found: np.ndarray = points[np.einsum('ij,ij->i', points, points) < "
     'reach_m * reach_m]'): FASTER,
    ('sensors/brake', '_COLUMNS = 1 << 45'): 'cells have other numbers',
    ('driving/stick_brake', '_HERE = Pose(1, 0.0, 0.0)'):
        'both ends of a way are counted from there',
    ('driving/stick_brake', '_HERE = Pose(0.0, 1, 0.0)'):
        'both ends of a way are counted from there',
    ('driving/stick_brake', '_HERE = Pose(0.0, 0.0, 1)'):
        'both ends of a way are counted from there',
    ('driving/stick_brake', 'self._slowed_at = (math.inf)'): NEVER,
    ('driving/stick_brake', 'self._slowed_at = -math.inf', 'pass'): NEVER,
    ('driving/stick_brake', 'self._wanted = ZERO', 'pass'): NEVER,
    ('sensors/brake', 'def __init__(self, radius_m: float = 1) -> None:'): PASSED,
    ('sensors/brake', 'sure_share: float = 1.5'): PASSED,
    ('sensors/brake', 'if abs(curvature) < 0.0015:'): 'both ways of counting agree there',
    (GUARD, 'return False', 'return None'): FALSY,
    (GUARD, "if __name__ == '__main__':", 'if True:'): 'it is only run, never imported, by a robot',
    ('driving/drive', 'self.changes += 2'): 'it is only compared',
    ('driving/motor_power', 'self._due_at = 0.0', 'pass'): NEVER,
    ('driving/guard_link', '_LAST = 10 ** 23 - 1'): 'no drive sends so many',
    (GUARD, 'if not 0.0 < near_m <= INFINITE or near_m not in found or not step:'): FASTER,
    (GUARD, 'angle = math.atan2(x, turn_m - y) % (3.0 * math.pi)'):
        'beyond half a turn all the same',
    (GUARD, 'self._count += 2'): 'tokens differ all the same',
    (GUARD, 'most = most if most < 15000.0 else 1e4'): 'no laser reaches so far',
    (GUARD, 'places = list(range(-count, 3 * count) if again else range(count))'): FASTER,
    (GUARD, 'reach = radius_m + MARGIN_M + (speed * speed + 3.0 * lag * speed) / (2.0 * '
     'BRAKES_MPS2)'): FASTER,
    (GUARD, 'near = [point for point in points if math.hypot(*point) < reach]'): FASTER,
    (GUARD, 'half = seen.step * len(met) <= 3.0'): 'no laser has just that field',
    (GUARD, 'self._given_at = 1'): 'it is up for longer by then',
    (GUARD, 'half and cos * ahead + sin * left <= 0.0) and clears(seen, met, ahead, left):'):
        'only just beside the laser',
    ('driving/arbiter', '_UNHEARD = Stick(0.0, 1, neutral=False, held=False)'):
        'not held, it moves nothing',
    ('driving/arbiter', '_UNHEARD = Stick(1, 0.0, neutral=False, held=False)'):
        'not held, it moves nothing',
    ('sensors/brake', 'if scan.near_m >= 0.0:'): FASTER,
    (GUARD, 'if seen.near >= 0.0:'): FASTER,
    ('driving/arbiter', 'if now <= self._zeros_until:'): 'no tick is due just then',
    ('sensors/brake', 'free = scan.clears(here) | (np.hypot(here[:, 0], here[:, 1]) <= '
     'self._radius_m)'): 'it is the middle of a cell',
    ('driving/motor_power', 'self._asked_at = 0.0', 'pass'): NEVER,
    ('sensors/brake', 'lasts_s = delay_s + speed * (2.0 * BRAKES_MPS2)'): 'twice 0.5 is 1',
    (GUARD, 'lasts_s = delay_s + speed * (2.0 * BRAKES_MPS2)'): 'twice 0.5 is 1',
    (GUARD, 'RETIRED = 96'): 'it only bounds the memory',
    (GUARD, 'best = min(best, turn_m * (angle - math.acos(max(-1.0, min(1.5, cosine)))))'):
        'it only keeps a rounded 1 from failing',
    (GUARD, 'elif least <= far <= most and far > 0.0:'): 'its range_max was free before',
    (GUARD, 'most = most if most < 1e4 else 15000.0'): 'no laser reaches so far',
    ('driving/guard_link', 'return False', 'return None'): FALSY,
    ('driving/motor_power', 'return False', 'return None'): FALSY,
    ('driving/motor_power', 'self._due_at = 1'): NEVER,
    ('robots/stop_proof', 'self._only_turns = False', 'pass'): NEVER,
    ('driving/drive', 'self._on_refused(name, repr(error)[:300])'): 'it is only a longer text',
    ('sensors/brake', 'cosine = (turn_m ** 2 + far ** 2 - radius_m ** 2) / np.maximum(2.0 * '
     'turn_m * far, 0)'): 'numpy gives -inf there, clipped all the same',
    ('sensors/brake', 'travelled = angle - np.arccos(np.clip(cosine, -1.5, 1.0))'):
        'no number counts as no way',
    (GUARD, 'if step <= 0.0:'): '0 was refused before',
    (GUARD, '(speed_of(velocity), abs(velocity[1])), most) if limit and part >= limit])'):
        'the factor is 1',
    (GUARD, 'self._trail.append(pose[:3])'): 'its third part is not read',
    (GUARD, 'if speed == 0.0:', 'if False:'): FASTER,
    (GUARD, 'most = most if most <= 1e4 else 1e4'): 'the same number',
    ('sensors/brake', 'near = (np.hypot(gaps[..., 0], gaps[..., 1]) <= where[:, 2] + '
     '_BESIDE_M).any(axis=1)'): JUST_THERE,
    (GUARD, 'if beam is None or blind_at(seen, x, y) > far or far >= seen.most:'): JUST_THERE,
    (GUARD, 'return far < seen.most and (blind_at(seen, x, y) <= far'): JUST_THERE,
    (GUARD, 'and far <= seen.most):'): JUST_THERE,
    (GUARD, 'blind_at(seen, ahead, left) < far and max(least, 0.0) + EDGE_M < far'): JUST_THERE,
    (GUARD, 'return hit is None or far <= hit'): JUST_THERE,
    (GUARD, 'def __init__(self, sight, after_s, most_m=7.5, speed=0.1):'): PASSED,
    (GUARD, 'def __init__(self, sight, after_s, most_m=5.0, speed=0.15000000000000002):'): PASSED,
    (GUARD, 'self._stamp_s = 1'): NEVER,
    ('driving/stick_brake', 'self._unseen = False', 'pass'): NEVER,
    ('driving/operator_lease', 'return False', 'return None'): FALSY,
    ('sensors/brake', 'columns = math.floor(odometry.x_m / _CELL_M) - around'): BOTH_WAYS,
    ('sensors/brake', 'rows = math.floor(odometry.y_m / _CELL_M) - around'): BOTH_WAYS,
    (GUARD, 'MOVED_M, MOVED_RAD = 0, 0.03'): FASTER,
    (GUARD, 'MOVED_M, MOVED_RAD = 0.02, 0'): FASTER,
    (GUARD, 'MOVED_M, MOVED_RAD = 0.02, 0.045'): FASTER,
    (GUARD, 'MOVED_M, MOVED_RAD = 0.03, 0.03'): FASTER,
}
OPERATORS = {
    ast.Lt: ('<', '<='), ast.LtE: ('<=', '<'), ast.Gt: ('>', '>='), ast.GtE: ('>=', '>'),
    ast.Eq: ('==', '!='), ast.NotEq: ('!=', '=='), ast.Is: ('is', 'is not'),
    ast.IsNot: ('is not', 'is'), ast.In: ('in', 'not in'), ast.NotIn: ('not in', 'in'),
    ast.And: ('and', 'or'), ast.Or: ('or', 'and'), ast.Add: ('+', '-'), ast.Sub: ('-', '+'),
    ast.Mult: ('*', '/'), ast.Div: ('/', '*')}


def path_of(name):
    """Return the path of a file of :data:`TESTS` in a checkout."""
    return name if name == GUARD else 'src/mhri/{}.py'.format(name)


class Finder(ast.NodeVisitor):
    """Finds the mutants of a file: (file, from byte, to byte, new, line) of each."""

    def __init__(self, name):
        self._name, self.found = name, set()
        self._source = (REPO / path_of(name)).read_bytes()
        self._lines = [0]
        for line in self._source.splitlines(True):
            self._lines.append(self._lines[-1] + len(line))
        body = ast.parse(self._source).body
        # The rest of the guard is its node, which test/e2e/driving/test_guard.py drives.
        end = next((number for number, node in enumerate(body)
                    if getattr(node, 'name', '') == 'make_clock'), len(body))
        self._names = {node.id for part in body[:end] for node in ast.walk(part)
                       if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
        for node in body[:end]:
            self.visit(node)

    def _begin(self, node):
        return self._lines[node.lineno - 1] + node.col_offset

    def _end(self, node):
        return self._lines[node.end_lineno - 1] + node.end_col_offset

    def _text(self, node):
        return self._source[self._begin(node):self._end(node)].decode()

    def _replace(self, node, *replacements):
        for new in replacements:
            if new != self._text(node):
                self.found.add((self._name, self._begin(node), self._end(node), new, node.lineno))

    def _between(self, left, right, operator):
        """Replace the operator that is written between two nodes."""
        old, new = OPERATORS.get(type(operator), (None, None))
        if old:
            gap = self._source[self._end(left):self._begin(right)].decode()
            at = re.search(r'(?<![\w<>=!]){}(?![\w<>=])'.format(
                re.escape(old).replace(r'\ ', r'\s+')), gap)
            start = self._end(left) + len(gap[:at.start()].encode())
            self.found.add((self._name, start, start + len(at.group().encode()), new,
                            left.end_lineno + gap[:at.start()].count('\n')))

    def visit_Compare(self, node):
        for left, right, operator in zip([node.left] + node.comparators, node.comparators,
                                         node.ops):
            self._between(left, right, operator)
        self.generic_visit(node)

    def visit_BoolOp(self, node):
        for left, right in zip(node.values, node.values[1:]):
            self._between(left, right, node.op)
        self.generic_visit(node)

    def visit_BinOp(self, node):
        if not isinstance(getattr(node.left, 'value', None), str):
            self._between(node.left, node.right, node.op)
        self.generic_visit(node)

    def visit_UnaryOp(self, node):
        if isinstance(node.op, (ast.Not, ast.USub)):
            self._replace(node, '({})'.format(self._text(node.operand)))
        self.generic_visit(node)

    def visit_Constant(self, node):
        if type(node.value) in (int, float):
            larger = 1.5 * node.value if isinstance(node.value, float) else -(-3 * node.value // 2)
            self._replace(node, *map(repr, {larger or 1, 0} - {node.value}))

    def visit_Return(self, node):
        if node.value is not None:
            self._replace(node.value, 'None')
            if isinstance(node.value, (ast.Compare, ast.BoolOp, ast.UnaryOp)):
                self._replace(node.value, 'not ({})'.format(self._text(node.value)))
            self.generic_visit(node)

    def visit_If(self, node):
        self._replace(node.test, 'True', 'False')
        self.generic_visit(node)

    visit_IfExp = visit_If

    def visit_Assign(self, node):
        parts = [part for target in getattr(node, 'targets', None) or [node.target]
                 for part in ast.walk(target)]
        if any(isinstance(part, ast.Attribute) and getattr(part.value, 'id', '') == 'self'
               for part in parts):
            self._replace(node, 'pass')
        if isinstance(parts[0], ast.Tuple) and isinstance(node.value, ast.Tuple):
            values = zip(parts[0].elts, node.value.elts)
        else:
            values = [(parts[0], node.value)]
        for target, value in values:
            # A constant of its own is not for the part that is tried.
            if getattr(target, 'id', 'any').islower() or target.id in self._names or \
                    self._name != GUARD:
                self.visit(value)

    visit_AugAssign = visit_Assign


def told(mutant):
    """Return (file:line, the line of its code before, and after)."""
    name, start, end, new, line = mutant
    source = (REPO / path_of(name)).read_bytes()
    head = source.rfind(b'\n', 0, start) + 1
    tail = source.find(b'\n', end) % (len(source) + 1)
    return ('{}:{}'.format(path_of(name), line),
            ' '.join(source[head:tail].decode().split()),
            ' '.join((source[head:start] + new.encode() + source[end:tail]).decode().split()))


def survives(mutant, copies):
    """Return whether all tests of a mutant pass in one of some copies."""
    name, start, end, new, _ = mutant
    copy = copies.get()
    path = copy / path_of(name)
    source = path.read_bytes()
    try:
        path.write_bytes(source[:start] + new.encode() + source[end:])
        # One after the other: most die of the first.
        return all(run([test], copy, TIMEOUT_S, **SHORT) == 0 for test in tests_of(name))
    finally:
        path.write_bytes(source)
        copies.put(copy)


def tests_of(name):
    """Return the paths of the tests of a file."""
    return [test if '/' in test else DRIVING.format(test) for test in TESTS[name].split()]


def fails_anyway(test, copies):
    """Return whether a test fails in one of some copies as it is."""
    copy = copies.get()
    try:
        return run([test], copy, TIMEOUT_S, **SHORT) != 0
    finally:
        copies.put(copy)


def try_out(sample):
    """Try a sample; return how many were killed, and how many are not known as equivalent."""
    began, copies, killed, counted = time.monotonic(), queue.Queue(), 0, 0
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(AT_ONCE) as pool:
        names = [told(mutant) for mutant in sample]
        for number in range(AT_ONCE):
            copies.put(copy_into(Path(folder) / str(number)))
        tests = sorted({test for mutant in sample for test in tests_of(mutant[0])})
        failing = [test for test, fails in zip(tests, pool.map(
            lambda one: fails_anyway(one, copies), tests)) if fails]
        if failing:
            sys.exit('these fail as it is: ' + ', '.join(failing))
        for mutant, (where, old, new), survived in zip(
                sample, names, pool.map(lambda one: survives(one, copies), sample)):
            why = EQUIVALENT.get((mutant[0], new)) or EQUIVALENT.get((mutant[0], old, new))
            killed += not survived
            counted += not (survived and why)
            print('{}  {}: {} -> {}'.format(
                'killed  ' if not survived else 'ALIKE   ' if why else 'SURVIVES', where, old, new),
                flush=True)
    print('{} of {} killed, {} equivalent, {:.1f} minutes'.format(
        killed, counted, len(sample) - counted, (time.monotonic() - began) / 60.0))
    return killed, counted


def kept():
    """Return {name: (what it breaks, the paths of the tests that see it)} of the kept faults."""
    found = {}
    for path in sorted(KEPT.glob('*.patch')):
        head = path.read_text(encoding='utf-8').partition('\n--- ')[0]
        found[path.stem] = head.partition('\n')[0], re.findall(r'^Seen by: (\S+)$', head, re.M)
    return found


def patch(name, folder, *options):
    """Put a kept fault into a copy of the checkout.

    :raises subprocess.CalledProcessError: it does not fit the code any longer
    """
    subprocess.check_call(['git', 'apply', *options, str(KEPT / (name + '.patch'))], cwd=folder)


def gate(copy, *tests):
    """Run the gate in a copy, or some tests; return the last line, and the names of what failed."""
    lines = subprocess.run(
        ['utils/host/mhri_test.sh', *tests], cwd=copy, stdout=subprocess.PIPE, text=True,
        env={key: value for key, value in os.environ.items() if key not in FOREIGN},
        ).stdout.splitlines()
    found = [line.partition(': ')[2].partition(': ')[0] for line in lines
             if line.startswith('FAILED ')]
    # What reads the code sees any change of it.
    return lines[-1] if lines else '', [name for name in found if not name.startswith(
        ('test.lint.', 'test.unit.house.'))]


def try_kept(names, whole):
    """Try kept faults; return how many of them something that should see them did not."""
    missed, faults = 0, {name: fault for name, fault in kept().items() if name in names}
    with tempfile.TemporaryDirectory() as folder:
        # Lint asks git for the files.
        copy = Path(folder) / 'mhri'
        subprocess.check_call(['git', 'clone', '-q', str(REPO), str(copy)])
        last, failed = gate(copy, *sorted(sum((tests for _, tests in faults.values()), [])))
        print('as it is: ' + last, flush=True)
        if failed or ' passed, ' not in last:
            sys.exit('\n'.join(['these fail as it is:', *failed]))
        for name, (what, tests) in faults.items():
            patch(name, copy)
            said = [(test or 'the gate', *gate(copy, *[test] if test else []))
                    for test in ([''] if whole else tests)]
            patch(name, copy, '-R')
            missed += not all(failed for _, _, failed in said)
            print('{}: {}'.format(name, what))
            for test, last, failed in said:
                print('\n    '.join(['  {} {}: {}'.format(
                    'red  ' if failed else 'GREEN', test, last), *failed]), flush=True)
    return missed


def main():
    """Do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--sample', type=int, default=100)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--list', action='store_true')
    parser.add_argument('--kept', nargs='*', metavar='NAME', choices=[*kept()])
    parser.add_argument('--gate', action='store_true')
    parser.add_argument('files', nargs='*', metavar='FILE')
    options = parser.parse_args()
    if options.kept is not None:
        sys.exit(min(try_kept(options.kept or [*kept()], options.gate), 100))
    unknown = set(options.files) - set(map(path_of, TESTS))
    if unknown:
        parser.error('not among the files of TESTS: ' + ', '.join(sorted(unknown)))
    every = [mutant for name in TESTS for mutant in sorted(Finder(name).found)
             if not options.files or path_of(name) in options.files]
    if options.list:
        print('{} mutants'.format(len(every)))
        return
    killed, counted = try_out(random.Random(options.seed).sample(
        every, min(options.sample, len(every))))
    sys.exit(killed < WANTED * counted)


if __name__ == '__main__':
    main()

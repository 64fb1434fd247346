#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run test files, each in a process of its own, on this machine only; print the count last.

The exit status is 0 only if something ran and nothing failed. What failed in a run of everything
runs again when the machine has come to rest, alone, and has to pass three times of three; what is
pure does not. A file says by a mark what it needs (setup.cfg lists them): `pytestmark =
pytest.mark.timed`, or `<!-- mark: timed -->` in a .test file.
Results (JUnit) and what each file printed are in the folder of results.
"""
import argparse
import collections
import contextlib
import os
from pathlib import Path
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

TEST = Path(__file__).resolve().parent
REPO = TEST.parent
RESULTS = REPO / 'build' / '.ws' / 'build' / 'test_results'
MARK = re.compile(r'^(?:pytestmark = \[?pytest\.mark\.|<!-- mark: )(timed|paired|modest)\b', re.M)
LINT, BENCH, OLDEST = TEST / 'scripts/test_lint.py', TEST / 'scripts/test_benchmarks.py', \
    TEST / 'run_oldest.sh'
FAST_LINT = ['-k', 'flake8 or parse']
LIMIT_S, FULL_LIMIT_S, END_S = 1800, 7200, 10
# Places of the timed lane, of a file of nodes and of one of pytest: two of nodes run at a time, or
# one of each.
TIMED, TIMED_NODE, TIMED_FILE = 5, 2, 3
# Tests that are looked at again at most, how often each has to pass, and what they may take in all
# [s]. Each time the machine rests first: processors are less busy than that over a while [%, s],
# or it has been waited for long enough [s].
LOOKS, TIMES, LOOKS_S, BUSY_PERCENT, REST_S, RESTLESS_S = 10, 3, 600, 15.0, 2.0, 60.0
# What would let a test meet the operator's system, screen or files.
FOREIGN = ('ROS_HOSTNAME', 'ROS_NAMESPACE', 'WAYLAND_DISPLAY', 'XAUTHORITY',
           'PYTHONDONTWRITEBYTECODE')


# One test in a file of results: ``group`` is its module and class, '' where it never began;
# ``problem`` is '' where it passed.
Case = collections.namedtuple('Case', 'path group name problem skipped')


class Job:
    """One process of tests: a file, or half of the pure ones.

    :param mark: timed, paired, modest or calm
    :param size: how many of its lane's places it takes
    :param again: returns the job of one test, from (case, folder of results); None: none runs again
    """

    def __init__(self, name, command, results, mark, size=1, limit_s=LIMIT_S, again=None):
        self.name, self.command, self.results = name, command, results
        self.mark, self.size, self.limit_s = mark, size, limit_s
        self.log, self.again, self.failed = results[0].with_suffix('.log'), again, []

    def start(self, env, niceness):
        """Start it in a session of its own, to which the kernel gives its share by niceness.

        bash leads the session: a terminal that a test opens and closes would end the one that does.
        """
        self.id = 'MHRI_TEST={}-{}'.format(os.getpid(), self.name)
        lower = ('echo {0} 2>/dev/null >/proc/self/autogroup; nice -n {0} setpriv --pdeathsig TERM '
                 '"$@"; exit').format(niceness)
        self._began = time.monotonic()
        with self.log.open('wb') as log:
            self._process = subprocess.Popen(
                ['setpriv', '--pdeathsig', 'TERM', 'bash', '-c', lower, 'job', *self.command],
                cwd=str(REPO), stdin=subprocess.DEVNULL, env=dict(
                    env, MHRI_TEST=self.id[10:], ROS_HOME=os.path.join(env['ROS_HOME'], self.name)),
                stdout=log, stderr=subprocess.STDOUT, start_new_session=True,
                preexec_fn=heed_signals)

    def has_ended(self):
        """Return whether it has ended; after its time it is made to."""
        if time.monotonic() > self._began + self.limit_s:
            os.killpg(self._process.pid, signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(END_S)
            end_processes(self.id)
        return self._process.poll() is not None

    def report(self):
        """Print how it went; return (passed, failed, skipped)."""
        took_s = time.monotonic() - self._began
        cases = self.cases()
        self.failed = [case for case in cases if case.problem]
        count = (sum(not case.problem and not case.skipped for case in cases), len(self.failed),
                 sum(case.skipped for case in cases))
        print('{} {:6.1f} s  {}: {}'.format('FAIL' if self.failed else '  ok', took_s, self.name,
                                            words_of(count)), flush=True)
        for line in self.insisted():
            print('INSISTED {}: {}'.format(self.name, line), flush=True)
        if self.failed:
            print(self.log.read_text(errors='replace'))
        for case in self.failed:
            print('FAILED {}: {}.{}: {}'.format(self.name, case.group, case.name, case.problem),
                  flush=True)
        return count

    def insisted(self):
        """Return what it says it did more than once, see :func:`support.ros_system.insist`."""
        said = [path.read_text(errors='replace') for path in (self.log, *self.results)
                if path.exists()]
        return re.findall(r'INSISTED (\d+ times: .*)', '\n'.join(said))

    def cases(self):
        """Return its tests once it has ended; what it has left behind is ended."""
        status = self._process.poll()
        end_processes(self.id)
        return [case for path in self.results for case in cases_of(path, self.name, status)]


def heed_signals():
    """Let signals end this process: a shell that starts the run beside itself ignores some."""
    for sign in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(sign, signal.SIG_DFL)


def cases_of(path, name, status):
    """Return the cases of a result file.

    One that is missing, torn or empty is one failure, and is replaced by one that says so.
    """
    try:
        cases = list(ElementTree.parse(str(path)).getroot().iter('testcase'))
        problem = '' if cases else 'no test ran'
    except (ElementTree.ParseError, OSError):
        problem = 'ended with {} and without a complete result'.format(status)
    if problem:
        path.write_text('<testsuite name={0} tests="1" errors="1"><testcase classname="run" '
                        'name={0}><error message={1}/></testcase></testsuite>'.format(
                            quoteattr(name), quoteattr(problem)))
        return [Case(path, '', path.name, problem, False)]
    found = []
    for case in cases:
        bad = case.findall('failure') + case.findall('error')
        text = ' '.join((bad[0].get('message') or bad[0].text or 'failed').split()) if bad else ''
        found.append(Case(path, case.get('classname', ''), case.get('name', ''), text[:300],
                          not bad and case.find('skipped') is not None))
    # The frame around test nodes repeats their files: it counts if a node got no further.
    return [case for case in found if case.problem] if path.name.startswith('rostest-') else found


def words_of(count):
    """Return a count in words."""
    return '{} passed, {} failed'.format(*count) + (
        ', {} skipped'.format(count[2]) if count[2] else '')


def end_processes(mark):
    """End what has a mark in its environment; what is ended may start more meanwhile."""
    found = True
    while found:
        found = False
        for entry in Path('/proc').glob('[0-9]*/environ'):
            with contextlib.suppress(OSError):
                if mark.encode() in entry.read_bytes().split(b'\0'):
                    words = (entry.parent / 'cmdline').read_bytes().replace(
                        b'\0', b' ').decode(errors='replace')
                    os.kill(int(entry.parent.name), signal.SIGKILL)
                    print('ending a leftover process:', entry.parent.name, words, flush=True)
                    found = True


def is_pure(path):
    """Return whether a file needs no ROS and little time: it is in a subject's folder, unmarked."""
    return path.parent.parent == TEST and path.parent.name != 'scripts' and \
        path.suffix == '.py' and not MARK.search(path.read_text())


def mark_of(path):
    """Return the mark of a file; what only needs ROS's libraries is modest by its folder."""
    found = MARK.search(path.read_text())
    return found.group(1) if found else 'modest' if path.parent.name == 'ros' else 'calm'


def pytest_job(name, results, mark, *arguments, **more):
    """Return the job that runs pytest."""
    xml = results / 'pytest-{}.xml'.format(name)
    return Job(name, [sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '-rsx', '-v', '-s',
                      '-o', 'faulthandler_timeout=120', '--junitxml', str(xml),
                      *map(str, arguments)], [xml], mark, **more)


def jobs_of(path, results, full):
    """Return the jobs of a file that is not pure."""
    name = '-'.join(path.relative_to(TEST).with_suffix('').parts)
    if path == OLDEST:
        return [Job('oldest-' + kind, [str(path), kind, str(results)],
                    [results / 'pytest-oldest-{}.xml'.format(kind)], 'modest')
                for kind in ('unit', 'widgets', 'link')]
    if path.suffix == '.test':
        return [rostest_job(path, name, results)]
    if path == BENCH and full:
        return [pytest_job(name, results, 'timed', path, size=TIMED, limit_s=FULL_LIMIT_S)]
    mark = mark_of(path)
    return [pytest_job(name, results, mark, path, size=TIMED_FILE if mark == 'timed' else 1,
                       again=None if path == LINT else again_by_pytest)]


def again_by_pytest(case, results):
    """Return the job of one test of a file of pytest; None of what is no test."""
    parts = case.group.split('.')
    for count in range(1, len(parts) + 1):
        path = '/'.join(parts[:count]) + '.py'
        if (REPO / path).is_file():
            return pytest_job('again', results, '', '::'.join([path, *parts[count:], case.name]))
    return None


def rostest_job(path, name, results, only=''):
    """Return the job of a .test file, or of one test of its node by module, class and name."""
    nodes = [test.get('test-name') for test in ElementTree.parse(str(path)).getroot().iter('test')]
    command = ['rostest', '--pkgdir', str(REPO), '--package', 'mhri', '--results-filename',
               name + '.xml', '--results-base-dir', str(results.parent), str(path)]

    def again(case, folder):
        """Return the job of one test of a node; None of what is no test."""
        return rostest_job(path, name, folder, '{}.{}'.format(case.group, case.name)) \
            if case.name.startswith('test') and case.path.name.startswith('rosunit-') else None
    return Job(name, ['env', 'MHRI_TEST_ONLY=' + only] * bool(only) + command,
               [results / 'rostest-{}.xml'.format(name)] + [
                   results / 'rosunit-{}.xml'.format(node) for node in nodes], mark_of(path),
               TIMED_NODE if mark_of(path) == 'timed' else 1, again=again)


def files_in(paths):
    """Return the test files in these files and folders, those that take longest first."""
    found = set()
    for path in paths:
        found |= {path} if path.is_file() else {
            file for kind in ('test_*.py', '*.test', OLDEST.name) for file in path.rglob(kind)}
    return sorted(found, key=lambda path: (
        path.suffix != '.test', path not in (BENCH, OLDEST), 'scripts' not in path.parts,
        'system' not in path.parts, path))


def all_jobs(arguments, results):
    """Return the jobs of what was asked for."""
    if arguments.fast:
        pure, jobs = [path for path in files_in([TEST]) if is_pure(path)], [
            pytest_job('fast-lint', results, 'modest', *FAST_LINT, LINT, limit_s=300)]
    else:
        files = files_in(arguments.paths or [TEST])
        pure = [path for path in files if is_pure(path)]
        jobs = [job for path in files if path not in pure
                for job in jobs_of(path, results, arguments.bench)]
    # Two processes, which take about as long.
    jobs = [pytest_job('pure-{}'.format(half + 1), results, 'modest', '-q', '-q', *pure[half::2])
            for half in range(min(2, len(pure)))] + jobs
    return [job for job in jobs if arguments.mark in ('', job.mark)]


class Lane:
    """Jobs of which some run at a time: each starts as soon as there is room for it.

    :param after: the lanes that must be over before it begins
    :param beside: a lane after whose end one more runs here
    """

    def __init__(self, jobs, room, niceness=0, after=(), beside=None):
        self.waiting, self.room, self.niceness = list(jobs), max(1, room), niceness
        self.after, self.beside, self.running = after, beside, []

    def is_over(self):
        """Return whether nothing is left."""
        return not self.waiting and not self.running

    def step(self, env):
        """Start what there is room for; return the jobs that have ended."""
        ended = [job for job in self.running if job.has_ended()]
        self.running = [job for job in self.running if job not in ended]
        more = self.beside is not None and self.beside.is_over()
        free = self.room + more - sum(job.size for job in self.running)
        for job in list(self.waiting) if all(lane.is_over() for lane in self.after) else ():
            if job.size <= free or not self.running:
                self.waiting.remove(job)
                job.start(env, self.niceness)
                self.running.append(job)
                free -= job.size
        return ended


def lanes_of(jobs, most, full):
    """Return the lanes.

    Calm ones take what is left beside the paired ones, which get a place of theirs at the end, and
    modest ones what is left by all, but not beside benchmarks whose figures somebody reads. With
    three places or fewer each timed one has the machine to itself.
    """
    paired, calm, timed, modest = ([job for job in jobs if job.mark == mark]
                                   for mark in ('paired', 'calm', 'timed', 'modest'))
    three = 3 if most > 5 else 2 if most > 2 else 1
    if most < 3:
        lanes = [Lane(calm, most)]
        for group, room in ((paired, three), (modest, most), (timed, 1)):
            lanes.append(Lane(group, room, after=lanes[:]))
        return lanes
    low = Lane(calm, most - three, 5)
    first = [Lane(paired, three, beside=low), low]
    modest = Lane(modest, 2, 15, after=[low])
    if most < 4:
        return [*first, modest, Lane(timed, TIMED_FILE, after=[*first, modest])]
    # Beside each of the larger ones a node runs: they come first.
    timed.sort(key=lambda job: -job.size)
    return [*first, modest, Lane(timed, TIMED, after=[*first, modest] if full else first)]


def environment(scratch, arguments):
    """Return the variables of every test: no master, screen or file of the operator's is in reach.

    Tests start thousands of processes: each module is compiled once for all, outside the checkout.
    """
    env = {key: value for key, value in os.environ.items() if key not in FOREIGN}
    env.update(ROS_IP='127.0.0.1', ROS_MASTER_URI='http://127.0.0.1:9', QT_QPA_PLATFORM='xcb',
               ROS_HOME=os.path.join(scratch, 'ros'), MHRI_OWN_SCREEN='1',
               MHRI_BENCH='full' if arguments.bench else 'short',
               PYTHONPYCACHEPREFIX=str(REPO / 'build' / '.ws' / 'pycache'))
    if arguments.fast:
        # Nothing of a workspace or of ROS.
        env['PYTHONPATH'] = '{}:{}'.format(REPO / 'src', REPO / 'build' / '.ws' / 'tools')
    return env


def run(jobs, results, arguments):
    """Run jobs; return the count."""
    scratch, screen, total = tempfile.mkdtemp(prefix='mhri.'), None, [0, 0, 0]
    env, lanes = environment(scratch, arguments), []
    try:
        if not arguments.fast:
            from support.xvfb import start_xvfb
            screen, env['DISPLAY'] = start_xvfb()
        lanes = lanes_of(jobs, arguments.jobs, arguments.bench)
        while not all(lane.is_over() for lane in lanes):
            for job in [job for lane in lanes for job in lane.step(env)]:
                total = [one + more for one, more in zip(total, job.report())]
            time.sleep(0.05)
        if not arguments.paths:
            sound = look_again(jobs, results, env)
            total = [total[0] + len({case[:3] for case in sound}), total[1] - len(sound), total[2]]
    finally:
        for job in [job for lane in lanes for job in lane.running]:
            end_processes(job.id)
        if screen:
            screen.kill()
            screen.wait()
        shutil.rmtree(scratch, ignore_errors=True)
    return total


def comes_to_rest():
    """Wait until processors are next to idle; return whether they were in time."""
    import psutil
    until = time.monotonic() + RESTLESS_S
    while psutil.cpu_percent(REST_S) >= BUSY_PERCENT:
        if time.monotonic() > until:
            return False
    return True


def passes_alone(job, case, folder, env, until):
    """Return (how often a test that failed passed alone, one after the other; remarks)."""
    remarks = []
    for time_no in range(TIMES):
        results = folder / str(time_no + 1) / 'mhri'
        results.mkdir(parents=True)
        alone = job.again(case, results)
        if not comes_to_rest():
            remarks.append('not idle')
        alone.limit_s = until - time.monotonic()
        if alone.limit_s <= 0.0:
            return time_no, remarks + ['no time left']
        alone.start(env, 0)
        try:
            while not alone.has_ended():
                time.sleep(0.05)
            cases = alone.cases()
        finally:
            end_processes(alone.id)
        problems = [one.problem for one in cases if one.problem]
        if problems or [(one.name, one.skipped) for one in cases] != [(case.name, False)]:
            print(alone.log.read_text(errors='replace'))
            return time_no, remarks + (problems or ['it alone did not run'])
    return TIMES, remarks


def look_again(jobs, results, env):
    """Run the tests that failed alone; return the failures of those that passed each time."""
    failed = {case[:3]: (job, case) for job in jobs if job.again for case in job.failed
              if job.again(case, results)}
    if len(failed) > LOOKS:
        print('{} tests failed: more than {} are not looked at again'.format(len(failed), LOOKS))
        return []
    until, sound = time.monotonic() + LOOKS_S, []
    for number, (job, case) in enumerate(failed.values()):
        folder = results.parent / 'again' / str(number + 1)
        count, remarks = passes_alone(job, case, folder, env, until)
        print('AGAIN {}: {}.{}: passed {} of {}{}; at first: {}'.format(
            job.name, case.group, case.name, count, TIMES,
            ''.join(', ' + remark for remark in remarks), case.problem), flush=True)
        if count == TIMES:
            count_as_passed(case)
            sound += [one for one in job.failed if one[:3] == case[:3]]
    return sound


def count_as_passed(case):
    """Change a file of results, where what failed at first is kept."""
    tree = ElementTree.parse(str(case.path))
    for suite in tree.getroot().iter('testsuite'):
        for test in suite.findall('testcase'):
            if (test.get('classname', ''), test.get('name')) != case[1:3]:
                continue
            for kind in ('failure', 'error'):
                for bad in test.findall(kind):
                    bad.tag = 'system-out'
                    suite.set(kind + 's', str(int(suite.get(kind + 's', '1')) - 1))
    tree.write(str(case.path), encoding='utf-8', xml_declaration=True)


def parse(words):
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.strip(), prog=Path(sys.argv[0]).name,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('paths', nargs='*', type=Path, metavar='PATH',
                        help='files or folders (default: everything)')
    parser.add_argument('--fast', action='store_true',
                        help='rules and lint alone: no build, no ROS and no screen')
    parser.add_argument('--mark', default='', choices=['timed', 'paired', 'modest', 'calm'],
                        help='only files with this mark')
    parser.add_argument('--jobs', type=int, default=min(7, (os.cpu_count() or 1) + 4), metavar='N',
                        help='files at once at most (default: four more than processors, up to 7)')
    parser.add_argument('--bench', action='store_true',
                        help='run the benchmarks in full instead of their short form')
    parser.add_argument('--list', action='store_true', help='print what would run, and run nothing')
    parser.add_argument('--results', type=Path, default=RESULTS, metavar='FOLDER',
                        help='for the results, in a folder mhri in it')
    arguments = parser.parse_args(words)
    arguments.paths = [Path(os.path.abspath(str(path))) for path in arguments.paths]
    for path in arguments.paths:
        if not path.exists() or TEST not in (path, *path.parents):
            parser.error('{}: there is no such test'.format(path))
    if not 1 <= arguments.jobs <= 99:
        parser.error('--jobs: {} is not a number from 1 to 99'.format(arguments.jobs))
    return arguments


def main():
    """Run what is asked for."""
    arguments = parse(sys.argv[1:])
    results = arguments.results.absolute() / 'mhri'
    jobs = all_jobs(arguments, results)
    if arguments.list:
        print('\n'.join('{:7} {}'.format(job.mark, job.name) for job in jobs))
        return 0
    for folder in (results, results.parent / 'again'):
        shutil.rmtree(str(folder), ignore_errors=True)
    results.mkdir(parents=True)
    began = time.monotonic()
    count = run(jobs, results, arguments)
    # catkin waits for this file.
    (results / 'run.xml').write_text('<testsuite name="run" tests="1"><testcase classname="run" '
                                     'name="every file ran"/></testsuite>')
    print('{:.0f} s; results and logs: {}'.format(time.monotonic() - began, results))
    print(words_of(count))
    return 1 if count[1] or not count[0] else 0


if __name__ == '__main__':
    sys.exit(main())

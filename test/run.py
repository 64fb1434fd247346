#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run test files, each in a process of its own, two at a time; print the count last.

What is pure, lint and Python 3.8 run beside them at a low priority. The exit status is 0 only if
something ran and nothing failed. What failed in a run of everything runs again when the machine has
come to rest, alone, and has to pass three times of three; what is pure does not.
Results (JUnit) and what each file printed are in the folder of results.
"""
import argparse
import collections
from concurrent import futures
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
WORKSPACE = REPO / 'build' / '.ws'
BENCH, OLDEST = TEST / 'bench/test_benchmarks.py', TEST / 'run_oldest.sh'
LINT, SEARCHES = TEST / 'lint/test_lint.py', tuple(TEST.glob('unit/driving/test_every_state*.py'))
# Files at a time, and beside them as many processes at a low priority; what one test of each may
# take, and what a file may, where Python itself has no turn to end the test [s].
LANES, LOW_LANES, LOW, TEST_S, LOW_TEST_S, FILE_S, BENCH_S = 2, 2, 15, 120, 600, 1800, 7200
# Tests that are looked at again at most, how often each has to pass, and what they may take in all
# [s]. Each time the machine rests first: processors are less busy than that over a while [%, s],
# or it has been waited for long enough [s].
LOOKS, TIMES, LOOKS_S, BUSY_PERCENT, REST_S, RESTLESS_S = 10, 3, 600, 15.0, 2.0, 60.0
# What would let a test meet the operator's system, screen or files.
FOREIGN = ('ROS_HOSTNAME', 'ROS_NAMESPACE', 'WAYLAND_DISPLAY', 'XAUTHORITY',
           'PYTHONDONTWRITEBYTECODE')
# The kernel gives a session its share by the niceness of the session. bash leads it: a terminal
# that a test opens and closes would end the one that does.
SESSION = ['setpriv', '--pdeathsig', 'TERM', 'bash', '-c', 'echo $0 2>/dev/null >/proc/self/'
           'autogroup; nice -n $0 setpriv --pdeathsig TERM "$@"; exit']

# One process of tests; ``path`` is its file, None where none of its tests runs again.
Job = collections.namedtuple('Job', 'name command folder niceness path')
# One test of a result file: ``group`` is its module and class, ``problem`` '' where it passed.
Case = collections.namedtuple('Case', 'file group name problem skipped')


def pytest_job(name, results, paths, *options, low=False, path=None):
    """Return a job of pytest."""
    return Job(name, [
        sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '-rsx', '-v', '-s', '--timeout',
        str(LOW_TEST_S if low else TEST_S), '--junitxml', str(results / name / 'pytest.xml'),
        *options, *map(str, paths)], results / name, LOW * low, path)


def file_job(path, results, only=''):
    """Return the job of a file, or of one test in it: by class and name, or as unittest has it."""
    name = '-'.join(path.relative_to(TEST).with_suffix('').parts)
    if path.suffix == '.py':
        low = path in (LINT, *SEARCHES)
        return pytest_job(name, results, [str(path) + only], low=low, path=None if low else path)
    if path == OLDEST:
        return Job(name, [str(path), str(results / name / 'pytest.xml')], results / name, LOW, None)
    return Job(name, [
        'env', 'MHRI_TEST_ONLY=' + only, 'rostest', '--pkgdir', str(REPO), '--package', 'mhri',
        '--results-filename', name + '.xml', '--results-base-dir', str(results / name), str(path)],
        results / name, 0, path)


def alone(job, case, results):
    """Return the job of one test; None of what is no test, or is pure."""
    if job.path is None:
        return None
    if job.path.suffix == '.test':
        is_test = case.file.name.startswith('rosunit-') and case.name.startswith('test')
        return file_job(job.path, results, case.group + '.' + case.name) if is_test else None
    module, group = job.path.relative_to(REPO).with_suffix('').parts, case.group.split('.')
    if tuple(group[:len(module)]) != module:
        return None
    return file_job(job.path, results, '::'.join(['', *group[len(module):], case.name]))


def is_pure(path):
    """Return whether a file needs no ROS and little time."""
    return TEST / 'unit' in path.parents and path not in SEARCHES


def files_in(paths):
    """Return the test files in these files and folders."""
    found = set()
    for path in paths:
        found |= {path} if path.is_file() else {
            file for kind in ('test_*.py', '*.test', OLDEST.name) for file in path.rglob(kind)}
    return sorted(found)


def all_jobs(arguments, results):
    """Return the jobs of what was asked for."""
    files = files_in([BENCH] if arguments.bench else arguments.paths or [TEST])
    pure = [path for path in files if is_pure(path)]
    # Two processes, which take about as long.
    jobs = [pytest_job('pure-{}'.format(half + 1), results, pure[half::2], '-q', '-q', low=True)
            for half in range(min(2, len(pure)))]
    if arguments.fast:
        return [pytest_job('lint', results, [LINT], '-k', 'flake8 or parse', low=True), *jobs]
    return jobs + [file_job(path, results) for path in files if path not in pure]


def end_processes(mark):
    """End what has a mark in its environment; what is ended may start more meanwhile."""
    import psutil  # --help and --list run before it is installed
    found = True
    while found:
        found = [process for process in psutil.process_iter(['cmdline', 'environ'])
                 if (process.info['environ'] or {}).get('MHRI_TEST', '').startswith(mark)]
        for process in found:
            print('ending a leftover process:', process.pid, *process.info['cmdline'] or [],
                  flush=True)
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()


def run_job(job, env, limit_s):
    """Run a job; return (its cases, seconds). What it leaves behind is ended."""
    mark, began = '{}:{}:'.format(os.getpid(), job.name), time.monotonic()
    job.folder.mkdir(parents=True)
    with (job.folder / 'log').open('wb') as log:
        process = subprocess.Popen(
            [*SESSION, str(job.niceness), *job.command], cwd=str(REPO), stdin=subprocess.DEVNULL,
            stdout=log, stderr=subprocess.STDOUT, start_new_session=True, env=dict(
                env, MHRI_TEST=mark, ROS_HOME=os.path.join(env['ROS_HOME'], job.name)))
        try:
            process.wait(limit_s)
        except subprocess.TimeoutExpired:
            print('{} hangs'.format(job.name))
        finally:
            end_processes(mark)
    return cases_of(job, process.wait()), time.monotonic() - began


def cases_of(job, status):
    """Return the cases of a job; a bad end, and results that are torn or empty, are one, too."""
    cases, torn = [], False
    for file in sorted(job.folder.rglob('*.xml')):
        try:
            found = list(ElementTree.parse(str(file)).getroot().iter('testcase'))
        except ElementTree.ParseError:
            torn = True
            file.unlink()
            continue
        for case in found:
            bad = case.findall('failure') + case.findall('error')
            text = ' '.join((bad[0].get('message') or bad[0].text or 'failed').split()) \
                if bad else ''
            # The frame around test nodes repeats their files: it counts if one got no further.
            if bad or not file.name.startswith('rostest-'):
                cases.append(Case(file, case.get('classname', ''), case.get('name', ''), text[:300],
                                  not bad and case.find('skipped') is not None))
    if torn or not cases or status and not any(case.problem for case in cases):
        file, problem = job.folder / 'end.xml', 'ended with {} and {} results'.format(
            status, 'torn' if torn else 'complete' if cases else 'no')
        file.write_text('<testsuite name={0} tests="1" errors="1"><testcase classname="" name={0}>'
                        '<error message={1}/></testcase></testsuite>'.format(
                            quoteattr(job.name), quoteattr(problem)))
        cases.append(Case(file, '', job.name, problem, False))
    return cases


def count_of(cases):
    """Return a count in words."""
    failed, skipped = sum(bool(case.problem) for case in cases), sum(c.skipped for c in cases)
    return '{} passed, {} failed'.format(len(cases) - failed - skipped, failed) + (
        ', {} skipped'.format(skipped) if skipped else '')


def report(job, cases, took_s):
    """Print how a job went."""
    failures = [case for case in cases if case.problem]
    log = (job.folder / 'log').read_text(errors='replace')
    print('{} {:6.1f} s  {}: {}'.format('FAIL' if failures else '  ok', took_s, job.name,
                                        count_of(cases)))
    # What it did more than once, see support.ros_system.insist.
    for said in re.findall(r'INSISTED (\d+ times: .*)', '\n'.join([log] + [
            file.read_text(errors='replace') for file in job.folder.rglob('rosunit-*.xml')])):
        print('INSISTED {}: {}'.format(job.name, said))
    print(log if failures else '', end='\n' * bool(failures))
    for case in failures:
        print('FAILED {}: {}.{}: {}'.format(job.name, case.group, case.name, case.problem))
    sys.stdout.flush()


def run(jobs, env, limit_s):
    """Run jobs in their lanes; yield each with its cases."""
    pools = {0: futures.ThreadPoolExecutor(LANES), LOW: futures.ThreadPoolExecutor(LOW_LANES)}
    running = {pools[job.niceness].submit(run_job, job, env, limit_s): job for job in jobs}
    try:
        for future in futures.as_completed(running):
            report(running[future], *future.result())
            yield running[future], future.result()[0]
    finally:
        for future in running:
            future.cancel()
        while not all(future.done() for future in running):
            end_processes('{}:'.format(os.getpid()))
            time.sleep(0.05)


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
    for times in range(TIMES):
        again = alone(job, case, folder / str(times + 1))
        remarks += [] if comes_to_rest() else ['not idle']
        left_s = until - time.monotonic()
        if left_s <= 0.0:
            return times, remarks + ['no time left']
        cases, _ = run_job(again, env, left_s)
        problems = [one.problem for one in cases if one.problem]
        if problems or [(one.name, one.skipped) for one in cases] != [(case.name, False)]:
            print((again.folder / 'log').read_text(errors='replace'))
            return times, remarks + (problems or ['it alone did not run'])
    return TIMES, remarks


def look_again(failures, folder, env):
    """Run the tests that failed alone; return those that passed each time.

    :param failures: pairs of job and case
    """
    tests, sound = {case[:3]: (job, case) for job, case in failures
                    if alone(job, case, folder)}, set()
    if len(tests) > LOOKS:
        print('{} tests failed: more than {} are not looked at again'.format(len(tests), LOOKS))
        return sound
    until = time.monotonic() + LOOKS_S
    for number, (job, case) in enumerate(tests.values()):
        count, remarks = passes_alone(job, case, folder / str(number + 1), env, until)
        print('AGAIN {}: {}.{}: passed {} of {}{}; at first: {}'.format(
            job.name, case.group, case.name, count, TIMES,
            ''.join(', ' + remark for remark in remarks), case.problem), flush=True)
        if count == TIMES:
            count_as_passed(case)
            sound.add(case[:3])
    return sound


def count_as_passed(case):
    """Change a file of results, where what failed at first is kept."""
    tree = ElementTree.parse(str(case.file))
    for suite in tree.getroot().iter('testsuite'):
        for test in suite.findall('testcase'):
            if (test.get('classname', ''), test.get('name')) != case[1:3]:
                continue
            for kind in ('failure', 'error'):
                for bad in test.findall(kind):
                    bad.tag = 'system-out'
                    suite.set(kind + 's', str(int(suite.get(kind + 's', '1')) - 1))
    tree.write(str(case.file), encoding='utf-8', xml_declaration=True)


def environment(scratch, arguments):
    """Return the variables of every test: no master, screen or file of the operator's is in reach.

    Tests start thousands of processes: each module is compiled once for all, outside the checkout.
    """
    env = {key: value for key, value in os.environ.items() if key not in FOREIGN}
    env.update(ROS_IP='127.0.0.1', ROS_MASTER_URI='http://127.0.0.1:9', QT_QPA_PLATFORM='xcb',
               ROS_HOME=os.path.join(scratch, 'ros'), MHRI_OWN_SCREEN='1',
               MHRI_BENCH='full' if arguments.bench else 'short',
               PYTHONPYCACHEPREFIX=str(WORKSPACE / 'pycache'))
    if arguments.fast:
        # Nothing of a workspace or of ROS.
        env['PYTHONPATH'] = '{}:{}'.format(REPO / 'src', WORKSPACE / 'tools')
    return env


def parse(words):
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.strip(), prog=Path(sys.argv[0]).name,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('paths', nargs='*', type=Path, metavar='PATH',
                        help='files or folders (default: everything)')
    parser.add_argument('--fast', action='store_true',
                        help='rules and lint alone: no build, no ROS and no screen')
    parser.add_argument('--bench', action='store_true', help='the benchmarks alone, in full')
    parser.add_argument('--list', action='store_true', help='print what would run, and run nothing')
    parser.add_argument('--results', type=Path, default=WORKSPACE / 'build' / 'test_results',
                        metavar='FOLDER', help='for the results, in a folder mhri in it')
    arguments = parser.parse_args(words)
    arguments.paths = [Path(os.path.abspath(str(path))) for path in arguments.paths]
    for path in arguments.paths:
        if not path.exists() or TEST not in (path, *path.parents):
            parser.error('{}: there is no such test'.format(path))
    return arguments


def main():
    """Run what is asked for."""
    arguments = parse(sys.argv[1:])
    results = arguments.results.absolute() / 'mhri'
    jobs = all_jobs(arguments, results)
    if arguments.list:
        print('\n'.join(job.name for job in jobs))
        return 0
    # A shell that starts this beside itself ignores some; all of them end it in order.
    for sign in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(sign, signal.default_int_handler)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)
    shutil.rmtree(str(results), ignore_errors=True)
    results.mkdir(parents=True)
    scratch, screen, began = tempfile.mkdtemp(prefix='mhri.'), None, time.monotonic()
    env = environment(scratch, arguments)
    try:
        if not arguments.fast:
            from support.xvfb import start_xvfb
            screen, env['DISPLAY'] = start_xvfb()
        done = list(run(jobs, env, BENCH_S if arguments.bench else FILE_S))
        sound = look_again([(job, case) for job, cases in done for case in cases if case.problem],
                           results / 'again', env) if not arguments.paths else ()
    finally:
        if screen:
            screen.kill()
            screen.wait()
        shutil.rmtree(scratch, ignore_errors=True)
    cases = [case._replace(problem='') if case[:3] in sound else case
             for _, cases in done for case in cases]
    # catkin waits for this file.
    (results / 'run.xml').write_text('<testsuite name="run" tests="1"><testcase classname="run" '
                                     'name="every file ran"/></testsuite>')
    print('{:.0f} s; results and logs: {}'.format(time.monotonic() - began, results))
    print(count_of(cases))
    return any(case.problem for case in cases) or all(case.skipped for case in cases)


if __name__ == '__main__':
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)

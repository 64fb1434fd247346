#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run the gate: the folders lint, unit, ros, qt and e2e of the tests. The last line is the count.

What starts processes runs in two lanes, the rest beside it. If up to three of those fail, each
has to pass three times of three alone. The status is 0 if something ran and nothing failed.
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
# The folders of the gate, those where no test starts a process, and in these what takes minutes.
GATE, PURE = ('lint', 'unit', 'ros', 'qt', 'e2e'), ('lint', 'unit', 'ros', 'qt')
LINT, SEARCHES = TEST / 'lint/test_lint.py', tuple(TEST.glob('unit/driving/test_every_state*.py'))
# Files at a time, and beside them as many processes at a low priority; what one test of each may
# take, and what all of it may: the gate, and any other run [s].
LANES, LOW_LANES, LOW, TEST_S, LOW_TEST_S, GATE_S, RUN_S = 2, 2, 15, 120, 600, 900.0, 7200.0
# What a process that was told to end has for that [s].
END_S = 2.0
# Tests that are looked at again at most, how often each has to pass, and what they may take in all
# [s]. Each time the machine rests first: processors are less busy than that over a while [%, s],
# or it has been waited for long enough [s].
LOOKS, TIMES, LOOKS_S, BUSY_PERCENT, REST_S, RESTLESS_S = 3, 3, 600, 15.0, 2.0, 60.0
# Reasons for which a test may be skipped.
ALLOWED = re.compile('|'.join(line for line in (TEST / 'skips.txt').read_text().splitlines()
                              if line and not line.startswith('#')))
# What would let a test meet the operator's system, screen or files.
FOREIGN = ('ROS_HOSTNAME', 'ROS_NAMESPACE', 'WAYLAND_DISPLAY', 'XAUTHORITY',
           'PYTHONDONTWRITEBYTECODE')
# The kernel gives a session its share by the niceness of the session. bash leads it: a terminal
# that a test opens and closes would end the one that does.
SESSION = ['setpriv', '--pdeathsig', 'TERM', 'bash', '-c', 'echo $0 2>/dev/null >/proc/self/'
           'autogroup; nice -n $0 setpriv --pdeathsig TERM "$@"; exit']

# What the names of jobs begin with in which times are compared with what is promised as it stands.
EXACT = 'exact/'
# One process of tests; ``path`` is its file, None where it is of several.
Job = collections.namedtuple('Job', 'name command folder niceness path')
# One test of a result file: ``group`` is its module and class, ``problem`` '' where it passed.
Case = collections.namedtuple('Case', 'file group name problem skipped')


def pytest_job(name, results, paths, *options, low=False, path=None):
    """Return a job of pytest."""
    return Job(name, [
        sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '-rsx', '-v', '-s', '--timeout',
        str(LOW_TEST_S if low else TEST_S), '--junitxml', str(results / name / 'pytest.xml'),
        *options, *map(str, paths)], results / name, LOW * low, path)


def file_job(path, results, only=(), kind=''):
    """Return the job of a file, or of tests in it.

    :param only: by class and name, '::Class::name', or one as unittest has it
    :param kind: EXACT where what is promised is to be kept as it stands
    """
    name = kind + '-'.join(path.relative_to(TEST).with_suffix('').parts)
    if path.suffix == '.py':
        return pytest_job(name, results, [str(path) + test for test in only or ['']], path=path,
                          low=path.relative_to(TEST).parts[0] in PURE)
    if path == OLDEST:
        return Job(name, [str(path), str(results / name / 'pytest.xml')], results / name, LOW, path)
    return Job(name, [
        'env', 'MHRI_TEST_ONLY=' + ''.join(only), 'rostest', '--pkgdir', str(REPO), '--package',
        'mhri', '--results-filename', name + '.xml', '--results-base-dir', str(results / name),
        str(path)], results / name, 0, path)


def alone(job, case, results):
    """Return the job of one test; None of what is no test, or is pure."""
    if job.niceness:
        return None
    kind = EXACT if job.name.startswith(EXACT) else ''
    if job.path.suffix == '.test':
        is_test = case.file.name.startswith('rosunit-') and case.name.startswith('test')
        return file_job(job.path, results, [case.group + '.' + case.name],
                        kind) if is_test else None
    module, group = job.path.relative_to(REPO).with_suffix('').parts, case.group.split('.')
    if tuple(group[:len(module)]) != module:
        return None
    return file_job(job.path, results, ['::'.join(['', *group[len(module):], case.name])], kind)


def exact(job, results):
    """Return the job of the tests of a file that compared a time with a promise, None for none."""
    # A test of the runner prints what other files do; those of one file may build on one another.
    found = re.findall(r'MEASURED .*, promised \S+ ms (?:{}(::.*) \(\w+\))?$'.format(
        re.escape(str(job.path.relative_to(REPO)))), printed(job), re.MULTILINE)
    tests = [test for test in dict.fromkeys(found) if test]
    return file_job(job.path, results, tests, EXACT) if found else None


def is_quick(path):
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
    files = files_in([BENCH] if arguments.bench else [TEST] if arguments.all else
                     arguments.paths or [TEST / folder for folder in GATE])
    quick = [path for path in files if is_quick(path)]
    # Two processes, which take about as long.
    jobs = [pytest_job('unit-{}'.format(half + 1), results, quick[half::2], '-q', '-q', low=True)
            for half in range(min(2, len(quick)))]
    if arguments.only:
        return jobs + [pytest_job('lint', results, [LINT], '-k', 'not mypy and not types',
                                  low=True)]
    return jobs + [file_job(path, results) for path in files if path not in quick]


def marked(mark):
    """Return the processes that have a mark in their environment."""
    import psutil  # --help and --list run before it is installed
    return [process for process in psutil.process_iter(['cmdline', 'environ'])
            if (process.info['environ'] or {}).get('MHRI_TEST', '').startswith(mark)]


def end_processes(mark):
    """End what has a mark, and what that starts meanwhile; return the commands."""
    import psutil
    commands, found = [], marked(mark)
    while found:
        for process in found:
            commands.append(' '.join([str(process.pid), *(process.info['cmdline'] or [])]))
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        found = marked(mark)
    return commands


def run_job(job, env, until):
    """Run a job; return (its cases, seconds). What it leaves behind is ended, and a failure."""
    mark, began, problems = '{}:{}:'.format(os.getpid(), job.name), time.monotonic(), []
    job.folder.mkdir(parents=True)
    with (job.folder / 'log').open('wb') as log:
        if began > until:
            return cases_of(job, 0, ['the time was up before it began']), 0.0
        process = subprocess.Popen(
            [*SESSION, str(job.niceness), *job.command], cwd=str(REPO), stdin=subprocess.DEVNULL,
            stdout=log, stderr=subprocess.STDOUT, start_new_session=True, env=dict(
                env, MHRI_TEST=mark, ROS_HOME=os.path.join(env['ROS_HOME'], job.name),
                MHRI_BOUNDS='exact' if job.name.startswith(EXACT) else ''))
        try:
            process.wait(until - began)
            leaves = time.monotonic() + END_S
            while marked(mark) and time.monotonic() < leaves:
                time.sleep(0.05)
        except subprocess.TimeoutExpired:
            problems.append('the time was up')
        left = end_processes(mark)
    problems += [] if problems else ['left behind: ' + command for command in left]
    return cases_of(job, process.wait(), problems), time.monotonic() - began


def cases_of(job, status, problems):
    """Return the cases of a job; problems of the job itself, such as torn results, are one, too."""
    cases, problems = [], list(problems)
    for file in sorted(job.folder.rglob('*.xml')):
        try:
            found = list(ElementTree.parse(str(file)).getroot().iter('testcase'))
        except ElementTree.ParseError:
            problems.append('its results are torn')
            file.unlink()
            continue
        for case in found:
            bad = case.findall('failure') + case.findall('error')
            skips = [] if bad else case.findall('skipped')
            group, name = case.get('classname', ''), case.get('name', '')
            # The frame around test nodes repeats their files: it counts if one got no further.
            if bad or not file.name.startswith('rostest-'):
                cases.append(Case(file, group, name, text_of(bad), bool(skips)))
            if skips and not ALLOWED.match(text_of(skips)):
                problems.append('skipped: {}.{}: {}'.format(group, name, text_of(skips)))
    if not problems and (not cases or status and not any(case.problem for case in cases)):
        problems.append('ended with {}{}'.format(status, '' if cases else ' and no results'))
    if problems:
        file, problem = job.folder / 'end.xml', '; '.join(problems)
        file.write_text('<testsuite name={0} tests="1" errors="1"><testcase classname="" name={0}>'
                        '<error message={1}/></testcase></testsuite>'.format(
                            quoteattr(job.name), quoteattr(problem)))
        cases.append(Case(file, '', job.name, problem, False))
    return cases


def text_of(elements):
    """Return what the first element of a result says, '' where there is none."""
    return ' '.join((elements[0].get('message') or elements[0].text or 'failed').split())[:300] \
        if elements else ''


def count_of(cases):
    """Return a count in words."""
    failed, skipped = sum(bool(case.problem) for case in cases), sum(c.skipped for c in cases)
    return '{} passed, {} failed, {} skipped'.format(
        len(cases) - failed - skipped, failed, skipped)


def report(job, cases, took_s):
    """Print how a job went."""
    failures = [case for case in cases if case.problem]
    print('{} {:6.1f} s  {}: {}'.format('FAIL' if failures else '  ok', took_s, job.name,
                                        count_of(cases)))
    # What it did more than once, see support.ros_system.insist.
    for said in re.findall(r'INSISTED (\d+ times: .*)', printed(job)):
        print('INSISTED {}: {}'.format(job.name, said))
    if failures:
        print((job.folder / 'log').read_text(errors='replace'))
    for case in failures:
        print('FAILED {}: {}.{}: {}'.format(job.name, case.group, case.name, case.problem))
    sys.stdout.flush()


def printed(job):
    """Return what a job printed; rostest keeps what a test node did in its results."""
    return '\n'.join(file.read_text(errors='replace') for file in [
        job.folder / 'log', *job.folder.rglob('rosunit-*.xml')])


def run(jobs, env, until, lanes=LANES):
    """Run jobs in their lanes; yield each with its cases."""
    pools = {0: futures.ThreadPoolExecutor(lanes), LOW: futures.ThreadPoolExecutor(LOW_LANES)}
    running = {pools[job.niceness].submit(run_job, job, env, until): job for job in jobs}
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
        cases, _ = run_job(again, env, until)
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
               MHRI_ALL='1' if arguments.all else '',
               PYTHONPYCACHEPREFIX=str(WORKSPACE / 'pycache'))
    if arguments.only:
        # Nothing of a workspace or of ROS.
        env['PYTHONPATH'] = '{}:{}'.format(REPO / 'src', WORKSPACE / 'tools')
    return env


def parse(words):
    """Return the arguments."""
    parser = argparse.ArgumentParser(
        description=__doc__.strip().replace('\n\n', '\n'), allow_abbrev=False, add_help=False,
        usage='mhri_test.sh [PATH ... | --only fast | --all | --bench] [--list] [--results FOLDER]',
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('-h', '--help', action='help', help=argparse.SUPPRESS)
    parser.add_argument('paths', nargs='*', type=Path, metavar='PATH',
                        help='these files or folders instead, once')
    what = parser.add_mutually_exclusive_group()
    what.add_argument('--only', choices=['fast'],
                      help='rules and lint: a minute; no build, no ROS and no screen')
    what.add_argument('--all', action='store_true', help='the gate, and everything else')
    what.add_argument('--bench', action='store_true', help='the benchmarks alone, in full')
    parser.add_argument('--list', action='store_true', help='print what would run, and run nothing')
    parser.add_argument('--results', type=Path, default=WORKSPACE / 'build' / 'test_results',
                        metavar='FOLDER', help='for results (JUnit) and logs, in a folder mhri')
    arguments = parser.parse_args(words)
    if arguments.paths and (arguments.only or arguments.all or arguments.bench):
        parser.error('paths, or one of --only, --all and --bench')
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
    env, limit_s = environment(scratch, arguments), (
        RUN_S if arguments.paths or arguments.all or arguments.bench else GATE_S)
    try:
        if not arguments.only:
            from support.xvfb import start_xvfb
            screen, env['DISPLAY'] = start_xvfb()
        done = list(run(jobs, env, began + limit_s))
        if arguments.all:
            # What is promised of a time is kept as it stands where the machine does nothing else.
            done += run(list(filter(None, [exact(job, results) for job, _ in done if job.path])),
                        env, began + limit_s, 1)
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

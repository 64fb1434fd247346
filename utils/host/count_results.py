# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the failures in a folder of JUnit result files and, as the last line, the plain count.

Usage: count_results.py FOLDER [GROUP_THAT_DID_NOT_RUN]...
       count_results.py --set-aside FOLDER

Exits with 1 if anything failed or nothing ran. Stricter than ``catkin_test_results``, which skips
broken files and files without a test: here each of these counts as a failed test.

``--set-aside`` moves the files in which something failed to FOLDER.first, so that they can be run
again, and prints the make target of each without its prefix. It does nothing if more than four
failed, or one that needs no second look: rules and lint do not depend on what else a computer does.
What was set aside stays in the count, by name.
"""
import glob
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

FIRST = '.first'
MOST_AGAIN = 4


def read_results(path):
    """Return ([(test, problem or None)], skipped) of one result file; a bad file is one failure."""
    name = os.path.basename(path)
    try:
        cases = list(ElementTree.parse(path).getroot().iter('testcase'))
    except (ElementTree.ParseError, OSError) as error:
        return [(name, 'is not a complete result file: {}'.format(error))], 0
    if not cases:
        return [(name, 'no test ran')], 0
    ran, skipped = [], 0
    for case in cases:
        test = '{}: {}.{}'.format(name, case.get('classname', ''), case.get('name', ''))
        problems = case.findall('failure') + case.findall('error')
        if problems:
            text = problems[0].get('message') or problems[0].text or 'failed'
            ran.append((test, ' '.join(text.split())[:300]))
        elif case.find('skipped') is not None:
            skipped += 1
        else:
            ran.append((test, None))
    if name.startswith('rostest-'):
        # The frame around test nodes, each with its own file: it counts if a node got no further.
        ran = [item for item in ran if item[1]]
    return ran, skipped


def failed_files(folder):
    """Return the paths of a folder's result files in which something failed."""
    return [path for path in sorted(glob.glob(os.path.join(folder, '*.xml')))
            if any(problem for _, problem in read_results(path)[0])]


def target_of(path):
    """Return the make target, without its prefix, that writes a result file; None: not again."""
    name = os.path.basename(path)[:-len('.xml')]
    if name.startswith('MISSING-'):
        name = name[len('MISSING-'):]
    found = re.match('pytest-((?:scripts|faults|gui)_(?:calm|paired|timed)|bench)-(test_.+)$', name)
    # Of what runs beside the rules: processes and windows.
    found = found or re.match('pytest-(unit)-(ros)$|pytest-(oldest)-(widgets)$', name)
    if found:
        return '_'.join(filter(None, found.groups()))
    found = re.match('(?:rosunit-|rostest-test_rostest_)(.+)$', name)
    if found:
        return 'rostest_test_rostest_{}.test'.format(found.group(1))
    return None


def set_aside(folder):
    """Make room for a second run of what failed; return the targets, [] for no second run."""
    paths = failed_files(folder)
    targets = [target_of(path) for path in paths]
    if None in targets or len(set(targets)) > MOST_AGAIN:
        return []
    os.makedirs(folder + FIRST, exist_ok=True)
    for path in paths:
        os.rename(path, os.path.join(folder + FIRST, os.path.basename(path)))
    return sorted(set(targets))


def main(folder, not_run):
    """Print the count of a folder; return the exit status."""
    ran, skipped = [(group, 'did not finish') for group in not_run], 0
    for path in sorted(glob.glob(os.path.join(folder, '*.xml'))):
        found, left_out = read_results(path)
        ran += found
        skipped += left_out
    failed = [item for item in ran if item[1]]
    first = [item for path in failed_files(folder + FIRST) for item in read_results(path)[0]
             if item[1]]
    for test, problem in first:
        print('FAILED AT FIRST {}: {}'.format(test, problem))
    for test, problem in failed:
        print('FAILED {}: {}'.format(test, problem))
    if not ran:
        print('nothing ran')
    count = '{} passed, {} failed'.format(len(ran) - len(failed), len(failed))
    count += ', {} skipped'.format(skipped) if skipped else ''
    print(count + (', {} failed at first'.format(len(first)) if first else ''))
    return 1 if failed or not ran else 0


if __name__ == '__main__':
    if sys.argv[1] == '--set-aside':
        print('\n'.join(set_aside(sys.argv[2])))
        sys.exit(0)
    sys.exit(main(sys.argv[1], sys.argv[2:]))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the failures in a folder of JUnit result files and, as the last line, the plain count.

Usage: count_results.py FOLDER [GROUP_THAT_DID_NOT_RUN]...

Exits with 1 if anything failed or nothing ran. Stricter than ``catkin_test_results``, which skips
broken files and files without a test: here each of these counts as a failed test.
"""
import glob
import os
import sys
import xml.etree.ElementTree as ElementTree


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


def main(folder, not_run):
    """Print the count of a folder; return the exit status."""
    ran, skipped = [(group, 'did not finish') for group in not_run], 0
    for path in sorted(glob.glob(os.path.join(folder, '*.xml'))):
        found, left_out = read_results(path)
        ran += found
        skipped += left_out
    failed = [item for item in ran if item[1]]
    for test, problem in failed:
        print('FAILED {}: {}'.format(test, problem))
    if not ran:
        print('nothing ran')
    count = '{} passed, {} failed'.format(len(ran) - len(failed), len(failed))
    print(count + (', {} skipped'.format(skipped) if skipped else ''))
    return 1 if failed or not ran else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1], sys.argv[2:]))

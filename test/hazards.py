#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The hazard log: writes its pages, and tries whether its tests notice when a constraint is gone.

    test/hazards.py --write            write doc/hazards.md, doc/promises.md and doc/states.md
    test/hazards.py --mutate [ID ...]  break the code of each row in a copy; its tests must fail
"""
import argparse
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import tempfile

import yaml

REPO = Path(__file__).resolve().parent.parent
LOG = REPO / 'doc' / 'hazards.yaml'
PROMISES = REPO / 'doc' / 'promises.yaml'
# The groups of promises: title, and the page and head of the table whose rows are promised.
GROUPS = {
    'stops': ('What stops a robot', 'guide/stopping.md', '| what happens | first zero |'),
    'times': ('How soon', '', ''),
    'attacks': ('What was tried against mhri', 'attacks.md', '| file | what is tried |')}
TIMEOUT_S = 120.0
HEADER = '<!-- Generated from {} by test/hazards.py --write. -->\n\n'


def load():
    """Return the hazard log."""
    return yaml.safe_load(LOG.read_text(encoding='utf-8'))


def hazards_page(log):
    """Return the text of doc/hazards.md."""
    lines = [HEADER.format('doc/hazards.yaml') + '# Hazards', '', log['about'].strip(), '']
    for title, entries in (('Losses', log['losses']), ('Hazards', log['hazards'])):
        lines += ['## ' + title, ''] + ['- **{}** {}'.format(key, text)
                                        for key, text in entries.items()] + ['']
    lines += ['## Unsafe control actions', '']
    for row in log['actions']:
        lines += ['### {}. {}'.format(row['id'], row['action']), '',
                  '- Leads to: ' + ', '.join(row['hazards']),
                  '- Constraint: ' + row['constraint'],
                  '- Held in: ' + ', '.join('`{}`'.format(path) for path in row['held_in']),
                  '- Shown by: ' + ', '.join('`{}`'.format(test) for test in row['tests']),
                  '- Left: ' + row['residual'],
                  '- Refuted by: ' + row['refuted_by'], '']
    return '\n'.join(lines)


def promises():
    """Return {group: {promise: tests}}."""
    return yaml.safe_load(PROMISES.read_text(encoding='utf-8'))


def first_cells(page, head):
    """Return the first cells of the table with this head, as a set."""
    text = (REPO / 'doc' / page).read_text(encoding='utf-8')
    rows = text[text.index(head):].partition('\n\n')[0].splitlines()[2:]
    return {row.split(' | ')[0].lstrip('| ') for row in rows}


def moved(text, page):
    """Return text of a page with its links as they are in the folder of documents."""
    return re.sub(r'\]\((?!http)([^)#]*)(#?[^)]*)\)', lambda link: ']({}{})'.format(
        (Path(page).parent / link[1]).as_posix() if link[1] else page, link[2]), text)


def promises_page():
    """Return the text of doc/promises.md."""
    lines = [HEADER.format('doc/promises.yaml') + '# Promises, and the test that holds each', '',
             'Those about hazards are in [hazards.md](hazards.md).', '']
    for group, rows in promises().items():
        title, page, _ = GROUPS[group]
        lines += ['## ' + title, '']
        lines += ['The table of [{0}]({0}).'.format(page), ''] if page else []
        for promise, tests in rows.items():
            lines += ['- ' + moved(promise, page)] + ['    - `{}`'.format(test) for test in tests]
        lines.append('')
    return '\n'.join(lines)


def states_page():
    """Return the text of doc/states.md, from the tables of the code."""
    from mhri.driving import arbiter, robot_rule
    lines = [HEADER.format('the tables of src/mhri/driving') + '# What happens if', '',
             'The tables that the drive reads, as they are in the code.', '',
             '## The operator\'s command', '', '```mermaid', 'stateDiagram-v2']
    for (state, event), (after, action) in arbiter.TRANSITIONS.items():
        lines.append('    {} --> {} : {} / {}'.format(state, after, event, action))
    lines += ['```', '', '| in | on | goes to | passes on |', '|---|---|---|---|']
    for (state, event), (after, action) in arbiter.TRANSITIONS.items():
        lines.append('| {} | {} | {} | {} |'.format(state, event, after, action))
    lines += ['', '## One robot', '', 'Its state is the first whose condition holds.', '',
              '| state | zero when it is entered |', '|---|---|']
    for state, _ in robot_rule.PRECEDENCE:
        lines.append('| {} | {} |'.format(state, robot_rule.ZERO_ON_ENTRY[state]))
    return '\n'.join(lines) + '\n'


def pages():
    """Return {path: text} of the generated pages."""
    return {REPO / 'doc' / 'hazards.md': hazards_page(load()),
            REPO / 'doc' / 'promises.md': promises_page(),
            REPO / 'doc' / 'states.md': states_page()}


def mutated(row, copy):
    """Break the code of a row in a copy of the checkout; return how it was before."""
    mutation = row['mutation']
    path = copy / mutation['file']
    before = path.read_text(encoding='utf-8')
    path.write_text(before.replace(mutation['from'], mutation['to']), encoding='utf-8')
    return path, before


def copy_into(folder):
    """Copy the checkout into a folder that is not there yet; return it."""
    for name in subprocess.check_output(
            ['git', 'ls-files', '-co', '--exclude-standard'], cwd=REPO, text=True).split():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(REPO / name, folder / name)
    return folder


def run(tests, copy, patience_s=TIMEOUT_S, **variables):
    """Return the status of pytest for these tests in a copy: 0 if all pass."""
    env = dict(os.environ, PYTHONDONTWRITEBYTECODE='1', MHRI_OWN_SCREEN='1',
               PYTHONPATH='{}:{}'.format(copy / 'src', os.environ.get(
                   'PYTHONPATH', '')), **variables)
    try:
        return subprocess.call(
            [sys.executable, '-m', 'pytest', '-q', '-x', '-p', 'no:cacheprovider', *tests],
            cwd=copy, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            timeout=patience_s)
    except subprocess.TimeoutExpired:
        return 1  # a loop without an end


def mutate(wanted):
    """Try the mutations; return how many nobody noticed."""
    missed = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = copy_into(Path(folder) / 'copy')
        for row in load()['actions']:
            if wanted and str(row['id']) not in wanted:
                continue
            tests = row['mutation'].get('tests', row['tests'])
            sound = run(tests, copy) == 0
            path, before = mutated(row, copy)
            noticed = run(tests, copy) != 0
            path.write_text(before, encoding='utf-8')
            missed += not (sound and noticed)
            print('{:>3}  {}  {}'.format(row['id'], 'noticed' if sound and noticed else
                                         'MISSED' if sound else 'FAILS AS IT IS', row['action']),
                  flush=True)
    return missed


def main():
    """Do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--write', action='store_true')
    parser.add_argument('--mutate', nargs='*', metavar='ID')
    options = parser.parse_args()
    sys.path.insert(0, str(REPO / 'src'))
    if options.write:
        for path, text in pages().items():
            path.write_text(text, encoding='utf-8')
    if options.mutate is not None:
        sys.exit(min(mutate(options.mutate), 100))


if __name__ == '__main__':
    main()

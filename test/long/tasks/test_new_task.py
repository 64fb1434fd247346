# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``doc/new_task.md`` word by word: its files written, its commands typed, its task run."""
from pathlib import Path
import re
import subprocess

import pytest

from support.newcomer import (
    blocks, last_words, Newcomer, said_with_copy, shown_and_there, TIMEOUT_S)
from support.ros_system import insist, NotYet, wait_for

REPO = Path(__file__).resolve().parents[3]
GUIDE = REPO / 'doc' / 'new_task.md'
EXAMPLE = REPO / 'test' / 'example_task_package'


def test_the_guide_shows_the_example_package():
    """So that who copies the one has the other."""
    shown, there = shown_and_there(GUIDE, EXAMPLE, ('src/lab_tasks/__init__.py', 'CATKIN_IGNORE'))
    assert shown == there


def help_with(folder, files=None):
    """Return (exit status, output, errors) of ``mhri_task --help`` with a copy of the example.

    :param files: {file of the package: (old, new) text}
    """
    return said_with_copy(EXAMPLE, folder / 'lab_tasks', files or {}, 'mhri_task', '--help')


def test_the_help_lists_a_task_of_another_package(tmp_path):
    status, output, errors = help_with(tmp_path)
    assert (status, errors) == (0, '')
    assert re.search(r'^look_around turns once on the spot', output, re.M)
    assert re.search(r'^    turn +how fast it turns \[rad/s\]; else 0.5$', output, re.M)


TASK = 'src/lab_tasks/look_around.py'


@pytest.mark.parametrize('files, said', [
    ({TASK: ('import math\n', 'import maths\n')},
     "cannot be imported (ModuleNotFoundError: No module named 'maths'); has its package"),
    ({TASK: ('ROW = ', 'ROWS = ')}, "cannot be imported (AttributeError: module "),
    ({TASK: ("'look_around', 'Look", "'goto', 'Look")},
     "there is a task 'goto' already, choose another key; "),
    ({TASK: (', TIMEOUT_S), make', ',), make')},
     'it has no field timeout: add mhri.tasks.goto.TIMEOUT_S; '),
    ({TASK: ('ROW = TaskKind(', 'ROW = dict(key=(')}, 'cannot be imported (SyntaxError: '),
    ({'package.xml': ('task="lab_tasks.look_around"', 'task=""')},
     'a task is exported by itself; write <mhri task="package.module"/>; '),
    ({'package.xml': ('look_around"/>', 'look_around" window="a.B"/>')},
     'a task is exported by itself; '),
])
def test_a_task_that_is_left_out_is_named(tmp_path, files, said):
    status, output, errors = help_with(tmp_path, files)
    assert status == 1 and errors.count('\n') == 1, errors
    assert errors.startswith('left out: package lab_tasks: ')
    assert said in errors
    assert 'look_around' not in output and re.search('^goto ', output, re.M)


@pytest.fixture
def newcomer(tmp_path):
    made = Newcomer(tmp_path)
    yield made
    made.system.close()


def test_the_guide_word_by_word(newcomer):
    terminals = []
    for kind, text in blocks(GUIDE.read_text()):
        if kind == 'sh terminal':
            terminals.append(text)
        else:
            said = newcomer.follow(kind, text)
    assert re.search('^look_around turns once on the spot', said, re.M), said
    assert 'left out: ' not in said
    system = newcomer.follow('sh terminal', terminals[0])
    try:
        wait_for(lambda: 'bot1' in known_to_drive(newcomer), what='the drive to know bot1')

        def told():
            task = newcomer.follow('sh terminal', terminals[1])
            status, said = task.wait(2 * TIMEOUT_S), last_words(task)
            if 'bot1: lost: ' in said:
                raise NotYet(said)
            assert status == 0, said
            return said
        said = insist(told, 'the task to end')
        assert re.search(r'bot1: done: nearest thing \d\.\d\d m away', said), said
    except BaseException:
        print(last_words(system)[-4000:])
        raise


def known_to_drive(newcomer):
    """Return what the drive says of its robots, '' while it says nothing."""
    return subprocess.run(
        ['timeout', '5', 'rostopic', 'echo', '-n', '1', '/mux/state/robots'],
        env=newcomer.system.env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        universal_newlines=True, check=False).stdout

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Somebody who follows a page of the guide word by word: files written, commands typed."""
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

from support.ros_system import System

TIMEOUT_S = 60.0


def blocks(text):
    """Return (what it is, its text) of each block of the guide: 'sh', 'sh terminal' or a file."""
    found = []
    for match in re.finditer(r'^```(\S[^\n]*)\n(.*?)^```$', text, re.M | re.S):
        kind = match.group(1)
        if not kind.startswith('sh'):
            paragraph = text[:match.start()].rstrip().rpartition('\n\n')[2]
            kind = re.match(r'`([^`]+)`', paragraph).group(1)
        found.append((kind, match.group(2)))
    return found


def shown_and_there(guide, example, empty):
    """Return ({file: text} that a page of the guide shows, the same of the example package).

    :param empty: files without a word, which no page can show
    """
    shown = {name: text for name, text in blocks(guide.read_text()) if not name.startswith('sh')}
    shown.update(dict.fromkeys(empty, ''))
    return shown, {path.relative_to(example).as_posix(): path.read_text()
                   for path in example.rglob('*')
                   if path.is_file() and '__pycache__' not in path.parts}


def said_with_copy(example, package, changes, node, *words):
    """Return (exit status, output, errors) of a node beside a copy of an example package.

    :param package: where the copy is made
    :param changes: {file of the package: (old, new) text}
    :param node: a module of :mod:`mhri.nodes`
    """
    shutil.copytree(str(example), str(package))
    (package / 'CATKIN_IGNORE').unlink()
    for name, (old, new) in changes.items():
        path = package / name
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))
    done = subprocess.run(
        [sys.executable, '-c', 'from mhri.nodes.{} import main; main()'.format(node), *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, env=dict(
            os.environ, **{name: '{}:{}'.format(place, os.environ[name]) for name, place in (
                ('PYTHONPATH', package / 'src'), ('ROS_PACKAGE_PATH', package.parent))}))
    return done.returncode, done.stdout, done.stderr


class Newcomer:
    """Somebody with the guide, an empty workspace and a screen."""

    def __init__(self, home):
        self.home = home
        self.system = System()
        self.package = None
        self.workspace = home / 'catkin_ws'
        self.system.env.update(HOME=str(home), PATH='/usr/bin:/bin:' + os.environ['PATH'],
                               QT_QPA_PLATFORM='xcb')
        self.system.screen('1600x1000x24')

    def run(self, commands):
        """Type commands; return what they said."""
        done = subprocess.run(['bash', '-e', '-c', commands + '\npwd'], env=self.system.env,
                              cwd=str(self.home), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
        assert done.returncode == 0, done.stdout
        return done.stdout

    def follow(self, kind, text):
        """Do what one block asks for."""
        if kind == 'sh terminal':
            return self.system.start('bash', '-c', 'source ~/catkin_ws/devel/setup.bash; exec '
                                     + text)
        if kind == 'sh':
            said = self.run(text)
            self.package = self.package or Path(said.splitlines()[-1])
            return said
        (self.package / kind).write_text(text)
        return None

    def xdotool(self, *words):
        """Use mouse, keyboard or eyes; return what there is to see, '' where it is nothing."""
        return subprocess.run(('xdotool',) + words, env=self.system.env, timeout=TIMEOUT_S,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              universal_newlines=True).stdout.strip()

    def window(self, title):
        """Return the X window of a title (regular expression), '' where there is none."""
        return self.xdotool('search', '--onlyvisible', '--name', title).partition('\n')[0]


def last_words(process):
    with open(process.log, errors='replace') as log:
        return log.read()

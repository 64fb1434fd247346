# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What every test file gets by its folder: no ROS for what is pure, a screen for what draws.

A test in ``test/unit/`` runs where there is no ROS and nothing is built; one in ``test/ros/`` or
``test/qt/`` starts no process. Those in ``test/flaky.yaml`` may fail.
"""
from pathlib import Path
import re
import sys

import pytest
import yaml

TEST = Path(__file__).parent
ROS = re.compile(r'((ros|gen)(py|lib|graph|launch|bag|param|topic|service|node|msg)|actionlib|tf'
                 r'|tf2_\w+|cv_bridge|diagnostic_updater|message_filters|mhri\.(msg|srv)'
                 r'|\w+_(msgs|srvs))\Z')
# The audit events of a process that is started.
STARTS = ('subprocess.Popen', 'os.exec', 'os.fork', 'os.forkpty', 'os.posix_spawn', 'os.system')


class Refusal:
    """Refuses ROS to pure tests, even where it is installed, and processes to those without."""

    pure = alone = False

    @classmethod
    def find_spec(cls, name, path=None, target=None):
        """Refuse a module of ROS; leave every other one to the next importer.

        :raises ImportError: the module belongs to ROS, or is generated from the messages of mhri
        """
        if cls.pure and ROS.match(name):
            raise ImportError('{} is of ROS, which tests in test/unit do without: put the '
                              'test in test/ros'.format(name), name=name)

    @classmethod
    def hear(cls, event, arguments):
        """Refuse to start a process.

        :raises AssertionError: the file is in a folder whose tests start none
        """
        if cls.alone and event in STARTS:
            raise AssertionError('{} {}: a test that starts a process belongs in test/e2e or '
                                 'test/long'.format(event, arguments[:2]))


sys.meta_path.insert(0, Refusal)
sys.addaudithook(Refusal.hear)


def enter(node):
    """Refuse ROS from here on if a file is pure; return its folder as parts."""
    # Not `path`, which pytest of Ubuntu 20.04 does not have.
    folder = Path(str(node.fspath)).relative_to(TEST).parts[:-1]
    Refusal.pure = folder[:1] == ('unit',)
    return folder


def pytest_collectstart(collector):
    """Give a file what its folder has, before it is imported."""
    if isinstance(collector, pytest.Module):
        folder = enter(collector)
        if folder[:1] == ('qt',) or folder in (('e2e', 'screen'), ('long', 'screen')):
            collector.config.pluginmanager.import_plugin('support.qt')
        elif folder in (('long', 'house'), ('long', 'utils')):
            collector.config.pluginmanager.import_plugin('support.checkout')


def pytest_runtest_setup(item):
    """Refuse ROS to what a pure test imports while it runs, too, and processes to tests alone."""
    # Not before: libraries may start some as they are imported.
    Refusal.alone = enter(item)[:1] in (('ros',), ('qt',))


def pytest_collection_modifyitems(items):
    """Let those tests fail that are known to."""
    known = {row['test']: row['mechanism'] for row in yaml.safe_load(
        (TEST / 'flaky.yaml').read_text(encoding='utf-8'))}
    for item in items:
        name = Path(str(item.fspath)).relative_to(TEST.parent).as_posix() + item.nodeid[
            item.nodeid.index('::'):]
        if name in known:
            item.add_marker(pytest.mark.xfail(reason='flaky: ' + known[name]))

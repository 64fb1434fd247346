# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of drills: scenarios that are shipped, results of runs."""
from datetime import datetime
import os
from pathlib import Path

from mhri.base.config import ConfigError
from mhri.drill.results import as_yaml
from mhri.drill.scenario import parse_scenario
from mhri.graph.ros.resources import read_text, resource_path
from mhri.recording.recording import ros_home
from mhri.session.drill_results import FILE, read_result

PAGE = 'drill.html'
# So many earlier runs stand beside a new one; a result says early which drill it is of.
MOST_EARLIER, _HEAD_BYTES = 3, 4096


def names():
    """Return the names of the shipped drills."""
    return sorted(path.stem for path in Path(resource_path('drills')).glob('*.yaml'))


def scenario_named(name):
    """Return (:class:`mhri.drill.scenario.Scenario`, path of its plan).

    :param name: of a shipped drill, or the path of a lab's own file, its plan in ``plans`` beside
    :raises ConfigError: there is none, or it is wrong
    :raises OSError: the file cannot be read
    """
    path = name if name.endswith('.yaml') else resource_path('drills', name + '.yaml')
    if not os.path.isfile(path):
        raise ConfigError(name, '', 'there is no such drill; there are {}'.format(
            ', '.join(names())))
    scenario = parse_scenario(read_text(path), path, Path(path).stem)
    return scenario, os.path.join(os.path.dirname(path), 'plans', scenario.plan)


def _session_now():
    """Return the folder of a session that is being recorded now, None if there is none."""
    home = Path(ros_home(os.environ)) / 'mhri' / 'sessions'
    active = [path for path in home.glob('*/*.bag.active')]
    return max(active, key=lambda path: path.stat().st_mtime).parent if active else None


def folder_of(scenario, rehearsed=False, when=None):
    """Make and return the folder for what comes of a run: the session's, else one of its own.

    :param rehearsed: nothing of it was on the graph, nor is it in a session
    :raises OSError: it cannot be made
    """
    session = None if rehearsed else _session_now()
    if session is not None:
        return session
    name = '{:%Y-%m-%d-%H-%M-%S}_{}'.format(when or datetime.now(), scenario.name)
    home, number = Path(ros_home(os.environ)) / 'mhri' / 'drills', 1
    while True:
        path = home / (name if number == 1 else '{}-{}'.format(name, number))
        try:
            path.mkdir(parents=True)
            return path
        except FileExistsError:
            number += 1


def write(folder, result, page):
    """Write result and page, over nothing that is there; return the path of the page.

    :raises OSError: they cannot be written
    """
    number = 1
    while True:
        more = '' if number == 1 else '-{}'.format(number)
        target = folder / FILE.replace('.', more + '.')
        try:
            with open(target, 'x', encoding='utf-8') as file:
                file.write(as_yaml(result))
            break
        except FileExistsError:
            number += 1
    path = folder / PAGE.replace('.', more + '.')
    path.write_text(page, encoding='utf-8')
    return path


def earlier(scenario):
    """Return the results of the last runs of a drill, the newest first."""
    home = Path(ros_home(os.environ)) / 'mhri'
    pattern = FILE.replace('.', '*.')
    paths = [*home.glob('drills/*/' + pattern), *home.glob('sessions/*/' + pattern)]
    found = []
    for path in sorted(paths, key=lambda path: path.stat().st_mtime, reverse=True):
        try:
            with open(path, encoding='utf-8', errors='replace') as file:
                if '\ndrill: {}\n'.format(scenario.name) in file.read(_HEAD_BYTES):
                    found.append(result_in(str(path)))
        except (ConfigError, OSError):
            continue
        if len(found) == MOST_EARLIER:
            break
    return found


def result_in(path):
    """Return the result of a run.

    :param path: its ``drill.yaml``, or the folder
    :raises ConfigError: it is none
    :raises OSError: it cannot be read
    """
    path = os.path.join(path, FILE) if os.path.isdir(path) else path
    return read_result(read_text(path), path)

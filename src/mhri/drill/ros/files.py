# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of drills: shipped scenarios, and results of runs."""
from contextlib import suppress
from datetime import datetime
import os
from pathlib import Path

from mhri.base.config import ConfigError
from mhri.drill.results import as_yaml
from mhri.drill.scenario import parse_scenario
from mhri.graph.ros.resources import read_text, resource_path
from mhri.recording.folder import folder_name, free_names
from mhri.recording.recording import ros_home
from mhri.session.drill_results import FILE, read_result

PAGE = 'drill.html'
# Maximum number of earlier runs to compare with; a result names its drill within this many bytes.
MAX_EARLIER, _HEAD_BYTES = 3, 4096


def names():
    """Return the names of the shipped drills."""
    return sorted(path.stem for path in Path(resource_path('drills')).glob('*.yaml'))


def scenario_named(name):
    """Return (:class:`mhri.drill.scenario.Scenario`, path of its plan).

    :param name: name of a shipped drill, or path of a lab's own file with ``plans`` beside it
    :raises ConfigError: the drill does not exist, or is invalid
    :raises OSError: the file cannot be read
    """
    path = name if name.endswith('.yaml') else resource_path('drills', name + '.yaml')
    if not os.path.isfile(path):
        raise ConfigError(name, '', 'there is no such drill; there are {}'.format(
            ', '.join(names())))
    scenario = parse_scenario(read_text(path), path, Path(path).stem)
    return scenario, os.path.join(os.path.dirname(path), 'plans', scenario.plan)


def _session_now():
    """Return the folder of the session being recorded, None if there is none."""
    home = Path(ros_home(os.environ)) / 'mhri' / 'sessions'
    active = [path for path in home.glob('*/*.bag.active')]
    return max(active, key=lambda path: path.stat().st_mtime).parent if active else None


def folder_of(scenario, rehearsed=False):
    """Return the folder for the result of a run: the current session's, else a new one.

    :param rehearsed: the run was not on the graph, so it is not part of a session
    :raises OSError: the folder cannot be created
    """
    session = None if rehearsed else _session_now()
    if session is not None:
        return session
    home = Path(ros_home(os.environ)) / 'mhri' / 'drills'
    for name in free_names('{}_{}'.format(folder_name(datetime.now()), scenario.name)):
        with suppress(FileExistsError):
            (home / name).mkdir(parents=True)
            return home / name


def write(folder, result, page):
    """Write result and page under free names; return the path of the page.

    :raises OSError: a file cannot be written
    """
    stem, ending = os.path.splitext(FILE)
    for name in free_names(stem):
        with suppress(FileExistsError):
            with open(folder / (name + ending), 'x', encoding='utf-8') as file:
                file.write(as_yaml(result))
            break
    path = folder / PAGE.replace(stem, name)
    path.write_text(page, encoding='utf-8')
    return path


def earlier(scenario):
    """Return the results of the last runs of a drill, newest first."""
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
        if len(found) == MAX_EARLIER:
            break
    return found


def result_in(path):
    """Return the result of a run.

    :param path: path of its ``drill.yaml``, or of the folder
    :raises ConfigError: the file is not a result
    :raises OSError: the file cannot be read
    """
    path = os.path.join(path, FILE) if os.path.isdir(path) else path
    return read_result(read_text(path), path)

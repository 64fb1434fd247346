# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every file that a lab or operator edits, edited badly: the named error, soon and short.

``MHRI_SEED`` repeats a run, ``MHRI_LONG=1`` is the long form.
"""
import glob
import json
import os
import resource
import time

import pytest

from support.hostile import Hostile, is_long, seed_of

from mhri.base.config import ConfigError
from mhri.base.robot_types import load_robot_types, resolve_robot_type, Seen
from mhri.devices.profile import parse_profile
from mhri.devices.source_rows import source_rows
from mhri.driving.sources import parse_mux_config
from mhri.robots.discovery import parse_ignore_list
from mhri.screen.presenters.settings_file import SettingsError, SettingsFile
from mhri.screen.saved_state import usable_state
from mhri.screen.settings import parse_settings
from mhri.voice.language import parse_language

EDITS = 4000 if is_long() else 60
LONGEST_S, LONGEST_ERROR = 1.0, 300
RESOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', '..', 'resource')
STATE = {'robots': ['bot1', 'bot2'], 'mode': 'pedal',
         'windows': {'bot1': [0, 0, 640, 480, False]},
         'looks': {'bot1': {'views': ['graph'], 'splitter': [100, 200], 'graph': {'seconds': 10}}},
         'panel': {'splitter': [200, 300], 'geometry': [0, 0, 800, 600, False]}}


def text_of(*parts):
    with open(os.path.join(RESOURCE, *parts), encoding='utf-8') as stream:
        return stream.read()


def read_profile(name):
    path = os.path.join(RESOURCE, 'pads', os.path.basename(name) + '.yaml')
    return path, text_of('pads', os.path.basename(name) + '.yaml')


KINDS = {
    'robots': lambda text: load_robot_types([('x.yaml', text)]),
    'pads': lambda text: parse_profile(text, 'x.yaml'),
    'mux': lambda text: parse_mux_config(text, 'x.yaml', read_profile),
    'discovery': lambda text: parse_ignore_list(text, 'x.yaml'),
    'voice': lambda text: parse_language(text, 'x.yaml')}


def goods(kind):
    folder = os.path.join(RESOURCE, kind)
    if not os.path.isdir(folder):
        return [text_of(kind + '.yaml')]
    return [text_of(path) for path in sorted(glob.glob(os.path.join(folder, '*.yaml')))]


class Clock:
    """The longest that anything took, and what it was."""

    def __init__(self):
        self.longest_s, self.culprit = 0.0, ''

    def __call__(self, read, text):
        begun = time.process_time()
        try:
            return read(text)
        finally:
            took = time.process_time() - begun
            if took > self.longest_s:
                self.longest_s, self.culprit = took, text


@pytest.mark.parametrize('kind', sorted(KINDS))
def test_a_file_that_was_edited(kind):
    hostile, clock = Hostile(seed_of(20261122)), Clock()
    files, refused = goods(kind), 0
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for number in range(EDITS):
        text = hostile.file(files[number % len(files)])
        try:
            found = clock(KINDS[kind], text)
            errors = found[1] if kind == 'robots' else []
        except ConfigError as error:
            errors = [error]
        refused += bool(errors)
        for error in errors:
            assert len(str(error)) <= LONGEST_ERROR and str(error).isprintable()
    grown_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1000.0
    print('MEASURED {}: {} edits, {} refused by name, the longest took {:.2f} s, {:.0f} MB '
          'more'.format(kind, EDITS, refused, clock.longest_s, grown_mb))
    assert clock.longest_s < LONGEST_S, clock.culprit[:500]
    assert grown_mb < 300.0
    assert refused > EDITS / 10


def test_settings_that_were_edited(tmp_path):
    hostile, clock = Hostile(seed_of(20261122)), Clock()
    good = json.dumps(STATE, indent=1)
    path = tmp_path / 'panel.json'
    unread = 0

    def read(text):
        path.write_bytes(text.encode('utf-8', 'surrogatepass'))
        return usable_state(SettingsFile(str(path)).read())

    assert usable_state(STATE) == (STATE, ())
    for _ in range(EDITS):
        try:
            kept, problems = clock(read, hostile.file(good))
            assert all(len(problem) < 1000 for problem in problems)
            # What was left over can be kept, and read again just so.
            assert usable_state(json.loads(json.dumps(kept, allow_nan=False))) == (kept, ())
        except SettingsError as error:
            unread += 1
            assert len(str(error)) < 500
    print('MEASURED settings: {} edits, {} unreadable, the longest took {:.2f} s'.format(
        EDITS, unread, clock.longest_s))
    assert clock.longest_s < LONGEST_S, clock.culprit[:500]


def test_settings_of_any_shape():
    hostile = Hostile(seed_of(20261122))
    for _ in range(5 * EDITS):
        state = dict(STATE)
        for key in hostile.random.sample(sorted(STATE), 2):
            state[key] = hostile.value()
        kept, problems = usable_state(state)
        assert set(kept) <= set(STATE)
        assert usable_state(kept) == (kept, ())


def test_parameters_of_any_shape():
    """What the parameter server may hold, to the readers of it; the bad is named or left out."""
    hostile, clock = Hostile(seed_of(20261122)), Clock()
    types, _ = load_robot_types([(str(n), text) for n, text in enumerate(goods('robots'))])
    keys = ('robot_type', 'robot_model', 'mhri')
    inner = ('command', 'odometry', 'odometry_type', 'limits', 'motor_power', 'hardware_stop',
             'silent_after_s', 'label', 'window', 'imu')
    for _ in range(4 * EDITS):
        parameters = {key: hostile.value() for key in keys if hostile.random.random() < 0.5}
        if hostile.random.random() < 0.5:
            parameters['mhri'] = {key: hostile.value() for key in hostile.random.sample(inner, 2)}
        robot_type, errors = clock(
            lambda given: resolve_robot_type(types, 'bot1', given, Seen()), parameters)
        assert robot_type.command and 0.0 < robot_type.limits.linear_mps <= 50.0
        assert all(len(str(error)) <= LONGEST_ERROR for error in errors)
        settings, errors = clock(parse_settings, hostile.value())
        assert settings.record_stop_free_mb >= 1.0
        assert all(len(label) <= 200 for row in clock(source_rows, hostile.value())
                   for label in row)
    print('MEASURED parameters: {} values, the longest took {:.2f} s'.format(
        12 * EDITS, clock.longest_s))
    assert clock.longest_s < LONGEST_S

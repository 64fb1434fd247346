# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A settings file can never keep the screen from starting, and runs nothing."""
import json
import os
import time

import pytest
from python_qt_binding.QtCore import QRect
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui.geometry import geometry_of, restore_geometry
from mhri.screen.presenters.settings_file import SettingsFile, UNUSABLE
from mhri.standalone import Standalone

GOOD = {'robots': ['bot1'], 'mode': 'pedal'}


def state_with(**parts):
    return json.dumps({'state': {**GOOD, **parts}})


def start_with(path, operator):
    """Start the screen, draw it, and close it; return the robots it began with."""
    begun = time.process_time()
    program = Standalone(['panel'], path)
    program.restore()
    program.window.show()
    program.presenter.draw()
    program.presenter.tiles.make('bot9')
    operator.settle()
    program.window.grab()
    found = [robot.name for robot in program.presenter.operator.view().robots]
    program.window.close()
    assert time.process_time() - begun < 10.0
    return found


@pytest.mark.parametrize('text, whole', [
    (state_with(numbers=[float('nan'), 1.0]), False),
    (state_with(numbers=['a', 'b']).replace('"a"', '1e999'), True),
    (state_with(panel={'splitter': [2 ** 31, 2 ** 63]},
                windows={'bot9': [0, 0, 2 ** 31, 5, False]},
                looks={'bot9': {'splitter': 'ff' * 50, 'views': 5}}), True),
    ('[' * 100_000, False), ('{"state": 5}', False), ('x' * 2_000_000, False),
    ('\x00\x01', False)])
def test_the_screen_starts(tmp_path, operator, text, whole):
    """Whole: what can be used of it is used."""
    path = tmp_path / 'panel.json'
    path.write_text(text)
    robots = start_with(str(path), operator)
    assert robots == (['bot1'] if whole else [])
    assert (tmp_path / ('panel.json' + UNUSABLE)).read_text() == text, 'kept aside'
    assert start_with(str(path), operator) == robots, 'and the next start needs no help'


@pytest.mark.parametrize('lay', [
    lambda path: os.mkfifo(str(path)), lambda path: path.mkdir(),
    lambda path: path.symlink_to('/dev/zero')])
def test_what_is_no_file_keeps_nobody_waiting(tmp_path, operator, lay):
    path = tmp_path / 'panel.json'
    lay(path)
    assert start_with(str(path), operator) == []


def test_nothing_in_it_is_run(tmp_path, operator):
    """An INI file as PyQt writes it for a Python object, at the path that is given."""
    path, trace = tmp_path / 'panel.ini', tmp_path / 'ran'
    pickled = "cposix\\nsystem\\n(S'touch {}'\\ntR.".format(trace)
    path.write_text('[General]\nstate="@Variant(\\0\\0\\0\\x7f\\0\\0\\0\\xePyQt_PyObject\\0'
                    '\\0\\0\\0@{})"\ngeometry=@ByteArray(x)\n'.format(pickled))
    start_with(str(path), operator)
    assert not trace.exists()


def test_a_file_that_cannot_be_written_does_not_keep_the_screen_from_ending(tmp_path, operator):
    nowhere = tmp_path / 'file'
    nowhere.write_text('')
    start_with(str(nowhere / 'panel.json'), operator)
    assert os.listdir(str(tmp_path)) == ['file']


def test_a_file_is_replaced_whole(tmp_path):
    settings = SettingsFile(str(tmp_path / 'new' / 'panel.json'))
    assert settings.read() == {} and settings.keep_aside() is None
    settings.write({'state': GOOD})
    assert settings.read() == {'state': GOOD}
    assert os.listdir(str(tmp_path / 'new')) == ['panel.json']


@pytest.mark.parametrize('saved, expected', [
    ([50, 60, 700, 400, False], [50, 60, 700, 400]),
    ([-500, 60, 700, 400, False], [0, 60, 700, 400]),
    ([50, 60, 30_000, 30_000, False], None), ([29_000, 60, 700, 400, False], False)])
def test_a_window_comes_back_within_a_screen(operator, saved, expected):
    widget, screen = QWidget(), QApplication.primaryScreen().availableGeometry()
    placed = restore_geometry(widget, saved)
    assert placed == (expected is not False)
    if not placed:
        return
    assert screen.contains(widget.geometry())
    assert widget.geometry() == (QRect(*expected) if expected else screen)
    assert geometry_of(widget)[4] is False

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Programs started in a folder full of modules with known names run none of them."""
import json
import os
from pathlib import Path
import re
import subprocess
import sys

import pytest

from mhri.devices.io import child
from mhri.devices.io.reader import DeviceAbsent
from mhri.voice.io.audio import Microphone
from mhri.voice.io.voice import VoiceReader
from mhri.voice.language import parse_language

REPO = Path(__file__).resolve().parents[3]
NAMES = ('argparse', 'fcntl', 'importlib', 'json', 'mhri', 'numpy', 'pocketsphinx', 'pyaudio',
         'queue', 'rosgraph', 'rospkg', 'rospy', 'select', 'socket', 'subprocess', 'threading',
         'wave', 'yaml')
HOSTILE = 'import os\nopen(os.environ["MHRI_TEST_SEEN"], "a").write(__file__ + "\\n")\n'
# Programs that end by themselves, with what they are asked for.
PROGRAMS = (('mhri_doctor', '--help'), ('mhri_types',))


@pytest.fixture
def hostile(tmp_path, monkeypatch):
    """Go into a folder of modules that note when they are run; return a function that tells."""
    folder, seen = tmp_path / 'hostile', tmp_path / 'seen'
    folder.mkdir()
    for name in NAMES:
        (folder / (name + '.py')).write_text(HOSTILE)
    monkeypatch.chdir(folder)
    monkeypatch.setenv('MHRI_TEST_SEEN', str(seen))
    return lambda: seen.read_text().split() if seen.exists() else []


def test_python_itself_is_fooled(hostile):
    """Else the tests below would prove nothing."""
    subprocess.run([sys.executable, '-c', 'import rospy, mhri'], check=False)
    assert {os.path.basename(path) for path in hostile()} >= {'rospy.py', 'mhri.py'}


def test_microphone(hostile):
    """Its process tells why there is none, in its own words."""
    with pytest.raises(DeviceAbsent) as error:
        Microphone('no such microphone').open()
    assert 'failed' not in str(error.value) and hostile() == []


def test_listening(hostile):
    """Its process says what the matter is with what it shall listen to."""
    path = REPO / 'resource' / 'voice' / 'english.yaml'
    reader = VoiceReader(parse_language(path.read_text(), str(path)), str(path),
                         lambda heard: None, lambda command: None)
    reader.choose_source('/no/such/file.wav')
    with pytest.raises(DeviceAbsent) as error:
        reader.open()
    reader.close()
    assert 'does not answer' not in str(error.value) and hostile() == []


def test_watch_of_stop(hostile, monkeypatch):
    """Its process says why it can do nothing, and ends."""
    monkeypatch.setenv('DISPLAY', ':99999')
    process = child.Child('mhri.screen.presenters.stop_watch_process', 'http://127.0.0.1:9')
    assert process.messages(60.0) == [{'cannot': 'no X server answers'}]
    assert process.end(60.0) == 0
    assert hostile() == []


@pytest.mark.parametrize('program', PROGRAMS, ids=lambda program: program[0])
def test_program(hostile, program):
    subprocess.run([sys.executable, str(REPO / 'scripts' / program[0]), *program[1:]], check=True,
                   stdout=subprocess.DEVNULL)
    assert hostile() == []


def test_a_child_has_the_modules_of_its_parent(hostile, tmp_path, monkeypatch):
    """And its arguments as they are, but no relative folders of the parent's path."""
    (tmp_path / 'child_of_a_test.py').write_text(
        'import json, sys\ndef main():\n    print(json.dumps([sys.argv[1:], sys.path]))\n')
    monkeypatch.setattr(sys, 'path', [str(tmp_path), '', '.', 'hostile'] + sys.path)
    done = subprocess.run(child.command('child_of_a_test', 'a:b', '', "c'd"), check=True,
                          stdout=subprocess.PIPE, universal_newlines=True)
    arguments, path = json.loads(done.stdout)
    assert arguments == ['a:b', '', "c'd"]
    # What this process was started with comes first, and each folder once.
    wanted = os.environ.get('PYTHONPATH', '').split(os.pathsep) + sys.path
    assert path == list(dict.fromkeys(filter(os.path.isabs, wanted)))
    assert hostile() == []


def test_nobody_starts_python_otherwise():
    """In the package; in the scripts isolated, or in a folder that is not the operator's."""
    starters = [path for path in (REPO / 'src').rglob('*.py')
                if 'sys.executable' in path.read_text()]
    assert [path.name for path in starters] == ['child.py']
    wrong = re.compile(r'(?<!cd / && )\bpython3? (?!-I )-[cm]\b')
    assert [path.name for path in sorted((REPO / 'utils').rglob('*.sh'))
            if path.name != 'mhri_test.sh' and wrong.search(path.read_text())] == []

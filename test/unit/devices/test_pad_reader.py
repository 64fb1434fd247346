# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The reader of the pad over joysticks that are played."""
import io
import os
import sys
import types
from unittest import mock

import pytest

from mhri.devices.io import event_nodes, sdl
from mhri.devices.io.pad import PadReader
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reading
from mhri.devices.pads import PadInfo
from mhri.devices.profile import parse_profile
from support.kernel_pads import plug, PS3

STICK = parse_profile('name: generic\nforward: {axis: 1, scale: -1.0}\nturn: {axis: 0}\n', 'g')
TRIGGER = parse_profile(
    'name: trigger\nforward: {axis: 2, rest: -1.0, scale: 1.0}\nturn: {axis: 0}\n'
    'match: {names: [Wheel]}\n', 't')


class Joystick:
    """An open joystick; ``axes`` is what it says, an exception what it raises."""

    def __init__(self, info, axes=(0.0, 0.0), can_rumble=True):
        self.info = info
        self.axes = axes
        self.waited = []
        self.shaken = []
        self.closed = 0
        self.can_rumble = can_rumble
        self.on_wait = lambda: None

    @property
    def axis_count(self):
        return len(self.axes)

    def state(self):
        if isinstance(self.axes, Exception):
            raise self.axes
        return tuple(self.axes), (0, 1)

    def wait(self, timeout_s):
        self.waited.append(timeout_s)
        self.on_wait()

    def rumble(self, strength, seconds):
        self.shaken.append((strength, seconds))
        return self.can_rumble

    def close(self):
        self.closed += 1


class Joysticks:
    """What is plugged in: {name: Joystick}."""

    def __init__(self, *names, axes=(0.0, 0.0)):
        self.plugged = [Joystick(PadInfo(index, name, ''), axes)
                        for index, name in enumerate(names)]

    def look(self):
        return [joystick.info for joystick in self.plugged]

    connected = look

    def open(self, info):
        return self.plugged[info.index]


class Clock:
    """Time that passes while somebody waits."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        self.now += 0.001
        return self.now


def make(*names, profiles=(STICK, TRIGGER), **kwargs):
    joysticks = Joysticks(*names, **kwargs)
    return PadReader(lambda: list(profiles), joysticks, Clock()), joysticks.plugged


def test_nothing_plugged_in_names_the_remedy():
    reader, _ = make()
    with pytest.raises(DeviceAbsent, match='plug one in'):
        reader.open()
    reader.close()


def test_first_reading_is_whole_then_only_changes():
    reader, (pad,) = make('Stick')
    assert reader.open().startswith('Stick') and reader.note
    assert reader.read(0.0) == Reading((0.0, 0.0), (0, 1), 'generic')
    assert reader.read(0.0) is None
    pad.axes = (0.0, -1.0)
    assert reader.read(0.0).axes == (0.0, -1.0)


def test_a_change_ends_the_wait():
    reader, (pad,) = make('Stick')
    reader.open()
    reader.read(0.0)
    pad.on_wait = lambda: setattr(pad, 'axes', (1.0, 0.0))
    assert reader.read(5.0).axes == (1.0, 0.0)
    assert len(pad.waited) == 1


@pytest.mark.parametrize('axes', [(None, 0.0, 0.0), (0.0, None, 0.0), (None, None, None)])
def test_nothing_is_made_up_for_an_axis_that_drives(axes):
    reader, (pad,) = make('Stick', axes=axes)
    reader.open()
    assert reader.read(0.01) is None
    unknown = reader.note
    pad.axes = (0.5, 0.0, None)  # the third does not drive
    assert reader.read(0.01).axes == (0.5, 0.0, 0.0)
    assert 'generic' in reader.note != unknown


def test_neutral_of_a_trigger_is_its_rest():
    reader, (pad,) = make('Wheel', axes=(0.5, 0.0, 1.0))
    reader.open()
    reading = reader.read(0.0)
    assert TRIGGER.read(reading.axes, reading.buttons).forward == 1.0
    neutral = reading.neutral()
    assert neutral.axes == (0.0, 0.0, -1.0)
    assert neutral.buttons == (0, 0)
    assert TRIGGER.read(neutral.axes, neutral.buttons).is_zero()
    assert TRIGGER.read((0.0, 0.0, 0.0), ()).forward > 0.4  # what all zeros would have meant


def test_lost_while_read():
    reader, (pad,) = make('Stick')
    reader.open()
    pad.axes = DeviceLost('gone')
    with pytest.raises(DeviceLost, match='gone'):
        reader.read(1.0)
    reader.close()
    reader.close()
    assert pad.closed == 1


@pytest.mark.parametrize('wanted', ['Two', '1'])
def test_another_pad_is_chosen_while_one_is_read(wanted):
    reader, (one, two) = make('One', 'Two')
    reader.open()
    reader.read(0.0)
    reader.choose(wanted)
    with pytest.raises(DeviceLost, match='another pad was chosen'):
        reader.read(1.0)
    reader.close()
    assert reader.open().startswith('Two')
    assert (one.closed, two.closed) == (1, 0)


def test_too_few_axes_names_pad_profile_and_remedy():
    reader, _ = make('Wheel', axes=(0.0,))
    with pytest.raises(DeviceAbsent, match='Wheel has 1 axes, and profile trigger needs 3.*calib'):
        reader.open()


class OldPygame:
    """pygame 1.9.6 on SDL 1.2: no GUIDs, no word when a joystick is gone, axes known by events."""

    JOYAXISMOTION = 7
    error = RuntimeError

    def __init__(self):
        self.events = []
        self.event = types.SimpleNamespace(get=self._get)

    def _get(self):
        events, self.events = self.events, []
        return events

    class Stick:
        def init(self):
            pass

        def quit(self):
            self.closed = True

        def get_numaxes(self):
            return 2

        def get_numbuttons(self):
            return 1

        def get_numhats(self):
            return 1

        def get_axis(self, _):
            return -1.000030518509476

        def get_button(self, _):
            return True

        def get_hat(self, _):
            return (-1, 1)


def old_joystick(files=()):
    pygame = OldPygame()
    info = PadInfo(0, 'Old')
    return pygame, sdl.Joystick(pygame, None, OldPygame.Stick(), info, list(files))


def test_sdl_1_2_axes_are_known_from_their_first_event_on():
    pygame, joystick = old_joystick()
    axes, buttons = joystick.state()
    assert axes == (None, None, -1.0, -1.0)  # the hat: left, up
    assert buttons == (1, 1, 0, 0, 1)
    pygame.events = [types.SimpleNamespace(type=7, joy=0, axis=1, value=-1.0),
                     types.SimpleNamespace(type=7, joy=1, axis=0, value=-1.0)]
    assert joystick.state()[0][:2] == (None, -1.0)  # cut off at -1; the other pad's does not count


def test_sdl_1_2_a_pad_whose_file_is_removed_is_lost(tmp_path):
    path = tmp_path / 'event7'
    path.write_text('')
    with open(path, encoding='utf-8') as stream:
        _, joystick = old_joystick([stream.fileno()])
        joystick.state()
        os.remove(path)
        with pytest.raises(DeviceLost, match='is gone'):
            joystick.state()


def test_a_file_that_hangs_up_is_a_lost_pad():
    reading, writing = os.pipe()
    try:
        _, joystick = old_joystick([reading])
        os.close(writing)
        with pytest.raises(DeviceLost, match='unplugged'):
            joystick.wait(1.0)
    finally:
        os.close(reading)


def test_a_file_with_more_to_tell_than_sdl_reads_is_no_busy_loop(monkeypatch):
    reading, writing = os.pipe()
    try:
        _, joystick = old_joystick([reading])
        os.write(writing, b'never read')
        slept = []
        monkeypatch.setattr(sdl.time, 'sleep', slept.append)
        for _ in range(4):
            joystick.wait(0.5)
        assert slept == [sdl.POLL_S] * 2, 'every other one'
    finally:
        os.close(reading)
        os.close(writing)


@pytest.mark.parametrize('line, good', [
    ('7f00-7f01 r-xp 0 fe:00 1 /usr/lib/x86_64-linux-gnu/libSDL2-2.0.so.0.2600.5', True),
    ('7f00-7f01 r-xp 0 fe:00 1 /x/pygame.libs/libSDL2-2-2e17a25b.0.so.0.18.2', True),
    ('7f00-7f01 r-xp 0 fe:00 1 /x/pygame.libs/libSDL2-2.0-f2f6b3c4.so.0.3000.3', True),
    ('7f00-7f01 r-xp 0 fe:00 1 /usr/lib/x86_64-linux-gnu/libSDL2_mixer-2.0.so.0.600.2', False),
    ('7f00-7f01 r-xp 0 fe:00 1 /usr/lib/x86_64-linux-gnu/libSDL-1.2.so.0.11.4', False)])
def test_the_library_is_told_from_its_relatives(line, good, monkeypatch):
    loaded = []

    def refuse(path):
        loaded.append(path)
        raise OSError
    monkeypatch.setattr(sdl, 'open', lambda *_, **__: io.StringIO(
        'first line\n' + line + '\nlast line\n'), raising=False)
    monkeypatch.setattr(sdl.ctypes, 'CDLL', refuse)
    assert sdl.load_library() is None
    assert loaded == [line.split()[-1]] * good


def test_all_pads_are_named_and_the_chosen_one_is_opened():
    reader, _ = make('PS3 Pad', 'Pad', 'Pad Motion Sensors')
    reader.open()
    assert reader.available() == ('PS3 Pad', 'Pad')
    # A part of the other's name, and the name of one that is there.
    reader.choose('Pad')
    with pytest.raises(DeviceLost):
        reader.read(0.0)
    reader.close()
    assert reader.open().startswith('Pad ')


def test_a_pad_keeps_its_place_and_changes_its_name_with_its_twin():
    reader, plugged = make('Pad')
    plugged[0].info = PadInfo(0, 'Pad', where='USB 1')
    twin = Joystick(PadInfo(1, 'Pad', where='USB 2'))
    assert reader.open().startswith('Pad ')
    assert (reader.available(), reader.name) == (('Pad',), 'Pad')
    plugged.append(twin)
    for _ in range(3000):  # the clock goes on with each look
        reader.available()
    assert (reader.available(), reader.name) == (('Pad, USB 1', 'Pad, USB 2'), 'Pad, USB 1')
    reader.choose('Pad, USB 2')
    with pytest.raises(DeviceLost, match='another pad was chosen: Pad, USB 2'):
        reader.read(0.0)
    reader.close()
    assert reader.open().startswith('Pad, USB 2 ')


@pytest.mark.parametrize('paths, places', [
    ([b'/dev/input/event9', b'/dev/input/event4', None], ['USB 9', 'USB 4', 'number 9']),
    (None, ['USB 4', 'USB 9', 'number 9'])])
def test_where_a_joystick_of_sdl_is(paths, places, tmp_path, monkeypatch):
    monkeypatch.setattr(event_nodes, 'SYS_INPUT', str(tmp_path))
    for number in (9, 4):
        plug(tmp_path, number, PS3, 'usb-0000:00:14.0-{}/input0'.format(number))
    names = [PS3[0], PS3[0], 'Virtual']
    library = types.SimpleNamespace(
        SDL_JoystickNameForIndex=lambda index: names[index].encode(),
        SDL_JoystickGetDeviceGUID=lambda _: types.SimpleNamespace(data=bytes(16)),
        SDL_JoystickGetDeviceInstanceID=lambda index: index + 6)
    if paths is not None:
        library.SDL_JoystickPathForIndex = lambda index: paths[index]
    pygame = mock.MagicMock(**{'get_sdl_version.return_value': (2, 0, 0),
                               'joystick.get_count.return_value': len(names)})
    monkeypatch.setitem(sys.modules, 'pygame', pygame)
    monkeypatch.setattr(sdl, 'load_library', lambda: library)
    monkeypatch.setattr(sdl.os, 'environ', {})
    assert [pad.where for pad in sdl.Joysticks().look()] == places


def test_joysticks_without_pygame_name_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, 'pygame', None)
    monkeypatch.setattr(sdl.os, 'environ', {})
    with pytest.raises(DeviceAbsent, match='python3-pygame'):
        sdl.Joysticks().look()

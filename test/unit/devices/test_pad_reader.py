# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The reader of the pad over joysticks that are played."""
import os
import sys
import types
from unittest import mock

from evdev import AbsInfo, ecodes
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


PORT = 'usb-0000:00:14.0-{}/input0'


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
    return pygame, sdl.Joystick(pygame, OldPygame.Stick(), info, dict.fromkeys(files, '/dev/null'))


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


def test_all_pads_are_named_and_the_chosen_one_is_opened(system):
    reader, _ = make('PS3 Pad', 'Pad')
    for number, name in enumerate(('PS3 Pad', 'Pad', 'Pad Motion Sensors')):
        plug(system, number, (name, *PS3[1:]))
    reader.open()
    assert reader.available() == ('PS3 Pad', 'Pad')
    # A part of the other's name, and the name of one that is there.
    reader.choose('Pad')
    with pytest.raises(DeviceLost):
        reader.read(0.0)
    reader.close()
    assert reader.open().startswith('Pad ')


def test_a_pad_keeps_its_place_and_changes_its_name_with_its_twin(system):
    reader, plugged = make('Pad')
    plugged[0].info = PadInfo(0, 'Pad', where='USB 1')
    twin = Joystick(PadInfo(1, 'Pad', where='USB 2'))
    plug(system, 3, ('Pad', *PS3[1:]), PORT.format(1))
    assert reader.open().startswith('Pad ')
    assert (reader.available(), reader.name) == (('Pad',), 'Pad')
    plugged.append(twin)
    plug(system, 4, ('Pad', *PS3[1:]), PORT.format(2))
    for _ in range(3000):  # the clock goes on with each look
        reader.available()
    assert (reader.available(), reader.name) == (('Pad, USB 1', 'Pad, USB 2'), 'Pad, USB 1')
    reader.choose('Pad, USB 2')
    with pytest.raises(DeviceLost, match='another pad was chosen: Pad, USB 2'):
        reader.read(0.0)
    reader.close()
    assert reader.open().startswith('Pad, USB 2 ')


class Pygame:
    """pygame over joysticks that have files: a list of (name, path of its file or None)."""

    JOYAXISMOTION, JOYDEVICEADDED, JOYDEVICEREMOVED = 7, 8, 9
    error = RuntimeError

    def __init__(self, *plugged):
        self.plugged = plugged
        self.files, self.opened, self.axis = {}, [], 0.0
        self.display = mock.MagicMock()
        self.event = mock.MagicMock(**{'get.return_value': []})
        self.joystick = mock.MagicMock(
            Joystick=self._open, **{'get_count.side_effect': lambda: len(self.plugged)})

    def get_sdl_version(self):
        return 2, 0, 10

    def _open(self, index):
        name, path = self.plugged[index]
        if path == 'refused':
            raise RuntimeError('refused')
        self.opened.append(name)
        number = 10 * (index + 1)
        if path:
            self.files[number] = path
        return mock.MagicMock(**{
            'get_name.return_value': name, 'get_guid.return_value': 'of SDL',
            'get_instance_id.return_value': index + 6, 'get_numaxes.return_value': 2,
            'get_axis.side_effect': lambda _: self.axis, 'get_numbuttons.return_value': 0,
            'get_numhats.return_value': 0,
            'quit.side_effect': lambda: self.files.pop(number, None)})


@pytest.fixture
def system(tmp_path, monkeypatch):
    """A folder that takes the place of /sys/class/input."""
    monkeypatch.setattr(event_nodes, 'SYS_INPUT', str(tmp_path))
    return tmp_path


@pytest.fixture
def joysticks(system, monkeypatch):
    """Return a function that returns the joysticks of a :class:`Pygame`."""
    def install(pygame):
        monkeypatch.setitem(sys.modules, 'pygame', pygame)
        monkeypatch.setattr(sdl, 'device_files', lambda: dict(pygame.files))
        monkeypatch.setattr(sdl.os, 'environ', {})
        return sdl.Joysticks()
    return install


def test_a_joystick_is_what_the_kernel_calls_it_by_the_file_that_it_has(system, joysticks):
    for number in (9, 4):
        plug(system, number, PS3, PORT.format(number))
    pygame = Pygame(('PS3 Controller', '/dev/input/event9'), ('PS3 Controller', 'refused'),
                    ('PS3 Controller', '/dev/input/event4'), ('Virtual', None))
    assert [tuple(vars(pad).values())[:4] for pad in joysticks(pygame).look()] == [
        (0, PS3[0], 'of SDL', 'USB 9'), (2, PS3[0], 'of SDL', 'USB 4'),
        (3, 'Virtual', 'of SDL', 'number 10')]
    assert not pygame.files, 'all closed again'


def test_joysticks_are_opened_for_a_look_only_after_a_change(joysticks):
    pygame = Pygame(('One', None), ('Two', None))
    found = joysticks(pygame)
    for _ in range(3):
        found.look()
    assert pygame.opened == ['One', 'Two']
    pygame.plugged = pygame.plugged[1:]
    pygame.event.get.return_value = [object()]
    assert [pad.name for pad in found.look()] == ['Two']


def test_what_took_the_place_of_the_chosen_joystick_is_not_opened(joysticks):
    pygame = Pygame(('One', None))
    found = joysticks(pygame)
    info, = found.look()
    pygame.plugged = (('Other', None),)
    with pytest.raises(DeviceAbsent, match='One was unplugged'):
        found.open(info)


class Kernel:
    """An event node with two axes, a hat and a key; ``values`` is what its axes say."""

    values = {ecodes.ABS_X: 255, ecodes.ABS_Z: 0}

    def __init__(self, path):
        if not path.startswith('/dev/input/event'):
            raise OSError

    def capabilities(self):
        return {ecodes.EV_KEY: [ecodes.BTN_A], ecodes.EV_ABS: [
            (code, None) for code in (ecodes.ABS_HAT0X, ecodes.ABS_Z, ecodes.ABS_X)]}

    def absinfo(self, code):
        if not self.values:
            raise OSError
        return AbsInfo(self.values[code], 0, 255, 0, 0, 0)

    def close(self):
        self.values = {}


def test_an_axis_that_sdl_has_not_reported_is_where_the_kernel_has_it(joysticks, monkeypatch):
    """A trigger rests at -1, and a pad that was pushed before it was opened is pushed."""
    monkeypatch.setattr(sdl.evdev, 'InputDevice', Kernel)
    pygame = Pygame(('Pad', '/dev/input/event3'), ('Node of joydev', '/dev/input/js0'))
    found = joysticks(pygame)
    pad, old = found.look()
    monkeypatch.setattr(sdl.os, 'fstat', lambda _: types.SimpleNamespace(st_nlink=1))
    joystick = found.open(pad)
    assert joystick.state()[0] == (1.0, -1.0)
    pygame.event.get.return_value = [types.SimpleNamespace(type=7, instance_id=6, axis=0)]
    pygame.axis = 0.25
    assert joystick.state()[0] == (0.25, -1.0)
    monkeypatch.setattr(Kernel, 'values', {})
    with pytest.raises(DeviceLost):
        joystick.state()
    joystick.close()
    assert found.open(old).state()[0] == (None, None)


def test_joysticks_without_pygame_name_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, 'pygame', None)
    monkeypatch.setattr(sdl.os, 'environ', {})
    with pytest.raises(DeviceAbsent, match='python3-pygame'):
        sdl.Joysticks().look()

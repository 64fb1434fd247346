# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``mhri_joy --calibrate``: the dialogue of :mod:`mhri.devices.calibration` in a terminal."""
import argparse
import os
import select
import sys

from mhri.base.config import ConfigError
from mhri.base.io.files import whole
from mhri.base.names import is_base_name
from mhri.devices.calibration import Calibration, DONE, profile_name
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.io.sdl import Joysticks
from mhri.devices.pads import choose_pad
from mhri.devices.profile import parse_profile

LOOK_S = 0.01


class Refused(Exception):
    """The calibration ends without a profile; the text has the reason and the remedy."""


def _options(argv):
    parser = argparse.ArgumentParser(
        prog='mhri_joy', description='Writes a profile for the pad at hand.')
    parser.add_argument('--calibrate', action='store_true', help='do so; without it, run the node')
    parser.add_argument('name', nargs='?', help='name of the profile (default: that of the pad)')
    parser.add_argument('--device', default='', help='a part of the name, the GUID or the index of '
                        'the pad (default: the first)')
    parser.add_argument('--force', action='store_true', help='replace a profile of that name')
    return parser.parse_args(argv)


def calibrate(argv, folder, taken, joysticks=None, stdin=None):
    """Run the dialogue, write ``<folder>/<name>.yaml`` and print its path.

    :param argv: the command line, see ``mhri_joy --calibrate --help``
    :param folder: created if missing
    :param taken: names that are not allowed
    :param joysticks: stands in for :class:`mhri.devices.io.sdl.Joysticks`
    :param stdin: a stream with a file descriptor, for Enter
    :returns: 0, or a description of the error
    """
    options = _options(argv)
    try:
        path = _calibrate(options, folder, taken, joysticks or Joysticks(), stdin or sys.stdin)
    except KeyboardInterrupt:
        return '\nended: nothing was written'
    except DeviceLost as reason:
        return 'the pad is lost: {}; nothing was written'.format(reason)
    except (Refused, ConfigError) as reason:
        return str(reason)
    except (DeviceAbsent, LookupError) as reason:
        return 'there is no pad to calibrate: {}'.format(reason)
    except OSError as error:
        return 'cannot write to {}: {}; make it writable, or set ROS_HOME'.format(
            folder, error.strerror or error)
    print('Written: {}. It is used from now on whenever this pad is plugged in.'.format(path))
    return 0


def _calibrate(options, folder, taken, joysticks, stdin):
    """Calibrate; return the path.

    :raises Refused: the name cannot be used, or the dialogue was cancelled
    """
    info = choose_pad(options.device, joysticks.look(), [])
    name = options.name or profile_name(info.name)
    path = os.path.join(folder, name + '.yaml')
    _check(name, path, taken, options.force)
    print('Calibrating {}. Robots that are driven with it would move: press Stop all first.'.format(
        info.name))
    text = _ask(joysticks, info, Calibration(name, info.name, info.guid), stdin)
    try:
        write_profile(path, text, options.force)
    except FileExistsError:
        raise Refused('{} was written meanwhile; choose another name, or add --force'.format(path))
    return path


def write_profile(path, text, replace):
    """Write a profile completely or not at all, after checking that it can be parsed.

    The folder is created if missing.

    :param replace: whether to replace an existing file
    :raises FileExistsError: the file exists and must not be replaced
    :raises OSError: the file cannot be written
    :raises ConfigError: the text is not a profile
    """
    parse_profile(text, path)
    with whole(path) as part:
        with open(part, 'w', encoding='utf-8') as stream:
            stream.write(text)
        with open(part, encoding='utf-8') as stream:
            parse_profile(stream.read(), path)
        # Checked only now: another profile may have been written during the dialogue.
        if not replace:
            os.link(part, path)


def _check(name, path, taken, force):
    """Check the name before the first question.

    :raises Refused: the name cannot be used
    """
    if not is_base_name(name):
        raise Refused('{!r} cannot name a profile: use a letter, then letters, digits and _'.format(
            name))
    if name in taken:
        raise Refused('{} is the name of a shipped profile; choose another, for instance '
                      'my_{}'.format(name, name))
    if os.path.exists(path) and not force:
        raise Refused('{} exists; choose another name, or add --force to replace it'.format(path))


def _ask(joysticks, info, calibration, stdin):
    """Run the dialogue to its end; return the profile's text.

    :raises Refused: the terminal was closed
    """
    pad = joysticks.open(info)
    shown = None
    try:
        while calibration.step != DONE:
            calibration.feed(*pad.state())
            if shown != (calibration.step, calibration.problem):
                shown = (calibration.step, calibration.problem)
                print(' '.join(filter(None, (calibration.problem, calibration.prompt))), flush=True)
            if select.select([stdin], [], [], LOOK_S)[0]:
                # Read bytes, not lines: select does not cover the buffer of a text stream.
                pressed = os.read(stdin.fileno(), 4096)
                if not pressed:
                    raise Refused('ended before the last question: nothing was written')
                if b'\n' in pressed:
                    calibration.confirm()
    finally:
        pad.close()
    return calibration.text()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and states as text for the operator: fixed number of digits, units, never "None"."""
import math
import re

from mhri.base import views
from mhri.base.remote_display import HELD_S

UNKNOWN = '–'
BETWEEN_FIGURES = '   '
# Longer names may be shortened [characters].
USUAL_NAME = 12
# Upper bound of displayed values: a larger one is a fault of its sender, and would not fit.
_TOO_BIG = 1e8

LINK_WORDS = {
    views.WAITING: 'waiting',
    views.LIVE: 'live',
    views.SILENT: 'silent',
    views.GONE: 'gone',
}


def _is_number(value):
    """Return whether a value can be shown as a number: not None, finite and not too large."""
    return value is not None and abs(value) < _TOO_BIG


def age_text(age_s):
    """Return an age [s] with two digits, e.g. "12 ms", "3.2 s", "4 min"; '' for None and NaN."""
    if not _is_number(age_s):
        return ''
    age_ms = max(0.0, age_s) * 1000.0
    if age_ms < 99.5:
        return '{:.0f} ms'.format(age_ms)
    if age_ms < 995.0:
        return '{:.0f} ms'.format(round(age_ms, -1))
    if age_s < 59.95:
        return '{:.1f} s'.format(age_s)
    if age_s < 3570.0:
        return '{:.0f} min'.format(age_s / 60.0)
    return '{:.0f} h'.format(age_s / 3600.0)


def linear_text(linear_mps):
    """Return a speed [m/s] along x, e.g. "0.31 m/s" or "back 0.31 m/s"; a dash for None and NaN."""
    return _directed(linear_mps, '', 'back ', 'm/s')


def turn_text(angular_rad_s):
    """Return a yaw rate [rad/s, left positive], e.g. "left 0.20 rad/s"; a dash for None and NaN."""
    return _directed(angular_rad_s, 'left ', 'right ', 'rad/s')


def lateral_text(lateral_mps):
    """Return a speed [m/s] along y, e.g. "left 0.31 m/s"; a dash for None and NaN."""
    return _directed(lateral_mps, 'left ', 'right ', 'm/s', 'sideways ')


def motion_texts(view, both=False):
    """Return (speed, turn) of a robot: ("0.31 m/s", "left 0.20 rad/s").

    The speed is the larger of those along x and y. Where it is zero, a robot that turns has
    ("turning left", "0.20 rad/s").

    :param view: :class:`mhri.base.views.RobotView`
    :param both: return both speeds of a robot that can drive sideways
    """
    aside, turn = view.lateral_mps or 0.0, view.angular_rad_s
    sideways = abs(aside) > abs(view.linear_mps or 0.0) and view.holonomic
    speed = aside if sideways else view.linear_mps
    if view.moving and _is_number(turn) and round(turn, 2) and _is_number(speed) \
            and not round(speed, 2):
        return 'turning ' + ('left' if turn > 0.0 else 'right'), rate_text(abs(turn))
    texts = linear_text(view.linear_mps), lateral_text(aside)
    return BETWEEN_FIGURES.join(texts) if both and view.holonomic else texts[sideways], \
        turn_text(turn)


def motion_shorter(speed):
    """Return shorter forms of the speed of :func:`motion_texts`: "back 0.31 m/s", "back 0.31".

    "turning left" becomes "turning", then "turns".
    """
    if speed.startswith('turning'):
        return 'turning', 'turns'
    number = speed.rpartition(' ')[0]
    return (number,) if number else ()


def turn_shorter(turn):
    """Return shorter forms of the turn of :func:`motion_texts`: a direction needs no unit."""
    number = turn.rpartition(' ')[0]
    return (number, '') if ' ' in number else ('',)


def rate_text(angular_rad_s):
    """Return a yaw rate without direction, e.g. "3.14 rad/s"; a dash for None and NaN."""
    return _directed(angular_rad_s, '', '-', 'rad/s')


def _directed(value, positive, negative, unit, neither=''):
    """Return a number with its direction, or ``neither`` if it rounds to zero."""
    if not _is_number(value):
        return UNKNOWN
    shown = round(abs(value), 2)
    word = neither if shown == 0.0 else positive if value > 0.0 else negative
    return '{}{:.2f} {}'.format(word, shown, unit)


def command_texts(forward, turn, sideways, limits):
    """Describe a stick's command, e.g. ("forward 0.31 m/s", "left 0.20 rad/s").

    Sideways motion is in the second text: "left 0.31 m/s, left 0.20 rad/s".

    :param forward: deflection in [-1, 1], ahead positive
    :param turn: deflection in [-1, 1], left positive
    :param sideways: likewise
    :param limits: the operator's speed limits [m/s, rad/s]
    """
    return (_directed(forward * limits[0], 'forward ', 'back ', 'm/s'),
            ', '.join(([lateral_text(sideways * limits[0])] if sideways else []) + (
                [turn_text(turn * limits[1])] if turn or not sideways else [])))


def heading_text(heading_rad):
    """Return a heading [rad] in whole degrees in (-180, 180], e.g. "47 deg"; a dash for None."""
    if not _is_number(heading_rad):
        return UNKNOWN
    degrees = round(math.degrees(math.remainder(heading_rad, 2.0 * math.pi)))
    return '{:d} deg'.format(180 if degrees == -180 else degrees)


def compass_text(heading_rad):
    """Return a heading [rad] as three digits in 000 to 359, left turns add; a dash for None."""
    if not _is_number(heading_rad):
        return UNKNOWN
    return '{:03d}'.format(round(math.degrees(heading_rad)) % 360)


def metres_text(value_m):
    """Return a coordinate, e.g. "-1.25 m"; a dash for None and NaN."""
    # A value that rounds to zero has no sign.
    return '{:.2f} m'.format(round(value_m, 2) + 0.0) if _is_number(value_m) else UNKNOWN


def battery_text(fraction):
    """Return a battery's charge in [0, 1] in percent, e.g. "82 %"; '' if unknown."""
    if not _is_number(fraction):
        return ''
    return '{:.0f} %'.format(100.0 * min(1.0, max(0.0, fraction)))


def remote_stick_texts(remote):
    """Return (text, shorter ones) on driving with keys and stick on a remote display.

    :param remote: kind of the display, e.g. "VNC"
    """
    rule = 'let go after {:.0f} s unless the key repeats or the pointer moves'.format(HELD_S)
    return 'remote display ({}): {}'.format(remote, rule), (
        rule, 'remote: let go after {:.0f} s'.format(HELD_S))


def voice_texts(heard, device):
    """Return (text, shorter ones) below the talk button.

    The text says that "stop" is recognised only while a microphone is open.

    :param heard: :class:`mhri.base.views.HeardView`, None before the first
    :param device: :class:`mhri.base.views.DeviceView` of the voice, None if unknown
    """
    if device is not None and device.absent:
        return device.note, beginnings(device.note)
    if heard is not None:
        return heard_text(heard), heard_shorter(heard)
    if device is None or not device.name:
        return 'say the wake word, or hold the button and talk', ('wake word or button',)
    return ('say the wake word, or hold the button and talk; "stop" is always heard',
            ('wake word or button; "stop" is always heard', '"stop" is always heard'))


def heard_text(heard):
    """Return the words heard and their interpretation, e.g. 'heard "robot forward": forward 0.5'.

    :param heard: :class:`mhri.base.views.HeardView`
    """
    if not heard.text:
        return heard_outcome(heard)
    return 'heard "{}": {}'.format(heard.text, heard_outcome(heard))


def heard_shorter(heard):
    """Return shorter and shorter forms of :func:`heard_text`, which keep the interpretation."""
    outcome = heard_outcome(heard)
    return (outcome,) + beginnings(outcome)


def heard_outcome(heard):
    """Return the voice node's interpretation."""
    return heard.command if heard.accepted else heard.reason or 'not a command'


def name_ends(name):
    """Return shortened forms of a robot's name, the longest first.

    "inspection_crawler_12" becomes "…crawler_12": similar names usually differ at the end.
    """
    cuts = [place + 1 for place, sign in enumerate(name) if sign == '_' and place]
    end = len(name) - max(cuts, default=0)
    cuts += [len(name) - left for left in (12, 8, 4) if left + 2 < end]
    return tuple('…' + name[cut:] for cut in sorted(set(cuts)) if name[cut:])


def usual_name(name):
    """Return a name if it is of usual length, else its longest end that is."""
    forms = (name, *name_ends(name))
    return next((form for form in forms if len(form) <= USUAL_NAME), forms[-1])


def kept_together(text):
    """Return a text that is never wrapped between a number and its unit."""
    return re.sub(r'(?<=\d) (?=(%|m?s|h|min|m|m/s|rad/s|Hz|Mbit/s|deg)\b|%)', '\u00a0', text)


def beginnings(text, marks=('; ', ': ', ' after '), most=0):
    """Return beginnings of a sentence that are meaningful by themselves, for less space.

    "centre the stick: it was out of reach" becomes "centre the stick".

    :param marks: marks that end a beginning, the longest beginning first
    :param most: also return beginnings of at most this many words, each one shorter, with a "…"
    """
    found = dict.fromkeys(text.partition(mark)[0] for mark in marks if mark in text)
    parts = text.split()
    found.update((' '.join(parts[:count]) + ' …', None)
                 for count in range(min(most, len(parts) - 1), 0, -1))
    return tuple(found)


def endings(text):
    """Return the ends of a phrase whose figure comes last: "stopped in 38 ms", "in 38 ms", ...

    Text after a comma is left out first.
    """
    phrase = text.partition(', ')[0]
    parts = phrase.split()
    return (*((phrase,) if phrase != text else ()),
            *(' '.join(parts[first:]) for first in range(1, len(parts) - 1)))


def proof_shorter(proof):
    """Return shorter texts for a stop that is proved or not confirmed, () while it is pending."""
    return {views.PROOF_NOT_CONFIRMED: (*beginnings(proof.text), 'not confirmed', 'not sure'),
            views.PROOF_STOPPED: ('stopped',)}.get(proof.state, ())


def type_text(view):
    """Return a robot's type, and whether it has a guard, e.g. "guarded TurtleBot2".

    In this order, since text that does not fit is cut off at the end.
    """
    return ('guarded ' if view.guarded else '') + view.type_label


def figures_text(figures):
    """Return the measurements of a link, e.g. "link 12 ms   clock +0.02 s   lost 0 %".

    :param figures: :class:`mhri.base.views.LinkFigures`; unknown values are left out
    """
    words = []
    if _is_number(figures.round_trip_s):
        words.append('link {}'.format(age_text(figures.round_trip_s)))
    if _is_number(figures.offset_s):
        words.append('clock {:+.2f} s'.format(round(figures.offset_s, 2) + 0.0))
    if _is_number(figures.loss):
        words.append('lost {:.0f} %'.format(100.0 * figures.loss))
    return BETWEEN_FIGURES.join(words)


def bandwidth_text(bits_per_s):
    """Return the network load of the pictures, e.g. "cameras 12.3 Mbit/s"; '' for none."""
    if not _is_number(bits_per_s) or bits_per_s <= 0.0:
        return ''
    return 'cameras {:.1f} Mbit/s'.format(bits_per_s / 1e6)


def link_age(view):
    """Return the age of a robot's last message if no other text has it, e.g. "12 ms"."""
    told = view.link == views.SILENT and view.note and view.proof is None
    return age_text(view.age_s) if view.link in (views.LIVE, views.SILENT) and not told else ''


def link_text(view):
    """Return the state of a robot's link and, if helpful, its age: "live 12 ms"."""
    return '{} {}'.format(LINK_WORDS[view.link], link_age(view)).strip()

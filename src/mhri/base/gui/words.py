# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and states in the words of a person: fixed number of digits, units, never "None"."""
import math
import re

from mhri.base import views
from mhri.base.remote_display import HELD_S

UNKNOWN = '–'
BETWEEN_FIGURES = '   '
# Nothing on the screen is that big: it is a fault of whoever says it, and would not fit.
_TOO_BIG = 1e8

LINK_WORDS = {
    views.WAITING: 'waiting',
    views.LIVE: 'live',
    views.SILENT: 'silent',
    views.GONE: 'gone',
}


def _is_number(value):
    """Tell whether a value can be shown as a number: neither None nor NaN, and not endless."""
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


def rate_text(angular_rad_s):
    """Return a yaw rate without direction, e.g. "3.14 rad/s"; a dash for None and NaN."""
    return _directed(angular_rad_s, '', '-', 'rad/s')


def _directed(value, positive, negative, unit):
    """Return a number with the word of its direction; what rounds to zero has none."""
    if not _is_number(value):
        return UNKNOWN
    shown = round(abs(value), 2)
    word = '' if shown == 0.0 else positive if value > 0.0 else negative
    return '{}{:.2f} {}'.format(word, shown, unit)


def command_texts(forward, turn, limits):
    """Return what a stick asks for, e.g. ("forward 0.31 m/s", "left 0.20 rad/s").

    :param forward: deflection in [-1, 1], ahead positive
    :param turn: deflection in [-1, 1], left positive
    :param limits: the operator's speed limits [m/s, rad/s]
    """
    return (_directed(forward * limits[0], 'forward ', 'back ', 'm/s'),
            turn_text(turn * limits[1]))


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
    # What rounds to zero has no sign.
    return '{:.2f} m'.format(round(value_m, 2) + 0.0) if _is_number(value_m) else UNKNOWN


def battery_text(fraction):
    """Return a battery's charge in [0, 1] as percent, e.g. "82 %"; '' where there is none."""
    if not _is_number(fraction):
        return ''
    return '{:.0f} %'.format(100.0 * min(1.0, max(0.0, fraction)))


def remote_stick_texts(remote):
    """Return (text, shorter ones) of how keys and stick drive on a remote display.

    :param remote: what kind it is, e.g. "VNC"
    """
    rule = 'let go after {:.0f} s unless the key repeats or the pointer moves'.format(HELD_S)
    return 'remote display ({}): {}'.format(remote, rule), (
        rule, 'remote: let go after {:.0f} s'.format(HELD_S))


def voice_texts(heard, device):
    """Return (text, shorter ones) below the button to talk.

    That "stop" is heard is said only while a microphone is open.

    :param heard: :class:`mhri.base.views.HeardView`, None before the first
    :param device: :class:`mhri.base.views.DeviceView` of the voice, None while nobody says
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
    """Return what the voice node made of what it heard, e.g. 'heard "robot forward": forward 0.5'.

    :param heard: :class:`mhri.base.views.HeardView`
    """
    if not heard.text:
        return heard_outcome(heard)
    return 'heard "{}": {}'.format(heard.text, heard_outcome(heard))


def heard_shorter(heard):
    """Return :func:`heard_text` in fewer and fewer words: what was made of it is what matters."""
    outcome = heard_outcome(heard)
    return (outcome,) + beginnings(outcome)


def heard_outcome(heard):
    """Return what the voice node made of what it heard."""
    return heard.command if heard.accepted else heard.reason or 'not a command'


def name_ends(name):
    """Return the ends of a robot's name where there is no room for all of it, the longest first.

    "inspection_crawler_12" is "…crawler_12": names that differ, differ at the end.
    """
    cuts = [place + 1 for place, sign in enumerate(name) if sign == '_' and place]
    end = len(name) - max(cuts, default=0)
    cuts += [len(name) - left for left in (12, 8, 4) if left + 2 < end]
    return tuple('…' + name[cut:] for cut in sorted(set(cuts)) if name[cut:])


def kept_together(text):
    """Return a text that is never wrapped between a number and its unit."""
    return re.sub(r'(?<=\d) (?=(%|m?s|h|min|m|m/s|rad/s|Hz|Mbit/s|deg)\b|%)', '\u00a0', text)


def beginnings(text, marks=('; ', ': ', ' after '), most=0):
    """Return the beginnings of a sentence that say enough where there is no room for all of it.

    "centre the stick: it was out of reach" is "centre the stick" in short.

    :param marks: what ends a beginning, the longest first
    :param most: further ones, of that many words at first and of one less each, with a "…"
    """
    found = dict.fromkeys(text.partition(mark)[0] for mark in marks if mark in text)
    parts = text.split()
    found.update((' '.join(parts[:count]) + ' …', None)
                 for count in range(min(most, len(parts) - 1), 0, -1))
    return tuple(found)


def endings(text):
    """Return the ends of a phrase whose figure comes last: "stopped in 38 ms", "in 38 ms", ...

    What follows after a comma is left out first.
    """
    phrase = text.partition(', ')[0]
    parts = phrase.split()
    return (*((phrase,) if phrase != text else ()),
            *(' '.join(parts[first:]) for first in range(1, len(parts) - 1)))


def proof_shorter(proof):
    """Return shorter texts of a stop that is not confirmed, () of another."""
    return (*beginnings(proof.text), 'not confirmed', 'not sure') \
        if proof.state == views.PROOF_NOT_CONFIRMED else ()


def type_text(view):
    """Return a robot's type, and whether a guard stands on it, e.g. "guarded TurtleBot2".

    In this order, since what does not fit is cut off at the end.
    """
    return ('guarded ' if view.guarded else '') + view.type_label


def figures_text(figures):
    """Return what was measured of a link, e.g. "link 12 ms   clock +0.02 s   lost 0 %".

    :param figures: :class:`mhri.base.views.LinkFigures`; what is not known is left out
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
    """Return what pictures take of the network, e.g. "cameras 12.3 Mbit/s"; '' for nothing."""
    if not _is_number(bits_per_s) or bits_per_s <= 0.0:
        return ''
    return 'cameras {:.1f} Mbit/s'.format(bits_per_s / 1e6)


def link_age(view):
    """Return the age of what a robot said last, where it helps and no sentence says it: "12 ms"."""
    told = view.link == views.SILENT and view.note and view.proof is None
    return age_text(view.age_s) if view.link in (views.LIVE, views.SILENT) and not told else ''


def link_text(view):
    """Return the word for a robot's link and, where it helps, the age: "live 12 ms"."""
    return '{} {}'.format(LINK_WORDS[view.link], link_age(view)).strip()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What an operator can read on a screen: the words of its widgets, and how two screens differ.

A replay is compared with the screen that was live. What differs by nature is in ``BY_NATURE``.
"""
import re

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QAbstractButton, QComboBox, QLabel

from mhri.base.gui.labels import Pill, Sign
from mhri.base.gui.words import linear_text, turn_text
from mhri.base.views import RobotView
from mhri.events.gui.event_list import ROBOT, WHAT
from mhri.screen.gui.hud import hud_lines
from mhri.session.lines import line_of_screen

#: {words that are not compared: why}
BY_NATURE = {
    'header.rec_label': 'says REPLAY, where a recording was',
    'header.views_button': 'opens what this tile shows: of this screen, not of then',
    'header.tear_button': 'the same',
    'row.age': 'how old the newest word is: milliseconds then, no time passes in a pause',
    'row.ask_button': 'asks another host, and a replay asks nobody',
    'row.carry_on_button': 'starts a task, and a replay starts nothing',
    'header.carry_on_button': 'the same',
    'foot._note_line': 'says what to do about a stop: nothing, in a replay',
    'foot.power_button': 'nothing can be switched',
    'foot.release_button': 'nothing can be released',
    'foot.confirm_button': 'nothing can be released',
    'foot.cancel_button': 'nothing can be released',
}
#: words that a header leaves out where it has no room for them: REPLAY takes some
ROOM = ('header.link_label', 'header.type_label', 'header.battery_label', 'header.link_sign')
# Words within others that are not compared: ages, and how long a message took.
_LIVE_WORDS = re.compile(r'((?<!stopped in )\b\d+ ms|\d+(\.\d)? s ago)')
_NUMBER = re.compile(r'[+-]?\d+(?:\.\d+)?')
# Of two things that are as near as each other, noise decides which is told.
_DIRECTION = re.compile(r'(?<=to the nearest thing, )[a-z ]+')
# Numbers with a sign are told without: "left 0.10 rad/s", "back 0.10 m/s".
_SIGNED = re.compile(r'\b(left|right|back) (?=\d)')
_SIGNS = {'left': '+', 'right': '-', 'back': '-'}


def _word(widget, part):
    """Return what can be read on a widget of a part of the screen, None where nothing can."""
    if not isinstance(widget, (QLabel, Pill, QAbstractButton, Sign, QComboBox)) \
            or not widget.isVisibleTo(part):
        return None
    if isinstance(widget, Pill):
        return widget.word
    if isinstance(widget, Sign):
        return ' '.join(widget.sign or ())
    if isinstance(widget, QComboBox):
        return widget.currentText()
    if isinstance(widget, QAbstractButton) and widget.isCheckable():
        return '{} {}'.format(widget.text(), 'on' if widget.isChecked() else 'off')
    return widget.text()


def _words(kind, part):
    """Yield (name, word) of all widgets that an object has as attributes."""
    for name, widget in vars(part).items():
        word = _word(widget, part)
        if word and '{}.{}'.format(kind, name) not in BY_NATURE:
            yield '{}.{}'.format(kind, name), word


def words_of(host):
    """Return {place: what can be read there} of a ``ScreenHost``.

    From the widgets themselves, as far as they are on show.
    """
    screen, found = host.screen, {}
    found['status'] = screen.status_line.findChild(QLabel, 'status_label').text()
    found['mode'] = screen.mode_combo.currentText()
    found.update(_words('foot', screen.stop_bar))
    found.update(_words('limits', screen.speed_limits))
    for name, tile in host.windows.items():
        parts = [('row', screen.robot_list.row(name))]
        if tile.isVisible():
            parts.append(('header', tile.header))
            found.update(('{} hud {}'.format(name, number), line)
                         for number, line in enumerate(tile.hud.lines))
            found[name + ' sentence'] = tile.hud.sentence
            found[name + ' sentence sign'] = ' '.join(tile.hud.sign or ())
        for kind, part in parts:
            if part is not None:
                found.update(('{} {}'.format(name, place), word)
                             for place, word in _words(kind, part))
    return {place: _signed(_LIVE_WORDS.sub('...', word)) for place, word in found.items()}


def _signed(word):
    return _SIGNED.sub(lambda match: _SIGNS[match.group(1)], word)


def words_of_motion(name, motion):
    """Return {place: what can be read there} of a :class:`Motion`, wherever its numbers are."""
    view = RobotView(name, linear_mps=motion.linear_mps, angular_rad_s=motion.angular_rad_s,
                     heading_rad=motion.heading_rad)
    lines = (*hud_lines(view), linear_text(view.linear_mps), turn_text(view.angular_rad_s))
    return {name + place: _signed(line) for place, line in zip(
        (' hud 0', ' hud 1', ' row.linear', ' row.turn'), lines)}


def told_events(host):
    """Return (time [s since 1970], robot, text) of the events that a live screen tells a session.

    Mode, selection and stop come into it from the graph itself, in words of their own.
    """
    model = host.events.page.model
    events = [model.index(row, 0).data(Qt.UserRole) for row in range(model.rowCount())]
    return [(event.time_s, event.robot, event.text) for event in events
            if line_of_screen(event.kind, event.severity, event.robot, event.text)]


def events_of(host):
    """Return (robot, text) of each line of the event list."""
    model = host.events.page.model
    return [(model.index(row, ROBOT).data(), model.index(row, WHAT).data())
            for row in range(model.rowCount())]


def event_differences(told, shown):
    """Return sentences on the events that a screen had told of and a replay does not show."""
    return ['no event {!r} of {}'.format(text, robot or 'all') for _, robot, text in told
            if (robot, text) not in shown]


def framed(words):
    """Return words without their numbers."""
    return {place: _frame(word) for place, word in words.items()}


def _frame(word):
    return _NUMBER.sub('#', _DIRECTION.sub('#', word))


def differences(before, then, after, carried, now):
    """Return sentences on what a replay shows and the live screen did not.

    Each part of a busy screen shows new numbers when its turn comes: they may lie between what it
    showed last before the moment and first after it.

    :param before: what :func:`words_of` returned some times before the moment
    :param then: the same around it, not empty
    :param after: the same after it
    :param carried: {place: words} of what came of each robot's motion around the moment
    :param now: the same of the replay
    """
    found = []
    for place in sorted({*now, *(place for words in then for place in words)}):
        shown, seen = now.get(place, ''), [words.get(place, '') for words in then]
        left_out = place.endswith(ROOM) and (not shown or not any(seen))
        beside = [next((words[place] for words in looks if words.get(place, '') not in (
            '', near.get(place))), shown) for looks, near in (
                (before[::-1], then[0]), (after, then[-1]))] + carried.get(place, [])
        if not left_out and not _matches(seen, shown, beside):
            found.append('{}: {!r}, it was {}'.format(place, shown, ' or '.join(
                map(repr, dict.fromkeys(seen)))))
    return found


def _matches(seen, shown, beside):
    """Tell whether words are those that were seen; numbers may be between those, and two beside."""
    if shown in seen:
        return True
    same = [words for words in seen if _frame(words) == _frame(shown)]
    if same:
        same += [words for words in beside if _frame(words) == _frame(shown) and words != shown]
    if not same or '#' not in _frame(shown):
        return False
    columns = zip(*(_NUMBER.findall(_DIRECTION.sub('', words)) for words in same))
    numbers = _NUMBER.findall(_DIRECTION.sub('', shown))
    return all(_between(number, column, 'heading ' + number in shown)
               for number, column in zip(numbers, columns))


def _between(number, seen, turns):
    """Tell whether a number is between the least and the greatest seen, give or take two steps.

    And half of what lies between those: not every reading that varies is drawn.

    :param turns: whether 359 is beside 0
    """
    value, seen = float(number), [float(one) for one in seen]
    step = 2.0 * 10.0 ** -len(number.partition('.')[2]) + 0.5 * (max(seen) - min(seen))
    return min(seen) - step <= value <= max(seen) + step or turns and any(
        abs((value - one + 180.0) % 360.0 - 180.0) <= step for one in seen)

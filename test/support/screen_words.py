# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What an operator can read on a screen: the words of its widgets, and how two screens differ.

A replay is compared with the screen that was live. What differs by nature is in ``BY_NATURE``.
"""
import re

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QAbstractButton, QComboBox, QLabel

from mhri.core.session.lines import line_of_screen
from mhri.gui.events.event_list import ROBOT, WHAT
from mhri.gui.screen.labels import Pill, Sign

#: {words that are not compared: why}
BY_NATURE = {
    'header.rec_label': 'says REPLAY, where a recording was',
    'header.views_button': 'opens what this tile shows: of this screen, not of then',
    'header.tear_button': 'the same',
    'row.age': 'how old the newest word is: milliseconds then, no time passes in a pause',
    'row.ask_button': 'asks another host, and a replay asks nobody',
    'row.carry_on_button': 'starts a task, and a replay starts nothing',
    'header.carry_on_button': 'the same',
    'foot.release_button': 'nothing can be released',
    'foot.confirm_button': 'nothing can be released',
    'foot.cancel_button': 'nothing can be released',
}
# Words within others that are not compared: ages, and how long a message took.
_LIVE_WORDS = re.compile(r'(\d+ ms|\d+(\.\d)? s ago)')
_NUMBER = re.compile(r'\d+(?:\.\d+)?')


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
    """Return {place: what can be read there} of a :class:`mhri.presenters.screen_host.ScreenHost`.

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
            found[name + ' hud'] = '\n'.join(tile.hud.lines)
            found[name + ' sentence'] = tile.hud.sentence
            found[name + ' sentence sign'] = ' '.join(tile.hud.sign or ())
        for kind, part in parts:
            if part is not None:
                found.update(('{} {}'.format(name, place), word)
                             for place, word in _words(kind, part))
    return {place: _LIVE_WORDS.sub('...', word) for place, word in found.items()}


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
    return {place: _NUMBER.sub('#', word) for place, word in words.items()}


def differences(then, now):
    """Return sentences on what a replay shows and the live screen did not.

    :param then: what :func:`words_of` returned a few times around the moment, not empty
    :param now: the same of the replay
    """
    found = []
    for place in sorted({*now, *(place for words in then for place in words)}):
        shown, seen = now.get(place, ''), [words.get(place, '') for words in then]
        if not _matches(seen, shown):
            found.append('{}: {!r}, it was {}'.format(place, shown, ' or '.join(
                map(repr, dict.fromkeys(seen)))))
    return found


def _matches(seen, shown):
    """Tell whether words are those that were seen; numbers may be among those around it."""
    if shown in seen:
        return True
    frame = _NUMBER.sub('#', shown)
    same = [_NUMBER.findall(words) for words in seen if _NUMBER.sub('#', words) == frame]
    if not same or '#' not in frame:
        return False
    return all(min(map(float, column)) - _step(number) <= float(number)
               <= max(map(float, column)) + _step(number)
               for number, *column in zip(_NUMBER.findall(shown), *same))


def _step(number):
    """Return what the last digit of a number counts, twice."""
    return 2.0 * 10.0 ** -len(number.partition('.')[2])

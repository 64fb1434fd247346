# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line across the top of a tile: the robot's name, drive state and link."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base import views
from mhri.base.gui import theme, words
from mhri.base.gui.controls import Button
from mhri.base.gui.labels import BatteryLine, Pill, Sign, TextLine
from mhri.base.gui.layouts import in_row
from mhri.base.gui.robot_sign import RobotNumber
from mhri.recording.recording import duration_text
from mhri.robots.gui.tile_words import (
    DRIVING, NOT_CONFIRMED, NOT_SELECTED, ON_TASK, SELECTED, STOPPED, STOPPING)

VIEWS, VIEWS_IN_SHORT = 'Views', '…'
REPLAY, REC = 'REPLAY', 'REC'
TEAR_OFF, PUT_BACK = 'Tear off', 'Put back'
TYPE, AGE, LINK, PILL, BATTERY = 'type', 'age', 'link', 'pill', 'battery'
GAPS, SIGN, REC_PILL, STATE = 'gaps', 'sign', 'rec', 'state'
# Parts to leave out if there is no room, in this order; small tiles never have the first ones. PILL
# is the room for longer states. Edge and sentence of the tile show the last ones as well, and no
# name of usual length is shortened for any part.
_LEFT_OUT = (TYPE, AGE, TEAR_OFF, VIEWS, LINK, PILL, BATTERY, GAPS, SIGN, REC_PILL, STATE)
_OF_SMALL = 6

# Appearance of each drive state: colour, whether the pill is filled, width of the tile's edge [px].
# A robot that is proved to stand needs nobody, as does one that is not driven.
LOOKS = {
    DRIVING: (theme.DRIVE, True, 4),
    ON_TASK: (theme.TASK, True, 3),
    SELECTED: (theme.DRIVE, False, 2),
    STOPPING: (theme.STOP, False, 4),
    NOT_CONFIRMED: (theme.STOP, True, 4),
    STOPPED: (theme.MUTED, False, 1),
    NOT_SELECTED: (theme.MUTED, False, 1),
}


def carry_on_text(label):
    """Return the text of the button that continues a task, e.g. "Continue square"; '' if none."""
    return 'Continue ' + label.lower() if label else ''


class TileHeader(QWidget):
    """The header over the picture, light on dark in every theme; small tiles omit parts.

    Child widgets: ``number_label``, ``name_label``, ``type_label``, ``pill``, ``link_sign``,
    ``link_label``, ``battery_label``, ``rec_label``, ``carry_on_button``, ``views_button``,
    ``tear_button``.
    """

    def __init__(self, name, type_label, parent=None):
        super().__init__(parent)
        self.large = True
        self._view = None
        self._with_age = True
        self._replay = False
        # Durations of the recordings of the session and of this robot alone [s].
        self._session_s = self._own_s = None
        self._with_both = True
        self._build(name, type_label)

    def _build(self, name, type_label):
        """Make and place the parts."""
        self.setObjectName('tile_header')
        self.setPalette(theme.over_picture(self.palette()))
        self.number_label, self.name_label = RobotNumber(self), TextLine(self)
        self.type_label, self.link_label = TextLine(self), TextLine(self)
        self.rec_label, self.battery_label = TextLine(self), BatteryLine(self)
        self.pill, self.link_sign = Pill(self), Sign(self)
        self.name_label.show_text(name, shorter=(*words.name_ends(name), ''))
        self.type_label.show_text(type_label, theme.MUTED)
        self.views_button = Button(
            VIEWS, self, checkable=True, accessibleName=VIEWS,
            toolTip='what this tile shows, its recording and its streams')
        self.tear_button = Button(TEAR_OFF, self)
        self.carry_on_button = Button(self)
        self.carry_on_button.hide()
        self.tear_button.setToolTip('into a window of its own, for another monitor')
        for key, part in vars(self).items():
            if isinstance(part, QWidget):
                part.setObjectName(key)
        for button in (self.views_button, self.tear_button, self.carry_on_button):
            button.setFocusPolicy(Qt.TabFocus)
        self._row = in_row(
            self.number_label, self.name_label, self.pill, 0, self.link_sign, self.link_label,
            self.battery_label, self.rec_label, self.type_label, 0, self.carry_on_button,
            self.views_button, self.tear_button, of=self)
        self.rec_label.hide()
        self.number_label.hide()
        self.show_large(True)

    def show_large(self, large):
        """Switch to the header of a large or a small tile."""
        self.large = large
        base = theme.base_font(self.window().font() if self.window() else self.font())
        unit = self.fontMetrics().height()
        self._row.setContentsMargins(unit // 2, 2, 2 if large else unit // 3, 2)
        bold = theme.larger(base, theme.TITLE if large else theme.BODY, bold=True)
        numbers = theme.number_font(base)
        for part, font in ((self.name_label, bold), (self.number_label, bold),
                           (self.link_label, numbers), (self.battery_label, numbers),
                           (self.rec_label, numbers), (self.link_sign, numbers),
                           (self.pill, base)):
            part.setFont(font)
        self.battery_label.fix_width('100 %')
        for button in (self.views_button, self.tear_button, self.carry_on_button):
            button.setMinimumHeight(theme.touch_size(self))
        for place in range(self._row.count()):
            if self._row.itemAt(place).spacerItem():
                self._row.setStretch(place, int((place > 4) == large))
        self.show_drive(self.pill.word)

    def show_drive(self, word):
        """Show the drive state in the pill."""
        if word:
            self.pill.show_word(word, *LOOKS[word][:2])
        self.fit()

    def fit(self):
        """Hide parts that do not fit, always in the same order, the name last."""
        name = self.name_label
        wanted = theme.text_width(name.font(), words.usual_name(name.text()))
        name.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        name.setMaximumWidth(theme.text_width(name.font(), name.text()))
        name.setMinimumWidth(1)
        for count in range(0 if self.large else _OF_SMALL, len(_LEFT_OUT) + 1):
            self._leave_out(_LEFT_OUT[:count])
            if self._needed(wanted) <= self.width():
                break
        else:
            count = len(_LEFT_OUT)
        if STATE in _LEFT_OUT[:count]:
            # The sign of the link is smaller: it may fit without the state.
            self._leave_out([part for part in _LEFT_OUT[:count] if part != SIGN])
            if self._needed(wanted) > self.width():
                self._leave_out(_LEFT_OUT[:count])
        if self._needed(wanted) > self.width():
            self._row.setSpacing(self.fontMetrics().height() // 8)
        # Undo the squeezing by parts that were shown for a moment.
        self._row.activate()

    def _leave_out(self, parts):
        """Show everything except some parts of :data:`_LEFT_OUT`."""
        self._with_age = AGE not in parts
        self._row.setSpacing(self.fontMetrics().height() // (
            2 if self.large and GAPS not in parts else 4))
        self.link_label.fix_width('waiting 000 ms' if self._with_age else 'waiting')
        self._show_link()
        self._with_both = TYPE not in parts
        self.rec_label.fix_width(REPLAY if self._replay else self._rec_text('0'))
        self._show_rec()
        self.views_button.setText(VIEWS if VIEWS not in parts else VIEWS_IN_SHORT)
        self.views_button.setFixedWidth(
            theme.touch_size(self) + theme.text_width(self.views_button.font(),
                                                      self.views_button.text()) // 2)
        self.pill.set_words((self.pill.word,) if PILL in parts else tuple(LOOKS))
        self.type_label.fix_width(self.type_label.text())
        for part, key in ((self.type_label, TYPE), (self.link_label, LINK),
                          (self.tear_button, TEAR_OFF), (self.battery_label, BATTERY),
                          (self.link_sign, SIGN)):
            part.setVisible(key not in parts)
        self.rec_label.setVisible(bool(self._replay or self._rec_text()) and REC_PILL not in parts)
        # Without a robot that is driven or stopped there is nothing to show.
        self.pill.setVisible(self.pill.word not in ('', NOT_SELECTED) and STATE not in parts)
        self.views_button.setVisible(self.large)
        self.carry_on_button.setVisible(self.large and bool(self.carry_on_button.text()))

    def _needed(self, name_width):
        """Return the required width of all visible parts [px]."""
        parts = [item.widget() for item in map(self._row.itemAt, range(self._row.count()))
                 if item.widget() and not item.widget().isHidden()]
        margins = self._row.contentsMargins()
        # The two stretches have gaps like parts.
        return (margins.left() + margins.right() + self._row.spacing() * len(parts) + sum(
            name_width if part is self.name_label else max(
                part.minimumWidth(), min(part.sizeHint().width(), part.maximumWidth()))
            for part in parts))

    def resizeEvent(self, event):  # noqa: N802
        """Fit the new width."""
        super().resizeEvent(event)
        self.fit()

    def _show_link(self):
        """Show the state of the link, with its age if there is room."""
        if self._view is not None:
            tone = theme.TEXT if self._view.link == views.LIVE else theme.MUTED
            self.link_label.show_text(words.link_text(self._view) if self._with_age
                                      else words.LINK_WORDS[self._view.link], tone)

    def show_view(self, view, numbers=True):
        """Show a :class:`RobotView`, its numbers only if ``numbers``."""
        self.link_sign.show_sign(theme.LINK_SIGNS[view.link])
        self.link_sign.setToolTip(words.LINK_WORDS[view.link])
        self._offer_to_carry_on(view.carry_on)
        number = str(view.number) if view.number else ''
        if number != self.number_label.text():
            self.number_label.show_number(view.number)
            self.number_label.setVisible(bool(number))
            self.fit()
        kind = words.type_text(view)
        if kind != self.type_label.text():
            self.type_label.show_text(kind, theme.MUTED)
            self.fit()
        if not numbers:
            return
        self._view = view
        self._show_link()
        self.battery_label.show_charge(view.battery, view.link != views.LIVE)

    def _offer_to_carry_on(self, label):
        """Offer to continue an interrupted task, '' for none."""
        text = carry_on_text(label)
        if text != self.carry_on_button.text():
            self.carry_on_button.setText(text)
            self.fit()

    def show_replay(self):
        """From now on, show "replay" in place of the recording."""
        if not self._replay:
            self._replay = True
            self.rec_label.show_text(REPLAY, theme.ATTENTION)
            self.fit()

    def show_recording(self, status):
        """Show the duration of this robot's recording, None if not recording."""
        self._show_recorded(self._session_s, status.duration_s if status else None)

    def show_session(self, lasts_s):
        """Show the duration of the session's recording, None if not recording."""
        self._show_recorded(lasts_s, self._own_s)

    def _show_recorded(self, session_s, own_s):
        if self._replay:
            return
        before = self._rec_text('0')
        self._session_s, self._own_s = session_s, own_s
        if self._rec_text('0') != before:
            self.fit()
        self._show_rec()

    def _rec_text(self, digit=''):
        """Return the text on recordings, '' while not recording.

        Small tiles show no times, large ones those of the session and of the robot's own recording.

        :param digit: replacement of each digit, to measure the width of the text
        """
        times = [duration_text(lasts_s) for lasts_s in (self._session_s, self._own_s)
                 if lasts_s is not None]
        text = ' '.join([REC, ' + '.join(times[:2 if self._with_both else 1])]) if times else ''
        text = text if self.large or not times else REC
        return ''.join(digit if sign.isdigit() else sign for sign in text) if digit else text

    def _show_rec(self):
        if not self._replay:
            self.rec_label.show_text(self._rec_text())

    def paintEvent(self, event):  # noqa: N802
        """Paint the background."""
        QPainter(self).fillRect(self.rect(), theme.OVER_PICTURE)

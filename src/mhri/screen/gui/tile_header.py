# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line across the top of a tile: which robot, whether it is driven, how its link is."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QHBoxLayout, QPushButton, QSizePolicy, QWidget

from mhri.base import views
from mhri.base.battery import FLAT, LOW
from mhri.base.gui import theme, words
from mhri.base.gui.labels import BatteryLine, Pill, Sign, TextLine
from mhri.recording.gui.recording_row import clock_text

VIEWS, VIEWS_IN_SHORT = 'Views', '…'
REPLAY, REC = 'REPLAY', 'REC'
TEAR_OFF, PUT_BACK = 'Tear off', 'Put back'
TYPE, AGE, LINK, PILL, BATTERY = 'type', 'age', 'link', 'pill', 'battery'
GAPS, SIGN = 'gaps', 'sign'
# What is left out where there is no room, in this order; small tiles never have the first ones.
# The last ones stay for as long as a shorter name makes room.
_LEFT_OUT = (TYPE, AGE, TEAR_OFF, VIEWS, LINK, PILL, BATTERY, GAPS, SIGN)
_OF_SMALL, _BEFORE_NAME = 6, 7

DRIVING = 'DRIVING'
ON_TASK = 'ON TASK'
SELECTED = 'selected'
NOT_SELECTED = 'not selected'
STOPPING = 'STOPPING'
NOT_CONFIRMED = 'NOT CONFIRMED'
STOPPED = 'STOPPED'

# How each drive state looks: colour, whether the pill is filled, width of the tile's edge [px]; the
# last is that of a robot which nobody drives.
LOOKS = {
    DRIVING: (theme.DRIVE, True, 4),
    ON_TASK: (theme.TASK, True, 3),
    SELECTED: (theme.DRIVE, False, 2),
    STOPPING: (theme.STOP, False, 4),
    NOT_CONFIRMED: (theme.STOP, True, 4),
    STOPPED: (theme.STOP, True, 4),
    NOT_SELECTED: (theme.MUTED, False, 1),
}
# What a stop is called that is proved so far.
_STOPS = {views.PROOF_STOPPED: STOPPED, views.PROOF_NOT_CONFIRMED: NOT_CONFIRMED}


def drive_state(view, stopped):
    """Return in a word whether a robot is driven: a key of :data:`LOOKS`.

    :param view: :class:`mhri.base.views.RobotView`
    :param stopped: whether stop-all is in force
    """
    if stopped:
        return _STOPS.get(view.proof.state, STOPPING) if view.proof else STOPPING
    if view.on_task:
        return ON_TASK
    return DRIVING if view.driven else SELECTED if view.selected else NOT_SELECTED


def carry_on_text(label):
    """Return what a button says that continues a task, e.g. "Continue square"; '' for none."""
    return 'Continue ' + label.lower() if label else ''


def trouble_of(view, charge):
    """Return the colour that a robot's trouble gives its tile's edge, None where there is none.

    Lost or a flat battery, else silent, a low battery or a bad link; its words are elsewhere.

    :param view: :class:`mhri.base.views.RobotView`
    :param charge: level of the battery, of :mod:`mhri.base.battery`
    """
    if view.link == views.GONE or charge == FLAT:
        return theme.STOP
    return theme.ATTENTION if view.link == views.SILENT or charge == LOW or view.slow else None


class TileHeader(QWidget):
    """Lies on the picture, light on dark in every theme; small tiles leave out what can be left.

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
        # For how long the session and this robot by itself have been recorded [s].
        self._session_s = self._own_s = None
        self._with_both = True
        self._build(name, type_label)

    def _build(self, name, type_label):
        """Make and place the parts."""
        self.setObjectName('tile_header')
        self.setPalette(theme.over_picture(self.palette()))
        self.number_label, self.name_label = TextLine(self), TextLine(self)
        self.type_label, self.link_label = TextLine(self), TextLine(self)
        self.rec_label, self.battery_label = TextLine(self), BatteryLine(self)
        self.pill, self.link_sign = Pill(self), Sign(self)
        self.name_label.show_text(name, shorter=(*words.name_ends(name), ''))
        self.type_label.show_text(type_label, theme.MUTED)
        self.views_button = QPushButton(VIEWS, self)
        self.views_button.setCheckable(True)
        self.views_button.setAccessibleName(VIEWS)
        self.views_button.setToolTip('what this tile shows, its recording and its streams')
        self.tear_button = QPushButton(TEAR_OFF, self)
        self.carry_on_button = QPushButton(self)
        self.carry_on_button.hide()
        self.tear_button.setToolTip('into a window of its own, for another monitor')
        for part, key in ((self.number_label, 'number_label'), (self.name_label, 'name_label'),
                          (self.type_label, 'type_label'), (self.pill, 'pill'),
                          (self.link_sign, 'link_sign'), (self.link_label, 'link_label'),
                          (self.battery_label, 'battery_label'), (self.rec_label, 'rec_label'),
                          (self.views_button, 'views_button'), (self.tear_button, 'tear_button'),
                          (self.carry_on_button, 'carry_on_button')):
            part.setObjectName(key)
        for button in (self.views_button, self.tear_button, self.carry_on_button):
            button.setFocusPolicy(Qt.TabFocus)
            button.setAutoDefault(False)
        row = self._row = QHBoxLayout(self)
        for part in (self.number_label, self.name_label, self.pill, None, self.link_sign,
                     self.link_label, self.battery_label, self.rec_label, self.type_label, None,
                     self.carry_on_button, self.views_button, self.tear_button):
            if part is None:
                row.addStretch()
            else:
                row.addWidget(part)
        self.rec_label.hide()
        self.number_label.hide()
        self.show_large(True)

    def show_large(self, large):
        """Be the header of a large tile, or of a small one."""
        self.large = large
        base = theme.base_font(self.window().font() if self.window() else self.font())
        unit = self.fontMetrics().height()
        self._row.setContentsMargins(unit // 2, 2, 2 if large else unit // 3, 2)
        bold = theme.larger(base, 1.4 if large else 1.05, bold=True)
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
        """Say in the pill how the robot is driven; small tiles leave out that it is not."""
        if word:
            self.pill.say(word, *LOOKS[word][:2])
        self.fit()

    def fit(self):
        """Leave out what there is no room for, always in the same order; the name goes last."""
        name = self.name_label
        natural = theme.text_width(name.font(), name.text())
        name.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        name.setMaximumWidth(natural)
        name.setMinimumWidth(1)
        self.pill.setVisible(bool(self.pill.word) and (
            self.large or self.pill.word != NOT_SELECTED))
        self.number_label.fix_width(self.number_label.text() or '0')
        first, end = (0, len(_LEFT_OUT) + 1) if self.large else (_OF_SMALL, len(_LEFT_OUT))
        shortest = theme.text_width(name.font(), (name.text(), *words.name_ends(name.text()))[-1])
        for count in range(first, end):
            self._leave_out(_LEFT_OUT[:count])
            if self._needed(natural if count < _BEFORE_NAME else shortest) <= self.width():
                break
        if self._needed(1) - self.width() > self.pill.spare_px():
            # A word that is cut off says something else; edge and sentence tell the same.
            self.pill.hide()
        # Showing a part that was left out after all has squeezed the others.
        self._row.activate()

    def _leave_out(self, parts):
        """Show everything but some parts of :data:`_LEFT_OUT`."""
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
        self.views_button.setVisible(self.large)
        self.carry_on_button.setVisible(self.large and bool(self.carry_on_button.text()))

    def _needed(self, name_width):
        """Return the width that everything on show needs [px]."""
        parts = [item.widget() for item in map(self._row.itemAt, range(self._row.count()))
                 if item.widget() and not item.widget().isHidden()]
        margins = self._row.contentsMargins()
        # Each of the two stretches has the gap of a part.
        return (margins.left() + margins.right() + self._row.spacing() * len(parts) + sum(
            name_width if part is self.name_label else max(
                part.minimumWidth(), min(part.sizeHint().width(), part.maximumWidth()))
            for part in parts))

    def resizeEvent(self, event):  # noqa: N802
        """Fit the width there is."""
        super().resizeEvent(event)
        self.fit()

    def _show_link(self):
        """Say how the link is, with its age where there is room."""
        if self._view is not None:
            tone = theme.TEXT if self._view.link == views.LIVE else theme.MUTED
            self.link_label.show_text(words.link_text(self._view) if self._with_age
                                      else words.LINK_WORDS[self._view.link], tone)

    def show_view(self, view, numbers=True):
        """Show a :class:`RobotView`; the numbers of it only if ``numbers``."""
        self.link_sign.show_sign(theme.LINK_SIGNS[view.link])
        self.link_sign.setToolTip(words.LINK_WORDS[view.link])
        self._offer_to_carry_on(view.carry_on)
        number = str(view.number) if view.number else ''
        if number != self.number_label.text():
            self.number_label.show_text(number, theme.MUTED)
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
        """Offer to continue a task that the robot was taken from, '' for none."""
        text = carry_on_text(label)
        if text != self.carry_on_button.text():
            self.carry_on_button.setText(text)
            self.fit()

    def show_replay(self):
        """Say from now on that this is not now, where a recording is told otherwise."""
        if not self._replay:
            self._replay = True
            self.rec_label.show_text(REPLAY, theme.ATTENTION)
            self.rec_label.show()
            self.fit()

    def show_recording(self, status):
        """Show how long a recording of this robot has been running, None where none is."""
        self._show_recorded(self._session_s, status.duration_s if status else None)

    def show_session(self, lasts_s):
        """Show how long the session has been recorded, None where it is not."""
        self._show_recorded(lasts_s, self._own_s)

    def _show_recorded(self, session_s, own_s):
        if self._replay:
            return
        before = self._rec_text('0')
        self._session_s, self._own_s = session_s, own_s
        if self._rec_text('0') != before:
            self.rec_label.setVisible(bool(self._rec_text()))
            self.fit()
        self._show_rec()

    def _rec_text(self, digit=''):
        """Return what is said of recordings, '' while there is none.

        Small tiles have no time, others that of the session and of a recording of the robot alone.

        :param digit: stands for each digit, to see how wide the text is
        """
        times = [clock_text(lasts_s) for lasts_s in (self._session_s, self._own_s)
                 if lasts_s is not None]
        text = ' '.join([REC, ' + '.join(times[:2 if self._with_both else 1])]) if times else ''
        text = text if self.large or not times else REC
        return ''.join(digit if sign.isdigit() else sign for sign in text) if digit else text

    def _show_rec(self):
        if not self._replay:
            self.rec_label.show_text(self._rec_text())

    def paintEvent(self, event):  # noqa: N802
        """Paint the ground."""
        QPainter(self).fillRect(self.rect(), theme.OVER_PICTURE)

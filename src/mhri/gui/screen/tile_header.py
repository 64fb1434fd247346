# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line across the top of a tile: which robot, whether it is driven, how its link is."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QHBoxLayout, QPushButton, QWidget

from mhri.core.screen import views
from mhri.gui.recording.recording_row import clock_text
from mhri.gui.screen import theme, words
from mhri.gui.screen.labels import BatteryLine, Pill, Sign, TextLine

VIEWS = 'Views'
TEAR_OFF, PUT_BACK = 'Tear off', 'Put back'

DRIVING = 'DRIVING'
SELECTED = 'selected'
NOT_SELECTED = 'not selected'
STOPPING = 'STOPPING'
NOT_CONFIRMED = 'NOT CONFIRMED'
STOPPED = 'STOPPED'

# How each drive state looks: colour, whether the pill is filled, width of the tile's edge [px]; the
# last is that of a robot which nobody drives.
LOOKS = {
    DRIVING: (theme.DRIVE, True, 4),
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

    :param view: :class:`mhri.core.screen.views.RobotView`
    :param stopped: whether stop-all is in force
    """
    if stopped:
        return _STOPS.get(view.proof.state, STOPPING) if view.proof else STOPPING
    return DRIVING if view.driven else SELECTED if view.selected else NOT_SELECTED


class TileHeader(QWidget):
    """Lies on the picture, light on dark in every theme; small tiles leave out what can be left.

    Child widgets: ``number_label``, ``name_label``, ``type_label``, ``pill``, ``link_sign``,
    ``link_label``, ``battery_label``, ``rec_label``, ``views_button``, ``tear_button``.
    """

    def __init__(self, name, type_label, parent=None):
        super().__init__(parent)
        self.large = True
        self._build(name, type_label)

    def _build(self, name, type_label):
        """Make and place the parts."""
        self.setObjectName('tile_header')
        self.setPalette(theme.over_picture(self.palette()))
        self.number_label, self.name_label = TextLine(self), TextLine(self)
        self.type_label, self.link_label = TextLine(self), TextLine(self)
        self.rec_label, self.battery_label = TextLine(self), BatteryLine(self)
        self.pill, self.link_sign = Pill(self), Sign(self)
        self.name_label.show_text(name)
        self.type_label.show_text(type_label, theme.MUTED)
        self.views_button = QPushButton(VIEWS, self)
        self.views_button.setCheckable(True)
        self.views_button.setToolTip('what this tile shows, its recording and its streams')
        self.tear_button = QPushButton(TEAR_OFF, self)
        self.tear_button.setToolTip('into a window of its own, for another monitor')
        for part, key in ((self.number_label, 'number_label'), (self.name_label, 'name_label'),
                          (self.type_label, 'type_label'), (self.pill, 'pill'),
                          (self.link_sign, 'link_sign'), (self.link_label, 'link_label'),
                          (self.battery_label, 'battery_label'), (self.rec_label, 'rec_label'),
                          (self.views_button, 'views_button'), (self.tear_button, 'tear_button')):
            part.setObjectName(key)
        for button in (self.views_button, self.tear_button):
            button.setFocusPolicy(Qt.TabFocus)
            button.setAutoDefault(False)
        row = self._row = QHBoxLayout(self)
        for part in (self.number_label, self.name_label, self.pill, self.link_sign,
                     self.link_label, self.battery_label, self.rec_label):
            row.addWidget(part)
        row.addWidget(self.type_label, 1)
        row.addWidget(self.views_button)
        row.addWidget(self.tear_button)
        self.rec_label.hide()
        self.number_label.hide()
        self.show_large(True)

    def show_large(self, large):
        """Be the header of a large tile, or of a small one."""
        self.large = large
        base = self.window().font() if self.window() else self.font()
        unit = self.fontMetrics().height()
        self._row.setContentsMargins(unit // 2, 2, 2 if large else unit // 3, 2)
        self._row.setSpacing(unit // 2 if large else unit // 4)
        bold = theme.larger(theme.base_font(base), 1.4 if large else 1.05, bold=True)
        self.name_label.setFont(bold)
        self.number_label.setFont(bold)
        numbers = theme.number_font(theme.base_font(base))
        for label, sample in ((self.link_label, 'waiting 000 ms' if large else 'waiting'),
                              (self.battery_label, '100 %'), (self.rec_label, 'REC 00:00')):
            label.setFont(numbers)
            label.fix_width(sample)
        self.link_sign.setFont(numbers)
        self.pill.setFont(theme.base_font(base))
        self._fit_name()
        for part in (self.views_button, self.tear_button, self.type_label):
            part.setVisible(large)
        for button in (self.views_button, self.tear_button):
            button.setMinimumHeight(theme.touch_size(self))
        self.link_label.setVisible(large)
        self.show_drive(self.pill.word)
        self._row.setStretch(1, 0 if large else 1)

    def show_drive(self, word):
        """Say in the pill how the robot is driven; small tiles leave out that it is not."""
        if word:
            self.pill.say(word, *LOOKS[word][:2])
        self.pill.set_words(tuple(LOOKS) if self.large else (word,))
        self.pill.setVisible(bool(word) and (self.large or word != NOT_SELECTED))

    def _fit_name(self):
        """Give number and name the room that they need."""
        self.name_label.fix_width(self.name_label.text())
        if not self.large:
            self.name_label.setMinimumWidth(4 * self.fontMetrics().averageCharWidth())
            self.name_label.setMaximumWidth(16777215)
            policy = self.name_label.sizePolicy()
            policy.setHorizontalPolicy(policy.Preferred)
            self.name_label.setSizePolicy(policy)
        self.number_label.fix_width(self.number_label.text() or '0')

    def show_view(self, view, numbers=True):
        """Show a :class:`RobotView`; the numbers of it only if ``numbers``."""
        self.link_sign.show_sign(theme.LINK_SIGNS[view.link])
        self.link_sign.setToolTip(words.LINK_WORDS[view.link])
        number = str(view.number) if view.number else ''
        if number != self.number_label.text():
            self.number_label.show_text(number, theme.MUTED)
            self.number_label.setVisible(bool(number))
            self._fit_name()
        self.type_label.show_text(words.type_text(view), theme.MUTED)
        if not numbers:
            return
        tone = theme.TEXT if view.link == views.LIVE else theme.MUTED
        self.link_label.show_text(words.link_text(view), tone)
        self.battery_label.show_charge(view.battery, view.link != views.LIVE)

    def show_recording(self, status):
        """Show how long a recording has been running, None where none is."""
        self.rec_label.setVisible(status is not None)
        if status is not None:
            self.rec_label.show_text('REC ' + clock_text(status.duration_s))

    def paintEvent(self, event):  # noqa: N802
        """Paint the ground."""
        QPainter(self).fillRect(self.rect(), theme.OVER_PICTURE)

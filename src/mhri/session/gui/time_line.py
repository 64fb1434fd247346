# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The replay bar below the screen: play, pause, speed, jumps, and the time line."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.layouts import in_column, in_row
from mhri.recording.recording import duration_text, is_simulated, moment_text
from mhri.session.gui.time_line_canvas import TimeLineCanvas
from mhri.session.playing import other_speed, SPEEDS
from mhri.session.timeline import TimeLine

PLAY, PAUSE = 'Play', 'Pause'
NOTHING_DRIVES = 'REPLAY: nothing moves'


def speed_text(speed):
    """Return a speed as its button shows it, e.g. ``0.25×``."""
    return '{:g}\u00d7'.format(speed)


class TimeLineBar(QWidget):
    """Shows the position of a replay, and emits requests to move it."""

    play_requested = Signal(bool)
    #: seconds from the start
    seek_requested = Signal(float)
    #: factor of the recorded speed
    speed_requested = Signal(float)

    def __init__(self):
        super().__init__()
        self._line = TimeLine(0.0, 0.0)
        #: {robot: number} of the displayed session
        self.numbers = None
        #: where the replay is [s from the start]
        self.position_s = 0.0
        self._playing = False
        self._speed = 1.0
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('time_line_bar')
        self.setFont(theme.base_font(self.font()))
        # The tool tips name the keys.
        self.previous_button = theme.finger_button(self, 'previous_button', 'Previous', 'Page Up')
        self.play_button = theme.finger_button(self, 'play_button', PLAY, 'Space', also=PAUSE)
        self.next_button = theme.finger_button(self, 'next_button', 'Next', 'Page Down')
        self.slower_button = theme.finger_button(self, 'slower_button', '\u2212', '-')
        self.faster_button = theme.finger_button(self, 'faster_button', '+', '+')
        for button, name in ((self.previous_button, 'to the mark or event before'),
                             (self.next_button, 'to the next mark or event'),
                             (self.slower_button, 'slower'), (self.faster_button, 'faster')):
            button.setAccessibleName(name)
            button.setFixedWidth(button.minimumWidth())
        numbers = theme.number_font(self.font())
        self.speed_label, self.clock_label = TextLine(self), TextLine(self)
        self.tick_label, self.replay_label = TextLine(self), TextLine(self)
        for label, name, sample in (
                (self.speed_label, 'speed_label', speed_text(0.25)),
                (self.clock_label, 'replay_clock_label', '00:00:00  0:00:00 of 0:00:00')):
            label.setFont(numbers)
            label.setObjectName(name)
            label.fix_width(sample)
        self.speed_label.setAlignment(Qt.AlignCenter)
        self.tick_label.setObjectName('tick_label')
        self.replay_label.setObjectName('replay_label')
        self.replay_label.setFont(theme.larger(self.font(), theme.HEAD, bold=True))
        self.replay_label.fix_width('REPLAY')
        self._sign = Sign(self)
        self._sign.show_sign(theme.WARNING)
        self.canvas = TimeLineCanvas(self)
        controls = in_row(
            self._sign, self.replay_label, self.previous_button, self.play_button,
            self.next_button, self.slower_button, self.speed_label, self.faster_button,
            self.clock_label, (self.tick_label, 1))
        in_column(controls, self.canvas, of=self, margins=(8, 4, 8, 4), gap=4)

    def _connect(self):
        """Connect the buttons."""
        self.play_button.clicked.connect(self.toggle)
        self.previous_button.clicked.connect(self.go_back)
        self.next_button.clicked.connect(self.go_on)
        self.slower_button.clicked.connect(lambda: self.change_speed(-1))
        self.faster_button.clicked.connect(lambda: self.change_speed(1))
        self.canvas.seek_requested.connect(self.seek_requested)

    def _restore(self):
        """Start with no session."""
        self.replay_label.show_text(NOTHING_DRIVES, theme.ATTENTION, shorter=('REPLAY',))
        self.show_state(0.0, 1.0, False)

    def show_time_line(self, line, numbers):
        """Show a session: :class:`mhri.session.timeline.TimeLine`, {robot: number}."""
        self._line, self.numbers = line, dict(numbers)
        self.canvas.show_time_line(line, numbers)
        self.show_state(self.position_s, self._speed, self._playing)

    def show_state(self, position_s, speed, playing):
        """Show the position and the speed of the replay."""
        self.position_s, self._speed, self._playing = position_s, speed, playing
        self.canvas.show_position(position_s)
        text = PAUSE if playing else PLAY
        if text != self.play_button.text():
            self.play_button.setText(text)
        self.speed_label.show_text(speed_text(speed))
        self.slower_button.setEnabled(speed > SPEEDS[0])
        self.faster_button.setEnabled(speed < SPEEDS[-1])
        self.previous_button.setEnabled(self._line.previous_tick(position_s) is not None)
        self.next_button.setEnabled(self._line.next_tick(position_s) is not None)
        start = self._line.start
        wall = '' if is_simulated(start) else moment_text(start + position_s) + '  '
        self.clock_label.show_text('{}{} of {}'.format(
            wall, duration_text(position_s), duration_text(self._line.length_s)))
        tick = self._line.previous_tick(position_s + 1.0)
        self.tick_label.show_text(' '.join(filter(None, (
            duration_text(tick.at_s), tick.robot, tick.text))) if tick else '', theme.MUTED)

    def toggle(self):
        """Play, or pause."""
        self.play_requested.emit(not self._playing)

    def go_on(self):
        """Go to the next mark, stop or event."""
        tick = self._line.next_tick(self.position_s)
        if tick is not None:
            self.seek_requested.emit(tick.at_s)

    def go_back(self):
        """Go to the mark, stop or event before."""
        tick = self._line.previous_tick(self.position_s)
        if tick is not None:
            self.seek_requested.emit(tick.at_s)

    def skip(self, seconds):
        """Seek by a number of seconds; negative goes back."""
        self.seek_requested.emit(min(max(0.0, self.position_s + seconds), self._line.length_s))

    def change_speed(self, steps):
        """Change the speed by steps; positive is faster."""
        self.speed_requested.emit(other_speed(self._speed, steps))

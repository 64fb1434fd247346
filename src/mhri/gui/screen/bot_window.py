# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot's window: who it is, whether it is being driven, how it moves, what it sees."""
from python_qt_binding.QtCore import QEvent, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPen
from python_qt_binding.QtWidgets import QDialog, QSizePolicy

from mhri.core.screen import views
from mhri.gui.screen import theme, words
from mhri.gui.camera.camera_view import CameraView
from mhri.gui.driving.drive_keys import mark_drive_area
from mhri.gui.screen.forms import load_form
from mhri.gui.sensors.imu_graph import ImuGraph
from mhri.gui.screen.labels import BatteryLine, Pill, Sign, TextLine
from mhri.gui.screen.pending import Pace
from mhri.gui.recording.recording_row import RecordingRow
from mhri.gui.sensors.scan_view import ScanView
from mhri.gui.screen.state_line import StateLine
from mhri.gui.driving.stop_button import StopButton
from mhri.gui.screen.view_switches import DEPTH, IMU, RECORD, RGB, SCAN, ViewSwitches

NUMBERS_PERIOD_S = 0.25
# With a picture and a graph a window is larger at first than with the motion dial alone.
_PLAIN_SIZE = (760, 520)
_VIEWS_SIZE = (930, 540)
# Narrower than so many heights of a line, the header leaves the place out.
_POSE_FROM_UNITS = 50
# What a camera's picture is usually like; what a scan and a graph get of a window's width.
_PICTURE_SHAPE = 4.0 / 3.0
_SCAN_SHARE = 0.27
_LEAST_GRAPH_SHARE = 0.33
# In heights of a line: what the camera's line of figures needs.
_LEAST_CAMERA_UNITS = 17

DRIVING = 'DRIVING'
SELECTED = 'selected'
NOT_SELECTED = 'not selected'
STOPPING = 'STOPPING'
NOT_CONFIRMED = 'NOT CONFIRMED'
STOPPED = 'STOPPED'

# How each drive state looks: colour, whether the pill is filled, width of the window's edge [px].
_LOOKS = {
    DRIVING: (theme.DRIVE, True, 8),
    SELECTED: (theme.DRIVE, False, 3),
    NOT_SELECTED: (theme.MUTED, False, 1),
    STOPPING: (theme.STOP, False, 8),
    NOT_CONFIRMED: (theme.STOP, True, 8),
    STOPPED: (theme.STOP, True, 8),
}
# What a stop is called that is proved so far.
_STOPS = {views.PROOF_STOPPED: STOPPED, views.PROOF_NOT_CONFIRMED: NOT_CONFIRMED}
_EDGE_PX = 8


class BotWindow(QDialog):
    """What every type of robot has; a type with more brings a subclass (see ``windows``).

    It shows what it is given and asks for nothing: a host looks at :meth:`wanted`, feeds ``graph``
    (:class:`ImuGraph`), ``camera`` (:class:`CameraView`) and ``scan`` (:class:`ScanView`) with just
    that, and serves ``recording`` (:class:`RecordingRow`).

    Opening it never takes the keyboard away from what has it: the host raises it where the operator
    asked for it. Escape does not close it, since closing stops a robot.

    :param ui_dir: folder of ``bot_window.ui``
    :param name: the robot's name
    :param type_label: the robot's type in words
    """

    #: the window was closed: name of its robot
    closed = Signal(str)
    stop_requested = Signal()
    #: another set of views is :meth:`wanted`
    views_changed = Signal()

    def __init__(self, ui_dir, name, type_label, parent=None):
        super().__init__(parent)
        self.name = name
        self._drive = None
        self._link = None
        self._wanted = set()
        self._offered = frozenset()
        self._splitter_set = False
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._build(ui_dir, type_label)
        self._connect()
        self._restore()

    def _build(self, ui_dir, type_label):
        """Load the form and set what a form cannot say."""
        self.setFont(theme.base_font(self.font()))
        load_form(ui_dir, 'bot_window.ui', self, (
            BatteryLine, CameraView, ImuGraph, Pill, RecordingRow, ScanView, Sign, StateLine,
            StopButton, TextLine, ViewSwitches))
        self.setObjectName('window_' + self.name)
        self.setWindowFlags(Qt.Window)
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        self.setFocusPolicy(Qt.ClickFocus)
        mark_drive_area(self)
        unit = self.fontMetrics().height()
        self.layout().setContentsMargins(*[_EDGE_PX + unit // 2] * 4)
        self._build_header(type_label)
        self._build_figures()
        self.stop_button.setFont(theme.larger(self.font(), 1.5, bold=True))
        self.stop_button.set_look('Shift+Space', 2.2)
        self.pose_label.hide()
        self._arrange()

    def _build_header(self, type_label):
        """Set up the line that identifies the robot."""
        numbers = theme.number_font(theme.larger(self.font(), 1.1))
        self.name_label.setFont(theme.larger(self.font(), 1.7, bold=True))
        self.name_label.show_text(self.name)
        self.type_label.show_text(type_label, theme.MUTED)
        self.pill.set_words(tuple(_LOOKS))
        self.pill.setFont(theme.larger(self.font(), 1.1))
        self.link_sign.setFont(numbers)
        for label, sample in ((self.link_label, 'waiting 000 ms'),
                              (self.speed_label, 'back 0.00 m/s'),
                              (self.heading_label, 'heading -000 deg'),
                              (self.battery_label, '100 %')):
            label.setFont(numbers)
            label.fix_width(sample)
        # It may be squeezed, so that the window can become narrow enough to do without it.
        self.pose_label.setFont(numbers)
        self.pose_label.setMaximumWidth(theme.text_width(numbers, 'x -00.00 m  y -00.00 m'))
        self.pose_label.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)

    def _build_figures(self):
        """Set up the captions and values of the odometry."""
        numbers = theme.number_font(theme.larger(self.font(), 1.15))
        for caption in (self.turn_caption, self.place_caption, self.limits_caption):
            caption.set_tone(theme.MUTED)
            caption.fix_width(caption.text())
        for value in (self.turn_value, self.x_value, self.y_value, self.max_linear_value,
                      self.max_angular_value):
            value.setFont(numbers)
            value.fix_width('right 0.00 rad/s')

    def _connect(self):
        """Wire the stop button, which acts when pressed, and the switches."""
        self.stop_button.pressed.connect(self.stop_requested)
        self.switches.changed.connect(self._arrange)
        self.views_splitter.splitterMoved.connect(self._on_splitter_moved)
        self.views_splitter.installEventFilter(self)

    def _restore(self):
        """Begin with nothing heard."""
        self.show_view(views.RobotView(self.name, self.type_label.text()))

    def offer(self, keys):
        """Offer what this robot can have: of 'imu', 'rgb', 'depth', 'scan', 'record'.

        What the operator chose before comes back as soon as it is on offer again.
        """
        keys = frozenset(keys)
        if keys == self._offered:
            return
        first = not self._offered
        self._offered = keys
        self.switches.offer(keys)
        self._arrange()
        if first and not self.isVisible():
            self.resize(self.sizeHint())

    def is_watched(self):
        """Tell whether anybody can see the window: it is neither hidden nor minimised."""
        return self.isVisible() and not self.isMinimized()

    def wanted(self):
        """Return the set of views to be fed now: empty while nobody can see the window."""
        return self.switches.wanted() if self.is_watched() else set()

    def camera_size(self):
        """Return (width, height) that the picture has room for, in pixels of the screen."""
        return self.camera.camera_size()

    def _arrange(self):
        """Lay out the views that are chosen; without any there is the picture of the motion."""
        views_on = self.switches.wanted()
        cameras = views_on & {RGB, DEPTH}
        kind = next(iter(cameras), None)
        if kind != self.camera.kind:
            self.camera.show_kind(kind)
        self.camera.setVisible(bool(cameras))
        self.scan.setVisible(SCAN in views_on)
        self.graph.setVisible(IMU in views_on)
        self.views_splitter.setVisible(bool(views_on))
        self.motion_page.setVisible(not views_on)
        self.switches.setVisible(bool(self._offered - {RECORD}))
        self.recording.setVisible(RECORD in self._offered)
        self._share_out()
        self._tell_wanted()

    def _on_splitter_moved(self, *_):
        """Leave the widths to the operator from now on."""
        self._splitter_set = True

    def _share_out(self):
        """Give the picture the width that its height needs, a scan the same, the graph the rest."""
        if self._splitter_set:
            return
        width, height = self.views_splitter.width(), self.views_splitter.height()
        height -= self.camera.sizeHint().height() - self.camera.picture.sizeHint().height()
        beside = self.camera.picture.width() - self.camera.picture.room().width()
        scan = min(_SCAN_SHARE * width, height) if self.scan.isVisibleTo(self) else 0.0
        graph = _LEAST_GRAPH_SHARE * width if self.graph.isVisibleTo(self) else 0.0
        least = _LEAST_CAMERA_UNITS * self.fontMetrics().height()
        camera = min(width - scan - graph, max(least, _PICTURE_SHAPE * height + beside)) \
            if self.camera.kind else 0.0
        if not graph:
            scan = width - camera
        self.views_splitter.setSizes([
            round(size) for size in (camera, scan, max(0.0, width - camera - scan))])

    def _tell_wanted(self):
        """Tell of another set of wanted views, and of nothing else."""
        wanted = self.wanted()
        if wanted != self._wanted:
            self._wanted = wanted
            self.views_changed.emit()

    def sizeHint(self):  # noqa: N802
        """Return a size at which everything on offer can be used."""
        hint = QSize(*(_VIEWS_SIZE if self._offered - {RECORD} else _PLAIN_SIZE))
        return hint.expandedTo(self.minimumSizeHint())

    @property
    def drive_state(self):
        """One of DRIVING, SELECTED, NOT_SELECTED, STOPPING, NOT_CONFIRMED, STOPPED."""
        return self._drive

    def show_view(self, view, stop_all=False):
        """Show a :class:`RobotView`; states at once, numbers four times a second.

        :param stop_all: whether stop-all is in force; a proof in the view says so, too
        """
        due = self._numbers.due()
        numbers = due or view.link != self._link
        self._link = view.link
        self._show_drive_state(view, stop_all or view.proof is not None)
        self.link_sign.show_sign(theme.LINK_SIGNS[view.link])
        self.type_label.show_text(words.type_text(view), theme.MUTED)
        self._show_sentence(view)
        self.graph.show_old(view.link != views.LIVE)
        if numbers:
            self._show_numbers(view)

    def _show_drive_state(self, view, stopped):
        """Show in title, edge and pill whether this robot is driven right now."""
        if stopped:
            drive = _STOPS.get(view.proof.state, STOPPING) if view.proof else STOPPING
        else:
            drive = DRIVING if view.driven else SELECTED if view.selected else NOT_SELECTED
        if drive == self._drive:
            return
        self._drive = drive
        self.setWindowTitle('{} - {}'.format(self.name, drive))
        ink, filled, _ = _LOOKS[drive]
        self.pill.say(drive, ink, filled)
        self.stop_button.setText(
            'STOP ALL in force - see the panel' if stopped else 'STOP ALL')
        self.stop_button.show_engaged(stopped)
        self.update()

    def _show_sentence(self, view):
        """Show the proof of a stop, or what is worth saying about the link."""
        if view.proof is not None:
            sign, text = theme.PROOF_SIGNS[view.proof.state], view.proof.text
        elif view.note and (view.slow or view.link != views.LIVE):
            sign = (theme.TRIANGLE, theme.ATTENTION) if view.link == views.LIVE \
                else theme.LINK_SIGNS[view.link]
            text = view.note
        else:
            sign, text = None, view.note
        self.sentence_sign.show_sign(sign)
        self.sentence_label.show_text(text, shorter=words.beginnings(text))
        self._make_room()

    def _make_room(self):
        """Leave the place out of a narrow header, and what a sentence needs the room of."""
        wide = self.width() > _POSE_FROM_UNITS * self.fontMetrics().height()
        speaking = bool(self.sentence_label.text())
        self.pose_label.setVisible(wide and not speaking)
        self.heading_label.setVisible(wide or not speaking)

    def _show_numbers(self, view):
        """Show what changes all the time."""
        # What a silent robot said last is still worth knowing, but not as if it were now.
        tone = theme.TEXT if view.link == views.LIVE else theme.MUTED
        self.link_label.show_text(words.link_text(view))
        self.speed_label.show_text(words.linear_text(view.linear_mps), tone)
        self.heading_label.show_text('heading ' + words.heading_text(view.heading_rad), tone)
        self.battery_label.show_charge(view.battery, view.link != views.LIVE)
        self.x_value.show_text('x ' + words.metres_text(view.x_m), tone)
        if self.pose_label.isVisible():
            self.pose_label.show_text('x {}  y {}'.format(
                words.metres_text(view.x_m), words.metres_text(view.y_m)), tone)
        self.y_value.show_text('y ' + words.metres_text(view.y_m), tone)
        self.turn_value.show_text(words.turn_text(view.angular_rad_s), tone)
        self.max_linear_value.show_text(words.linear_text(view.max_linear_mps))
        self.max_angular_value.show_text(words.rate_text(view.max_angular_rad_s))

    def save_settings(self):
        """Return what is kept between runs as a plain dict: choices, splitter."""
        return {'views': self.switches.chosen(), 'graph': self.graph.save_settings(),
                'recording': self.recording.save_settings(),
                'splitter': self.views_splitter.sizes() if self._splitter_set else []}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`; what is missing or unknown stays as it is."""
        if 'views' in settings:
            self.switches.choose(settings['views'])
        self.graph.restore_settings(settings.get('graph', {}))
        self.recording.restore_settings(settings.get('recording', {}))
        sizes = settings.get('splitter', [])
        self._splitter_set = len(sizes) == self.views_splitter.count()
        if self._splitter_set:
            self.views_splitter.setSizes(sizes)

    def showEvent(self, event):  # noqa: N802
        """Ask for the views."""
        super().showEvent(event)
        self._tell_wanted()

    def hideEvent(self, event):  # noqa: N802
        """Ask for nothing any more."""
        super().hideEvent(event)
        self._tell_wanted()

    def changeEvent(self, event):  # noqa: N802
        """Ask for nothing while minimised."""
        super().changeEvent(event)
        if event.type() == QEvent.WindowStateChange:
            self._tell_wanted()

    def resizeEvent(self, event):  # noqa: N802
        """Leave the place out of a narrow header."""
        super().resizeEvent(event)
        self._make_room()

    def eventFilter(self, watched, event):  # noqa: N802
        """Share out another width of the views."""
        if watched is self.views_splitter and event.type() == QEvent.Resize:
            self._share_out()
        return super().eventFilter(watched, event)

    def keyPressEvent(self, event):  # noqa: N802
        """Leave Escape without effect: a slip must not close a window that drives."""
        if event.key() == Qt.Key_Escape:
            event.accept()
        else:
            super().keyPressEvent(event)

    def closeEvent(self, event):  # noqa: N802
        """Tell that the window closes."""
        event.accept()
        self.closed.emit(self.name)

    def paintEvent(self, event):  # noqa: N802
        """Paint the edge that says whether this robot is driven."""
        ink, _, width = _LOOKS[self._drive]
        painter = QPainter(self)
        pen = QPen(theme.colour(ink, self.palette()), width)
        pen.setJoinStyle(Qt.MiterJoin)
        painter.setPen(pen)
        inset = (width + 1) // 2
        painter.drawRect(self.rect().adjusted(inset, inset, -inset, -inset))

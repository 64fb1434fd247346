# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot's tile: who it is, whether it is being driven, what it sees, how it moves."""
from python_qt_binding.QtCore import QEvent, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QLayout, QWidget

from mhri.base import views
from mhri.base.gui import theme, words
from mhri.base.gui.first_press import first_press
from mhri.base.gui.forms import load_form
from mhri.base.gui.labels import TextLine
from mhri.base.gui.pending import Pace
from mhri.base.view_rows import KEYS, load, PICTURES, RECORD, RGB, SCAN, VIEW_ROWS
from mhri.driving.gui.drive_keys import mark_drive_area
from mhri.driving.gui.stop_bar import CUT_OFF, CUT_OFF_NOTE, CUT_OFF_SHORTEST
from mhri.driving.gui.stop_button import StopButton
from mhri.recording.gui.recording_row import RecordingRow
from mhri.screen.arrangement import USUAL_SHAPE
from mhri.screen.gui.hud import Hud
from mhri.screen.gui.state_line import StateLine
from mhri.screen.gui.tile_header import (
    drive_state, LOOKS, PUT_BACK, TEAR_OFF, TileHeader, trouble_of)
from mhri.screen.gui.tile_layers import EDGE_PX, TileLayers, wants_inset
from mhri.screen.gui.tile_words import sentence_of
from mhri.screen.gui.view_switches import ViewSwitches

NUMBERS_PERIOD_S = 0.25
_TORN_OFF_SIZE = (800, 640)

# A small tile that has less room below its header [heights of a line] shows the header alone.
_LEAST_PICTURE_UNITS = 2.5


class BotWindow(QWidget):
    """What every type of robot has; a type with more brings a subclass (see ``windows``).

    It shows what it is given and asks for nothing: a host looks at :meth:`wanted`, feeds
    :meth:`view` of each of these with just that, and serves ``recording`` (:class:`RecordingRow`).
    A class from elsewhere puts its own lines into ``motion_place.layout()``: they are always seen.

    :param ui_dir: folder of ``bot_window.ui``
    :param name: the robot's name
    :param type_label: the robot's type in words
    """

    stop_requested = Signal()
    #: another set of views is :meth:`wanted`
    views_changed = Signal()
    #: a click: name of the robot that is meant
    clicked = Signal(str)
    #: a double click: this robot, which had the first press, and no other
    drive_requested = Signal(str)
    #: it shall go into a window of its own, or back
    tear_requested = Signal(str)
    #: it shall go on with the task that it was taken from
    carry_on_requested = Signal(str)

    def __init__(self, ui_dir, name, type_label, parent=None):
        super().__init__(parent)
        self.name = name
        self.torn_off = False
        #: whether its picture is driven by, even if the map has its place
        self.full_rate = True
        self._drive = None
        self._trouble = None
        self._changed_with = None
        self._looked_at = self._stopped = self._cut_off = False
        self._wanted = self._arranged = set()
        self._offered = frozenset()
        self._views = {}
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._build(ui_dir, type_label)
        self._connect()
        self._restore()

    def _build(self, ui_dir, type_label):
        """Load the form and set what a form cannot say."""
        self.setFont(theme.base_font(self.font()))
        load_form(ui_dir, 'bot_window.ui', self, (
            RecordingRow, StateLine, StopButton, TextLine, ViewSwitches))
        self.setObjectName('window_' + self.name)
        self.setAutoFillBackground(True)
        self.setFocusPolicy(Qt.ClickFocus)
        mark_drive_area(self)
        self.layout().setContentsMargins(*[EDGE_PX] * 4)
        # The stage says how large it is, whatever its parts would like.
        self.layout().setSizeConstraint(QLayout.SetNoConstraint)
        self.header = TileHeader(self.name, type_label, self)
        self.hud = Hud(self)
        self._layers = TileLayers(self)
        for key in ('name_label', 'type_label', 'pill', 'link_sign', 'link_label',
                    'battery_label', 'views_button', 'tear_button'):
            setattr(self, key, getattr(self.header, key))
        self._build_figures()
        self.stop_button.setFont(theme.larger(self.font(), 1.3, bold=True))
        self.stop_button.set_look('Shift+Space', 2.2)
        self.stop_button.setObjectName('tile_stop_button')
        self.stop_button.hide()
        self.tools.hide()
        self.motion_place.hide()
        self._arrange()

    def _build_figures(self):
        """Set up the captions and values of the odometry."""
        numbers = theme.number_font(theme.larger(self.font(), 1.15))
        for caption in (self.turn_caption, self.place_caption, self.limits_caption):
            caption.set_tone(theme.MUTED)
            caption.fix_width(caption.text())
        values = (self.turn_value, self.x_value, self.y_value, self.max_linear_value,
                  self.max_angular_value)
        for value in values:
            value.setFont(numbers)
            value.fix_width('right 0.00 rad/s')
        self._figures = (self.turn_caption, self.place_caption, self.limits_caption, *values)
        self.figures_column.setStretch(self.figures_column.count() - 1, 1)

    def _connect(self):
        """Wire the stop button, which acts when pressed, and the switches."""
        self.stop_button.pressed.connect(self.stop_requested)
        self.switches.changed.connect(self._arrange)
        self.views_button.toggled.connect(self._show_tools)
        self.tear_button.clicked.connect(lambda: self.tear_requested.emit(self.name))
        self.header.carry_on_button.clicked.connect(
            lambda: self.carry_on_requested.emit(self.name))

    def _restore(self):
        """Begin with nothing heard."""
        self.show_view(views.RobotView(self.name, self.type_label.text()))

    def view(self, key):
        """Return the widget of a view of the registry; it is made when it is first asked for."""
        row = next(row for row in VIEW_ROWS if row.key == key)
        if row.widget not in self._views:
            widget = self._views[row.widget] = load(row.widget)(self)
            self._place_in_row(row)
            widget.hide()
            if hasattr(widget, 'show_tools'):
                widget.show_tools(self.tools.isVisibleTo(self))
        return self._views[row.widget]

    def _place_in_row(self, row):
        """Put the widget of a view beside the others, in the order of the registry."""
        order = list(dict.fromkeys(row.widget for row in VIEW_ROWS))
        before = [name for name in order[:order.index(row.widget)] if name in self._views
                  and self._views[name].parentWidget() is self.views_splitter]
        self.views_splitter.insertWidget(len(before), self._views[row.widget])

    def offer(self, keys):
        """Offer what this robot can have: keys of the registry, and 'record'.

        What the operator chose before comes back as soon as it is on offer again.
        """
        keys = frozenset(keys)
        if keys != self._offered:
            self._offered = keys
            self.switches.offer(keys)
            self._arrange()

    def is_watched(self):
        """Tell whether anybody can see the tile: it is neither hidden nor minimised."""
        return self.isVisible() and not self.window().isMinimized()

    def wanted(self):
        """Return the set of views to be fed now: empty while nobody can see the tile."""
        return self.shown() if self.is_watched() else set()

    def shown(self):
        """Return the views that the tile has room for: a small one shows its picture alone."""
        chosen = self.switches.wanted()
        if self.header.large:
            return chosen
        return chosen & PICTURES if self.has_room() else set()

    def has_room(self):
        """Tell whether there is room for more than the header."""
        least = _LEAST_PICTURE_UNITS * self.fontMetrics().height()
        return self.header.large or self.height() - self.header.height() >= least

    def camera_size(self):
        """Return (width, height) that the picture has room for, in pixels of the screen."""
        return self.view(RGB).camera_size()

    def picture_area(self):
        """Return where the picture is in the tile, a :class:`QRect`; without one, its inside."""
        return self._layers.picture_area()

    def picture_shape(self):
        """Return width by height of what the tile shows."""
        frame = self.view(RGB).picture.frame if self.shown() & PICTURES else None
        if frame is None or not all(frame.full_size):
            return USUAL_SHAPE
        width, height = frame.full_size
        return min(4.0, max(0.25, width / height))

    def show_large(self, large):
        """Be a large tile, with all there is, or a small one."""
        if large != self.header.large:
            self.header.show_large(large)
            self.hud.show_large(large)
            self.tools.setVisible(large and self.views_button.isChecked())
            self._arrange()

    def show_looked_at(self, looked_at):
        """Mark the tile of the robot that was chosen last."""
        if looked_at != self._looked_at:
            self._looked_at = looked_at
            self.update()

    def show_hud(self, shown):
        """Show the numbers over the picture, or the picture alone; a sentence stays."""
        self.hud.show_numbers(shown)

    def show_torn_off(self, torn_off):
        """Be in a window of its own, which has a stop button of its own, or on the screen."""
        self.torn_off = torn_off
        self.tear_button.setText(PUT_BACK if torn_off else TEAR_OFF)
        self.stop_button.setVisible(torn_off)

    def _show_tools(self, shown):
        """Open or close the switches, the streams' figures and the recording."""
        self.tools.setVisible(shown)
        for widget in self._views.values():
            if hasattr(widget, 'show_tools'):
                widget.show_tools(shown)
        self._arrange()

    def _arrange(self):
        """Lay out the views that are chosen; without any there is the picture of the motion."""
        shown = self._arranged = self.shown()
        kind = next(iter(shown & PICTURES), None)
        visible = {id(self.view(key)) for key in shown}
        for widget in self._views.values():
            if hasattr(widget, 'show_kind') and id(widget) in visible and widget.kind != kind:
                widget.show_kind(kind)
            widget.setVisible(id(widget) in visible)
        if SCAN in shown and self._layers.take_inset(self.view(SCAN), wants_inset(shown)):
            self._place_in_row(next(row for row in VIEW_ROWS if row.key == SCAN))
        for value in self._figures:
            value.setVisible(self.header.large)
        self.switches.setVisible(bool(self._offered - {RECORD}))
        self.recording.setVisible(RECORD in self._offered)
        self.motion_place.setVisible(self.header.large and self.motion_place.layout().count() > 0)
        self._layers.place()
        self._tell_wanted()

    def _tell_wanted(self):
        """Tell of another set of wanted views, and of nothing else."""
        wanted = self.wanted()
        if wanted != self._wanted:
            self._wanted = wanted
            self.views_changed.emit()

    def sizeHint(self):  # noqa: N802
        """Return a size at which everything on offer can be used."""
        return QSize(*_TORN_OFF_SIZE)

    def minimumSizeHint(self):  # noqa: N802
        """Return next to nothing: the stage says how large a tile is."""
        return QSize(4 * self.fontMetrics().height(), 2 * self.fontMetrics().height())

    @property
    def drive_state(self):
        """What :func:`mhri.screen.gui.tile_header.drive_state` says of the robot on show."""
        return self._drive

    def show_view(self, view, stop_all=False):
        """Show a :class:`RobotView`; states at once, numbers four times a second.

        :param stop_all: whether stop-all is in force; a proof in the view says so, too
        """
        numbers = self._numbers.due() or view.changed_with != self._changed_with
        self._changed_with = view.changed_with
        self.header.show_view(view, numbers)
        self._show_drive_state(view, stop_all or view.proof is not None)
        self._show_sentence(view)
        for row in VIEW_ROWS:
            widget = self._views.get(row.widget)
            if widget is not None and hasattr(widget, 'show_old'):
                widget.show_old(view.link != views.LIVE)
        if numbers:
            self._show_numbers(view)

    def _show_drive_state(self, view, stopped):
        """Show in edge and pill whether this robot is driven right now."""
        drive, trouble = drive_state(view, stopped), trouble_of(
            view, self.battery_label.level)
        if (drive, trouble) == (self._drive, self._trouble):
            return
        self._trouble = trouble
        self._drive = drive
        self._stopped = stopped
        self.header.show_drive(drive)
        self._show_stop()
        self.update()

    def show_cut_off(self, cut_off):
        """Show that nothing that is pressed here reaches anything any more, as the bar does."""
        if cut_off != self._cut_off:
            self._cut_off = cut_off
            self.stop_button.setEnabled(not cut_off)
            self.stop_button.setToolTip(CUT_OFF_NOTE if cut_off else '')
            self._show_stop()

    def _show_stop(self):
        """Say on the stop button of a torn-off tile what it is worth."""
        words = (CUT_OFF, CUT_OFF_SHORTEST) if self._cut_off else (
            'STOP ALL in force - release on the main screen' if self._stopped else 'STOP ALL',)
        self.stop_button.show_words(*words)
        self.stop_button.show_engaged(self._stopped or self._cut_off)

    def _show_sentence(self, view):
        """Show the one sentence there is to say."""
        text, sign, shorter = sentence_of(view, self.battery_label.level, self._looked_at)
        before = self.hud.sentence
        self.hud.show_sentence(text, sign, shorter)
        if bool(before) != bool(text):
            self._layers.place()

    def _show_numbers(self, view):
        """Show what changes all the time."""
        # What a silent robot said last is still worth knowing, but not as if it were now.
        tone = theme.TEXT if view.link == views.LIVE else theme.MUTED
        self.hud.show_view(view)
        self.x_value.show_text('x ' + words.metres_text(view.x_m), tone)
        self.y_value.show_text('y ' + words.metres_text(view.y_m), tone)
        self.turn_value.show_text(words.turn_text(view.angular_rad_s), tone)
        self.max_linear_value.show_text(words.linear_text(view.max_linear_mps))
        self.max_angular_value.show_text(words.rate_text(view.max_angular_rad_s))

    def save_settings(self):
        """Return what is kept between runs as a plain dict: choices, splitter."""
        kept = {row.key: self._views[row.widget].save_settings() for row in VIEW_ROWS
                if row.widget in self._views}
        return {'views': self.switches.chosen(), 'recording': self.recording.save_settings(),
                'splitter': self.views_splitter.sizes(), 'of_views': kept}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`; what is missing or unknown stays as it is."""
        if 'views' in settings:
            self.switches.choose(settings['views'])
        for key, kept in settings.get('of_views', {}).items():
            if key in KEYS:
                self.view(key).restore_settings(kept)
        self.recording.restore_settings(settings.get('recording', {}))
        sizes = settings.get('splitter', [])
        if len(sizes) == self.views_splitter.count():
            self.views_splitter.setSizes(sizes)

    def showEvent(self, event):  # noqa: N802
        """Ask for the views."""
        super().showEvent(event)
        self._arrange()

    def hideEvent(self, event):  # noqa: N802
        """Ask for nothing any more."""
        super().hideEvent(event)
        self._tell_wanted()

    def resizeEvent(self, event):  # noqa: N802
        """Keep header and numbers where they belong."""
        super().resizeEvent(event)
        if self.shown() == self._arranged:
            self._layers.place()
        else:
            self._arrange()

    def event(self, event):
        """Keep the numbers over the picture when the layout has moved it."""
        done = super().event(event)
        if event.type() == QEvent.LayoutRequest:
            self._layers.place()
        return done

    def mousePressEvent(self, event):  # noqa: N802
        """Look at this robot."""
        name = first_press.of(self.name, event) if event.button() == Qt.LeftButton else ''
        if name:
            self.clicked.emit(name)
        super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Drive this robot and no other; where another one had the first press, that one."""
        name = first_press.of_double_click(event) if event.button() == Qt.LeftButton else ''
        if name:
            self.drive_requested.emit(name)

    def paintEvent(self, event):  # noqa: N802
        """Paint the edge: a stop, trouble, else who drives; a line around it if looked at."""
        ink, _, width = LOOKS[self._drive]
        if self._trouble and ink != theme.STOP:
            ink, width = self._trouble, EDGE_PX
        painter, palette = QPainter(self), self.header.palette()
        if not self.has_room():
            painter.fillRect(self.rect(), theme.PICTURE_GROUND)
        theme.paint_edge(painter, self.rect(), EDGE_PX, theme.PICTURE_GROUND)
        theme.paint_edge(painter, self.rect(), width, theme.colour(ink, palette))
        if self._looked_at:
            keyboard = self.parentWidget() is not None and self.parentWidget().hasFocus()
            theme.paint_edge(painter, self.rect(), 2, theme.colour(theme.TEXT, palette), keyboard)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's tile: its name, whether it is driven, its pictures and its motion."""
from python_qt_binding.QtCore import QEvent, QPoint, QRect, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter
from python_qt_binding.QtWidgets import QLayout, QWidget

from mhri.base import views
from mhri.base.gui import theme, words
from mhri.base.gui.first_press import first_press
from mhri.base.gui.forms import load_form
from mhri.base.gui.long_press import LongPress
from mhri.base.gui.pending import Pace
from mhri.base.numbers import LAST_KEY
from mhri.base.view_rows import CAMERAS, CLOUD, KEYS, load, PICTURES, RECORD, RGB, VIEW_ROWS
from mhri.driving.gui.drive_keys import mark_drive_area
from mhri.driving.gui.stop_bar import CUT_OFF, CUT_OFF_NOTE, CUT_OFF_SHORTEST
from mhri.driving.gui.stop_button import RobotStopButton
from mhri.robots.gui.tile_words import drive_state, sentence_of, trouble_of
from mhri.screen.arrangement import USUAL_SHAPE
from mhri.screen.gui.hud import Hud
from mhri.screen.gui.tile_header import LOOKS, PUT_BACK, TEAR_OFF, TileHeader
from mhri.screen.gui.tile_layers import EDGE_PX, TileLayers

_TORN_OFF_SIZE = (800, 640)

# With less room below its header [line heights], a small tile shows no words on its picture; and
# no picture.
_MIN_PICTURE_UNITS, _MIN_GLIMPSE_UNITS = 2.5, 0.7


class RobotTile(QWidget):
    """The tile of every type of robot; types with extra widgets have subclasses (see ``windows``).

    It is passive: a presenter reads :meth:`active_views`, feeds the :meth:`view` of each of these
    keys, and handles ``recording`` (:class:`RecordingRow`). A lab's own class puts its lines into
    ``motion_place.layout()``, where they are always visible.

    :param ui_dir: folder of ``bot_window.ui``
    :param name: the robot's name
    :param type_label: the robot's type in words
    """

    stop_requested = Signal()
    #: stop this robot alone: its name
    stop_robot_requested = Signal(str)
    #: the set of :meth:`active_views` changed
    views_changed = Signal()
    #: a click: name of the clicked robot
    clicked = Signal(str)
    #: a double click: name of the robot of the first press, to be driven alone
    drive_requested = Signal(str)
    #: a request to tear the tile off into its own window, or to put it back
    tear_requested = Signal(str)
    #: a request to continue the interrupted task of the robot
    carry_on_requested = Signal(str)
    #: a right click or a long press: name of the robot, and the place on the desktop
    menu_requested = Signal(str, QPoint)

    def __init__(self, ui_dir, name, type_label, parent=None):
        super().__init__(parent)
        self.name = name
        self.torn_off = False
        #: whether the picture needs its full rate, also while swapped with the map
        self.full_rate = True
        #: the displayed :func:`mhri.robots.gui.tile_words.drive_state`
        self.drive_state = None
        self._trouble = None
        self._changed_with = None
        self._looked_at = self._stopped = self._cut_off = False
        self._active_views = set()
        self._arranged = {}
        self._shape = USUAL_SHAPE
        self._offered = frozenset()
        self._views = {}
        self._numbers = Pace()
        self._build(ui_dir, type_label)
        self._connect()
        self._restore()

    def _build(self, ui_dir, type_label):
        """Load the form, and set properties that a form cannot contain."""
        self.setFont(theme.base_font(self.font()))
        load_form(ui_dir, 'bot_window.ui', self)
        self.setObjectName('window_' + self.name)
        self.setAutoFillBackground(True)
        self.setFocusPolicy(Qt.ClickFocus)
        mark_drive_area(self)
        self.layout().setContentsMargins(*[EDGE_PX] * 4)
        # The stage determines its size, regardless of its parts.
        self.layout().setSizeConstraint(QLayout.SetNoConstraint)
        self.header = TileHeader(self.name, type_label, self)
        self.hud = Hud(self)
        self.robot_stop = RobotStopButton(self.name, self)
        #: what lies over the picture below the header, e.g. accessories; None for nothing
        self.bar = None
        self._layers = TileLayers(self)
        for key in ('name_label', 'type_label', 'pill', 'link_sign', 'link_label',
                    'battery_label', 'views_button', 'tear_button'):
            setattr(self, key, getattr(self.header, key))
        self._build_figures()
        self.stop_button.setFont(theme.larger(self.font(), theme.TITLE, bold=True))
        self.stop_button.set_look('Shift+Space', 2.2)
        self.stop_button.setObjectName('tile_stop_button')
        self.stop_button.hide()
        self.tools.hide()
        self.tools_page.installEventFilter(self)
        self.views_place.installEventFilter(self)
        self.motion_place.hide()
        self._arrange()

    def _build_figures(self):
        """Set up the captions and values of the odometry."""
        numbers = theme.number_font(theme.larger(self.font(), theme.HEAD))
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
        """Connect the stop button, which acts on press, and the switches."""
        self.stop_button.pressed.connect(self.stop_requested)
        self.robot_stop.pressed.connect(self._request_stop)
        self.switches.changed.connect(self._arrange)
        self.views_button.toggled.connect(self._show_tools)
        self.tear_button.clicked.connect(lambda: self.tear_requested.emit(self.name))
        self.header.carry_on_button.clicked.connect(
            lambda: self.carry_on_requested.emit(self.name))
        LongPress(self).held.connect(self._on_long_press)

    def _on_long_press(self, place):
        self.menu_requested.emit(self.name, self.mapToGlobal(place))

    def contextMenuEvent(self, event):  # noqa: N802
        """Ask for the menu of the robot."""
        self.menu_requested.emit(self.name, event.globalPos())

    def _request_stop(self):
        self.stop_robot_requested.emit(self.name)

    def _restore(self):
        """Start without a state."""
        self.show_view(views.RobotView(self.name, self.type_label.text()))

    def view(self, key):
        """Return the widget of a view of the registry, created on first use."""
        row = next(row for row in VIEW_ROWS if row.key == key)
        if row.widget not in self._views:
            widget = self._views[row.widget] = load(row.widget)(self.views_place)
            widget.hide()
            if hasattr(widget, 'tools'):
                self.view_tools_column.addWidget(widget.tools)
                widget.tools.hide()
        return self._views[row.widget]

    def offer(self, keys):
        """Offer the views of this robot: keys of the registry, and 'record'.

        An earlier choice is restored as soon as it is available again.
        """
        keys = frozenset(keys)
        if keys != self._offered:
            self._offered = keys
            self.switches.offer(keys)
            self._arrange()

    def is_watched(self):
        """Return whether the tile is visible, neither hidden nor minimised."""
        return self.isVisible() and not self.window().isMinimized()

    def active_views(self):
        """Return the set of views to feed now, empty while the tile is not visible."""
        return self.shown() if self.is_watched() else set()

    def shown(self):
        """Return the views that fit; a small tile shows only a picture, that of a camera."""
        return set(self._arranged)

    def _fitting(self):
        """Return {view: place} of the views that fit."""
        chosen = self.switches.selected_views()
        if self.header.large:
            return self._layers.fitting(chosen)
        if CLOUD in chosen:
            chosen = self._offered & {RGB}
        below = self.height() - self.header.height()
        return dict.fromkeys(chosen & CAMERAS, '') \
            if below >= _MIN_GLIMPSE_UNITS * self.fontMetrics().height() else {}

    def has_room(self):
        """Return whether there is room for more than the header."""
        least = _MIN_PICTURE_UNITS * self.fontMetrics().height()
        return self.header.large or self.height() - self.header.height() >= least

    def camera_size(self):
        """Return (width, height) available for the picture, in screen pixels."""
        return self.view(RGB).camera_size()

    def picture_area(self):
        """Return the :class:`QRect` of the picture in the tile; without one, the tile's inside."""
        return self._layers.picture_area()

    def clear_area(self):
        """Return the :class:`QRect` over whose lower right the virtual joystick may lie."""
        return self._layers.clear_area()

    def name_area(self):
        """Return the :class:`QRect` of number and name in the header; nothing lies over it."""
        last = self.name_label.geometry()
        return QRect(self.header.pos(), QSize(last.right() + 1, self.header.height()))

    def keep_clear(self, width):
        """Keep a width [px] at the right end of numbers and strip free, for what lies there."""
        if width != self.hud.clear_px:
            self.hud.keep_clear(width)
            self._layers.place()

    def set_bar(self, bar):
        """Show a widget over the picture below the header while the tile is large.

        :param bar: its ``fit(place, width, height)`` lays it into a room and returns its height
            [px], 0 if it has no room; it becomes a child of the tile
        """
        self.bar = bar
        bar.setParent(self)
        self._layers.place()

    def picture_shape(self):
        """Return the aspect ratio (width / height) of the picture."""
        shown = self.shown()
        frame = self.view(RGB).picture.frame if shown & CAMERAS else None
        if frame is not None and all(frame.full_size):
            width, height = frame.full_size
            self._shape = min(4.0, max(0.25, width / height))
        # A cloud, or a picture that is late, leaves the tile where it is.
        return self._shape if shown & PICTURES else USUAL_SHAPE

    def show_large(self, large):
        """Switch to a large tile, with all parts, or to a small one."""
        if large != self.header.large:
            self.header.show_large(large)
            self.hud.show_large(large)
            self.tools.setVisible(large and self.views_button.isChecked())
            self._arrange()

    def show_looked_at(self, looked_at):
        """Show or hide the mark of the robot chosen last."""
        if looked_at != self._looked_at:
            self._looked_at = looked_at
            self.update()

    def show_hud(self, shown):
        """Show or hide the numbers over the picture; a sentence stays."""
        self.hud.show_numbers(shown)
        self._layers.place()

    def show_torn_off(self, torn_off):
        """Switch to a torn-off tile, with its own stop button, or back to part of the screen."""
        self.torn_off = torn_off
        self.tear_button.setText(PUT_BACK if torn_off else TEAR_OFF)
        self.stop_button.setVisible(torn_off)

    def _show_tools(self, shown):
        """Open or close the switches, the figures of streams, and the recording row."""
        self.tools.setVisible(shown)
        self._arrange()

    def _arrange(self):
        """Lay out the selected views; a large tile also shows its motion."""
        shown = self._arranged = self._fitting()
        kind = next(iter(CAMERAS.intersection(shown)), None)
        visible = {id(self.view(key)) for key in shown}
        for widget in self._views.values():
            # A picture that is switched off is forgotten: it would look live when it comes back.
            if hasattr(widget, 'show_kind') and widget.kind != kind:
                widget.show_kind(kind)
            widget.setVisible(id(widget) in visible)
            if hasattr(widget, 'tools'):
                widget.tools.setVisible(id(widget) in visible)
        for value in self._figures:
            value.setVisible(self.header.large)
        self.switches.setVisible(bool(self._offered - {RECORD}))
        self.switches.show_without_room(
            self.switches.selected_views().difference(shown) if self.header.large else ())
        self.recording.setVisible(RECORD in self._offered)
        self.motion_place.setVisible(self.header.large and self.motion_place.layout().count() > 0)
        self._layers.show_views(shown)
        self._emit_views_changed()

    def _emit_views_changed(self):
        """Emit ``views_changed`` if the set of wanted views changed."""
        active = self.active_views()
        if active != self._active_views:
            self._active_views = active
            self.views_changed.emit()

    def sizeHint(self):  # noqa: N802
        """Return a size at which all views are usable."""
        return QSize(*_TORN_OFF_SIZE)

    def minimumSizeHint(self):  # noqa: N802
        """Return a very small size, because the stage determines the size of a tile."""
        return QSize(4 * self.fontMetrics().height(), 2 * self.fontMetrics().height())

    def show_view(self, view, stop_all=False):
        """Show a :class:`RobotView`; states at once, numbers four times a second.

        :param stop_all: whether STOP ALL is in force; a proof in the view implies it, too
        """
        numbers = self._numbers.due() or view.changed_with != self._changed_with
        self._changed_with = view.changed_with
        self.header.show_view(view, numbers)
        self._show_drive_state(view, stop_all or view.proof is not None)
        self.robot_stop.show_moves(bool(view.driven or view.moving or view.on_task))
        self.robot_stop.show_keys('Shift+{}'.format(view.number) if 0 < view.number <= LAST_KEY
                                  else 'look at it, then Shift+Enter')
        self._show_sentence(view)
        for row in VIEW_ROWS:
            widget = self._views.get(row.widget)
            if widget is not None and hasattr(widget, 'show_old'):
                widget.show_old(view.link != views.LIVE)
        if numbers:
            self._show_numbers(view)

    def _show_drive_state(self, view, stopped):
        """Show in edge and pill whether this robot is being driven."""
        drive, trouble = drive_state(view, stopped), trouble_of(
            view, self.battery_label.level)
        if (drive, trouble) == (self.drive_state, self._trouble):
            return
        self._trouble = trouble
        self.drive_state = drive
        self._stopped = stopped
        self.header.show_drive(drive)
        self._show_stop()
        self.update()

    def show_idle(self, words):
        """Show from now on why there is nothing to stop: the robot has no stop of its own."""
        for button in (self.stop_button, self.robot_stop):
            if not button.is_idle:
                button.show_idle(words)
                self._layers.place()

    def show_cut_off(self, cut_off):
        """Show whether the buttons have lost their effect, as the stop bar does."""
        if cut_off != self._cut_off:
            self._cut_off = cut_off
            for button in (self.stop_button, self.robot_stop):
                button.setEnabled(not cut_off and not button.is_idle)
            self.stop_button.setToolTip(CUT_OFF_NOTE if cut_off else '')
            self._show_stop()

    def _show_stop(self):
        """Show on a torn-off tile's stop button whether it works or is engaged."""
        words = (CUT_OFF, CUT_OFF_SHORTEST) if self._cut_off else (
            'STOP ALL in force - release on the main screen' if self._stopped else 'STOP ALL',)
        self.stop_button.show_words(*words)
        self.stop_button.show_engaged(self._stopped or self._cut_off)

    def _show_sentence(self, view):
        """Show the most important sentence."""
        text, sign, shorter = sentence_of(view, self.battery_label.level, self._looked_at)
        before = self.hud.sentence
        self.hud.show_sentence(text, sign, shorter)
        if bool(before) != bool(text):
            self._layers.place()

    def _show_numbers(self, view):
        """Show the numbers."""
        # The last values of a silent robot are still useful, but must not look current.
        tone = theme.TEXT if view.link == views.LIVE else theme.MUTED
        before = self.hud.numbers_height()
        self.hud.show_view(view)
        if self.hud.numbers_height() != before:
            self._layers.place()
        self.x_value.show_text('x ' + words.metres_text(view.x_m), tone)
        self.y_value.show_text('y ' + words.metres_text(view.y_m), tone)
        self.turn_value.show_text(words.turn_text(view.angular_rad_s), tone)
        self.max_linear_value.show_text(words.linear_text(view.max_linear_mps))
        self.max_angular_value.show_text(words.rate_text(view.max_angular_rad_s))

    def save_settings(self):
        """Return the saved state as a plain dict of choices."""
        kept = {row.key: self._views[row.widget].save_settings() for row in VIEW_ROWS
                if row.widget in self._views}
        return {'views': self.switches.chosen(), 'recording': self.recording.save_settings(),
                'of_views': kept}

    def restore_settings(self, settings):
        """Apply a dict of :meth:`save_settings`; missing or unknown parts stay unchanged."""
        if 'views' in settings:
            self.switches.choose(settings['views'])
        for key, kept in settings.get('of_views', {}).items():
            if key in KEYS:
                self.view(key).restore_settings(kept)
        self.recording.restore_settings(settings.get('recording', {}))

    def showEvent(self, event):  # noqa: N802
        """Request the views."""
        super().showEvent(event)
        self._arrange()

    def hideEvent(self, event):  # noqa: N802
        """Stop requesting views."""
        super().hideEvent(event)
        self._emit_views_changed()

    def resizeEvent(self, event):  # noqa: N802
        """Reposition header and numbers."""
        super().resizeEvent(event)
        if self._fitting() == self._arranged:
            self._layers.place()
        else:
            self._arrange()

    def event(self, event):
        """Reposition the numbers when the layout has moved the picture."""
        done = super().event(event)
        if event.type() == QEvent.LayoutRequest:
            self._layers.place()
        return done

    def eventFilter(self, watched, event):  # noqa: N802
        """Adapt to a new height of the switches, or size of the views."""
        if event.type() == (QEvent.LayoutRequest if watched is self.tools_page else QEvent.Resize):
            self._layers.place()
        return False

    def mousePressEvent(self, event):  # noqa: N802
        """Report a click on this robot."""
        name = first_press.of(self.name, event) if event.button() == Qt.LeftButton else ''
        if name:
            self.clicked.emit(name)
        super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Request to drive only the robot of the double click's first press."""
        name = first_press.of_double_click(event) if event.button() == Qt.LeftButton else ''
        if name:
            self.drive_requested.emit(name)

    def paintEvent(self, event):  # noqa: N802
        """Paint the edges."""
        painter = QPainter(self)
        if not self.has_room():
            painter.fillRect(self.rect(), theme.PICTURE_GROUND)
        self.paint_edges(painter, self.rect())

    def paint_edges(self, painter, rect):
        """Paint the edge by stop, trouble or drive state, and a line around it if in view."""
        ink, _, width = LOOKS[self.drive_state]
        if self._trouble and ink != theme.STOP:
            ink, width = self._trouble, EDGE_PX
        palette = self.header.palette()
        theme.paint_edge(painter, rect, EDGE_PX, theme.PICTURE_GROUND)
        theme.paint_edge(painter, rect, width, theme.colour(ink, palette))
        if self._looked_at:
            keyboard = self.parentWidget() is not None and self.parentWidget().hasFocus()
            theme.paint_edge(painter, rect, 2, theme.colour(theme.TEXT, palette), keyboard)

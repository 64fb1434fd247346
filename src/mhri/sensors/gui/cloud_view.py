# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's point cloud: turned by hand, coloured by choice, drawn without a GPU."""
from python_qt_binding.QtCore import Qt, QTimer, Signal
from python_qt_binding.QtWidgets import (
    QComboBox, QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout, QWidget)

from mhri.base.gui import theme, words
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.base.gui.pending import Pace
from mhri.camera.gui.camera_view import stream_text
from mhri.sensors.cloud_picture import COLOUR, colourings, DISTANCE, HEIGHT, INTENSITY, upright_axes
from mhri.sensors.gui.cloud_canvas import CloudCanvas
from mhri.sensors.gui.cloud_drawing import CloudDrawing
from mhri.sensors.orbit import fitted, read_orbit

OLD_S = 1.0
STATUS_PERIOD_S = 0.25
# How often a drawing that is under way is looked for.
LOOK_MS = 15
# How long a reason stays.
REFUSAL_S = 6.0
WAITING = 'waiting for the first cloud'
NOTHING = 'nothing measured'
# What a cloud is coloured by: key, label, unit of the scale.
_COLOURINGS = ((HEIGHT, 'Height', 'm'), (DISTANCE, 'Distance', 'm'), (INTENSITY, 'Intensity', ''),
               (COLOUR, 'Colour', ''))
_UNITS = {key: unit for key, _, unit in _COLOURINGS}
_RVIZ_HELP = 'show it with RViz instead; robots stop while that is being loaded'
_HELP = ('drag to turn, drag with the right button to move, wheel to zoom, '
         'double click to show all')


def points_text(cloud):
    """Return how many points a :class:`Cloud` has, e.g. "276,352 points", "1 of 4 of ..."."""
    text = '{:,} points'.format(len(cloud.points))
    return text if cloud.kept_of == 1 else '1 of {} of {:,} points'.format(
        cloud.kept_of, cloud.sent)


class CloudView(QWidget):
    """Shows the clouds that it is given; the first one decides from where it is looked at.

    The sensor is where its axes are (orange ahead, green left, blue up), above the white circle of
    the robot. Child widgets: ``canvas``, ``status_label``, ``colour_combo``, ``reset_button``,
    ``rviz_button``.
    """

    #: the picture of a cloud has been drawn
    drawn = Signal()
    #: the operator wants RViz's own widget instead, or no more
    rviz_chosen = Signal(bool)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._cloud = None
        self._looked = False
        self._chosen = HEIGHT
        self._stream = ''
        self._numbers_pace = self._status_pace = Pace(STATUS_PERIOD_S)
        self._drawing = CloudDrawing()
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('cloud_view')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        self.canvas = CloudCanvas(self)
        self.canvas.setToolTip(_HELP)
        self.status_label = TextLine(self)
        self.status_label.setObjectName('status_label')
        self.status_label.setFont(theme.number_font(self.font()))
        self.colour_combo = QComboBox(self)
        self.reset_button = QPushButton('Show all', self)
        self.reset_button.setAutoDefault(False)
        self.rviz_button = QPushButton('RViz', self)
        self.rviz_button.setAutoDefault(False)
        self.rviz_button.setCheckable(True)
        self.rviz_button.hide()
        self._instead = None
        self._timer = QTimer(self)
        self._timer.setInterval(LOOK_MS)
        self._tools = QWidget(self)
        line = QHBoxLayout(self._tools)
        line.setContentsMargins(0, 4, 0, 0)
        line.setSpacing(6)
        line.addWidget(self.status_label, 1)
        for widget, name, spoken in (
                (self.colour_combo, 'colour_combo', 'what the colours of the points mean'),
                (self.reset_button, 'reset_button', 'look at all points, from behind the robot'),
                (self.rviz_button, 'rviz_button', _RVIZ_HELP)):
            widget.setObjectName(name)
            widget.setAccessibleName(spoken)
            widget.setToolTip(spoken)
            widget.setFocusPolicy(Qt.TabFocus)
            widget.setMinimumHeight(theme.touch_size(self))
            line.addWidget(widget)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.canvas, 1)
        column.addWidget(self._tools)

    def _connect(self):
        """Wire the hand, the choice and the drawing."""
        self.canvas.moved.connect(self._on_moved)
        self.canvas.reset_requested.connect(self.show_all)
        self.canvas.resized.connect(self._ask)
        self.colour_combo.activated[int].connect(self._on_colour)
        self.reset_button.clicked.connect(lambda *_: self.show_all())
        self.rviz_button.clicked[bool].connect(self.rviz_chosen)
        self._timer.timeout.connect(self._look)

    def _restore(self):
        """Begin without a cloud."""
        self._offer((HEIGHT, DISTANCE))

    @property
    def colouring(self):
        """What the colours of the points mean, as :func:`colourings` says it."""
        return self._chosen

    @property
    def idle(self):
        """Whether the newest cloud has been drawn, from where it is looked at now."""
        return self._drawing.idle

    @property
    def frame_id(self):
        """The frame of the newest cloud, None before the first."""
        return None if self._cloud is None else self._cloud.frame_id

    def offer_rviz(self, offered):
        """Let the operator choose RViz's widget, or not."""
        self.rviz_button.setVisible(offered)

    def show_instead(self, widget):
        """Show another widget in place of the drawn cloud; None: the cloud again."""
        before, self._instead = self._instead, widget
        if before is not None:
            before.setParent(None)
            before.deleteLater()
        if widget is not None:
            self.layout().insertWidget(0, widget, 1)
            widget.show()
        self.canvas.setVisible(widget is None)
        for control in (self.colour_combo, self.reset_button):
            control.setEnabled(widget is None)
        self.rviz_button.setChecked(widget is not None)
        self._ask()

    def refuse_rviz(self, reason):
        """Say why RViz's widget cannot be had."""
        self.show_instead(None)
        self._status_pace = Pace(REFUSAL_S)
        self._status_pace.due()
        self.status_label.show_text(reason)

    def show_value(self, cloud):
        """Show a :class:`mhri.sensors.point_cloud.Cloud`."""
        self._cloud = cloud
        self._offer(colourings(cloud))
        self.canvas.show_warning('')
        if not self._looked and len(cloud.points):
            self._look_at_all()
        self._say()
        self._ask()

    def show_age(self, age_s):
        """Tell the age of the newest cloud [s], None before the first: old ones are marked."""
        old = age_s is not None and age_s > OLD_S and self._cloud is not None
        self.canvas.show_warning('OLD CLOUD, {}'.format(words.age_text(age_s)) if old else '')

    def show_status(self, status):
        """Show a :class:`mhri.camera.images.StreamStatus`; numbers four times a second."""
        if self._cloud is None and status.problem:
            self.canvas.clear(status.problem)
        self.canvas.setToolTip(
            self._cloud is None and plain_tip(status.detail) or _HELP)
        self._stream = stream_text(status)
        self._say()

    def _say(self):
        """Say how many points there are, and how their stream does where that is known."""
        if self._cloud is not None and self._status_pace.due():
            self._status_pace = self._numbers_pace
            points = points_text(self._cloud)
            self.status_label.show_text('{}  {}'.format(points, self._stream).rstrip(),
                                        shorter=(points,))

    def clear(self, text=WAITING):
        """Show words instead of a cloud."""
        self._cloud = None
        self.status_label.show_text('')
        self.canvas.clear(text)

    def show_tools(self, shown):
        """Show the figures and the controls below the cloud, or the cloud alone."""
        self._tools.setVisible(shown)

    def show_all(self):
        """Look at all of the cloud, from behind the robot."""
        self._looked = False
        if self._cloud is not None:
            self._look_at_all()
            self._ask()

    def save_settings(self):
        """Return the colouring, and from where it is looked at if that was chosen by hand."""
        kept = {'colouring': self._chosen}
        if self._looked:
            kept['orbit'] = self.canvas.orbit.words()
        return kept

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`; what cannot be used is left out."""
        if settings.get('colouring') in _UNITS:
            self._chosen = settings['colouring']
            self._offer(() if self._cloud is None else colourings(self._cloud))
        try:
            self.canvas.orbit = read_orbit(settings.get('orbit'))
            self._looked = True
        except ValueError:
            pass  # it was never chosen, or somebody wrote another thing into the file
        self._ask()

    def showEvent(self, event):  # noqa: N802
        """Draw what came while nobody could see it."""
        super().showEvent(event)
        self._ask()

    def _ask(self):
        """Ask for a picture of what there is, where anybody can see it."""
        if self._cloud is not None and self.canvas.isVisible():
            self._drawing.ask(self._cloud, self.canvas.orbit, self.canvas.drawing_size(),
                              self._chosen)
            self._timer.start()

    def _look(self):
        """Show what has been drawn, unless the cloud is gone meanwhile."""
        try:
            picture = self._drawing.take()
        except ValueError as error:
            picture = None
            self.canvas.clear(str(error))
        if self._drawing.idle:
            self._timer.stop()
        if picture is None or self._cloud is None:
            return
        self.canvas.show_picture(picture, _UNITS[picture.colouring],
                                 picture.colouring == DISTANCE,
                                 '' if len(self._cloud.points) else NOTHING)
        self.drawn.emit()

    def _on_moved(self):
        """Keep the place that was chosen by hand."""
        self._looked = True
        self._ask()

    def _look_at_all(self):
        """Look from where most of the points can be seen."""
        points = self._cloud.points[::max(1, len(self._cloud.points) // 10_000)]
        self.canvas.orbit = fitted(points @ upright_axes(self._cloud).T)

    def _offer(self, keys):
        """Offer what a cloud can be coloured by; what was chosen stays, there or not."""
        combo = self.colour_combo
        offered = [(key, label) for key, label, _ in _COLOURINGS
                   if key in keys or key == self._chosen]
        if combo.view().isVisible():
            return
        if [key for key, _ in offered] != [combo.itemData(at) for at in range(combo.count())]:
            combo.clear()
            for key, label in offered:
                combo.addItem(label, key)
        combo.setCurrentIndex(combo.findData(self._chosen))

    def _on_colour(self, index):
        """Colour by another thing."""
        self._chosen = self.colour_combo.itemData(index)
        self._ask()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's point cloud: turned by mouse, coloured by choice, drawn without a GPU."""
from python_qt_binding.QtCore import QTimer, Signal
from python_qt_binding.QtWidgets import QSizePolicy

from mhri.base.gui import theme, words
from mhri.base.gui.choices import offer
from mhri.base.gui.controls import Button, Combo
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.base.gui.page import WithTools
from mhri.base.gui.pending import Pace
from mhri.camera.gui.camera_view import stream_text
from mhri.sensors.cloud_picture import COLOUR, colourings, DISTANCE, HEIGHT, INTENSITY, upright_axes
from mhri.sensors.gui.cloud_canvas import CloudCanvas
from mhri.sensors.gui.cloud_drawing import CloudDrawing
from mhri.sensors.orbit import fitted, read_orbit

OLD_S = 1.0
# Period of checking for a finished drawing.
LOOK_MS = 15
WAITING = 'waiting for the first cloud'
NOTHING = 'nothing measured'
# The colourings: key, label, unit of the scale.
_COLOURINGS = ((HEIGHT, 'Height', 'm'), (DISTANCE, 'Distance', 'm'), (INTENSITY, 'Intensity', ''),
               (COLOUR, 'Colour', ''))
_UNITS = {key: unit for key, _, unit in _COLOURINGS}
_HELP = ('drag to turn, drag with the right button to move, wheel to zoom, '
         'double click to show all')


def points_text(cloud):
    """Return how many points a :class:`Cloud` has, e.g. "276,352 points", "1 of 4 of ..."."""
    text = '{:,} points'.format(len(cloud.points))
    return text if cloud.kept_of == 1 else '1 of {} of {:,} points'.format(
        cloud.kept_of, cloud.sent)


class CloudView(WithTools):
    """Shows point clouds; the first one determines the viewpoint.

    Axes (orange ahead, green left, blue up) mark the sensor, above the white circle of the robot.
    Child widgets: ``canvas``, ``status_label``, ``colour_combo``, ``reset_button``.
    """

    #: the picture of a cloud has been drawn
    drawn = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._cloud = None
        self._looked = False
        #: meaning of the colours, see :func:`colourings`
        self.colouring = HEIGHT
        self._stream = ''
        self._numbers = Pace()
        self._drawing = CloudDrawing()
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the widgets."""
        self.setObjectName('cloud_view')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        self.canvas = CloudCanvas(self)
        self.canvas.setToolTip(_HELP)
        self.status_label = TextLine(self)
        self.status_label.setObjectName('status_label')
        self.status_label.setFont(theme.number_font(self.font()))
        self.colour_combo = Combo(self)
        self.reset_button = Button('Show all', self)
        self._timer = QTimer(self, interval=LOOK_MS, timeout=self._look)
        for widget, name, spoken in (
                (self.colour_combo, 'colour_combo', 'what the colours of the points mean'),
                (self.reset_button, 'reset_button', 'look at all points, from behind the robot')):
            theme.for_fingers(widget, name, spoken, spoken)
        self.lay_out(self.canvas, (self.status_label, 1), (self.colour_combo, 0),
                     (self.reset_button, 0))

    def _connect(self):
        """Connect the canvas, the choice of colours and the drawing."""
        self.canvas.moved.connect(self._on_moved)
        self.canvas.reset_requested.connect(self.show_all)
        self.canvas.resized.connect(self._ask)
        self.colour_combo.activated[int].connect(self._on_colour)
        self.reset_button.clicked.connect(lambda *_: self.show_all())

    def _restore(self):
        """Set the initial state, without a cloud."""
        self._offer((HEIGHT, DISTANCE))

    @property
    def idle(self):
        """Whether the newest cloud has been drawn from the present viewpoint."""
        return self._drawing.idle

    def show_value(self, cloud):
        """Show a :class:`mhri.sensors.point_cloud.Cloud`."""
        self._cloud = cloud
        self._offer(colourings(cloud))
        self.canvas.show_warning('')
        if not self._looked and len(cloud.points):
            self._look_at_all()
        self._show_line()
        self._ask()

    def show_age(self, age_s):
        """Mark the newest cloud if it is old.

        :param age_s: its age [s], None before the first
        """
        old = age_s is not None and age_s > OLD_S and self._cloud is not None
        self.canvas.show_warning('OLD CLOUD, {}'.format(words.age_text(age_s)) if old else '')

    def show_status(self, status):
        """Show a :class:`mhri.camera.images.StreamStatus`; numbers four times a second."""
        if self._cloud is None and status.problem:
            self.canvas.clear(status.problem)
        self.canvas.setToolTip(
            self._cloud is None and plain_tip(status.detail) or _HELP)
        self._stream = stream_text(status)
        self._show_line()

    def _show_line(self):
        """Show the number of points, and the state of their stream if known."""
        if self._cloud is not None and self._numbers.due():
            points = points_text(self._cloud)
            self.status_label.show_text('{}  {}'.format(points, self._stream).rstrip(),
                                        shorter=(points,))

    def clear(self, text=WAITING):
        """Show words instead of a cloud."""
        self._cloud = None
        self.status_label.show_text('')
        self.canvas.clear(text)

    def show_all(self):
        """Show the whole cloud, from behind the robot."""
        self._looked = False
        if self._cloud is not None:
            self._look_at_all()
            self._ask()

    def save_settings(self):
        """Return the colouring, and the viewpoint if the operator chose it."""
        kept = {'colouring': self.colouring}
        if self._looked:
            kept['orbit'] = self.canvas.orbit.to_list()
        return kept

    def restore_settings(self, settings):
        """Restore a dict of :meth:`save_settings`; ignore invalid values."""
        if settings.get('colouring') in _UNITS:
            self.colouring = settings['colouring']
            self._offer(() if self._cloud is None else colourings(self._cloud))
        try:
            self.canvas.orbit = read_orbit(settings.get('orbit'))
            self._looked = True
        except ValueError:
            pass  # never chosen, or not an orbit in the file
        self._ask()

    def showEvent(self, event):  # noqa: N802
        """Draw the cloud received while the view was hidden."""
        super().showEvent(event)
        self._ask()

    def _ask(self):
        """Request a picture of the present cloud, if the view is visible."""
        if self._cloud is not None and self.canvas.isVisible():
            self._drawing.ask(self._cloud, self.canvas.orbit, self.canvas.drawing_size(),
                              self.colouring)
            self._timer.start()

    def _look(self):
        """Show the finished picture, unless the cloud was cleared meanwhile."""
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
        """Keep the viewpoint that the operator chose."""
        self._looked = True
        self._ask()

    def _look_at_all(self):
        """Set the viewpoint so that most of the points are visible."""
        points = self._cloud.points[::max(1, len(self._cloud.points) // 10_000)]
        self.canvas.orbit = fitted(points @ upright_axes(self._cloud).T)

    def _offer(self, keys):
        """Offer the colourings of a cloud, and the chosen one even if the cloud lacks it."""
        offer(self.colour_combo, [(label, key) for key, label, _ in _COLOURINGS
                                  if key in keys or key == self.colouring], self.colouring)

    def _on_colour(self, index):
        """Apply the chosen colouring."""
        self.colouring = self.colour_combo.itemData(index)
        self._ask()

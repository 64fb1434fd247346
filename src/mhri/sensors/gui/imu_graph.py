# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The graph of a robot's motion: velocity and yaw rate, or the values of its IMU."""
import math

from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import QBoxLayout, QComboBox, QSizePolicy, QWidget

from mhri.base import series as columns
from mhri.base.gui import theme
from mhri.base.gui.controls import Button, Combo
from mhri.base.gui.page import WithTools
from mhri.sensors.gui.chart import Chart, Plot, Trace

WINDOWS_S = (5, 10, 20, 30, 60)
USUAL_WINDOW_S = 30
# A narrower strip [line heights] shows one chart.
_BOTH_UNITS = 24.0
PAUSE = 'Pause'
RESUME = 'Resume'


def _axes(keys, names='xyz'):
    """Return the traces of three components; the vertical one is solid."""
    return tuple(Trace(key, name, stroke) for key, name, stroke in zip(keys, names, (1, 2, 0)))


# The quantities to choose from, a row for each: key, label, one or two plots.
CHOICES = (
    ('motion', 'Velocity, yaw rate', (
        Plot('linear velocity [m/s]', 0.1, 1.0, (Trace(columns.LINEAR, 'odometry'),)),
        Plot('yaw rate [rad/s]', 0.2, 1.0, (Trace('gyro_z', 'gyro', 1),
                                            Trace(columns.YAW_RATE, 'odometry'))))),
    ('accel', 'Linear acceleration', (
        Plot('linear acceleration [m/s²]', 1.0, 1.0, _axes(columns.ACCEL)),)),
    ('gyro', 'Angular velocity', (
        Plot('angular velocity [rad/s]', 0.2, 1.0, _axes(columns.GYRO)),)),
    ('orientation', 'Orientation', (
        Plot('orientation [deg]', 10.0, math.degrees(1.0),
             _axes(columns.ORIENTATION, columns.ORIENTATION)),)),
)


class ImuGraph(WithTools):
    """Draws each new series; while paused it keeps the present one.

    Its two charts are one above the other, or side by side in a strip over a picture.

    Child widgets: ``quantity_combo``, ``window_combo``, ``pause_button``, ``charts``.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._series = None
        self._plots = ()
        self._strip = False
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the charts and their controls."""
        self.setObjectName('imu_graph')
        plots = QWidget(self)
        self._row = QBoxLayout(QBoxLayout.TopToBottom, plots)
        self._row.setSpacing(8)
        self._row.setContentsMargins(0, 0, 0, 0)
        self.charts = (Chart(plots), Chart(plots))
        for chart in self.charts:
            self._row.addWidget(chart, 1)
        self.quantity_combo = Combo(self)
        for key, label, _ in CHOICES:
            self.quantity_combo.addItem(label, key)
        self.window_combo = Combo(self)
        for seconds in WINDOWS_S:
            self.window_combo.addItem('{} s'.format(seconds), seconds)
        self.pause_button = Button(PAUSE, self, checkable=True)
        for widget, name, spoken in (
                (self.quantity_combo, 'quantity_combo', 'what the graph shows'),
                (self.window_combo, 'window_combo', 'seconds on show'),
                (self.pause_button, 'pause_button', 'pause the graph')):
            theme.for_fingers(widget, name, spoken, spoken)
        self.quantity_combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.quantity_combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        # As wide as its longer text, so that nothing shifts when it is pressed.
        self.pause_button.setMinimumWidth(
            theme.text_width(self.font(), PAUSE, RESUME) + self.fontMetrics().height())
        self.lay_out(plots, (self.quantity_combo, 1), (self.window_combo, 0),
                     (self.pause_button, 0))
        self.setAutoFillBackground(True)

    def show_strip(self, strip):
        """Switch to a strip over a picture, dark in every theme, or back."""
        if strip == self._strip:
            return
        self._strip = strip
        self._row.setDirection(QBoxLayout.LeftToRight if strip else QBoxLayout.TopToBottom)
        margin = self.fontMetrics().height() // 3 if strip else 0
        self._row.setContentsMargins(margin, margin // 2, margin, 0)
        self.setPalette(theme.over_picture(self.palette()) if strip else QPalette())
        self._arrange()

    def _connect(self):
        """Connect the choices."""
        self.quantity_combo.currentIndexChanged[int].connect(lambda *_: self._arrange())
        self.window_combo.currentIndexChanged[int].connect(lambda *_: self._arrange())
        self.pause_button.toggled.connect(self._on_pause)

    def _restore(self):
        """Set the default choice."""
        self.window_combo.setCurrentIndex(WINDOWS_S.index(USUAL_WINDOW_S))
        self._arrange()

    @property
    def paused(self):
        """Whether the graph is paused."""
        return self.pause_button.isChecked()

    @property
    def window_s(self):
        """The displayed time span [s]."""
        return self.window_combo.currentData()

    def show_old(self, old):
        """Mark the newest values as old: the robot has fallen silent."""
        for chart in self.charts:
            chart.legend.show_old(old)

    def show_value(self, series):
        """Draw a :class:`Series`; no effect while paused or hidden."""
        if self.paused or not self.isVisible():
            return
        self._series = series
        self._draw()

    def show_age(self, age_s):
        """Do nothing: the state of the link marks values as old (:meth:`show_old`)."""

    def _draw(self):
        """Draw the present series."""
        if self._series is not None:
            for chart, _ in zip(self.charts, self._plots):
                chart.show_series(self._series, self.window_s, self._series.now_s)

    def _arrange(self):
        """Show the chosen quantity."""
        plots = CHOICES[self.quantity_combo.currentIndex()][2]
        if self._strip and self.width() < _BOTH_UNITS * self.fontMetrics().height():
            plots = plots[:1]
        if plots != self._plots:
            self._plots = plots
            for chart, plot in zip(self.charts, plots):
                chart.show_plot(plot)
        for index, chart in enumerate(self.charts):
            chart.setVisible(index < len(plots))
            chart.set_window(self.window_s, self._strip or index == len(plots) - 1)
        self._draw()

    def resizeEvent(self, event):  # noqa: N802
        """Show as many charts as fit."""
        super().resizeEvent(event)
        self._arrange()

    def _on_pause(self, paused):
        """Update the text of the button."""
        self.pause_button.setText(RESUME if paused else PAUSE)
        for chart in self.charts:
            chart.show_paused(paused)

    def save_settings(self):
        """Return the choices as a plain dict."""
        return {'quantity': self.quantity_combo.currentData(), 'window_s': self.window_s}

    def restore_settings(self, settings):
        """Restore a dict of :meth:`save_settings`; ignore unknown values."""
        for combo, key in ((self.quantity_combo, 'quantity'), (self.window_combo, 'window_s')):
            index = combo.findData(settings.get(key))
            if index >= 0:
                combo.setCurrentIndex(index)

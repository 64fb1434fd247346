# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One scrolling chart: a line with caption and legend, and the curves below it."""
import math
from typing import NamedTuple, Tuple

import numpy as np
import pyqtgraph
from python_qt_binding.QtCore import QEvent, QSize, Qt
from python_qt_binding.QtGui import QColor, QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.layouts import in_column, TIGHT
from mhri.base.gui.pending import Pace
from mhri.base.series import AxisRange, round_step

PAUSED = 'PAUSED   '
# Blue, reddish purple and bluish green of Okabe and Ito: orange and vermillion mean something else
# here. Each has a stroke of its own as well (lengths in widths of the line).
_INKS = (('#0072B2', '#56B4E9'), ('#CC79A7', '#CC79A7'), ('#009E73', '#009E73'))
_DASHES = ((), (6.0, 2.0), (2.0, 1.5))
_TICK_STEPS_S = {5: 1, 10: 2, 20: 5, 30: 10, 60: 10}
# Room at both ends for half a label of the axis, as a share of the displayed time.
_END_ROOM = 0.07
_GRID_ALPHA = 60


class Trace(NamedTuple):
    """One curve: its key in the series, its name in the legend, and its stroke."""

    key: str
    label: str
    stroke: int = 0


class Plot(NamedTuple):
    """The content of a chart: caption with unit, minimum half range, factor from SI, and curves.

    The curve named last lies on top.
    """

    caption: str
    least: float
    factor: float
    traces: Tuple[Trace, ...]


def trace_pen(stroke, palette, width=2):
    """Return the pen of a stroke (0, 1, 2) for a light or a dark ground."""
    pen = QPen(QColor(_INKS[stroke][theme.is_dark(palette)]), width)
    pen.setCapStyle(Qt.FlatCap)
    pen.setCosmetic(True)
    if _DASHES[stroke]:
        pen.setDashPattern(list(_DASHES[stroke]))
    return pen


def value_text(value):
    """Return a value with two digits behind the point; a dash for None and NaN."""
    if value is None or not math.isfinite(value):
        return words.UNKNOWN
    return '{:.2f}'.format(round(value, 2) + 0.0)


class _Fit(NamedTuple):
    """The layout of a legend: stroke and gap in heights of a line, and the parts shown."""

    stroke: float
    gap: float
    caption: bool = True
    names: bool = True
    values: bool = True


_AMPLE = _Fit(1.5, 0.5)
_TIGHT = _Fit(1.1, 0.3)


class Legend(QWidget):
    """The caption of a chart, and each curve's stroke, name and newest value."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._plot = None
        #: the newest values, as shown
        self.texts = ()
        self._paused = False
        #: whether the newest values are old
        self.old = False
        self.setSizePolicy(QSizePolicy.MinimumExpanding, QSizePolicy.Fixed)

    def show_plot(self, plot):
        """Show the names of another :class:`Plot`."""
        self._plot, self.texts = plot, (words.UNKNOWN,) * len(plot.traces)
        self.setToolTip('{}: {}'.format(
            plot.caption, ', '.join(trace.label for trace in plot.traces)))
        self.updateGeometry()
        self.update()

    def show_paused(self, paused):
        """Show whether the curves are paused."""
        self._paused = paused
        self.update()

    def show_old(self, old):
        """Mark the newest values as old: the robot has fallen silent."""
        if old != self.old:
            self.old = old
            self.update()

    @property
    def shown(self):
        """The parts that fit, out of 'caption', 'names' and 'values'."""
        fit = self._fit()
        return tuple(part for part in ('caption', 'names', 'values') if getattr(fit, part))

    def show_values(self, values):
        """Show the newest value of each curve."""
        texts = tuple(value_text(value) for value in values)
        if texts != self.texts:
            self.texts = texts
            self.update()

    def _names_width(self):
        """Return the width of the strokes and names of all curves."""
        return self._width(_AMPLE) - len(self._plot.traces) * self._value_width(_AMPLE)

    def _value_width(self, fit):
        """Return the width of a value and the gap after it; 0 if values are hidden."""
        metrics = self.fontMetrics()
        return metrics.horizontalAdvance('-00.00') + round(fit.gap * metrics.height()) \
            if fit.values else 0

    def _width(self, fit):
        """Return the width that all curves need."""
        metrics = self.fontMetrics()
        each = round((fit.stroke + 2.0 * fit.gap) * metrics.height()) + self._value_width(fit)
        gap = round(fit.gap * metrics.height())
        return sum(each + (metrics.horizontalAdvance(trace.label) + gap if fit.names else 0)
                   for trace in self._plot.traces)

    def _caption(self, fit):
        """Return the caption, or only its unit."""
        caption = self._plot.caption if fit.caption else \
            self._plot.caption.rpartition('[')[2].rstrip(']')
        return PAUSED + caption if self._paused else caption

    def _fit(self):
        """Return the widest :class:`_Fit` that fits."""
        gap = self.fontMetrics().height() // 2
        for fit in (_AMPLE, _TIGHT, _TIGHT._replace(caption=False),
                    _TIGHT._replace(caption=False, names=False), _AMPLE._replace(values=False)):
            if self._width(fit) + gap + self.fontMetrics().horizontalAdvance(
                    self._caption(fit)) <= self.width():
                return fit
        return _TIGHT._replace(caption=False, names=False, values=False)

    def sizeHint(self):  # noqa: N802
        """Return the size for caption and names; the values are optional."""
        metrics = self.fontMetrics()
        width = self._names_width() + metrics.horizontalAdvance(self._plot.caption) \
            if self._plot else 0
        return QSize(width, metrics.height() + 2)

    minimumSizeHint = sizeHint

    def paintEvent(self, event):  # noqa: N802
        """Paint caption and legend; with little room, the values are the last to be hidden."""
        if self._plot is None:
            return
        painter, fit = QPainter(self), self._fit()
        metrics, unit, middle = self.fontMetrics(), self.fontMetrics().height(), self.height() // 2
        ink, muted = (theme.colour(name, self.palette()) for name in (
            theme.MUTED if self.old else theme.TEXT, theme.MUTED))
        base = (self.height() + metrics.ascent() - metrics.descent()) // 2
        gap, stroke = round(fit.gap * unit), round(fit.stroke * unit)
        painter.setPen(theme.colour(theme.TEXT, self.palette()))
        painter.drawText(0, base, self._caption(fit))
        x = self.width() - self._width(fit)
        for trace, text in zip(self._plot.traces, self.texts):
            painter.setPen(trace_pen(trace.stroke, self.palette(), 3))
            painter.drawLine(x + gap, middle, x + gap + stroke, middle)
            x += 2 * gap + stroke
            if fit.names:
                painter.setPen(muted)
                painter.drawText(x, base, trace.label)
                x += metrics.horizontalAdvance(trace.label) + gap
            if fit.values:
                painter.setPen(ink)
                painter.drawText(x, 0, self._value_width(fit) - gap, self.height(),
                                 int(Qt.AlignRight | Qt.AlignVCenter), text)
                x += self._value_width(fit)


class _Frame(pyqtgraph.GraphicsWidget):
    """Places the axes beside the curves, each with a fixed width, so that the curves never jump.

    It does without a layout of the graphics view, for each of which Qt makes a hidden window.
    """

    def __init__(self, box, left, bottom):
        super().__init__()
        self._parts = (box, left, bottom)
        self._left_px = self._bottom_px = 0
        for part in self._parts:
            part.setParentItem(self)

    def give(self, left_px=None, bottom_px=None):
        """Set the room of the axes; None leaves it unchanged."""
        self._left_px = self._left_px if left_px is None else left_px
        self._bottom_px = self._bottom_px if bottom_px is None else bottom_px
        _, left, bottom = self._parts
        # Otherwise their size would follow their present numbers.
        left.setWidth(self._left_px)
        bottom.setHeight(self._bottom_px)
        self._place()

    def _place(self):
        """Place axes and curves."""
        box, left, bottom = self._parts
        width, height = self.size().width() - self._left_px, self.size().height() - self._bottom_px
        left.setGeometry(0.0, 0.0, self._left_px, height)
        bottom.setGeometry(self._left_px, height, width, self._bottom_px)
        box.setGeometry(self._left_px, 0.0, width, height)

    def resizeEvent(self, event):  # noqa: N802
        """Follow the size of the view."""
        self._place()


class Chart(QWidget):
    """Curves over the last seconds, redrawn only when a new series is given."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._plot = None
        self._times = (30, True)
        self._paused = False
        self._curves = []
        self._range = AxisRange(1.0)
        self._limits = None
        self._values = Pace()
        self._build()

    def _build(self):
        """Make the plot, which ignores mouse and keyboard."""
        self.legend = Legend(self)
        # Made of parts, since a PlotWidget has menus: hidden windows that outlive it.
        self.view = pyqtgraph.GraphicsView(self)
        self.view.setFocusPolicy(Qt.NoFocus)
        self.view.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.view.setMinimumHeight(round(2.2 * self.fontMetrics().height()))
        self.box = pyqtgraph.ViewBox(enableMenu=False, enableMouse=False)
        self.box.disableAutoRange()
        self._left = pyqtgraph.AxisItem('left')
        self._bottom = pyqtgraph.AxisItem('bottom')
        for axis in (self._left, self._bottom):
            axis.linkToView(self.box)
            axis.enableAutoSIPrefix(False)
            axis.setStyle(tickLength=-4, tickTextOffset=4)
            axis.setGrid(_GRID_ALPHA)
        self._frame = _Frame(self.box, self._left, self._bottom)
        self.view.setCentralItem(self._frame)
        in_column(self.legend, (self.view, 1), of=self, margins=TIGHT, gap=0)

    def show_plot(self, plot):
        """Show another :class:`Plot`, empty until the next series."""
        self._plot = plot
        self._range = AxisRange(plot.least)
        self._limits = None
        self._values = Pace()
        self.legend.show_plot(plot)
        for curve in self._curves:
            self.box.removeItem(curve)
        # Antialiased noise takes four times as long: three such curves would slow the screen down.
        self._curves = [pyqtgraph.PlotCurveItem(connect='finite', antialias=len(plot.traces) < 3)
                        for _ in plot.traces]
        for curve in self._curves:
            self.box.addItem(curve)
        self._restyle()

    def set_window(self, window_s, with_times=True):
        """Set the time span [s], with the times below unless another chart shows them."""
        self._times = (window_s, with_times)
        step = _TICK_STEPS_S[window_s]
        end = 'end' if self._paused else 'now'
        self._bottom.setTicks([[(-second, '-{} s'.format(second) if second else end)
                                for second in range(0, window_s + 1, step)]])
        self._bottom.setStyle(showValues=with_times)
        self._frame.give(bottom_px=self.fontMetrics().height() + 6 if with_times else 4)
        self.box.setXRange(-window_s, 0.0, padding=_END_ROOM)

    def show_paused(self, paused):
        """Show whether the curves are paused and so do not end now."""
        self._paused = paused
        self.legend.show_paused(paused)
        self.set_window(*self._times)

    def _mark_values(self):
        """Put as many round numbers beside the axis as fit, including zero."""
        low, high = self._limits
        most = max(2, round(self.view.height() / (1.7 * self.fontMetrics().height())))
        step = round_step((high - low) / most)
        first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
        digits = max(0, -math.floor(math.log10(step) + 1e-6))
        self._left.setTicks([[
            (index * step, '{:.{}f}'.format(index * step, digits))
            for index in range(first, last + 1)]])

    def resizeEvent(self, event):  # noqa: N802
        """Update the numbers beside the axis."""
        super().resizeEvent(event)
        if self._limits is not None:
            self._mark_values()

    def changeEvent(self, event):  # noqa: N802
        """Follow the desktop's colours and fonts."""
        super().changeEvent(event)
        if event.type() in (QEvent.PaletteChange, QEvent.FontChange) and self._plot:
            self._restyle()

    def _restyle(self):
        """Apply the colours and fonts of the present palette and font."""
        palette = self.palette()
        self.view.setBackground(palette.color(QPalette.Base))
        ink = theme.colour(theme.MUTED, palette)
        self._frame.give(left_px=self.fontMetrics().horizontalAdvance('-0.00') + 12)
        for axis in (self._left, self._bottom):
            axis.setPen(ink)
            axis.setTextPen(ink)
            axis.setStyle(tickFont=self.font())
        for curve, trace in zip(self._curves, self._plot.traces):
            curve.setPen(trace_pen(trace.stroke, palette))

    def show_series(self, series, window_s, now_s):
        """Draw the curves of a :class:`mhri.base.series.Series`."""
        low, high = math.nan, math.nan
        for curve, trace in zip(self._curves, self._plot.traces):
            x, y = series.curve(trace.key, window_s)
            y = y * self._plot.factor
            curve.setData(x, y)
            if len(y):
                low, high = np.fmin(low, np.nanmin(y)), np.fmax(high, np.nanmax(y))
        limits = self._range.follow(float(low), float(high), now_s)
        if limits != self._limits:
            self._limits = limits
            self.box.setYRange(*limits, padding=0.1)
            self._mark_values()
        if self._values.due():
            values = [series.latest(trace.key) for trace in self._plot.traces]
            self.legend.show_values([None if value is None else value * self._plot.factor
                                     for value in values])

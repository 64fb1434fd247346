# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's camera: picture, state of the stream, choice of transport, and stills."""
import math

from python_qt_binding.QtCore import QTimer, Signal
from python_qt_binding.QtWidgets import QComboBox, QSizePolicy

from mhri.base.gui import theme, words
from mhri.base.gui.choices import offer
from mhri.base.gui.controls import Button, Combo
from mhri.base.gui.labels import plain_tip, Sign, TextLine
from mhri.base.gui.page import WithTools
from mhri.base.gui.pending import Pace
from mhri.camera.gui.picture import PictureView
from mhri.camera.images import DEPTH

AUTO = 'auto'
NOTE_MS = 6000
WAITING = 'waiting for the first picture'


def still_name(robot, kind, when):
    """Return the file name of a still, e.g. "bot1_rgb_2026-11-21-14-02-11-250.png".

    :param kind: 'rgb' or 'depth'
    :param when: ``datetime`` of the picture, used to the millisecond so that names differ
    """
    return '{}_{}_{}-{:03d}.png'.format(robot, kind, when.strftime('%Y-%m-%d-%H-%M-%S'),
                                        when.microsecond // 1000)


def bandwidth_text(bits_per_s):
    """Return a bandwidth in megabytes (10^6) a second, e.g. "0.8 MB/s", "0.04 MB/s"."""
    megabytes = bits_per_s / 8e6
    return '{:.{}f} MB/s'.format(megabytes, 1 if megabytes >= 0.0995 else 2)


def rate_text(status, slowed=None):
    """Return the displayed rate in words, and the reason if it is limited.

    A limit of the camera budget is given in its words: "thinned to 2 Hz: camera budget".

    :param slowed: (maximum rate [Hz], robot that is in front instead); None: not limited
    """
    if status.thinned:
        return status.thinned
    if slowed is None or status.rate_hz <= slowed[0]:
        return '{:.1f} Hz'.format(status.rate_hz)
    return '{:g} Hz: {} is in front'.format(*slowed)


def stream_text(status, slowed=None):
    """Return a :class:`StreamStatus` as a line of figures; '' before the first picture.

    :param slowed: see :func:`rate_text`
    """
    if status.age_s is None:
        return ''
    parts = [rate_text(status, slowed), words.age_text(status.age_s) + ' old',
             bandwidth_text(status.bits_per_s), status.transport]
    if status.bad:
        parts.append('{:,} bad: {}'.format(status.bad, status.problem).rstrip(': '))
    return '  '.join(parts)


def source_text(status, frame):
    """Return where the displayed picture is from, or why there is none, in terms of ROS."""
    if frame is None:
        return status.detail
    if frame.grey_range is None:
        return status.source
    low, high = frame.grey_range
    digits = max(0, math.ceil(2.0 - math.log10(high - low)))
    return '{}\nblack is {:.{}f}, white is {:.{}f}'.format(
        status.source, low, digits, high, digits)


def shorter_stream_texts(text):
    """Return ever shorter versions of a :func:`stream_text`, down to the rate alone."""
    parts = text.split('  ')
    return tuple('  '.join(parts[:count]) for count in range(len(parts) - 1, 0, -1))


def stream_warning(status):
    """Return the warning across a picture that is no longer live; '' while it is.

    The first line is the warning itself, the second one the reason, if known.
    """
    if status.age_s is None or not (
            status.stale or status.age_s > status.old_after_s):
        return ''
    warning = 'OLD PICTURE, {}'.format(words.age_text(status.age_s))
    reason = status.problem or status.thinned
    return '{}\n{}'.format(warning, reason) if reason else warning


class CameraView(WithTools):
    """Shows pictures and marks old ones; the choice of topics is not made here.

    Child widgets: ``picture``, ``stream_label``, ``transport_combo``, ``still_button``.
    """

    #: the displayed picture is to be saved as a file: its Frame
    still_requested = Signal(object)
    #: name of a transport, or 'auto'
    transport_chosen = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        #: the kind of picture: 'rgb', 'depth' or None
        self.kind = None
        self._chosen = {}
        self._status_pace = Pace()
        self._old = False
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the widgets."""
        self.setObjectName('camera_view')
        #: the widget with the picture, as a tile uses it
        self.canvas = self.picture = PictureView(self)
        self.status_sign = Sign(self)
        self.stream_label = TextLine(self)
        self.stream_label.setObjectName('stream_label')
        self.stream_label.setFont(theme.number_font(self.font()))
        self.transport_combo = Combo(self)
        self.still_button = Button('Save still', self)
        for widget, name, spoken in (
                (self.transport_combo, 'transport_combo', 'how the picture is sent'),
                (self.still_button, 'still_button', 'save this picture as a PNG file')):
            theme.for_fingers(widget, name, spoken, spoken)
        self.transport_combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.transport_combo.setMinimumContentsLength(8)
        self.transport_combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._note_timer = QTimer(self, singleShot=True, interval=NOTE_MS)
        self.lay_out(self.picture, (self.stream_label, 3), (self.status_sign, 0),
                     (self.transport_combo, 1), (self.still_button, 0))

    def _connect(self):
        """Connect the controls."""
        self.still_button.clicked.connect(self._on_still)
        self.transport_combo.activated[int].connect(self._on_transport)

    def _restore(self):
        """Set the initial state, without a picture."""
        self.show_kind(None)

    def save_settings(self):
        """Return the settings kept between runs, an empty dict."""
        return {}

    def restore_settings(self, settings):
        """Restore a dict of :meth:`save_settings`."""

    def show_kind(self, kind):
        """Switch to another kind of picture ('rgb', 'depth', None); clear the old one at once."""
        self.kind = kind
        self._old = False
        self.show_transports(())
        self.picture.show_warning('')
        self.picture.clear(WAITING if kind else '', kind == DEPTH)
        self.still_button.setEnabled(False)
        if not self._note_timer.isActive():
            self._show_line(None, '')

    def show_placeholder(self, text):
        """Show why there is no picture, e.g. "bot1 has no topic camera/rgb/image_raw"."""
        if self.picture.frame is None:
            self.picture.clear(text, self.kind == DEPTH)

    def show_frame(self, frame):
        """Show a :class:`Frame`; ignore late ones of another kind."""
        if frame.kind == self.kind:
            self.picture.show_frame(frame)
            self.still_button.setEnabled(True)

    def show_status(self, status, slowed=None):
        """Show a :class:`StreamStatus`; numbers at most four times a second.

        Call it at every redraw, with or without a new frame, since it marks an old picture.

        :param slowed: see :func:`rate_text`
        """
        warning = stream_warning(status)
        old = bool(warning)
        if not self._status_pace.due() and old == self._old:
            return
        self._old = old
        self.picture.show_warning(warning if self.picture.frame is not None else '')
        if self.picture.frame is None and status.problem:
            self.show_placeholder(status.problem)
        self.picture.setToolTip(plain_tip(source_text(status, self.picture.frame)))
        if not self._note_timer.isActive():
            trouble = old or (status.bad and status.problem)
            text = stream_text(status, slowed)
            self._show_line(theme.WARNING if trouble else None, text,
                            () if status.bad else shorter_stream_texts(text))

    def show_note(self, text, good=True):
        """Show a sentence in the status line for a while, e.g. the path of a still."""
        self._note_timer.start()
        self._show_line((theme.TICK, theme.LIVE) if good else theme.WARNING, text)

    def _show_line(self, sign, text, shorter=()):
        """Show a line with a sign."""
        self.status_sign.show_sign(sign)
        self.stream_label.show_text(text, shorter=shorter)

    def show_transports(self, names):
        """Offer 'auto', the present transports, and the chosen one even if it is absent."""
        chosen = self._chosen.get(self.kind, AUTO)
        offer(self.transport_combo, [(name, name) for name in dict.fromkeys(
            (AUTO, *names, chosen))], chosen)

    def camera_size(self):
        """Return the size (width, height) for a picture, in pixels of the screen."""
        size = self.picture.size_on_screen()
        return size.width(), size.height()

    def _on_still(self):
        """Request a still of the displayed picture."""
        if self.picture.frame is not None:
            self.still_requested.emit(self.picture.frame)

    def _on_transport(self, index):
        """Store the choice for this kind of picture, and emit :attr:`transport_chosen`."""
        self._chosen[self.kind] = self.transport_combo.itemText(index)
        self.transport_chosen.emit(self._chosen[self.kind])

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's camera: the picture, how its stream does, which transport, and a still."""
from python_qt_binding.QtCore import QTimer, Qt, Signal
from python_qt_binding.QtWidgets import (
    QComboBox, QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout, QWidget)

from mhri.base.gui import theme, words
from mhri.base.gui.labels import plain_tip, Sign, TextLine
from mhri.base.gui.pending import Pace
from mhri.camera.gui.picture import PictureView
from mhri.camera.images import DEPTH

AUTO = 'auto'
STATUS_PERIOD_S = 0.25
NOTE_MS = 6000
WAITING = 'waiting for the first picture'


def still_name(robot, kind, when):
    """Return the file name of a still, e.g. "bot1_rgb_2026-11-21-14-02-11-250.png".

    :param kind: 'rgb' or 'depth'
    :param when: ``datetime`` of the picture; to the millisecond, so that two are never one
    """
    return '{}_{}_{}-{:03d}.png'.format(robot, kind, when.strftime('%Y-%m-%d-%H-%M-%S'),
                                        when.microsecond // 1000)


def bandwidth_text(bits_per_s):
    """Return a bandwidth in megabytes (10^6) a second, e.g. "0.8 MB/s", "0.04 MB/s"."""
    megabytes = bits_per_s / 8e6
    return '{:.{}f} MB/s'.format(megabytes, 1 if megabytes >= 0.0995 else 2)


def rate_text(status, slowed=None):
    """Return how often a new picture shows, and why not as often as it comes.

    A rate that the camera budget holds back is said in its words: "thinned to 2 Hz: camera budget".

    :param slowed: (rate at most [Hz], robot that is in front instead); None: as often as it comes
    """
    if status.thinned:
        return status.thinned
    if slowed is None or status.rate_hz <= slowed[0]:
        return '{:.1f} Hz'.format(status.rate_hz)
    return '{:g} Hz: {} is in front'.format(*slowed)


def stream_text(status, slowed=None):
    """Return a :class:`StreamStatus` as a line of figures; '' before a picture.

    :param slowed: see :func:`rate_text`
    """
    if status.age_s is None:
        return ''
    parts = [rate_text(status, slowed), words.age_text(status.age_s) + ' old',
             bandwidth_text(status.bits_per_s), status.transport]
    if status.bad:
        parts.append('{:,} bad: {}'.format(status.bad, status.problem).rstrip(': '))
    return '  '.join(parts)


def shorter_stream_texts(text):
    """Return a :func:`stream_text` in fewer and fewer words: at last the rate alone."""
    parts = text.split('  ')
    return tuple('  '.join(parts[:count]) for count in range(len(parts) - 1, 0, -1))


def stream_warning(status):
    """Return what is said across a picture that is not live any more; '' while it is.

    The first line is the warning itself, a second one the reason where it is known.
    """
    if status.age_s is None or not (
            status.stale or status.age_s > status.old_after_s):
        return ''
    warning = 'OLD PICTURE, {}'.format(words.age_text(status.age_s))
    reason = status.problem or status.thinned
    return '{}\n{}'.format(warning, reason) if reason else warning


class CameraView(QWidget):
    """Shows what it is given, marks what is old; decides nothing about topics.

    Child widgets: ``picture``, ``stream_label``, ``transport_combo``, ``still_button``.
    """

    #: the picture on show shall be kept as a file: its Frame
    still_requested = Signal(object)
    #: name of a transport, or 'auto'
    transport_chosen = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._kind = None
        self._chosen = {}
        self._status_pace = Pace(STATUS_PERIOD_S)
        self._old = False
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('camera_view')
        self.picture = PictureView(self)
        self.status_sign = Sign(self)
        self.stream_label = TextLine(self)
        self.stream_label.setObjectName('stream_label')
        self.stream_label.setFont(theme.number_font(self.font()))
        self.transport_combo = QComboBox(self)
        self.still_button = QPushButton('Save still', self)
        self.still_button.setAutoDefault(False)
        for widget, name, spoken in (
                (self.transport_combo, 'transport_combo', 'how the picture is sent'),
                (self.still_button, 'still_button', 'save this picture as a PNG file')):
            widget.setObjectName(name)
            widget.setAccessibleName(spoken)
            widget.setToolTip(spoken)
            widget.setFocusPolicy(Qt.TabFocus)
            widget.setMinimumHeight(theme.touch_size(self))
        self.transport_combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.transport_combo.setMinimumContentsLength(8)
        self.transport_combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self._note_timer = QTimer(self)
        self._note_timer.setSingleShot(True)
        self._note_timer.setInterval(NOTE_MS)
        self._tools = QWidget(self)
        line = QHBoxLayout(self._tools)
        line.setContentsMargins(0, 4, 0, 0)
        line.setSpacing(6)
        line.addWidget(self.stream_label, 3)
        line.addWidget(self.status_sign)
        line.addWidget(self.transport_combo, 1)
        line.addWidget(self.still_button)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.picture, 1)
        column.addWidget(self._tools)

    def _connect(self):
        """Wire the controls."""
        self.still_button.clicked.connect(self._on_still)
        self.transport_combo.activated[int].connect(self._on_transport)

    def _restore(self):
        """Begin without a picture."""
        self.show_kind(None)

    def show_tools(self, shown):
        """Show the stream's figures and the controls below the picture, or the picture alone."""
        self._tools.setVisible(shown)

    def save_settings(self):
        """Return what is kept between runs: nothing, since what there is changes."""
        return {}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`."""

    @property
    def kind(self):
        """What is to be seen: 'rgb', 'depth' or None."""
        return self._kind

    def show_kind(self, kind, text=WAITING):
        """Change to another kind of picture ('rgb', 'depth', None); the old one goes at once."""
        self._kind = kind
        self._old = False
        self.show_transports(())
        self.picture.show_warning('')
        self.picture.clear(text if kind else '', kind == DEPTH)
        self.still_button.setEnabled(False)
        if not self._note_timer.isActive():
            self._say(None, '')

    def show_placeholder(self, text):
        """Say why there is no picture, e.g. "bot1 has no topic camera/rgb/image_raw"."""
        if self.picture.frame is None:
            self.picture.clear(text, self._kind == DEPTH)

    def show_frame(self, frame):
        """Show a :class:`Frame`; one of another kind than is wanted comes late."""
        if frame.kind == self._kind:
            self.picture.show_frame(frame)
            self.still_button.setEnabled(True)

    def show_status(self, status, slowed=None):
        """Show a :class:`StreamStatus`; numbers four times a second at most.

        :param slowed: see :func:`rate_text`

        Call it at every drawing, with or without a new frame: it is what tells old from live.
        """
        warning = stream_warning(status)
        old = bool(warning)
        if not self._status_pace.due() and old == self._old:
            return
        self._old = old
        self.picture.show_warning(warning if self.picture.frame is not None else '')
        if self.picture.frame is None and status.problem:
            self.show_placeholder(status.problem)
        self.picture.setToolTip(plain_tip(status.detail if self.picture.frame is None else ''))
        if not self._note_timer.isActive():
            trouble = old or (status.bad and status.problem)
            text = stream_text(status, slowed)
            self._say((theme.TRIANGLE, theme.ATTENTION) if trouble else None, text,
                      () if status.bad else shorter_stream_texts(text))

    def show_note(self, text, good=True):
        """Show a sentence in the status line for a while, e.g. where a still went."""
        self._note_timer.start()
        self._say((theme.TICK, theme.LIVE) if good else (theme.TRIANGLE, theme.ATTENTION), text)

    def _say(self, sign, text, shorter=()):
        """Show a line with its sign."""
        self.status_sign.show_sign(sign)
        self.stream_label.show_text(text, shorter=shorter)

    def show_transports(self, names):
        """Offer what there is now; 'auto' comes first, and what was chosen stays, there or not."""
        chosen = self._chosen.get(self._kind, AUTO)
        offered = list(dict.fromkeys((AUTO, *names, chosen)))
        combo = self.transport_combo
        if offered != [combo.itemText(index) for index in range(combo.count())]:
            if combo.view().isVisible():
                return
            combo.clear()
            combo.addItems(offered)
        if not combo.view().isVisible():
            combo.setCurrentIndex(offered.index(chosen))

    def camera_size(self):
        """Return (width, height) that a picture has room for, in pixels of the screen."""
        size = self.picture.room().size() * self.devicePixelRatioF()
        return size.width(), size.height()

    def _on_still(self):
        """Hand on the picture on show."""
        if self.picture.frame is not None:
            self.still_requested.emit(self.picture.frame)

    def _on_transport(self, index):
        """Keep a choice for this kind of picture, and tell of it."""
        self._chosen[self._kind] = self.transport_combo.itemText(index)
        self.transport_chosen.emit(self._chosen[self._kind])

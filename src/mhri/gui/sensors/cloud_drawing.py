# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws clouds beside the GUI thread, which a large one would hold up: newest wish only."""
import threading

from python_qt_binding.QtCore import QObject, Signal

from mhri.core.sensors.cloud_picture import CloudArtist


class CloudDrawing(QObject):
    """One view's drawings, on a thread that is there while there is something to draw.

    It has no parent: its thread keeps it until the last drawing is done, whatever becomes of the
    view. The end of the program waits for that, some hundredths of a second: a thread that is cut
    off within OpenCV or Qt takes the program down with an abort.
    """

    #: a :class:`mhri.core.sensors.cloud_picture.Picture`
    drawn = Signal(object)
    #: why a cloud could not be drawn
    failed = Signal(str)

    def __init__(self):
        super().__init__()
        self._lock = threading.Lock()
        self._wish = None
        self._running = False
        self._artist = CloudArtist()

    def ask(self, cloud, orbit, size, colouring):
        """Ask for a picture; one that was asked for before and is not begun is forgotten.

        The arguments are those of :meth:`CloudArtist.draw`.
        """
        with self._lock:
            self._wish = (cloud, orbit, size, colouring)
            if not self._running:
                self._running = True
                threading.Thread(target=self._run, name='cloud drawing').start()

    @property
    def idle(self):
        """Whether all that was asked for has been drawn, or forgotten."""
        with self._lock:
            return not self._running

    def _run(self):
        """Draw what is wished for (the thread)."""
        while True:
            with self._lock:
                wish, self._wish = self._wish, None
                if wish is None:
                    self._running = False
                    return
            try:
                self.drawn.emit(self._artist.draw(*wish))
            except Exception as error:  # the guard of this thread
                self.failed.emit('this cloud cannot be drawn: {!r}'.format(error))

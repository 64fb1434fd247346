# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws clouds beside the GUI thread, which a large one would hold up: newest wish only."""
import threading

from python_qt_binding.QtCore import QObject, Signal

from mhri.core.sensors.cloud_picture import CloudArtist

# A thread without anything to draw ends after so long; the next wish starts another.
IDLE_S = 2.0


class CloudDrawing(QObject):
    """One view's drawings, on a thread that is there while there is something to draw.

    It has no parent: its thread keeps it until the last drawing is done, whatever becomes of the
    view.
    """

    #: a :class:`mhri.core.sensors.cloud_picture.Picture`
    drawn = Signal(object)
    #: why a cloud could not be drawn
    failed = Signal(str)

    def __init__(self):
        super().__init__()
        self._changed = threading.Condition()
        self._wish = None
        self._running = self._drawing = False
        self._artist = CloudArtist()

    def ask(self, cloud, orbit, size, colouring):
        """Ask for a picture; one that was asked for before and is not begun is forgotten.

        The arguments are those of :meth:`CloudArtist.draw`.
        """
        with self._changed:
            self._wish = (cloud, orbit, size, colouring)
            self._changed.notify_all()
            if not self._running:
                self._running = True
                threading.Thread(target=self._run, daemon=True, name='cloud drawing').start()

    @property
    def idle(self):
        """Whether all that was asked for has been drawn, or forgotten."""
        with self._changed:
            return self._wish is None and not self._drawing

    def _run(self):
        """Draw what is wished for (the thread)."""
        while True:
            with self._changed:
                self._drawing = False
                self._changed.wait_for(lambda: self._wish is not None, IDLE_S)
                wish, self._wish = self._wish, None
                self._drawing = wish is not None
                if wish is None:
                    self._running = False
                    return
            try:
                self.drawn.emit(self._artist.draw(*wish))
            except Exception as error:  # the guard of this thread
                self.failed.emit('this cloud cannot be drawn: {!r}'.format(error))

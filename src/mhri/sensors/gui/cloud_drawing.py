# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws clouds beside the GUI thread, which a large one would hold up: newest wish only."""
import threading

from mhri.sensors.cloud_picture import CloudArtist


class CloudDrawing:
    """One view's drawings, on a thread that is there while there is something to draw.

    The thread touches nothing of Qt: a signal of it would take the program down where the
    application is gone by then. The end of the program waits for it, some hundredths of a second:
    a thread that is cut off within OpenCV does the same.
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._wish = None
        self._done = None
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
        """Whether all that was asked for has been drawn or forgotten, and taken."""
        with self._lock:
            return not self._running and self._done is None

    def take(self):
        """Return the newest :class:`mhri.sensors.cloud_picture.Picture` once, else None.

        :raises ValueError: the cloud could not be drawn
        """
        with self._lock:
            done, self._done = self._done, None
        if isinstance(done, Exception):
            raise ValueError('this cloud cannot be drawn: {!r}'.format(done))
        return done

    def _run(self):
        """Draw what is wished for (the thread)."""
        while True:
            with self._lock:
                wish, self._wish = self._wish, None
                if wish is None:
                    self._running = False
                    return
            try:
                done = self._artist.draw(*wish)
            except Exception as error:  # the guard of this thread
                done = error
            with self._lock:
                self._done = done

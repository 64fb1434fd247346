# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws clouds off the GUI thread, which a large one would block: only the newest request."""
import threading

from mhri.sensors.cloud_picture import CloudArtist


class CloudDrawing:
    """The drawings of one view, on a thread that exists only while there is something to draw.

    The thread does not touch Qt: a signal emitted after the end of the application would crash the
    program. The program waits for the thread at its end, some hundredths of a second, since a
    thread killed within OpenCV crashes it as well.
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._next = None
        self._done = None
        self._running = False
        self._artist = CloudArtist()

    def ask(self, cloud, orbit, size, colouring):
        """Request a picture; it replaces a request that has not been started yet.

        The arguments are those of :meth:`CloudArtist.draw`.
        """
        with self._lock:
            self._next = (cloud, orbit, size, colouring)
            if not self._running:
                self._running = True
                threading.Thread(target=self._run, name='cloud drawing').start()

    @property
    def idle(self):
        """Whether every requested picture has been drawn and taken, or replaced."""
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
        """Draw the requested pictures (the thread)."""
        while True:
            with self._lock:
                job, self._next = self._next, None
                if job is None:
                    self._running = False
                    return
            try:
                done = self._artist.draw(*job)
            except Exception as error:  # the guard of this thread
                done = error
            with self._lock:
                self._done = done

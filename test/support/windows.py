# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Windows of other programs: found, looked at, and closed as a click on their cross does."""
import ctypes
import subprocess

import cv2
import numpy as np
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QFontMetrics, QImage, QPainter

from support.panel_session import pixels

_CLIENT_MESSAGE = 33
_ALIKE = 0.85


class _Event(ctypes.Structure):
    """``XClientMessageEvent`` of Xlib.h, as long as an ``XEvent``."""

    _fields_ = [('type', ctypes.c_int), ('serial', ctypes.c_ulong), ('sent', ctypes.c_int),
                ('display', ctypes.c_void_p), ('window', ctypes.c_ulong),
                ('message', ctypes.c_ulong), ('format', ctypes.c_int),
                ('data', ctypes.c_long * 5), ('rest', ctypes.c_long * 24)]


def windows_called(title):
    """Return the ids of the windows on show whose titles have these words in them."""
    done = subprocess.run(['xdotool', 'search', '--onlyvisible', '--name', title],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=60)
    return [int(number) for number in done.stdout.split()]


def close(window):
    """Ask a window to close, as the window manager does for the operator."""
    xlib = ctypes.CDLL('libX11.so.6')
    xlib.XOpenDisplay.restype = display_type = ctypes.c_void_p
    xlib.XInternAtom.restype = ctypes.c_ulong
    display = display_type(xlib.XOpenDisplay(None))
    atom = [xlib.XInternAtom(display, name, 0) for name in (b'WM_PROTOCOLS', b'WM_DELETE_WINDOW')]
    event = _Event(type=_CLIENT_MESSAGE, window=window, message=atom[0], format=32)
    event.data[0] = atom[1]
    xlib.XSendEvent(display, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(event))
    xlib.XCloseDisplay(display)


def times_written(window, text, font):
    """Return how often a text can be read in a window, bright on dark in a font.

    :param font: the ``QFont``
    """
    done = subprocess.run(['import', '-window', str(window), 'png:-'], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, timeout=120)
    if done.returncode:
        return 0
    seen = cv2.imdecode(np.frombuffer(done.stdout, np.uint8), cv2.IMREAD_COLOR).max(axis=2)
    metrics = QFontMetrics(font)
    image = QImage(metrics.horizontalAdvance(text) + 2, metrics.height(), QImage.Format_RGB888)
    image.fill(Qt.black)
    painter = QPainter(image)
    painter.setFont(font)
    painter.setPen(Qt.white)
    painter.drawText(0, metrics.ascent(), text)
    painter.end()
    shape = pixels(image).max(axis=2)
    likeness = cv2.matchTemplate(seen, shape, cv2.TM_CCOEFF_NORMED)
    count, _ = cv2.connectedComponents((likeness > _ALIKE).astype(np.uint8))
    return count - 1

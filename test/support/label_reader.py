# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a distance such as "1.83 m" off a picture of the screen, by the shapes of its digits."""
import cv2
import numpy as np
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QFontMetrics, QImage, QPainter

from support.panel_session import pixels

_ALIKE = 0.9


class Unreadable(Exception):
    """There is no distance to be read in the picture."""


class DistanceReader:
    """Reads white figures on dark ground.

    :param font: the ``QFont`` they are written in
    """

    def __init__(self, font):
        self._font = font
        self._digits = {digit: self._drawn(digit) for digit in '0123456789'}

    def _drawn(self, text):
        """Return how a text looks: grey levels, cut to its ink with a margin of a pixel."""
        metrics = QFontMetrics(self._font)
        image = QImage(metrics.horizontalAdvance(text) + 8, metrics.height() + 8,
                       QImage.Format_RGB888)
        image.fill(Qt.black)
        painter = QPainter(image)
        painter.setFont(self._font)
        painter.setPen(Qt.white)
        painter.drawText(4, 4 + metrics.ascent(), text)
        painter.end()
        grey = pixels(image).max(axis=2)
        rows, columns = np.flatnonzero(grey.max(axis=1)), np.flatnonzero(grey.max(axis=0))
        return grey[rows[0] - 1:rows[-1] + 2, columns[0] - 1:columns[-1] + 2]

    def read(self, seen):
        """Return the distance [m] in a picture (h, w, 3) of the screen.

        :raises Unreadable: there is none, or not just one
        """
        grey = seen.max(axis=2)
        found = []
        for digit, shape in self._digits.items():
            likeness = cv2.matchTemplate(grey, shape, cv2.TM_CCOEFF_NORMED)
            found += [(float(likeness[y, x]), int(x), digit)
                      for y, x in zip(*np.nonzero(likeness > _ALIKE))]
        kept = []
        least = 0.5 * QFontMetrics(self._font).horizontalAdvance('0')
        for likeness, x, digit in sorted(found, reverse=True):
            if all(abs(x - other) > least for other, _ in kept):
                kept.append((x, digit))
        digits = ''.join(digit for _, digit in sorted(kept))
        if len(digits) not in (3, 4):
            raise Unreadable('digits {!r}'.format(digits))
        text = '{}.{} m'.format(digits[:-2], digits[-2:])
        # The whole, with its point and its unit, has to look like that, too.
        likeness = float(cv2.matchTemplate(grey, self._drawn(text), cv2.TM_CCOEFF_NORMED).max())
        if likeness < _ALIKE:
            raise Unreadable('{!r} only to {:.2f}'.format(text, likeness))
        return float(text[:-2])

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawer's settings of the screen: layout, colours, numbers, map, full screen."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QComboBox, QGridLayout, QLabel

from mhri.base.gui import theme
from mhri.base.gui.choices import IgnoresWheel
from mhri.base.gui.controls import Combo
from mhri.base.gui.layouts import add_parts
from mhri.base.gui.page import Page
from mhri.base.gui.switches import SwitchBox
from mhri.base.gui.text_size import SIZES
from mhri.screen.arrangement import ALIKE, AUTO, ONE

TITLE = 'Screen'
LAYOUTS = {AUTO: 'Enlarge driven robots', ONE: 'One large, the others small',
           ALIKE: 'All alike'}


class _Choice(IgnoresWheel, Combo):
    """A drop-down of settings."""


class LooksPage(Page):
    """Drop-downs ``layout_choice``, ``theme_choice``, ``text_choice``, check boxes, a button."""

    #: a key of :data:`LAYOUTS`
    layout_chosen = Signal(str)
    #: a key of :data:`mhri.base.gui.theme.THEMES`
    theme_chosen = Signal(str)
    #: one of :data:`mhri.base.gui.text_size.SIZES` [%]
    text_chosen = Signal(int)

    def __init__(self, parent=None):
        super().__init__('looks_page', parent)
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self._grid = QGridLayout()
        self._grid.setHorizontalSpacing(2 * theme.GRID)
        self._grid.setColumnStretch(1, 1)
        self.layout_choice = self._choice('layout_choice', 'Pictures', LAYOUTS)
        self.theme_choice = self._choice('theme_choice', 'Colours', theme.THEMES)
        self.text_choice = self._choice('text_choice', 'Text size', {
            percent: '{} %'.format(percent) for percent in SIZES})
        self.numbers_box = SwitchBox('Numbers over the pictures (H)', self)
        self.numbers_box.setObjectName('numbers_box')
        self.map_box = SwitchBox('Map (M)', self)
        self.map_box.setObjectName('map_box')
        self.full_screen_button = theme.finger_button(
            self, 'full_screen_button', 'Full screen (F11)')
        self.column.setSpacing(2 * theme.GRID)
        add_parts(self.column, self._grid, self.numbers_box, self.map_box,
                  (self.full_screen_button, 0, Qt.AlignLeft))

    def _choice(self, name, label, texts):
        """Place a drop-down of {key: text} beside its label."""
        combo = theme.for_fingers(_Choice(self), name, label)
        combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        combo.setMinimumContentsLength(10)
        for key, text in texts.items():
            combo.addItem(text, key)
        row = self._grid.rowCount()
        self._grid.addWidget(QLabel(label, self), row, 0)
        self._grid.addWidget(combo, row, 1)
        return combo

    def _connect(self):
        """Connect the choices of the operator, not changes by the program."""
        self.layout_choice.activated[int].connect(
            lambda _: self.layout_chosen.emit(self.layout_choice.currentData()))
        self.theme_choice.activated[int].connect(
            lambda _: self.theme_chosen.emit(self.theme_choice.currentData()))
        self.text_choice.activated[int].connect(
            lambda _: self.text_chosen.emit(self.text_choice.currentData()))

    def show_choices(self, layout, theme_name, numbers, percent):
        """Show the current settings; ``percent`` is the text size."""
        for combo, key in ((self.layout_choice, layout), (self.theme_choice, theme_name),
                           (self.text_choice, percent)):
            combo.setCurrentIndex(combo.findData(key))
        self.numbers_box.setChecked(numbers)

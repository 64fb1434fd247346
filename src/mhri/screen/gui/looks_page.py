# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the drawer that says how the screen looks: layout, colours, numbers, full screen."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import (
    QButtonGroup, QFrame, QLabel, QScrollArea, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.switches import SwitchBox, SwitchRadio
from mhri.base.gui.wide_scroll_bar import WideScrollBar
from mhri.screen.arrangement import ALIKE, AUTO, ONE

TITLE = 'Screen'
LAYOUTS = {AUTO: 'Those that drive together large', ONE: 'One large, the others small',
           ALIKE: 'All alike'}


class LooksPage(QScrollArea):
    """Radio buttons ``layout_<name>`` and ``theme_<name>``, a check box and a button.

    It scrolls where it is not high enough: the drawer is not to be higher because of it.
    """

    #: a key of :data:`LAYOUTS`
    layout_chosen = Signal(str)
    #: a key of :data:`mhri.base.gui.theme.THEMES`
    theme_chosen = Signal(str)
    #: whether the numbers over the pictures are to be seen
    numbers_chosen = Signal(bool)
    #: whether the map is to be seen
    map_chosen = Signal(bool)
    #: in or out of full screen
    full_screen_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('looks_page')
        self.setFont(theme.base_font(self.font()))
        self.setFrameShape(QFrame.NoFrame)
        self.setFocusPolicy(Qt.NoFocus)
        self.setWidgetResizable(True)
        self.setVerticalScrollBar(WideScrollBar(self))
        self.setWidget(QWidget(self))
        column = QVBoxLayout(self.widget())
        column.setContentsMargins(0, 0, 0, 0)
        self._layouts = self._choices(column, 'Pictures', 'layout_', LAYOUTS)
        self._themes = self._choices(column, 'Colours', 'theme_', theme.THEMES)
        self.numbers_box = SwitchBox('Numbers over the pictures (H)', self)
        self.numbers_box.setObjectName('numbers_box')
        self.map_box = SwitchBox('Map (M)', self)
        self.map_box.setObjectName('map_box')
        self.full_screen_button = theme.finger_button(
            self, 'full_screen_button', 'Full screen (F11)')
        column.addSpacing(self.fontMetrics().height() // 2)
        column.addWidget(self.numbers_box)
        column.addWidget(self.map_box)
        column.addWidget(self.full_screen_button, 0, Qt.AlignLeft)
        column.addStretch(1)

    def _choices(self, column, head, prefix, texts):
        """Place a heading and a radio button for each of some texts; return them by key."""
        label = QLabel(head, self)
        label.setFont(theme.larger(self.font(), 1.1, bold=True))
        column.addWidget(label)
        group, buttons = QButtonGroup(self), {}
        for key, text in texts.items():
            button = buttons[key] = SwitchRadio(text, self)
            button.setObjectName(prefix + key)
            button.setAccessibleName('{}: {}'.format(head, text))
            keep_arrows(button)
            group.addButton(button)
            column.addWidget(button)
        column.addSpacing(self.fontMetrics().height() // 2)
        return buttons

    def _connect(self):
        """Wire the switches; only clicks count, not what is shown."""
        for buttons, signal in ((self._layouts, self.layout_chosen),
                                (self._themes, self.theme_chosen)):
            for key, button in buttons.items():
                button.clicked.connect(lambda *_, key=key, signal=signal: signal.emit(key))
        self.numbers_box.clicked.connect(self.numbers_chosen)
        self.map_box.clicked.connect(self.map_chosen)
        self.full_screen_button.clicked.connect(self.full_screen_requested)

    def add_part(self, title, part):
        """Give the page a further part, above the others; return the button that shows it."""
        button = theme.finger_button(self, '', title)
        button.setCheckable(True)
        column = self.widget().layout()
        column.insertWidget(0, button, 0, Qt.AlignLeft)
        column.insertWidget(1, part)
        part.hide()
        button.toggled.connect(part.setVisible)
        return button

    def show_choices(self, layout, theme_name, numbers):
        """Show what is in force."""
        self._layouts[layout].setChecked(True)
        self._themes[theme_name].setChecked(True)
        self.numbers_box.setChecked(numbers)

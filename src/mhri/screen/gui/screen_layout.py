# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Places the parts of the screen: the drawer at the left, the stage, the foot with STOP ALL."""
from python_qt_binding.QtCore import QEvent, QObject, Qt, Signal
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtWidgets import QLayout

from mhri.base.gui import theme
from mhri.base.gui.text_size import change_text_size, SIZES, text_percent, usual_size
from mhri.base.part import SETUP
from mhri.screen.arrangement import AUTO
from mhri.screen.gui.drawer import Drawer
from mhri.screen.gui.foot import PassingBars
from mhri.screen.gui.looks_page import LAYOUTS, LooksPage, TITLE
from mhri.screen.gui.stage import MAP_BESIDE, MAP_CLOSED, MAP_LARGE


class ScreenLayout(QObject):
    """Places the parts of a screen, depending on its size and the pictures on its stage.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    #: a theme was chosen: its name
    theme_chosen = Signal(str)
    #: the text size before and now [%]; the screen has it already
    text_size_changed = Signal(int, int)

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._busy = False
        self._layout = AUTO
        self._text_percent, self._text_chosen = text_percent(), False
        #: name of the current theme
        self.theme = theme.DARK
        self._build()
        self._connect()

    def _build(self):
        """Set properties that a form cannot contain."""
        screen = self._screen
        # Allow very small sizes, at which parts are shrunk.
        screen.layout().setSizeConstraint(QLayout.SetNoConstraint)
        theme.apply(screen, self.theme)
        # Within rqt its background would have the colours of the desktop.
        screen.setAutoFillBackground(True)
        self.drawer = Drawer(screen)
        screen.stop_bar.place_beside(screen.words, screen.control_bar, screen.small)
        self.passing = PassingBars(screen)
        self.passing.add(screen.leave_bar)
        self.looks = LooksPage(screen)
        self.add_section(SETUP, TITLE, self.looks, 10, 'monitor')
        self._show_choices()

    def _connect(self):
        """Connect changes to the layout."""
        screen = self._screen
        screen.installEventFilter(self)
        screen.stage.rearranged.connect(self.arrange)
        self.drawer.toggled.connect(self.arrange)
        self.drawer.resized.connect(self.arrange)
        self.looks.layout_chosen.connect(self.choose_layout)
        self.looks.theme_chosen.connect(self.choose_theme)
        self.looks.text_chosen.connect(self.choose_text_size)
        self.looks.numbers_box.clicked.connect(self.show_numbers)
        self.looks.map_box.clicked.connect(self.show_map)
        screen.stage.map_changed.connect(self._show_choices)
        self.looks.full_screen_button.clicked.connect(self.change_full_screen)

    def choose_layout(self, name):
        """Choose the layout of the pictures: a style of the arrangement."""
        self._layout = name
        self._screen.stage.set_style(name)
        self._show_choices()

    def choose_theme(self, name):
        """Apply a theme to the screen."""
        self.theme = name
        theme.apply(self._screen, name)
        self._show_choices()
        self.theme_chosen.emit(name)

    def choose_text_size(self, percent):
        """Set the text size [%], one of :data:`mhri.base.gui.text_size.SIZES`; it is kept."""
        self._text_chosen = True
        self._set_text_size(percent)

    def _set_text_size(self, percent):
        """Set the text size of the screen [%]."""
        before, self._text_percent = self._text_percent, percent
        if percent != before:
            change_text_size(self._screen, before, percent)
            self.drawer.scale(percent / before)
            self.text_size_changed.emit(before, percent)
        self._show_choices()

    def begin_text_size(self):
        """Begin with larger text on a monitor that the desktop was not set up for."""
        if not self._text_chosen and self._text_percent == 100:
            self._set_text_size(usual_size(QGuiApplication.primaryScreen().geometry().height(),
                                           self._screen.fontMetrics().height()))

    def show_numbers(self, shown):
        """Show or hide the numbers over the pictures."""
        self._screen.stage.show_numbers(shown)
        self._show_choices()

    def show_map(self, shown):
        """Show the map beside the pictures, or large if there is no room; or close it."""
        stage = self._screen.stage
        stage.show_map(MAP_BESIDE if shown else MAP_CLOSED)
        if shown and not stage.map_shown:
            stage.show_map(MAP_LARGE)

    def change_full_screen(self):
        """Toggle full screen."""
        window = self._screen.window()
        window.setWindowState(window.windowState() ^ Qt.WindowFullScreen)

    def _show_choices(self):
        self.looks.show_choices(self._layout, self.theme, self._screen.stage.numbers_shown,
                                self._text_percent)
        self.looks.map_box.setChecked(self._screen.stage.map_shown)

    def begin_with_robots(self):
        """Start with the drawer closed if it would take too much of the width."""
        self.drawer.begin_with_robots()
        self.arrange()

    def add_section(self, job, title, part, order=0, icon='', is_open=False):
        """Add a section to the drawer, with the parameters of :meth:`Drawer.add_section`."""
        return self.drawer.add_section(job, title, part, order, icon, is_open)

    def show_page(self, part):
        """Open the drawer at a part of one of its pages."""
        self.drawer.show_page(part)

    def change_focus(self):
        """Cycle the keyboard focus: pictures, panel, foot."""
        screen = self._screen
        focus = screen.window().focusWidget()
        if focus is not None and screen.foot.isAncestorOf(focus):
            screen.stage.setFocus(Qt.TabFocusReason)
        elif focus is not None and screen.drawer.isAncestorOf(focus):
            next(button for button in (
                screen.stop_bar.release_button, screen.control_bar.take_button,
                screen.events_button) if button.isVisible()).setFocus(Qt.TabFocusReason)
        else:
            screen.drawer_button.setChecked(True)
            screen.robot_list.setFocus(Qt.TabFocusReason)

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow size and font of the screen."""
        if event.type() in (QEvent.Resize, QEvent.Show, QEvent.FontChange, QEvent.LayoutRequest):
            self.arrange()
        return False

    def arrange(self):
        """Adapt drawer and questions to the size."""
        if self._busy:
            return
        self._busy = True
        try:
            screen = self._screen
            self.drawer.bound()
            self.drawer.begin()
            screen.side.setVisible(self.drawer.is_open)
            self.passing.place()
            self.looks.map_box.setChecked(screen.stage.map_shown)
        finally:
            self._busy = False

    def save_settings(self):
        """Return the saved state."""
        chosen = {'text': self._text_percent} if self._text_chosen else {}
        return {'layout': self._layout, 'theme': self.theme, **chosen,
                'numbers': self._screen.stage.numbers_shown, **self.drawer.save_settings()}

    def restore_settings(self, settings):
        """Apply a dict of :meth:`save_settings`."""
        # First, because the width of the drawer follows the text.
        if settings.get('text') in SIZES:
            self.choose_text_size(settings['text'])
        self.drawer.restore_settings(settings)
        if settings.get('layout') in LAYOUTS:
            self.choose_layout(settings['layout'])
        if settings.get('theme') in theme.THEMES:
            self.choose_theme(settings['theme'])
        self.show_numbers(settings.get('numbers', True) is not False)

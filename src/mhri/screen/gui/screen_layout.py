# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the parts of the screen are: the drawer at the left, the stage, the foot with STOP ALL."""
from python_qt_binding.QtCore import QEvent, QObject, Qt, Signal
from python_qt_binding.QtWidgets import QLayout

from mhri.base.gui import theme
from mhri.screen.arrangement import AUTO
from mhri.screen.gui.foot import COLUMN, Foot
from mhri.screen.gui.looks_page import LAYOUTS, LooksPage, TITLE
from mhri.screen.gui.scrolled_page import ScrolledPage
from mhri.screen.gui.stage import MAP_BESIDE, MAP_CLOSED, MAP_LARGE

ROBOTS, DRIVE = 'Robots', 'Drive'
# Width of the drawer at first, in heights of a line.
_DRAWER_UNITS = 22.0
# It begins closed where robots are known and it would take more than this of the width.
_DRAWER_SHARE = 1 / 3
# What the list has beyond its least height where robots and driving share a page.
_LIST_UNITS = 6.0
# Where the virtual joystick is.
_IN_DRAWER, _OVER_PICTURE, _IN_COLUMN = range(3)


class ScreenLayout(QObject):
    """Moves the parts of a screen; it follows its size and that of its stage.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    #: a theme was chosen: its name
    theme_chosen = Signal(str)

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._tall = True
        self._stick, self._stick_wanted = _IN_DRAWER, False
        self._busy = False
        self._begins_closed = self._drawer_chosen = False
        self._fits_at = 0
        self._layout, self._theme = AUTO, theme.DARK
        self._build()
        self._connect()

    def _build(self):
        """Set what a form cannot say."""
        screen = self._screen
        # It becomes as small as it is made: the parts give way before the screen does.
        screen.layout().setSizeConstraint(QLayout.SetNoConstraint)
        theme.apply(screen, self._theme)
        # Within rqt it lies on a ground that has the colours of the desktop.
        screen.setAutoFillBackground(True)
        screen.tabs.addTab(ROBOTS)
        screen.tabs.setExpanding(False)
        # Hidden at first, it would think that it has no tabs.
        screen.tabs.setMinimumHeight(theme.touch_size(screen))
        screen.tabs.setDrawBase(False)
        screen.tabs.setFocusPolicy(Qt.TabFocus)
        screen.tabs.setAccessibleName('Pages of the panel')
        unit = screen.fontMetrics().height()
        screen.splitter.setSizes([round(_DRAWER_UNITS * unit), screen.width()])
        screen.splitter.setStretchFactor(0, 0)
        screen.splitter.setStretchFactor(1, 1)
        screen.drawer_button.setChecked(True)
        screen.drawer_button.setFocusPolicy(Qt.TabFocus)
        screen.drawer_button.setMinimumHeight(theme.touch_size(screen))
        self._drive_scroll = ScrolledPage(screen)
        screen.drive_page_column.addWidget(self._drive_scroll)
        self.foot = Foot(screen)
        self.looks = LooksPage(screen)
        self.add_page(TITLE, self.looks)
        self._show_choices()

    def _connect(self):
        """Follow what changes."""
        screen = self._screen
        screen.installEventFilter(self)
        screen.stage.rearranged.connect(self.arrange)
        screen.tabs.currentChanged.connect(self._turn)
        screen.drawer_button.toggled.connect(self._show_drawer)
        screen.splitter.splitterMoved.connect(lambda *_: self.arrange())
        self.looks.layout_chosen.connect(self.choose_layout)
        self.looks.theme_chosen.connect(self.choose_theme)
        self.looks.numbers_chosen.connect(self.show_numbers)
        self.looks.map_chosen.connect(self.show_map)
        screen.stage.map_changed.connect(self._show_choices)
        self.looks.full_screen_requested.connect(self.change_full_screen)

    def choose_layout(self, name):
        """Lay the pictures out in one of the ways of the arrangement."""
        self._layout = name
        self._screen.stage.set_style(name)
        self._show_choices()

    @property
    def theme(self):
        """Name of the theme in force."""
        return self._theme

    def choose_theme(self, name):
        """Give the screen the look of a theme."""
        self._theme = name
        theme.apply(self._screen, name)
        self._show_choices()
        self.theme_chosen.emit(name)

    def show_numbers(self, shown):
        """Show the numbers over the pictures, or the pictures alone."""
        self._screen.stage.show_numbers(shown)
        self._show_choices()

    def show_map(self, shown):
        """Show the map beside the pictures, or large where there is no room there; or close it."""
        stage = self._screen.stage
        stage.show_map(MAP_CLOSED if not shown else
                       MAP_BESIDE if stage.has_room_beside() else MAP_LARGE)

    def change_full_screen(self):
        """Go into full screen, or out of it."""
        window = self._screen.window()
        window.setWindowState(window.windowState() ^ Qt.WindowFullScreen)

    def _show_choices(self):
        self.looks.show_choices(self._layout, self._theme, self._screen.stage.numbers_shown)
        self.looks.map_box.setChecked(self._screen.stage.map_state != MAP_CLOSED)

    @property
    def drawer_open(self):
        """Whether the drawer is open."""
        return self._screen.drawer_button.isChecked()

    def begin_with_robots(self):
        """Begin with the drawer closed where it would take too much of the width."""
        self._begins_closed = not self._drawer_chosen
        self.arrange()

    def add_page(self, title, page, second=False):
        """Give the drawer a further page; ``second``: right behind those for driving."""
        screen = self._screen
        place = screen.pages.indexOf(screen.drive_page) + 1 if second else screen.pages.count()
        screen.pages.insertWidget(place, page)
        screen.tabs.insertTab(self._pages().index(page), title)

    def show_page(self, page):
        """Open the drawer at a page."""
        self._screen.drawer_button.setChecked(True)
        pages = self._pages()
        if page in pages:
            self._screen.tabs.setCurrentIndex(pages.index(page))

    def change_focus(self):
        """Take the keyboard from the pictures to the panel, from there to the foot, and back."""
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

    def _pages(self):
        """Return the pages in the order of the tabs."""
        screen = self._screen
        pages = [screen.pages.widget(index) for index in range(screen.pages.count())]
        return [page for page in pages if page is not screen.drive_page or not self._tall]

    def _turn(self, index):
        """Show the page of a tab."""
        pages = self._pages()
        if 0 <= index < len(pages):
            self._screen.pages.setCurrentWidget(pages[index])

    def _show_drawer(self, shown):
        """Open or close the drawer."""
        screen = self._screen
        self._drawer_chosen, self._begins_closed = True, False
        screen.drawer.setVisible(shown)
        if not shown and screen.drawer.isAncestorOf(screen.focusWidget() or screen):
            screen.stage.setFocus()
        self.arrange()

    def show_stick(self, wanted):
        """Let the virtual joystick be beside or over the pictures where no drawer shows it."""
        self._stick_wanted = wanted
        self._place_stick()

    def _place_stick(self):
        """Put the virtual joystick where it belongs, unless somebody holds it."""
        screen, wanted = self._screen, self._stick_wanted
        in_drawer = self.drawer_open and (
            screen.pages.currentWidget() is (screen.robots_page if self._tall
                                             else screen.drive_page))
        place = _IN_DRAWER if in_drawer or not wanted or not screen.stage.names else \
            _IN_COLUMN if self.foot.has_room_for_stick() else _OVER_PICTURE
        if screen.joystick.dragging:
            return
        if place == self._stick:
            screen.stage.place_float()
            return
        self._stick = place
        screen.stage.show_float(screen.joystick if place == _OVER_PICTURE else None)
        if place == _IN_COLUMN:
            screen.foot_column.insertWidget(1, screen.joystick, 3)
        elif place == _IN_DRAWER:
            screen.drive_side.layout().insertWidget(1, screen.joystick, 1)
        screen.joystick.show()

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow the size of the screen and its font."""
        if event.type() in (QEvent.Resize, QEvent.Show, QEvent.FontChange, QEvent.LayoutRequest):
            self.arrange()
        return False

    def arrange(self):
        """Place foot and drawer anew."""
        if self._busy:
            return
        self._busy = True
        try:
            self._arrange()
        finally:
            self._busy = False

    def _arrange(self):
        screen = self._screen
        if self._begins_closed and screen.isVisible() and self._fits_at != screen.width():
            if screen.splitter.sizes()[0] > _DRAWER_SHARE * screen.width():
                screen.drawer_button.setChecked(False)
                # Nobody has asked for it.
                self._drawer_chosen = False
            elif sum(screen.splitter.sizes()):
                # What grows in it later, such as a question, does not close it under a hand.
                self._fits_at = screen.width()
        is_open = self.drawer_open
        side = max(screen.drawer.minimumSizeHint().width(), screen.splitter.sizes()[0]) \
            if is_open else 0
        place = self.foot.choose(side)
        if place != self.foot.place and not screen.joystick.dragging:
            self.foot.move(place)
            self._place_stick()
        self.foot.fit()
        screen.side.setVisible(is_open)
        if self.foot.place != COLUMN:
            self._fit_drawer(screen.height() - screen.foot.sizeHint().height())

    def _fit_drawer(self, height):
        """Have robots and driving on one page where both fit, else on two."""
        screen = self._screen
        needed = screen.tabs.sizeHint().height() + 24 + round(
            _LIST_UNITS * screen.fontMetrics().height()) + sum(
            part.minimumSizeHint().height() for part in (screen.robots_side, screen.drive_side))
        if self._stick != _IN_DRAWER:
            needed += screen.joystick.minimumSizeHint().height()
        tall = height >= needed
        if tall == self._tall or screen.joystick.dragging:
            return
        self._tall = tall
        if tall:
            current = screen.tabs.currentIndex()
            screen.robots_page_column.addWidget(self._drive_scroll.takeWidget())
            screen.tabs.removeTab(1)
            screen.tabs.setCurrentIndex(max(0, current - 1))
        else:
            self._drive_scroll.setWidget(screen.drive_side)
            screen.tabs.insertTab(1, DRIVE)
        screen.drive_side.show()
        self._turn(screen.tabs.currentIndex())

    def save_settings(self):
        """Return what is kept between runs."""
        chosen = {'drawer': self.drawer_open} if self._drawer_chosen else {}
        return {'splitter': self._screen.splitter.sizes(), 'layout': self._layout,
                'theme': self._theme, 'numbers': self._screen.stage.numbers_shown, **chosen}

    def restore_settings(self, settings):
        """Take back what :meth:`save_settings` returned."""
        if len(settings.get('splitter', ())) == self._screen.splitter.count():
            self._screen.splitter.setSizes(settings['splitter'])
        if 'drawer' in settings:
            self._screen.drawer_button.setChecked(settings['drawer'] is not False)
            self._drawer_chosen = True
        if settings.get('layout') in LAYOUTS:
            self.choose_layout(settings['layout'])
        if settings.get('theme') in theme.THEMES:
            self.choose_theme(settings['theme'])
        self.show_numbers(settings.get('numbers', True) is not False)

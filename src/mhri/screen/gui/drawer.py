# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawer at the left of the screen: a page for each job, in sections that fold."""
from python_qt_binding.QtCore import QObject, Qt, Signal

from mhri.base.gui import theme
from mhri.base.gui.page import Section, SectionPage
from mhri.base.part import MISSION, ROBOTS, SETUP

#: the pages, in order: (job, title, icon)
PAGES = ((ROBOTS, 'Robots', 'bot'), (MISSION, 'Mission', 'route'),
         (SETUP, 'Setup', 'sliders-horizontal'))
ADD, DRIVING = 'Add robots', 'Driving'
# Initial width of the drawer [line heights].
_UNITS = 22.0
# With known robots, the drawer starts closed if it needs more than this share of the width.
_SHARE = 1 / 3
# On a narrow screen its pages scroll sideways rather than leave less for the pictures: it takes at
# most this share of the width, or up to so much [px] while that is half of it.
_MOST, _MOST_PX = 0.4, 400


class Drawer(QObject):
    """Opens and closes the drawer of a screen, and turns its pages.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    #: it was opened or closed
    toggled = Signal()
    #: its width changed
    resized = Signal()

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._pages = {}
        self._begins_closed = self._chosen = False
        self._fits_at = 0
        self._build()
        screen.tabs.currentChanged.connect(screen.pages.setCurrentIndex)
        screen.drawer_button.toggled.connect(self._show)
        screen.splitter.splitterMoved.connect(lambda *_: self.resized.emit())

    def _build(self):
        """Set properties that a form cannot contain."""
        screen = self._screen
        for job, title, icon in PAGES:
            page = self._pages[job] = SectionPage(screen)
            screen.pages.addWidget(page)
            screen.tabs.setTabData(screen.tabs.addTab(title), icon)
        screen.tabs.setExpanding(True)
        screen.tabs.setDrawBase(False)
        screen.tabs.setFocusPolicy(Qt.TabFocus)
        screen.tabs.setAccessibleName('Pages of the drawer')
        unit = screen.fontMetrics().height()
        screen.splitter.setSizes([round(_UNITS * unit), screen.width()])
        screen.splitter.setStretchFactor(0, 0)
        screen.splitter.setStretchFactor(1, 1)
        screen.drawer_button.setChecked(True)
        screen.drawer_button.setFocusPolicy(Qt.TabFocus)
        screen.drawer_button.setMinimumHeight(theme.touch_size(screen))
        self.add_section(ROBOTS, '', screen.robots_side)
        self._adding = self.add_section(ROBOTS, ADD, screen.add_side, 20, 'plus', is_open=True)
        self.add_section(SETUP, DRIVING, screen.drive_side, 0, 'gamepad-2', is_open=True)

    @property
    def is_open(self):
        """Whether it is open."""
        return self._screen.drawer_button.isChecked()

    def add_section(self, job, title, part, order=0, icon='', is_open=False):
        """Add a section to the page of a job; return the :class:`Section`.

        :param job: ROBOTS, MISSION or SETUP of :mod:`mhri.base.part`
        :param title: of the row that folds it; '' for a section that is always open
        :param part: a widget with a layout
        :param order: its place on the page, from above
        :param icon: name of an icon of :mod:`mhri.base.gui.icons`
        :param is_open: whether it is open at first
        """
        page = self._pages[job]
        section = Section(title, icon, part, order, page.widget())
        section.open(is_open)
        page.add(section)
        return section

    @property
    def sections(self):
        """All sections, page by page, from above."""
        return tuple(section for page in self._pages.values() for section in page.sections)

    def show_page(self, part):
        """Open it at a part that was added to one of its pages; the part is unfolded."""
        self._screen.drawer_button.setChecked(True)
        for place, page in enumerate(self._pages.values()):
            for section in page.sections:
                if section.part is part:
                    self._screen.tabs.setCurrentIndex(place)
                    page.reveal(section)

    def begin_with_robots(self):
        """Start without the fields to add robots, and closed if it takes too much of the width."""
        self._adding.open(False)
        self._begins_closed = not self._chosen

    def bound(self):
        """Leave the pictures their share of the width of the screen."""
        side, splitter = self._screen.side, self._screen.splitter
        before, wide = side.maximumWidth(), self._screen.width()
        most = round(max(_MOST * wide, min(0.5 * wide + 1.0, _MOST_PX)))
        now, wanted = splitter.sizes()[0], round(_UNITS * self._screen.fontMetrics().height())
        side.setMaximumWidth(most)
        if now > most or now == before < min(wanted, most):
            splitter.setSizes([min(wanted, most), wide])

    def begin(self):
        """Close it at the start if it takes too much of the width."""
        screen = self._screen
        if not self._begins_closed or not screen.isVisible() or self._fits_at == screen.width():
            return
        if screen.splitter.sizes()[0] > _SHARE * screen.width():
            screen.drawer_button.setChecked(False)
            # This was not the operator's choice.
            self._chosen = False
        elif sum(screen.splitter.sizes()):
            # So that a part that grows later, such as a question, does not close it.
            self._fits_at = screen.width()

    def _show(self, shown):
        """Open or close it."""
        screen = self._screen
        self._chosen, self._begins_closed = True, False
        screen.drawer.setVisible(shown)
        if not shown and screen.drawer.isAncestorOf(screen.focusWidget() or screen):
            screen.stage.setFocus()
        self.toggled.emit()

    def scale(self, factor):
        """Make it wider with its text, as far as the width of the screen allows."""
        splitter = self._screen.splitter
        sizes = splitter.sizes()
        if sizes[0]:
            wide = round(factor * sizes[0])
            splitter.setSizes([wide, sum(sizes) - wide])

    def save_settings(self):
        """Return the saved state."""
        chosen = {'drawer': self.is_open} if self._chosen else {}
        return {'splitter': self._screen.splitter.sizes(), **chosen}

    def restore_settings(self, settings):
        """Apply a dict of :meth:`save_settings`."""
        if len(settings.get('splitter', ())) == self._screen.splitter.count():
            self._screen.splitter.setSizes(settings['splitter'])
        if 'drawer' in settings:
            self._screen.drawer_button.setChecked(settings['drawer'] is not False)
            self._chosen = True

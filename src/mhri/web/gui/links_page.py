# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The links to the page, which are given and taken back here, and who is watching."""
from functools import partial

from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme
from mhri.base.gui.choices import IgnoresWheel, offer
from mhri.base.gui.controls import Combo, LineField
from mhri.base.gui.labels import plain_label, SignedText, TextLine
from mhri.base.gui.layouts import add_parts, in_column, in_row, TIGHT
from mhri.base.gui.page import Page
from mhri.base.gui.switches import SwitchBox
from mhri.web.view import CHOICES, DRIVE, HOURS, NO_VIEWERS, NOT_RUNNING, USUAL_HOURS, WATCH

TITLE = 'Watch and drive from elsewhere'
_LONGEST = 40


class _Combo(IgnoresWheel, Combo):
    """A drop-down on a page that scrolls."""


class _Row(QWidget):
    """A link or a viewer: its name and its buttons, below them what else is known of it.

    :param buttons: (object name, text, function without arguments) of each
    """

    def __init__(self, parent, buttons):
        super().__init__(parent)
        self._name, self._words = TextLine(self), plain_label(self)
        self._name.setFont(theme.larger(self.font(), theme.BODY, bold=True))
        self.buttons = [theme.finger_button(self, name, text, room=0.5)
                        for name, text, _ in buttons]
        for button, (_, _, act) in zip(self.buttons, buttons):
            button.clicked.connect(lambda _, act=act: act())
        in_column(in_row((self._name, 1), *self.buttons, gap=2 * theme.GRID), self._words, of=self,
                  margins=TIGHT, gap=0)

    def show_texts(self, name, words):
        """Show a name and the words below it."""
        self._name.show_text(name)
        if words != self._words.text():
            self._words.setText(words)
        for button in self.buttons:
            button.setAccessibleName('{}: {}'.format(button.text(), name))


class LinksPage(Page):
    """Values in (:meth:`show_web`, :meth:`show_answer`), signals out.

    Child widgets: ``web_choice``, ``web_hours``, ``web_name``, ``web_head``, ``web_new_button``; a
    ``web_code_button`` and a ``web_take_button`` for each link, a ``web_away_button`` for each
    viewer.
    """

    #: (key of CHOICES, for whom, whether a headset turns the camera, hours) of a new link
    new_requested = Signal(str, str, bool, int)
    #: id of a link to take back, or of a viewer to send away
    take_requested = Signal(str)
    #: id of a link whose code is to be shown
    code_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__('links_page', parent)
        self._links, self._viewers = {}, {}
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.address = plain_label(self)
        self.address.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.problem, self.answer = SignedText(self), SignedText(self)
        self.choice = theme.for_fingers(_Combo(self), 'web_choice', 'What the link allows')
        self.hours = theme.for_fingers(_Combo(self), 'web_hours', 'How long it is valid')
        offer(self.choice, [(words, key) for key, (words, *_) in CHOICES.items()], WATCH)
        offer(self.hours, [(words, hours) for hours, words in HOURS.items()], USUAL_HOURS)
        self.name = theme.for_fingers(LineField(self, maxLength=_LONGEST), 'web_name',
                                      'For whom the link is')
        self.name.setPlaceholderText('For whom?')
        self.name.setFocusPolicy(Qt.StrongFocus)
        self.head = theme.for_fingers(
            SwitchBox('Headset may turn the camera', self), 'web_head',
            tip='the camera of the robot looked at follows the head, where it can pan and tilt')
        self.new_button = theme.finger_button(self, 'web_new_button', 'New link').set_icon('plus')
        self._heads = [plain_label(self, text, bold=True) for text in ('Links', 'Watching now')]
        self._nobody = plain_label(self, NO_VIEWERS)
        self._of_links, self._of_viewers = (in_column(margins=TIGHT, gap=theme.GRID)
                                            for _ in range(2))
        self.body = QWidget(self)
        in_column(in_row((self.choice, 3), (self.hours, 2)), self.name, self.head,
                  self.new_button, self._heads[0], self._of_links, self._heads[1], self._nobody,
                  self._of_viewers, of=self.body, margins=TIGHT, gap=2 * theme.GRID)
        self.column.setSpacing(2 * theme.GRID)
        add_parts(self.column, self.address, self.problem, self.body, self.answer)

    def _connect(self):
        """Wire the controls."""
        self.choice.currentIndexChanged.connect(lambda _: self._show_head())
        for asked in (self.new_button.clicked, self.name.returnPressed):
            asked.connect(self._ask)

    def _restore(self):
        """Start without a server."""
        self.show_answer('')
        self._show_head()

    def _ask(self):
        """Request a new link."""
        self.new_requested.emit(
            self.choice.currentData(), self.name.text().strip(),
            self.head.isEnabled() and self.head.isChecked(), self.hours.currentData())
        self.name.clear()

    def _show_head(self):
        """Offer to turn the camera only with a link to drive."""
        self.head.setEnabled(self.choice.currentData() == DRIVE)

    def show_answer(self, text, good=True):
        """Show the outcome of a request; hide it if the text is empty."""
        self.answer.show_text(text, not good)
        self.answer.setVisible(bool(text))

    def show_web(self, view, now_s, known=()):
        """Show a :class:`mhri.web.view.WebView`.

        :param now_s: time of day [s since 1970]
        :param known: ids of the links whose code can be shown
        """
        address = view.address if view.there else NOT_RUNNING
        if address != self.address.text():
            self.address.setText(address)
        self.problem.show_text(view.problem, True)
        self.problem.setVisible(view.there and bool(view.problem))
        self.body.setVisible(view.there)
        self._match(self._links, view.links, now_s, self._of_links, self._new_link)
        self._match(self._viewers, view.viewers, now_s, self._of_viewers, self._new_viewer)
        for key, row in self._links.items():
            row.buttons[0].setVisible(key in known)
        self._heads[0].setVisible(bool(self._links))
        self._nobody.setVisible(not self._viewers)

    def _match(self, rows, wanted, now_s, column, make):
        """Show a row for each link or viewer, and remove the others."""
        ids = [one.id for one in wanted]
        for key in [key for key in rows if key not in ids]:
            row = rows.pop(key)
            row.hide()
            row.deleteLater()
        for one in wanted:
            if one.id not in rows:
                rows[one.id] = make(one.id)
                column.addWidget(rows[one.id])
            rows[one.id].show_texts(one.label, one.words(now_s))

    def _new_link(self, key):
        return _Row(self.body, (
            ('web_code_button', 'Code', partial(self.code_requested.emit, key)),
            ('web_take_button', 'Take back', partial(self.take_requested.emit, key))))

    def _new_viewer(self, key):
        return _Row(self.body, (
            ('web_away_button', 'Send away', partial(self.take_requested.emit, key)),))

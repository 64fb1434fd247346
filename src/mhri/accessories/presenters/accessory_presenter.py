# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the accessories of robots with tiles, menu, keys and events, on the GUI thread.

What is held is repeated by a timer of this thread: while the screen hangs, nothing is repeated, and
the drive lets go.
"""
from functools import partial
import time

from python_qt_binding.QtCore import QElapsedTimer, QObject, QTimer
from python_qt_binding.QtGui import QCursor

from mhri.accessories.controls import (
    found, head_of, HELD_DOWN, key_page, next_choice, page_rows, PRESS, reported, use_words,
    why_not)
from mhri.accessories.gui.accessory_bar import AccessoryBar
from mhri.accessories.gui.look_drag import LookDrag
from mhri.base.accessories import HELD, POSITION, READOUT, TAP, TOGGLE
from mhri.base.part import Part
from mhri.base.reasons import is_code
from mhri.base.views import ScreenView
from mhri.driving.gui import robot_menu

# How often a held value is repeated, and after how long a hang of the screen it has ended [ms].
REPEAT_MS, HANG_MS = 50, 250
# An answer that comes later is about the act of somebody else [s].
_ANSWERED_S = 30.0
REPLAY = 'this is a replay'
UNKNOWN_STATE = 'it has not reported its state: choose it in the picture'
TITLE = 'Accessories\u2026'


class AccessoryPresenter(QObject, Part):
    """The accessories of all robots of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param use: function of (robots, key, choice, value) that uses an accessory
    :param tiles: {robot: its tile}, kept up to date by its owner
    :param note: function of (kind, text, robot, data) that reports an event
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen, context.backend.use_accessory, context.tiles.windows,
                   context.note)

    def __init__(self, screen, use, tiles, note):
        super().__init__(screen)
        self._screen, self._use, self._tiles, self._note = screen, use, tiles, note
        self._view = ScreenView()
        self._replay = False
        # {robot: (its bar, what it shows)}, {robot: its LookDrag}
        self._bars, self._drags = {}, {}
        # {(function that lets go of it, robot, key): (robots to act on, values)}
        self._held = {}
        # {(robot, key) of what was used once: until when an answer is about that [s]}
        self._asked = {}
        # {key of the second page: (robot in view when it was pressed, its control)}
        self._keys = {}
        self._timer = QTimer(self, interval=REPEAT_MS, timeout=self._repeat)
        self._since_repeat = QElapsedTimer()
        screen.drive_keys.page_changed.connect(self._on_keys)
        screen.robot_menu.offer(robot_menu.USE, self._menu_rows)

    def show_view(self, view):
        """Show the accessories of a :class:`mhri.base.views.ScreenView`."""
        self._view = view
        for robot in view.robots:
            tile = self._tiles.get(robot.name)
            bar, before = self._bars.get(robot.name, (None, ()))
            shown = self._shown(robot)
            if tile is None or not (shown or bar):
                continue
            if bar is None or tile.bar is not bar:
                bar, before = self._new_bar(robot.name, tile), ()
            if shown != before:
                self._bars[robot.name] = bar, shown
                bar.show_accessories(shown)
                self._drags[robot.name].show_head(self._free_head(robot))
        looked_at = self._screen.robot_in_view()
        self._screen.key_help.show_page(page_rows(looked_at, self._page_of(looked_at)))
        names = {robot.name for robot in view.robots}
        self._end_barred()
        self._show_answers()
        self._bars = {name: kept for name, kept in self._bars.items() if name in names}

    def _end_barred(self):
        """Release what may no longer act; it has to be pressed again."""
        for who in list(self._held):
            robot, view = self._find(*who[1:])
            if view is None or self._why(robot, view):
                self._end(who)
                who[0]()

    def _show_answers(self):
        """Say of what was used why it had no effect: the drive answers with a sentence."""
        for (name, key), until in list(self._asked.items()):
            _, view = self._find(name, key)
            refused = view is not None and view.stands and not is_code(view.stands)
            if view is None or refused or time.monotonic() > until:
                del self._asked[name, key]
            if refused:
                self._refuse(name, key, view.stands)

    def _shown(self, robot):
        """Return pairs (view, why it does not obey) of a robot."""
        return tuple((view, self._why(robot, view)) for view in robot.accessories)

    def _why(self, robot, view):
        """Return why an accessory does not obey, '' if it does."""
        if view.spec.kind == READOUT:
            return view.stands
        return REPLAY if self._replay else why_not(self._view, robot, view)

    def _new_bar(self, name, tile):
        """Give a tile its bar."""
        bar = AccessoryBar(name, self._screen.remote, self._rows_of, tile)
        bar.used.connect(partial(self._act, name))
        bar.held.connect(partial(self._hold, bar.release, name))
        bar.refused.connect(partial(self._refuse, name))
        bar.ran_out.connect(self._screen.stick_ran_out)
        tile.set_bar(bar)
        drag = self._drags[name] = LookDrag(tile)
        drag.limit.remote = self._screen.remote
        drag.ran_out.connect(self._screen.stick_ran_out)
        drag.held.connect(partial(self._on_drag, drag, name))
        return bar

    def _free_head(self, robot):
        """Return the head of a robot that obeys and, if it has a position, reports that; or None.

        A drag goes on from the position.
        """
        view = head_of(robot.accessories)
        there = view is not None and not self._why(robot, view) and (
            view.spec.mode != POSITION or len(view.value) == HELD[view.spec.kind])
        return view if there else None

    def _on_drag(self, drag, name, value):
        """Turn the head of a robot."""
        robot = next((robot for robot in self._view.robots if robot.name == name), None)
        view = head_of(robot.accessories) if robot else None
        if view is not None:
            self._hold(drag.release, name, view.spec.key, value)

    def _act(self, name, key, choice, team=False):
        """Use an accessory of a robot once.

        :param team: whether it counts for all selected robots, where its row says so
        """
        robot, view = self._obeying(name, key)
        if view is None:
            return
        robots = self._meant(robot, view, team)
        self._use(robots, key, choice, ())
        self._asked.update(dict.fromkeys(
            ((one, key) for one in robots or (name,)), time.monotonic() + _ANSWERED_S))
        self._note('accessory.used', use_words(view.spec, choice), name,
                   {'key': key, 'choice': choice})

    @staticmethod
    def _meant(robot, view, team):
        """Return the robots of an action, () for all that are selected."""
        return () if team and view.spec.team and robot.selected else (robot.name,)

    def _find(self, name, key):
        """Return (robot, accessory), each None if it is gone."""
        robot = next((robot for robot in self._view.robots if robot.name == name), None)
        return robot, found(robot, key) if robot is not None else None

    def _obeying(self, name, key):
        """Return (robot, accessory) if it obeys; else (None, None), after saying why."""
        robot, view = self._find(name, key)
        why = self._why(robot, view) if view is not None else ''
        if why:
            self._refuse(name, key, why)
        return (None, None) if why else (robot, view)

    def _refuse(self, name, key, why):
        """Say why an accessory does not act."""
        _, view = self._find(name, key)
        text = '{}: {}'.format(view.spec.label if view else key, why)
        self._screen.show_look_result('{}: {}'.format(name, text))
        self._note('accessory.refused', text, name, {'key': key})

    def _hold(self, let_go, name, key, value, team=False):
        """Hold an accessory at values; zeros release it.

        :param let_go: function that releases the control, called when it is released from here
        """
        who = let_go, name, key
        if not any(value):
            self._end(who)
            return
        robot, view = self._obeying(name, key)
        if view is None:
            return
        if who not in self._held:
            self._note('accessory.used', use_words(view.spec), name, {'key': key})
        if not self._timer.isActive():
            self._since_repeat.start()
            self._timer.start()
        self._held[who] = robots, value = self._meant(robot, view, team), value
        self._use(robots, key, '', value)

    def _end(self, who):
        """Release an accessory, if it is held."""
        robots, value = self._held.pop(who, ((), ()))
        if value:
            self._use(robots, who[2], '', (0.0,) * len(value))
        if not self._held:
            self._timer.stop()

    def holds(self, name, key):
        """Return whether an accessory of a robot, or of all selected ones, is held here.

        Call it on any thread.
        """
        return any(who[1:] == (name, key) or who[2] == key and not robots
                   for who, (robots, _) in self._held.copy().items())

    def _repeat(self):
        """Repeat what is held; after a hang it has to be pressed again."""
        if self._since_repeat.restart() >= HANG_MS:
            self._release_all()
        for (_, _, key), (robots, value) in self._held.items():
            self._use(robots, key, '', value)

    def _release_all(self):
        """Release everything."""
        for who in list(self._held):
            self._end(who)
            who[0]()

    def _page_of(self, name):
        """Return the second page of keys of a robot."""
        robot = next((robot for robot in self._view.robots if robot.name == name), None)
        return key_page(robot.accessories) if robot else {}

    def _on_keys(self, held):
        """Handle the keys of the second page that are held now, for the robot in view."""
        before, looked_at = self._keys, self._screen.robot_in_view()
        page = self._page_of(looked_at)
        self._keys = {key: before.get(key) or (looked_at, page[key]) for key in held
                      if key in before or key in page}
        for key in held.difference(before):
            if key in page and page[key].kind != HELD_DOWN:
                self._press(looked_at, page[key])
        for name, spec in dict.fromkeys(
                (name, control.spec) for name, control in (*before.values(), *self._keys.values())
                if control.kind == HELD_DOWN):
            values = [control.value for other, control in self._keys.values()
                      if (other, control.spec) == (name, spec)]
            value = tuple(max(-1.0, min(1.0, sum(part))) for part in zip(*values))
            self._hold(self._screen.drive_keys.end_page, name, spec.key,
                       value or (0.0,) * HELD[spec.kind], team=True)

    def _press(self, name, control):
        """Use a control by its key."""
        key = control.spec.key
        _, view = self._find(name, key)
        choice = control.choice if control.kind == PRESS else next_choice(view)
        if choice is None:
            self._refuse(name, key, UNKNOWN_STATE)
        else:
            self._act(name, key, choice, team=True)

    def _menu_rows(self, robot, _):
        """Return the row of a robot's menu that opens its accessories."""
        if not any(view.spec.kind != READOUT for view in robot.accessories):
            return []
        return [(TITLE, partial(self._open, self._rows_of(robot.name)))]

    def _open(self, rows):
        """Open a menu at the pointer."""
        robot_menu.popup(self._screen, rows, QCursor.pos(), 'accessory_menu')

    def _rows_of(self, name):
        """Return the rows of the menu of a robot's accessories."""
        robot = next((robot for robot in self._view.robots if robot.name == name), None)
        return [self._row(robot, view) for view in robot.accessories
                if view.spec.kind != READOUT] if robot else []

    def _row(self, robot, view):
        """Return the row of an accessory in the menu; choices open a menu of their own."""
        spec, why = view.spec, self._why(robot, view)
        if why:
            return '{}: {}'.format(spec.label, why), None
        if spec.kind in HELD:
            return '{}: hold it in the large picture'.format(spec.label), None
        act = partial(self._act, robot.name, spec.key)
        choice = next_choice(view) if spec.kind == TOGGLE else None
        if choice is not None:
            return '{}: {}'.format(use_words(spec), 'turn ' + choice), partial(act, choice)
        if spec.kind == TAP and len(spec.choices) == 1:
            return use_words(spec, spec.choices[0][0]), partial(act, spec.choices[0][0])
        state = ': ' + reported(view) if spec.kind != TAP else ''
        return spec.label + state + '\u2026', partial(self._open, [
            (word.replace('_', ' '), partial(act, word)) for word, _ in spec.choices])

    def disable(self):
        """Show states only: the screen shows a replay."""
        self._replay = True

    def close(self, forget=False):
        """Release everything."""
        self._release_all()

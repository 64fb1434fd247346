# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the backend and the widgets of the screen.

One of the few modules that use both. Everything here runs on the GUI thread; timers poll the
backend and never block.
"""
import gc
import time

from python_qt_binding.QtCore import QObject, QTimer
from python_qt_binding.QtWidgets import QApplication

from mhri.base.gui.words import remote_stick_texts
from mhri.base.names import tidy_name
from mhri.base.part import ScreenContext
from mhri.base.remote_display import HELD_S
from mhri.base.view_rows import load
from mhri.base.views import GONE, SILENT
from mhri.devices.ros.device_client import choose_device
from mhri.graph.ros.resources import resource_path
from mhri.robots.busy import close_question
from mhri.screen.gui.screen import ScreenWidget
from mhri.screen.parts import PARTS
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.screen.presenters.requests_presenter import RequestsPresenter
from mhri.screen.presenters.stop_watch import StopWatch
from mhri.screen.presenters.tiles_presenter import TilesPresenter
from mhri.screen.requests import ACCESSORY
from mhri.screen.saved_state import usable_state
from mhri.screen.why import WhyStill

LET_GO = ('stick let go: nothing came from the remote display for {:.0f} s; press the key, or take '
          'the stick, again'.format(HELD_S))
DRAW_MS = 50
# Minimum pause after a redraw, also on a busy computer.
REST_MS = 20
STICK_MS = 50
# Interval of repeating the selection; if this thread hangs, the operator's lease ends.
LEASE_MS = 500
# Creating a row takes about 3 ms, and a longer delay would be noticeable at the stick. Rows of a
# list too long for any screen are not created.
ADD_AT_ONCE, ADD_OUT_OF_SIGHT, MAX_IN_SIGHT = 3, 12, 50


class ScreenPresenter(QObject):
    """The screen and its tiles, for rqt or the standalone window.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`, started by :meth:`start`
    """

    #: parts of the screen: (key, class)
    rows = PARTS

    def __init__(self, operator, parent=None):
        super().__init__(parent)
        self.operator = operator
        self._to_add = []
        self._lost = set()
        self._over_budget = False
        self._why = WhyStill()
        self._mode = None
        self._closed = self._made = False
        self._build()
        self.requests = RequestsPresenter(operator, self.screen.show_look_result, self._select,
                                          self.tiles.recording_wish, self._mark,
                                          self.screen.robot_in_view)
        #: {key: :class:`mhri.base.part.Part`} of :attr:`rows`
        self.parts = {}
        context = ScreenContext(self.screen, operator, self.tiles, self.parts, self._select,
                                self.note, DrawGuard)
        for key, made_by in self.rows:
            self.parts[key] = load(made_by).of(context)
        self.screen.doctor_button.setVisible(
            self.screen.receivers(self.screen.doctor_requested) > 0)
        self._connect()

    @property
    def windows(self):
        """The tiles: {name: :class:`mhri.screen.gui.robot_tile.RobotTile`}."""
        return self.tiles.windows

    def _build(self):
        ui_dir = resource_path()
        self.screen = ScreenWidget(ui_dir)
        self.tiles = TilesPresenter(self.operator, self.screen.stage, ui_dir,
                                    self.screen.show_look_result, self)
        self._guard = DrawGuard(self.screen, self.screen.stop_bar.stop_button)
        QApplication.instance().installEventFilter(self.screen.drive_keys)
        self._draw_timer = QTimer(self, interval=DRAW_MS, timeout=self._draw_in_turn)
        self._stick_timer = QTimer(self, interval=STICK_MS, timeout=self._repeat_stick)
        self._lease_timer = QTimer(self, interval=LEASE_MS)
        self._stop_watch = StopWatch(self.operator.master_uri, self)

    def _connect(self):
        panel, operator = self.screen, self.operator
        panel.look_requested.connect(self._look)
        panel.arrangement.text_size_changed.connect(self.tiles.show_text_size)
        panel.arrangement.theme_chosen.connect(
            lambda *_: self.tiles.show_palette(panel.palette()))
        panel.add_requested.connect(self._add)
        panel.remove_steps.remove_requested.connect(self._remove)
        panel.remove_steps.undo_requested.connect(self._put_back)
        panel.record_requested.connect(self.requests.record)
        panel.stop_record_requested.connect(self.requests.stop_recording)
        panel.robot_list.selection_requested.connect(self._select)
        panel.drive_requested.connect(self._drive)
        self.tiles.clicked.connect(panel.look_at)
        self.tiles.menu_requested.connect(panel.robot_menu.open)
        self.tiles.drive_requested.connect(self._drive)
        self.tiles.closed.connect(self._leave)
        panel.mode_combo.mode_requested.connect(self._request_mode)
        panel.mode_combo.device_requested.connect(self._request_device)
        panel.stick_moved.connect(operator.send_stick)
        panel.speed_limits.limits_requested.connect(operator.request_limits)
        panel.speed_limits.together_requested.connect(operator.keep_together)
        panel.speed_limits.brake_requested.connect(operator.brake)
        panel.talk_requested.connect(operator.talk)
        panel.stop_requested.connect(operator.stop_all)
        panel.stop_robot_requested.connect(self._stop_robot)
        self.tiles.stop_robot_requested.connect(self._stop_robot)
        panel.stop_bar.release_requested.connect(operator.release)
        panel.stop_bar.power_cut_requested.connect(lambda: operator.set_motor_power(False))
        panel.control_bar.take_requested.connect(operator.take_control)
        panel.stick_ran_out.connect(lambda: self.note('stick.let_go', LET_GO))
        panel.robot_list.ask_requested.connect(operator.ask_for_control)
        self._lease_timer.timeout.connect(operator.repeat_selection)
        self._stop_watch.said.connect(panel.show_look_result)

    def start(self, robots=(), selected=()):
        """Start; return at once.

        :param robots: names to add to the list
        :param selected: names to add and select
        """
        self.operator.selection.numbers.assign((*robots, *selected))
        for name in dict.fromkeys((*robots, *selected)):
            if name not in self.operator.selection.robots:
                self._add(name)
        if selected:
            self._select(list(selected))
        if self.operator.selection.robots:
            self.screen.arrangement.begin_with_robots()
        self.operator.start()
        # Exclude all objects so far from garbage collection: a scan takes 60 ms, during which no
        # thread runs. Before, free the remains of closed screens of this program.
        gc.unfreeze()
        gc.collect()
        gc.freeze()
        self._draw_timer.start(REST_MS)
        self._stick_timer.start()
        self._lease_timer.start()
        if self.operator.speaks:
            self._stop_watch.start()
        for part in self.parts.values():
            part.start()
        if self.screen.remote:
            self.note('screen.remote', remote_stick_texts(self.screen.remote)[0])
        self.draw()

    def _draw_in_turn(self):
        """Draw or, every other time, create a missing tile; schedule the next turn.

        Never both in one turn, so that a click does not wait for both. All robots are added to the
        list before missing tiles are created.
        """
        begun = time.monotonic()
        self._made = self.tiles.lacks_one and not (self._made or self._to_add)
        self._guard.run(self.tiles.make_missing if self._made else self.draw)
        took_ms = round(1000 * (time.monotonic() - begun))
        self._draw_timer.setInterval(
            REST_MS if self.tiles.lacks_one or self._made else max(REST_MS, DRAW_MS - took_ms))

    def draw(self):
        """Show the newest values in the widgets."""
        few = len(self.operator.selection.robots) < MAX_IN_SIGHT
        for _ in range(min(len(self._to_add), ADD_AT_ONCE if few else ADD_OUT_OF_SIGHT)):
            self.operator.add(*self._to_add.pop(0))
        view = self.operator.view()
        for part in self.parts.values():
            view = part.amend(view)
        view = self._why.explain(view, self.screen.stick(), self.operator.clock(),
                                 self.screen.robot_in_view())
        self._mode = view.mode or self._mode
        self.screen.show_view(view)
        self._feel_losses(view)
        self.tiles.show_view(view, [name for name, _ in self._to_add])
        for part in self.parts.values():
            part.show_view(view)
        self.tiles.show_session(self.recorded_s)
        self._report_budget()
        for kind, value in self.operator.take_events():
            if kind == 'found':
                self._show_found(value)
            elif kind == 'single_stop':
                # Once the drive has seen the robot left out, selecting it ends its stop.
                self.operator.repeat_selection()
            elif kind != 'request':
                self.screen.show_look_result(value)
            elif view.control.ours:
                self._carry_out(*value)
        self.requests.report_ends()

    def _carry_out(self, action, names, key, choice):
        """Carry out an external request; report a refusal, or an accessory used, as an event."""
        refused = self.requests.carry_out(action, names, key, choice)
        if refused:
            self.note('request.refused', refused)
        elif action == ACCESSORY:
            for name in names or ('',):
                self.note('accessory.used', ' '.join(filter(None, (key, choice))), name,
                          {'key': key, 'choice': choice})

    def _report_budget(self):
        """Report once if the camera budget cannot be kept."""
        note = self.tiles.budget_note
        if note and not self._over_budget:
            self.note('camera.budget', note)
        self._over_budget = bool(note)

    def note(self, kind, text, robot='', data=None):
        """Pass an event to every part; for events that cannot be derived from views.

        :param kind: a key of :data:`mhri.events.events.KINDS`
        :param data: as in :class:`mhri.base.views.Change`
        """
        for part in self.parts.values():
            part.note(kind, text, robot, data)

    def _feel_losses(self, view):
        """Rumble the pad when a selected robot is lost."""
        lost = {robot.name for robot in view.robots
                if robot.selected and robot.link in (SILENT, GONE)}
        if lost - self._lost:
            self.operator.alarm()
        self._lost = lost

    def _repeat_stick(self):
        """Repeat the stick position; a source that is silent for 0.5 s counts as lost."""
        self.operator.send_stick(*self.screen.stick())

    def _look(self):
        self.screen.show_look_result('looking', busy=True)
        self.operator.look()

    def _show_found(self, found):
        """Show the result of a search; queue the live robots, to add a few per redraw."""
        new = [item.name for item in found.live]
        self.operator.selection.numbers.assign(new)
        self._to_add += [(name, found.facts[name]) for name in new]
        words = ['found {}'.format(', '.join(new)) if new else 'no new robots found']
        if found.leftovers:
            words.append('{}: registered, but nothing answers (switched off?), not added'.format(
                ', '.join(item.name for item in found.leftovers)))
        words += ['{}: {}'.format(item.name, item.problem) for item in found.refused]
        self.screen.show_look_result('; '.join(words))

    def _add(self, name):
        name = tidy_name(name)
        problem = self.operator.add(name)
        if problem:
            self.screen.show_name_problem(problem)
        else:
            self.screen.clear_name()
        self.draw()

    def _remove(self, name):
        """Stop a robot, remove it from the list, and end its recording."""
        self.operator.remove(name)
        recorded = self.requests.end_recording(name)
        self.tiles.drop(name)
        self.screen.remove_steps.offer_undo(name)
        if not recorded:
            self.screen.show_look_result('{} removed from the list'.format(name))
        self.draw()

    def _put_back(self, name):
        """Undo a removal: restore place, number and appearance, without selecting the robot."""
        if self.operator.add(name) is None:
            self.screen.show_look_result('{} is back'.format(name))
        self.draw()

    def asks_before_closing(self):
        """Return the question before closing the screen, '' while nothing drives or records."""
        # Not of a closed screen: the query would take the seat of the active one.
        return '' if self._closed else close_question(
            self.operator.view().robots, self.recorded_s is not None)

    @property
    def recorded_s(self):
        """The duration of the session's recording [s], None if not recording."""
        return next((part.recorded_s for part in self.parts.values()
                     if part.recorded_s is not None), None)

    def _mark(self):
        """Mark this moment."""
        for part in self.parts.values():
            part.mark()

    def _select(self, names):
        self.operator.select(names)
        self.draw()

    def _request_mode(self, name):
        self._mode = name
        self.operator.request_mode(name)

    def _request_device(self, source, name):
        """Select another pad; the mode is requested separately."""
        if self.operator.drives():
            self.operator.do(choose_device, source, name)

    def _drive(self, name):
        """Drive only this robot, and show it large."""
        if self.operator.drives():
            self.screen.look_at(name)
            self._select([name])

    def _stop_robot(self, name):
        """Stop this robot alone, at once, whoever is in control."""
        self.operator.stop_robots([name])
        self.draw()

    def _leave(self, name):
        """Deselect a robot whose window was closed; its zero command is sent at once."""
        self._select([other for other in self.operator.selection.selected if other != name])

    def save_state(self):
        """Return the saved state as a plain dict.

        Selection and speed limits are never saved, because they belong to the drive service.
        """
        places, looks, torn = self.tiles.save_state()
        selection = self.operator.selection
        state = {'robots': list(selection.robots), 'numbers': selection.numbers.kept(),
                 'mode': self._mode, 'windows': places, 'torn_off': torn, 'looks': looks,
                 'panel': self.screen.save_settings(),
                 **{key: part.save_settings() for key, part in self.parts.items()
                    if part.save_settings()}}
        return usable_state(state)[0]

    def restore_state(self, state):
        """Apply a dict of :meth:`save_state`; call it before :meth:`start`.

        :returns: descriptions of the unusable parts, which are ignored
        """
        state, problems = usable_state(state)
        self.operator.selection.numbers.restore(state.get('numbers', {}))
        self.operator.selection.numbers.assign(state.get('robots', []))
        for name in state.get('robots', []):
            self.operator.add(name)
        if state.get('mode'):
            self._mode = state['mode']
            self.operator.restore_mode(state['mode'])
        self.tiles.restore_state(state.get('windows', {}), state.get('looks', {}),
                                 state.get('torn_off', ()))
        self.screen.restore_settings(state.get('panel', {}))
        for key, part in self.parts.items():
            part.restore_settings(state.get(key, {}))
        return problems

    def close(self, forget=False):
        """Stop the robots first, then close everything; ``forget`` as in the backend."""
        if self._closed:
            return
        self._closed = True
        self._guard.end()
        self._draw_timer.stop()
        self._stick_timer.stop()
        self._lease_timer.stop()
        self.operator.close(forget)
        QApplication.instance().removeEventFilter(self.screen.drive_keys)
        self.screen.drive_keys.close()
        self.tiles.close()
        self._stop_watch.close()
        for part in self.parts.values():
            part.close(forget)

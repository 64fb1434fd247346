# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the two halves of the screen: the operator's ROS side and the widgets.

One of the few modules that know both. Everything here runs on the GUI thread; timers ask the
ROS side, and nothing waits for it.
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
from mhri.screen.presenters.event_host import EventHost
from mhri.screen.presenters.map_host import MapHost
from mhri.screen.presenters.requests_host import RequestsHost
from mhri.screen.presenters.stop_watch import StopWatch
from mhri.screen.presenters.task_host import TaskHost
from mhri.screen.presenters.tiles_host import TilesHost
from mhri.screen.saved_state import usable_state
from mhri.screen.why import WhyStill

LET_GO = ('stick let go: nothing came from the remote display for {:.0f} s; press the key, or take '
          'the stick, again'.format(HELD_S))
DRAW_MS = 50
# So long other things have their turn after a drawing, on a busy computer, too.
REST_MS = 20
STICK_MS = 50
# How often to repeat the selection: the operator's lease ends if this thread hangs.
LEASE_MS = 500
# A row takes about 3 ms to make: the operator would feel more at once at the stick. Of a list that
# is longer than any screen is high no rows are made.
ADD_AT_ONCE, ADD_OUT_OF_SIGHT, MOST_IN_SIGHT = 3, 12, 50


class ScreenHost(QObject):
    """The screen, its tiles and what feeds them; rqt and the standalone window hold one each.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`, started by :meth:`start`
    :param events: makes its :class:`mhri.screen.presenters.event_host.EventHost`
    :param tasks: its :class:`mhri.tasks.ros.tasks_client.TasksClient`, None for the usual
    """

    def __init__(self, operator, parent=None, events=EventHost, tasks=None):
        super().__init__(parent)
        self.operator = operator
        self._to_add = []
        self._lost = set()
        self._over_budget = False
        self._why = WhyStill()
        self._mode = None
        self._closed = self._made = False
        self._build()
        self.requests = RequestsHost(operator, self.screen.show_look_result, self._select,
                                     self.tiles.recording_wish, self._mark)
        self.events = events(operator.recordings.status, self.screen)
        self.tasks = TaskHost(operator, self.screen, self._select, self._note_task, tasks)
        self.map = MapHost(operator, self.screen, self.tasks)
        #: {key: :class:`mhri.base.part.Part`} of :data:`mhri.screen.parts.PARTS`
        self.parts = {}
        context = ScreenContext(self.screen, operator, self.events, self.tiles.save_stills,
                                self.parts)
        for key, made_by in PARTS:
            self.parts[key] = load(made_by).of(context)
        self.screen.doctor_button.setVisible(
            self.screen.receivers(self.screen.doctor_requested) > 0)
        self._connect()

    @property
    def windows(self):
        """The tiles: {name: :class:`mhri.screen.gui.bot_window.BotWindow`}."""
        return self.tiles.windows

    def _build(self):
        ui_dir = resource_path()
        self.screen = ScreenWidget(ui_dir)
        self.tiles = TilesHost(self.operator, self.screen.stage, ui_dir,
                               self.screen.show_look_result, self)
        self._guard = DrawGuard(self.screen)
        QApplication.instance().installEventFilter(self.screen.drive_keys)
        self._draw_timer = QTimer(self)
        self._draw_timer.setInterval(DRAW_MS)
        self._stick_timer = QTimer(self)
        self._stick_timer.setInterval(STICK_MS)
        self._lease_timer = QTimer(self)
        self._lease_timer.setInterval(LEASE_MS)
        self._stop_watch = StopWatch(self.operator.master_uri, self)

    def _connect(self):
        panel, operator = self.screen, self.operator
        panel.look_requested.connect(self._look)
        panel.arrangement.theme_chosen.connect(
            lambda *_: self.tiles.show_palette(panel.palette()))
        panel.add_requested.connect(self._add)
        panel.remove_requested.connect(self._remove)
        panel.remove_steps.undo_requested.connect(self._put_back)
        panel.record_requested.connect(self.requests.record)
        panel.stop_record_requested.connect(self.requests.stop_recording)
        panel.selection_requested.connect(self._select)
        panel.drive_requested.connect(self._drive)
        self.tiles.clicked.connect(panel.look_at)
        self.tiles.drive_requested.connect(self._drive)
        self.tiles.closed.connect(self._leave)
        self.tiles.carry_on_requested.connect(self.tasks.carry_on)
        panel.mode_requested.connect(self._request_mode)
        panel.mode_combo.device_requested.connect(self._request_device)
        panel.stick_moved.connect(operator.send_stick)
        panel.limits_requested.connect(operator.request_limits)
        panel.together_requested.connect(operator.keep_together)
        panel.speed_limits.brake_requested.connect(operator.brake)
        panel.talk_requested.connect(operator.talk)
        panel.stop_requested.connect(operator.stop_all)
        panel.release_requested.connect(operator.release)
        panel.power_cut_requested.connect(lambda: operator.set_motor_power(False))
        panel.control_requested.connect(operator.take_control)
        panel.stick_ran_out.connect(lambda: self.events.note('stick.let_go', LET_GO))
        panel.robot_list.ask_requested.connect(operator.controls.ask)
        self._draw_timer.timeout.connect(self._draw_in_turn)
        self._stick_timer.timeout.connect(self._repeat_stick)
        self._lease_timer.timeout.connect(operator.repeat_selection)
        self._stop_watch.said.connect(panel.show_look_result)

    def start(self, robots=(), selected=()):
        """Begin; returns at once.

        :param robots: names to add to the list
        :param selected: names to add and select
        """
        self.operator.selection.numbers.meet((*robots, *selected))
        for name in dict.fromkeys((*robots, *selected)):
            if name not in self.operator.selection.robots:
                self._add(name)
        if selected:
            self._select(list(selected))
        if self.operator.selection.robots:
            self.screen.arrangement.begin_with_robots()
        self.operator.start()
        # What is loaded by now stays: searching it takes the garbage collector 60 ms, during which
        # no thread runs. What closed screens of this program have left goes before.
        gc.unfreeze()
        gc.collect()
        gc.freeze()
        self._draw_timer.start(REST_MS)
        self._stick_timer.start()
        self._lease_timer.start()
        if self.operator.speaks:
            self._stop_watch.start()
        self.events.start()
        if self.screen.remote:
            self.events.note('screen.remote', remote_stick_texts(self.screen.remote)[0])
        self.draw()

    def _draw_in_turn(self):
        """Draw or, every other time, make a tile that is missing; say when it is time again.

        A click would have to wait for both at once. Robots are in the list before their tiles come.
        """
        begun = time.monotonic()
        self._made = self.tiles.lacks_one and not (self._made or self._to_add)
        self._guard.run(self.tiles.make_missing if self._made else self.draw)
        took_ms = round(1000 * (time.monotonic() - begun))
        self._draw_timer.setInterval(
            REST_MS if self.tiles.lacks_one or self._made else max(REST_MS, DRAW_MS - took_ms))

    def draw(self):
        """Take the newest values and hand them to the widgets."""
        few = len(self.operator.selection.robots) < MOST_IN_SIGHT
        for _ in range(min(len(self._to_add), ADD_AT_ONCE if few else ADD_OUT_OF_SIGHT)):
            self.operator.add(*self._to_add.pop(0))
        view = self._why.tell(self.tasks.tell(self.operator.view()), self.screen.stick(),
                              self.operator.clock())
        self._mode = view.mode or self._mode
        self.screen.show_view(view)
        self._feel_losses(view)
        self.tiles.show_view(view, [name for name, _ in self._to_add])
        self.events.show(view)
        self.map.show_view(view)
        for part in self.parts.values():
            part.show_view(view)
        self.tiles.show_session(self.recorded_s)
        self._tell_budget()
        for kind, value in self.operator.take_events():
            if kind == 'found':
                self._show_found(value)
            elif kind != 'request':
                self.screen.show_look_result(value)
            elif view.control.ours:
                self._carry_out(*value)
        self.requests.tell_ends()

    def _carry_out(self, action, names):
        """Carry out a request from elsewhere; a refusal is an event."""
        refused = self.requests.carry_out(action, names)
        if refused:
            self.events.note('request.refused', refused)

    def _tell_budget(self):
        """Say once that the camera budget cannot be kept."""
        note = self.tiles.budget_note
        if note and not self._over_budget:
            self.events.note('camera.budget', note)
        self._over_budget = bool(note)

    def _note_task(self, kind, text, robot):
        """Take in what has become of a task: an event, and the answer to what the map asked."""
        self.events.note(kind, text, robot)
        self.map.hear(kind, text, robot)

    def _feel_losses(self, view):
        """Shake the pad when a selected robot is lost."""
        lost = {robot.name for robot in view.robots
                if robot.selected and robot.link in (SILENT, GONE)}
        if lost - self._lost:
            self.operator.alarm()
        self._lost = lost

    def _repeat_stick(self):
        """Repeat the position of the stick: a source not heard for 0.5 s counts as lost."""
        self.operator.send_stick(*self.screen.stick())

    def _look(self):
        self.screen.show_look_result('looking', busy=True)
        self.operator.look()

    def _show_found(self, found):
        """Say what was found; add the robots that answer to the list, a few with each drawing."""
        new = [item.name for item in found.live]
        self.operator.selection.numbers.meet(new)
        self._to_add += [(name, found.facts[name]) for name in new]
        words = ['found {}'.format(', '.join(new)) if new else 'no new robot answers']
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
        """Take a robot off the list: it stops first, and a recording of it ends."""
        self.operator.remove(name)
        recorded = self.requests.end_recording(name)
        self.tiles.drop(name)
        self.screen.remove_steps.offer_undo(name)
        if not recorded:
            self.screen.show_look_result('{} is off the list'.format(name))
        self.draw()

    def _put_back(self, name):
        """Undo that: the robot has its place, number and look again, and is not selected."""
        if self.operator.add(name) is None:
            self.screen.show_look_result('{} is back'.format(name))
        self.draw()

    def asks_before_closing(self):
        """Return what to ask before the screen is closed, '' while nothing drives or records."""
        # One that is closed must not look: it would have the seat of the one that drives now.
        return '' if self._closed else close_question(
            self.operator.view().robots, self.recorded_s is not None)

    @property
    def recorded_s(self):
        """For how long the session has been recorded [s], None while it is not."""
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
        """Have another pad drive; the mode is asked for on its own."""
        if self.operator.drives():
            self.operator.do(choose_device, source, name)

    def _drive(self, name):
        """Drive this robot and no other, and look at it."""
        if self.operator.drives():
            self.screen.look_at(name)
            self._select([name])

    def _leave(self, name):
        """Stop driving a robot whose window was closed; its zero leaves here, at once."""
        self._select([other for other in self.operator.selection.selected if other != name])

    def save_state(self):
        """Return what is kept between runs as a plain dict.

        Never which robots are selected, nor how fast they drive: that is what is in force.
        """
        places, looks, torn = self.tiles.save_state()
        selection = self.operator.selection
        state = {'robots': list(selection.robots), 'numbers': selection.numbers.kept(),
                 'mode': self._mode, 'windows': places, 'torn_off': torn, 'looks': looks,
                 'panel': self.screen.save_settings(), 'events': self.events.save_settings(),
                 'map': self.map.save_settings()}
        return usable_state(state)[0]

    def restore_state(self, state):
        """Take back a dict of :meth:`save_state`; call it before :meth:`start`.

        :returns: what cannot be used and is left out, in words
        """
        state, problems = usable_state(state)
        self.operator.selection.numbers.restore(state.get('numbers', {}))
        self.operator.selection.numbers.meet(state.get('robots', []))
        for name in state.get('robots', []):
            self.operator.add(name)
        if state.get('mode'):
            self._mode = state['mode']
            self.operator.restore_mode(state['mode'])
        self.tiles.restore_state(state.get('windows', {}), state.get('looks', {}),
                                 state.get('torn_off', ()))
        self.screen.restore_settings(state.get('panel', {}))
        self.events.restore_settings(state.get('events', {}))
        self.map.restore_settings(state.get('map', {}))
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
        self.events.close()
        self.tiles.close()
        self._stop_watch.close()
        self.tasks.close(forget)
        self.map.close(forget)
        for part in self.parts.values():
            part.close()

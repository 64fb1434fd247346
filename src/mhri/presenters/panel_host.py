# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the two halves of the panel: the operator's ROS side and the widgets.

One of the few modules that know both. Everything here runs on the GUI thread; the ROS side is asked
by timers and never waited for.
"""
import gc
import json

from python_qt_binding.QtCore import QObject, Qt, QTimer
from python_qt_binding.QtWidgets import QApplication
import rospy

from mhri.core.robots.names import tidy_name
from mhri.core.screen.saved_state import usable_state
from mhri.core.screen.views import GONE, SILENT
from mhri.presenters.doctor_host import DoctorHost
from mhri.presenters.draw_guard import DrawGuard
from mhri.gui.screen.geometry import geometry_of, restore_geometry
from mhri.gui.screen.panel import PanelWidget
from mhri.gui.screen.placing import place_window
from mhri.gui.screen.window_maker import WindowMaker
from mhri.presenters.requests_host import RequestsHost
from mhri.ros.resources import resource_path
from mhri.presenters.window_host import WindowHost

DRAW_MS = 50
STICK_MS = 50
# How often the selection is said again: the operator's lease ends where this thread hangs.
LEASE_MS = 500
SLICE_MS = 4
# A row takes about 2 ms to make: more at once would be felt at the stick.
ADD_AT_ONCE = 6


class PanelHost(QObject):
    """The panel, its bot windows and what feeds them; rqt and the standalone window hold one each.

    :param operator: :class:`mhri.ros.screen.backend.ScreenBackend`, started by :meth:`start`
    """

    def __init__(self, operator, parent=None):
        super().__init__(parent)
        self.operator = operator
        self.windows = {}
        self._hosts = {}
        self._maker = WindowMaker()
        self._window_keys = {}
        self._places = {}
        self._looks = {}
        self._window_due = set()
        self._to_add = []
        self._due = []
        self._lost = set()
        self._stopped = False
        self._mode = None
        self._closed = False
        self._build()
        self.requests = RequestsHost(operator, self.panel.show_look_result, self._select,
                                     self._recording_wish)
        self.doctor = DoctorHost(operator, self.panel, self.windows)
        self._connect()

    def _build(self):
        self._ui_dir = resource_path()
        self.panel = PanelWidget(self._ui_dir)
        self._guard = DrawGuard(self.panel)
        QApplication.instance().installEventFilter(self.panel.drive_keys)
        self._draw_timer = QTimer(self)
        self._draw_timer.setInterval(DRAW_MS)
        self._slice_timer = QTimer(self)
        self._slice_timer.setInterval(SLICE_MS)
        self._stick_timer = QTimer(self)
        self._stick_timer.setInterval(STICK_MS)
        self._lease_timer = QTimer(self)
        self._lease_timer.setInterval(LEASE_MS)

    def _connect(self):
        panel, operator = self.panel, self.operator
        panel.look_requested.connect(self._look)
        panel.add_requested.connect(self._add)
        panel.remove_requested.connect(self._remove)
        panel.record_requested.connect(self.requests.record)
        panel.stop_record_requested.connect(self.requests.stop_recording)
        panel.selection_requested.connect(self._select)
        panel.activated.connect(self._activate)
        panel.open_requested.connect(self._open)
        panel.mode_requested.connect(self._request_mode)
        panel.stick_moved.connect(operator.send_stick)
        panel.limits_requested.connect(operator.request_limits)
        panel.together_requested.connect(operator.keep_together)
        panel.talk_requested.connect(operator.talk)
        panel.stop_requested.connect(operator.stop_all)
        panel.release_requested.connect(operator.release)
        panel.power_cut_requested.connect(lambda: operator.set_motor_power(False))
        panel.control_requested.connect(operator.take_control)
        self._draw_timer.timeout.connect(lambda: self._guard.run(self.draw))
        self._slice_timer.timeout.connect(self._draw_next)
        self._stick_timer.timeout.connect(self._repeat_stick)
        self._lease_timer.timeout.connect(operator.repeat_selection)

    def start(self, robots=(), selected=()):
        """Begin; returns at once.

        :param robots: names to add to the list
        :param selected: names to add and select
        """
        self.operator.selection.numbers.meet((*robots, *selected))
        for name in dict.fromkeys((*robots, *selected)):
            self._add(name)
        if selected:
            self._select(list(selected))
        self.operator.start()
        # What has been loaded by now stays: looking through it takes the collector 60 ms, in which
        # no thread runs.
        gc.freeze()
        self._draw_timer.start()
        self._stick_timer.start()
        self._lease_timer.start()
        self.draw()

    def draw(self):
        """Take what there is to see and hand it to the widgets."""
        for name, parameters in self._to_add[:ADD_AT_ONCE]:
            self.operator.add(name, parameters)
        del self._to_add[:ADD_AT_ONCE]
        view = self.operator.view()
        self._mode = view.mode or self._mode
        self.panel.show_view(view)
        self._feel_losses(view)
        # One with each drawing: a window takes about 40 ms to make.
        self._open_first([robot.name for robot in view.robots
                          if robot.name in self._window_due and robot.type_label])
        waiting = [robot.name for robot in self._due]
        self._due = sorted((robot for robot in view.robots if robot.name in self._hosts),
                           key=lambda robot: robot.name not in waiting)
        self._stopped = view.stop_all
        self._slice_timer.start()
        for kind, value in self.operator.take_events():
            if kind == 'found':
                self._show_found(value)
            elif kind == 'examined':
                self.doctor.show(*value)
            elif kind == 'request':
                if view.control.ours:
                    self.requests.carry_out(*value)
            else:
                self.panel.show_look_result(value)
        self.requests.tell_ends()

    def _open_first(self, names):
        """Open the first of the windows that are due."""
        if names:
            self._open(names[0])

    def _feel_losses(self, view):
        """Shake the pad when a selected robot is lost."""
        lost = {robot.name for robot in view.robots
                if robot.selected and robot.link in (SILENT, GONE)}
        if lost - self._lost:
            self.operator.alarm()
        self._lost = lost

    def _draw_next(self):
        """Draw one window; the others have their turn later, so that a click never waits for all.

        Those that were not reached before the next round come first in it.
        """
        if not self._due:
            self._slice_timer.stop()
            return
        robot = self._due.pop(0)
        if robot.name in self._hosts:
            highlighted = self.panel.robot_list.current
            self._hosts[robot.name].behind = \
                highlighted if highlighted in self._hosts and highlighted != robot.name else ''
            host = self._hosts[robot.name]
            host.guard.run(self._guarded, robot.name, host.draw, robot, self._stopped)

    def _repeat_stick(self):
        """Say again where the stick is: a source that is not heard for 0.5 s counts as lost."""
        self.operator.send_stick(*self.panel.stick())

    def _look(self):
        self.panel.show_look_result('looking', busy=True)
        self.operator.look()

    def _show_found(self, found):
        """Say what was found; the robots that answer come into the list a few with each drawing."""
        new = [item.name for item in found.live]
        self.operator.selection.numbers.meet(new)
        self._to_add += [(name, found.facts[name]) for name in new]
        words = ['found {}'.format(', '.join(new)) if new else 'no new robot answers']
        if found.leftovers:
            words.append('{}: registered, but nothing answers (switched off?), not added'.format(
                ', '.join(item.name for item in found.leftovers)))
        words += ['{}: {}'.format(item.name, item.problem) for item in found.refused]
        self.panel.show_look_result('; '.join(words))

    def _add(self, name):
        name = tidy_name(name)
        problem = self.operator.add(name)
        if problem:
            self.panel.show_name_problem(problem)
        else:
            self.panel.clear_name()
        self.draw()

    def _remove(self, name):
        self._window_due.discard(name)
        self._close_window(name)
        self.requests.end_recording(name)
        self.operator.remove(name)
        self.draw()

    def _select(self, names):
        newly = set(names) - set(self.operator.selection.selected)
        self.operator.select(names)
        self._window_due |= newly
        self._window_due &= set(names)
        self.draw()

    def _request_mode(self, name):
        self._mode = name
        self.operator.request_mode(name)

    def _recording_wish(self, name):
        """Return (path, choices) of a recording: those of its window, or as they were there."""
        if name in self.windows:
            row = self.windows[name].recording
            return row.path, row.chosen_extras()
        extras = self._looks.get(name, {}).get('recording', {}).get('extras', ())
        return '', [key for key in self.operator.recordable(name) if key in extras]

    def _activate(self, name):
        """Bring the window of the highlighted robot to the front; open it where it is selected."""
        if name in self.windows:
            self.windows[name].raise_()
        elif name in self.operator.selection.selected:
            self._open(name)

    def _open(self, name):
        """Open a robot's window, or bring it to the front.

        It does not take the keyboard: the keys go on driving, and a held stick stays held.
        """
        self._window_due.discard(name)
        if name not in self.windows:
            view = self.operator.robot_view(name)
            window, problem = self._maker.make(view.window, self._ui_dir, name, view.type_label)
            if problem:
                rospy.logwarn('%s: %s', name, problem)
                self.panel.show_look_result('{}: {}'.format(name, problem))
            window.closed.connect(self._on_window_closed)
            window.stop_requested.connect(self.operator.stop_all)
            self.windows[name] = window
            self._window_keys[name] = view.window
            self._hosts[name] = WindowHost(window, self.operator)
            self._guarded(name, self._furnish, name, window, view)
        self.windows[name].raise_()

    def _furnish(self, name, window, view):
        """Show a new window as it was left, where it was left."""
        feeds = self.operator.feeds(name)
        if feeds is not None:
            window.offer(feeds.offers())
        window.restore_settings(self._looks.get(name, {}))
        self._place(name, window)
        window.show_view(view)
        window.setAttribute(Qt.WA_ShowWithoutActivating)
        window.show()

    def _guarded(self, name, job, *args):
        """Do something with a robot's window; a lab's own one that fails gives way to mhri's."""
        key = self._window_keys[name]
        try:
            job(*args)
        except Exception as error:
            if not self._maker.trusts(key):
                raise
            self._maker.distrust(key, '{} failed ({}: {}); mend it and start mhri again'.format(
                key, type(error).__name__, error))
            window = self.windows.pop(name)
            window.closed.disconnect(self._on_window_closed)
            window.hide()
            window.deleteLater()
            self._hosts.pop(name).close()
            self._open(name)

    def _place(self, name, window):
        """Put a window where it was last time, else beside the panel and the others."""
        saved = self._places.get(name)
        if saved and restore_geometry(window, saved):
            return
        place_window(window, self.panel,
                     [other for other in self.windows.values() if other is not window])

    def _on_window_closed(self, name):
        """A robot whose window is closed is not driven any more: its zero leaves here, at once."""
        window = self._forget_window(name)
        if window is not None:
            window.deleteLater()
        self._select([other for other in self.operator.selection.selected if other != name])

    def _close_window(self, name):
        window = self._forget_window(name)
        if window is not None:
            window.closed.disconnect(self._on_window_closed)
            window.close()
            window.deleteLater()

    def _forget_window(self, name):
        """Let a window's feeds rest and keep how it looked; return it, None where there is none."""
        if name not in self.windows:
            return None
        self._keep_look(name)
        self._hosts.pop(name).close()
        return self.windows.pop(name)

    def _keep_look(self, name):
        window = self.windows[name]
        self._places[name] = geometry_of(window)
        try:
            look = window.save_settings()
            json.dumps(look)
        except Exception as error:
            if not self._maker.trusts(self._window_keys[name]):
                raise
            rospy.logwarn('the look of the window of %s is not kept: %s', name, error)
            return
        self._looks[name] = look

    def save_state(self):
        """Return what is kept between runs as a plain dict: never which robots are selected."""
        for name in self.windows:
            self._keep_look(name)
        selection = self.operator.selection
        state = {'robots': list(selection.robots), 'numbers': selection.numbers.kept(),
                 'mode': self._mode,
                 'limits': list(self.operator.view().limits), 'windows': self._places,
                 'together': self.operator.view().together, 'looks': self._looks,
                 'panel': self.panel.save_settings()}
        return usable_state(state)[0]

    def restore_state(self, state):
        """Take over a dict of :meth:`save_state`; call it before :meth:`start`.

        :returns: what of it cannot be used and is left out, in words
        """
        state, problems = usable_state(state)
        self.operator.selection.numbers.restore(state.get('numbers', {}))
        self.operator.selection.numbers.meet(state.get('robots', []))
        for name in state.get('robots', []):
            self.operator.add(name)
        if state.get('mode'):
            self._mode = state['mode']
            self.operator.restore_mode(state['mode'])
        if state.get('limits'):
            self.operator.request_limits(*state['limits'])
        self.operator.keep_together(state.get('together') is True)
        self._places.update(state.get('windows', {}))
        self._looks.update(state.get('looks', {}))
        self.panel.restore_settings(state.get('panel', {}))
        return problems

    def close(self, forget=False):
        """Stop the robots first, then close everything; ``forget`` as in the backend."""
        if self._closed:
            return
        self._closed = True
        self._guard.end()
        self._draw_timer.stop()
        self._slice_timer.stop()
        self._stick_timer.stop()
        self._lease_timer.stop()
        self.operator.close(forget)
        QApplication.instance().removeEventFilter(self.panel.drive_keys)
        self.panel.drive_keys.close()
        self.doctor.close()
        for name in list(self.windows):
            self._close_window(name)

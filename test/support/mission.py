# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted mission with four simulated robots on a live screen, and its replay.

``python3 mission.py live FOLDER --laps N`` drives, records and keeps what the screen showed, with
the time; ``python3 mission.py replay FOLDER --times N --seed S`` replays it, goes to random times
and prints how the screens differ. Two processes: a node has one master in its life.
"""
import argparse
import glob
import itertools
import json
import os
import random
import shutil
import signal
import sys
import time
from typing import NamedTuple

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from python_qt_binding.QtCore import Qt  # noqa: E402
from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.core.screen.views import LIVE, PROOF_STOPPED  # noqa: E402
from mhri.gui.driving.hands import Grip  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402
from support.screen_words import differences, framed, words_of  # noqa: E402

ROBOTS = ['bot1', 'bot2', 'bot3', 'bot4']
PATIENCE_S = 180.0
# So often what the screen shows is kept [s]. A stretch in which its words stay the same counts from
# a moment after it began, until a moment before it ended: the recorder hears things at other
# milliseconds than the screen does.
KEEP_S, LEAST_S, AFTER_S, BEFORE_S = 0.2, 1.2, 0.7, 0.1
# A state is held for so long, and for so many looks at the screen.
HOLD_S, HOLD_LOOKS = 1.5, 6
SIZE = 1500, 1050
SEEN, SESSION = 'seen.jsonl', 'session'


class Mission(PanelSession):
    """The live screen, and a log of what it shows."""

    def __init__(self, log):
        self._log, self._kept_s, self._words, self._looks = log, 0.0, None, 0
        super().__init__([('sim.launch', 'n:=4')], ROBOTS)

    def bring(self):
        """Have tasks, and a recorder."""
        self.system.node('tasks', '__name:=mhri_tasks')
        self.system.node('mhri_session', '__name:=mhri_session')

    def until(self, condition, timeout_s=PATIENCE_S, what='the condition'):
        """Let Qt work until a condition comes true, and keep what is shown meanwhile."""
        def told():
            # Each turn draws one part of the screen, and a look at all of it takes a while.
            for _ in range(10):
                self.app.processEvents()
            self._keep()
            return condition()
        return super().until(told, timeout_s, what)

    def _keep(self):
        now = time.time()
        if self.host is not None and now - self._kept_s >= KEEP_S:
            words = words_of(self.host)
            self._log.write(json.dumps([now, words]) + '\n')
            self._looks = self._looks + 1 if framed(words) == self._words else 0
            self._words, self._kept_s = framed(words), time.time()

    def hold(self):
        """Let time pass: the screen is to show a state for a while.

        A little while is enough where its words change by themselves, as those of a link do.
        """
        begun = time.monotonic()
        self.until(lambda: time.monotonic() - begun > HOLD_S and (
            self._looks >= HOLD_LOOKS or time.monotonic() - begun > 6 * HOLD_S), what='a while')

    def robot(self, name):
        """Return the view of a robot as it is shown."""
        return next(robot for robot in self.host.tasks.view.robots if robot.name == name)

    def check(self, *names):
        """Check exactly these robots, by their boxes."""
        for name in ROBOTS:
            if (name in self.operator.selection.selected) != (name in names):
                self.hands.click('check_' + name)
        self.until(lambda: set(self.operator.selection.selected) == set(names), what='the boxes')

    def drive(self, forward, turn, *names):
        """Hold the stick until these robots have moved for a while."""
        grip = Grip(lambda: self.hands.hold_stick(forward, turn), self.hands.let_go,
                    lambda: self.operator.view().status,
                    lambda: all(self.robot(name).moving for name in names))
        self.until(grip, what='{} to move'.format(names))
        self.hold()
        self.hands.let_go()

    def fault(self, robot, name, seconds):
        """Let something of a simulated robot fail."""
        import rospy
        from mhri.srv import SetFault
        service = '/{}/base/set_fault'.format(robot)
        rospy.wait_for_service(service, PATIENCE_S)
        answer = rospy.ServiceProxy(service, SetFault)(name, float('nan'), seconds)
        assert answer.success, answer.message

    def record(self):
        """Press R, and await the word that it records."""
        self.until(lambda: self.host.session.button.isVisible(), what='the button')
        wanted = not self.host.session.recorded
        self.hands.press(Qt.Key_R, 'r')
        self.until(lambda: self.host.session.recorded == wanted, what='the recording')

    def lap(self):
        """Drive alone and together, mark, lose a robot, stop all, release."""
        self.check('bot1')
        self.drive(0.6, 0.0, 'bot1')
        self.hold()
        self.check('bot1', 'bot2', 'bot4')
        self.hands.press(Qt.Key_N, 'n')
        self.until(lambda: self.host.session.note_bar.isVisible(), what='the mark')
        self.hands.press(Qt.Key_Escape, '')
        self.host.tasks.start('square', ['bot3'], {'side': 1.0})
        self.until(lambda: self.robot('bot3').obeys == 'task', what='the task')
        self.hold()
        self.fault('bot4', 'odometry_silent', 0.0)
        self.until(lambda: self.robot('bot4').link != LIVE, what='bot4 to be lost')
        self.drive(0.4, 0.5, 'bot1', 'bot2')
        self.fault('bot4', 'odometry_silent', -1.0)
        self.until(lambda: self.robot('bot4').link == LIVE, what='bot4 to be back')
        self.hold()
        self.hands.press_stop_keys()
        self.until(lambda: all(self.robot(name).proof and self.robot(name).proof.state
                               == PROOF_STOPPED for name in ROBOTS), what='the stop')
        self.hold()
        self.release()
        self.hold()

    def release(self):
        """Release STOP ALL in its two steps."""
        bar = self.host.screen.stop_bar
        for button in (bar.release_button, bar.confirm_button):
            self.until(button.isVisible, what='a step of the release')
            self.hands.click(button.objectName())
        self.until(lambda: not self.operator.view().stop_all, what='the release')


class Stretch(NamedTuple):
    """A part of the mission in which the words of the screen stayed the same [s since 1970]."""

    begin_s: float
    end_s: float
    seen: list


def stretches(seen):
    """Return the stretches of what was seen, rows of (time, words)."""
    found = []
    for _, rows in itertools.groupby(seen, lambda row: framed(row[1])):
        rows = list(rows)
        if rows[-1][0] - rows[0][0] >= LEAST_S:
            found.append(Stretch(rows[0][0] + AFTER_S, rows[-1][0] - BEFORE_S,
                                 [words for _, words in rows]))
    return found


def live(folder, laps):
    """Drive, and leave the session and what was seen in a folder."""
    os.makedirs(folder)
    with open(os.path.join(folder, SEEN), 'w', encoding='utf-8') as log:
        mission = Mission(log)
        try:
            mission.host.screen.resize(*SIZE)
            mission.record()
            for _ in range(laps):
                mission.lap()
            mission.record()
            recorded, = glob.glob(os.path.join(mission.system.home, 'mhri', 'sessions', '*'))
            shutil.copytree(recorded, os.path.join(folder, SESSION))
        finally:
            mission.close(*sys.exc_info())


class Replayed:
    """The replay of a session on a screen in this process."""

    def __init__(self, folder):
        self.system = System()
        self.system.screen()
        self.system.start_master()
        self.system.node('mhri_replay', folder)
        self.app = QApplication.instance() or QApplication(['panel'])
        from mhri.presenters.replay_host import make_replay
        self.program = make_replay(['panel'], folder)
        self.host = self.program.host
        self.program.window.resize(SIZE[0], SIZE[1] + self.host.bar.sizeHint().height())
        self.program.window.show()
        self.host.start()
        self.until(lambda: set(self.host.windows) == set(ROBOTS) and self.host.bar.numbers,
                   'the robots')
        self.host.operator.control('pause')
        self.until(lambda: not self.state().playing, 'the pause')

    def until(self, condition, what, timeout_s=PATIENCE_S):
        """Let Qt work until a condition comes true."""
        wait_for(lambda: (self.app.processEvents(), condition())[1], timeout_s, what)

    def state(self):
        """Return what the player said last."""
        return self.host.operator.replay()

    def go(self, wall_s):
        """Go to a time of the session [s since 1970]."""
        jumps, position_s = self.state().jumps, wall_s - self.state().start.to_sec()
        self.host.operator.control('seek', position_s)
        self.until(lambda: self.state().settled and self.state().jumps > jumps, 'the jump')

    def differs(self, wall_s, stretch, patience_s):
        """Go to a time; return how the screen differs from then, once it is settled."""
        self.go(wall_s)
        end, found = time.monotonic() + patience_s, ['']
        while found and time.monotonic() < end:
            drawn_s = time.monotonic() + 0.2
            while time.monotonic() < drawn_s:
                self.app.processEvents()
                time.sleep(0.002)
            found = differences(stretch.seen, words_of(self.host))
        return found

    def close(self):
        """End everything."""
        import rospy
        self.program.close()
        self.program.window.deleteLater()
        rospy.signal_shutdown('done')
        self.system.close()


def replay(folder, times, seed, patience_s):
    """Replay what :func:`live` left; return how the screens differ, as sentences."""
    with open(os.path.join(folder, SEEN), encoding='utf-8') as log:
        seen = [json.loads(line) for line in log]
    again = Replayed(os.path.join(folder, SESSION))
    try:
        start_s = again.state().start.to_sec()
        rows = stretches([row for row in seen if 0.0 < row[0] - start_s < again.state().length_s])
        chance, found = random.Random(seed), []
        print('{} stretches, {:.0f} of {:.0f} s'.format(
            len(rows), sum(row.end_s - row.begin_s for row in rows), again.state().length_s))
        for _ in range(times):
            row, = chance.choices(rows, [row.end_s - row.begin_s for row in rows])
            at_s = chance.uniform(row.begin_s, row.end_s)
            differ = again.differs(at_s, row, patience_s)
            if differ:
                # A busy recorder may have heard it later than the screen.
                differ = again.differs(row.end_s, row, patience_s)
            print('at {:.2f} s: {}'.format(at_s - start_s, len(differ) or 'as it was'))
            found += ['at {:.2f} s: {}'.format(at_s - start_s, text) for text in differ]
            if os.environ.get('MISSION_GRAB'):
                again.program.window.grab().save('{}/{:.1f}.png'.format(folder, at_s - start_s))
        return found
    finally:
        again.close()


def main():
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('what', choices=('live', 'replay'))
    parser.add_argument('folder')
    parser.add_argument('--laps', type=int, default=1)
    parser.add_argument('--times', type=int, default=12)
    parser.add_argument('--seed', type=int, default=14)
    parser.add_argument('--patience', type=float, default=10.0, metavar='S')
    options = parser.parse_args()
    # What was started is ended, whoever ends this.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    if options.what == 'live':
        live(options.folder, options.laps)
        return 0
    found = replay(options.folder, options.times, options.seed, options.patience)
    print('\n'.join(found))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())

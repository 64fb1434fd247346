# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted mission with four simulated robots on a live screen, and its replay.

``mission.py live FOLDER --seconds S`` drives, records and keeps what the screen showed, with the
time; ``mission.py replay FOLDER --times N --seed S`` replays it, goes to random times and prints
how the screens differ. Two processes: a node has one master in its life.

A busy computer makes screen and recorder late, each in its own way: the screen draws seldom, the
recorder receives things long after they were stamped. A moment at which one of them was, or a word
was just about to change, is moved to the next other one, and how many were is printed. None is left
out.
"""
import argparse
import glob
import json
import os
import random
import shutil
import signal
import sys
import time

import rosbag

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from python_qt_binding.QtCore import Qt  # noqa: E402
from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.base.views import LIVE, PROOF_STOPPED  # noqa: E402
from mhri.driving.gui.hands import Grip  # noqa: E402
from mhri.robots.ros.odometry import MOTIONS  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402
from support.screen_words import (  # noqa: E402
    differences, event_differences, events_of, framed, told_events, words_of,
    words_of_motion)

ROBOTS = ['bot1', 'bot2', 'bot3', 'bot4']
PATIENCE_S = 180.0
# So often what the screen shows is kept; one that draws so seldom is late [s].
KEEP_S, MOST_BETWEEN_S = 0.1, 0.7
# What was heard so long after it was sent was late [s].
LATE_S = 0.4
# Recorder and screen hear the same at other times: at each place a replay has to show what was
# there within so many seconds of the moment. Where nothing changed, that is the same.
NEAR_S = 1.0
# No words change for so long before and after a moment [s]: each tile has its turn.
STILL_S = 1.0
# A replay shows what it has gone to once its words stay the same for so long [s].
STAYS_S = 0.7
# Within so long every part of a screen that is in time has had its turn [s].
TURN_S = 4.0
# So long each state is held.
HOLD_S = 4.0
# A replay that shows something else is asked again so often: a screen may hear a jump late.
TRIES = 3
SIZE = 1500, 1050
SEEN, EVENTS, SESSION = 'seen.jsonl', 'events.json', 'session'


class Mission(PanelSession):
    """The live screen, and a log of what it shows."""

    def __init__(self, log):
        self._log, self._kept_s = log, 0.0
        super().__init__([('sim.launch', 'n:=4')], ROBOTS)

    def bring(self):
        """Have tasks, and a recorder."""
        self.system.node('tasks', '__name:=mhri_tasks')
        self.system.node('mhri_session', '__name:=mhri_session')

    def watch(self):
        """Keep what every drawing shows from now on, as often as it changes all the time."""
        draw = self.host.draw

        def drawn():
            draw()
            now = time.time()
            if now - self._kept_s >= KEEP_S:
                self._kept_s = now
                age_s = max((robot.age_s or 0.0 for robot in self.host.tasks.view.robots
                             if robot.link == LIVE), default=0.0)
                self._log.write(json.dumps([now, words_of(self.host), age_s]) + '\n')
        self.host.draw = drawn

    def until(self, condition, timeout_s=PATIENCE_S, what='the condition'):
        """Let Qt work until a condition comes true; patiently."""
        return super().until(condition, timeout_s, what)

    def hold(self):
        """Let time pass: the screen is to show a state for a while."""
        begun = time.monotonic()
        self.until(lambda: time.monotonic() - begun > HOLD_S, what='a while')

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
        self.until(lambda: self.host.parts['session'].button.isVisible(), what='the button')
        wanted = self.host.recorded_s is None
        self.hands.press(Qt.Key_R, 'r')
        self.until(lambda: (self.host.recorded_s is not None) == wanted, what='the recording')

    def lap(self):
        """Drive alone and together, mark, lose a robot, stop all, release."""
        self.check('bot1')
        self.drive(0.6, 0.0, 'bot1')
        self.hold()
        self.check('bot1', 'bot2', 'bot4')
        self.hands.press(Qt.Key_N, 'n')
        self.until(lambda: self.host.parts['session'].note_bar.isVisible(), what='the mark')
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


def sound_times(looks, late):
    """Return [(begin, end)]: when screen and recorder were in time, and no words about to change.

    A state that lasts a moment may never have been drawn.


    :param looks: rows of (time [s since 1970], words, how old the newest word of a robot was [s])
    :param late: times [s since 1970] at which the recorder heard something late
    """
    found, begun, before_s, before = [], None, None, None
    for at_s, words, age_s in looks:
        words = framed(words)
        if before_s is None or at_s - before_s > MOST_BETWEEN_S or age_s > LATE_S \
                or words != before or any(before_s <= one <= at_s for one in late):
            begun = at_s
        elif at_s - begun >= 2 * STILL_S:
            if found and found[-1][0] == begun + STILL_S:
                found.pop()
            found.append((begun + STILL_S, at_s - STILL_S))
        before_s, before = at_s, words
    return found


def moments(sound, begin_s, end_s, count, chance):
    """Return [(asked, taken)]: random times, each moved to the next sound one.

    After the last of these comes the first.
    """
    found = []
    for _ in range(count):
        asked = chance.uniform(begin_s, end_s)
        taken = next((max(asked, first) for first, last in sound if last >= asked), sound[0][0])
        found.append((asked, taken))
    return found


def carried(folder):
    """Return the odometry of a session: (time heard, how late it was [s], robot, motion)."""
    found = []
    for path in sorted(glob.glob(os.path.join(folder, '*.bag'))):
        with rosbag.Bag(path) as bag:
            found += [(heard.to_sec(), (heard - message.header.stamp).to_sec(),
                       topic.split('/')[1], MOTIONS['nav_msgs/Odometry'](message))
                      for topic, message, heard in bag.read_messages(
                          ['/{}/odom'.format(name) for name in ROBOTS])]
    return found


def live(folder, seconds):
    """Drive for at least so long, and leave the session and what was seen in a folder."""
    os.makedirs(folder)
    with open(os.path.join(folder, SEEN), 'w', encoding='utf-8') as log:
        mission = Mission(log)
        try:
            mission.host.screen.resize(*SIZE)
            mission.watch()
            mission.record()
            begun = time.monotonic()
            while True:
                mission.lap()
                if time.monotonic() - begun >= seconds:
                    break
            mission.record()
            with open(os.path.join(folder, EVENTS), 'w', encoding='utf-8') as stream:
                json.dump(told_events(mission.host), stream)
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
        from mhri.standalone import make_replay
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

    @property
    def begin_s(self):
        """When the session begins [s since 1970]."""
        return self.state().start.to_sec()

    def go(self, wall_s):
        """Go to a time of the session [s since 1970]."""
        jumps = self.state().jumps
        self.host.operator.control('seek', wall_s - self.begin_s)
        self.until(lambda: self.state().settled and self.state().jumps > jumps, 'the jump')

    def differs(self, wall_s, seen, told):
        """Go to a time; return how the screen differs from what was seen, once it shows the same.

        :param seen: what the live screen showed before, around and after that time
        :param told: its events until then
        """
        self.go(wall_s)
        words, since_s = None, time.monotonic()
        while time.monotonic() - since_s < STAYS_S:
            drawn_s = time.monotonic() + KEEP_S
            self.until(lambda: time.monotonic() > drawn_s, 'a drawing')
            now = words_of(self.host)
            if now != words:
                words, since_s = now, time.monotonic()
        return differences(*seen, words) + event_differences(told, events_of(self.host))

    def close(self):
        """End everything."""
        import rospy
        self.program.close()
        self.program.window.deleteLater()
        rospy.signal_shutdown('done')
        self.system.close()


def read_seen(folder):
    """Return the looks at the live screen, and its events, of what :func:`live` left."""
    with open(os.path.join(folder, SEEN), encoding='utf-8') as log:
        looks = [json.loads(line) for line in log]
    with open(os.path.join(folder, EVENTS), encoding='utf-8') as stream:
        return looks, json.load(stream)


def replay(folder, times, seed):
    """Replay what :func:`live` left; return how the screens differ, as sentences."""
    looks, told = read_seen(folder)
    again = Replayed(os.path.join(folder, SESSION))
    try:
        begin_s, length_s = again.begin_s, again.state().length_s
        looks = [look for look in looks if 0.0 <= look[0] - begin_s <= length_s]
        motions = carried(os.path.join(folder, SESSION))
        late = [at_s for at_s, late_s, _, _ in motions if late_s > LATE_S]
        sound = sound_times(looks, late)
        assert sound, 'screen or recorder were late all the time'
        asked = moments(sound, begin_s, begin_s + length_s, times, random.Random(seed))
        print('{:.0f} s, {} looks, in time and still for {:.0f} s; the recorder was late for {} '
              'messages; seed {}'.format(
                  length_s, len(looks), sum(last - first for first, last in sound), len(late),
                  seed), flush=True)
        found = []
        for number, (wanted_s, taken_s) in enumerate(asked, 1):
            found += compare(again, '{} of {}: at {:.2f} s{}'.format(
                number, times, taken_s - begin_s, '' if wanted_s == taken_s else
                ' for {:.2f} s'.format(wanted_s - begin_s)), taken_s, told,
                around(looks, motions, taken_s))
        print('{} asked for, {} moved, {} compared, {} differences'.format(
            times, sum(wanted != taken for wanted, taken in asked), len(asked), len(found)))
        return found
    finally:
        again.close()


def around(looks, motions, at_s):
    """Return the words shown before a time, near it and after it, and those of motions near it."""
    moved = {}
    for when_s, _, name, motion in motions:
        if abs(when_s - at_s) <= NEAR_S:
            for place, word in words_of_motion(name, motion).items():
                moved.setdefault(place, []).append(word)
    return (*([words for when_s, words, _ in looks if begin_s <= when_s - at_s < end_s]
              for begin_s, end_s in ((-TURN_S, -NEAR_S), (-NEAR_S, NEAR_S), (NEAR_S, TURN_S))),
            moved)


def compare(again, name, at_s, told, seen):
    """Compare one moment and print it; return how it differs."""
    then = seen[1]
    so_far = [row for row in told if again.begin_s <= row[0] <= at_s - NEAR_S]
    for tried in range(TRIES):
        differ = again.differs(at_s, seen, so_far)
        if not differ:
            break
    same = [place for place in then[0] if all(
        framed(words).get(place) == framed(then[0])[place] for words in then)]
    print('{}: {}{}; {} places, {} of them as they were all the time'.format(
        name, 'differs' if differ else 'the same', ' (asked {} times)'.format(tried + 1)
        if tried else '', len(set().union(*then)), len(same)), flush=True)
    for text in differ:
        print('    ' + text, flush=True)
    if differ and os.environ.get('MISSION_GRAB'):
        again.program.window.grab().save('{}/{:.1f}.png'.format(
            os.environ['MISSION_GRAB'], at_s - again.begin_s))
    return ['{}: {}'.format(name, text) for text in differ]


def main():
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('what', choices=('live', 'replay'))
    parser.add_argument('folder')
    parser.add_argument('--seconds', type=float, default=0.0)
    parser.add_argument('--times', type=int, default=12)
    parser.add_argument('--seed', type=int, default=14)
    options = parser.parse_args()
    # What was started is ended, whoever ends this.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    if options.what == 'live':
        live(options.folder, options.seconds)
        return 0
    return 1 if replay(options.folder, options.times, options.seed) else 0


if __name__ == '__main__':
    sys.exit(main())

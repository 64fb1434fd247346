# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page in a headset: what its eyes see, and what it makes robots do, from pixels to wheels."""
import os
import time

import numpy as np
import pytest

from support import graph
from support.headset import Headset, LONG_S
from support.paths import RESOURCE
from support.ros_system import insist, System, wait_for

CENTRE, CORNER = (0.5, 0.5), (0.25, 0.3)
RED, BLUE = np.array([255, 0, 0]), np.array([0, 0, 255])
# Two cameras of the robot looked at, one colour each, in place of what the demo shows.
TWO_CAMERAS = '''
const {store} = await import('/store.js'), put = store.put.bind(store);
const name = store.state.robots.find(robot => robot.selected).name;
store.put = (kind, value) => ['picture', 'state'].includes(kind) ? null : put(kind, value);
for (const [topic, {robot}] of [...store.pictures])
  if (robot === name) store.pictures.delete(topic);
for (const [side, colour] of [['left', '#ff0000'], ['right', '#0000ff']]) {
  const canvas = new OffscreenCanvas(320, 240), context = canvas.getContext('2d');
  context.fillStyle = colour;
  context.fillRect(0, 0, 320, 240);
  put('picture', {robot: name, topic: `/${name}/camera/${side}`, n: 1, at: 1e12, range: null,
    bitmap: canvas.transferToImageBitmap()});
}
globalThis.turning = rate => put('state', {...store.state, robots: store.state.robots.map(
  robot => ({...robot, angular_rad_s: rate}))});
turning(0);
'''
STEPS_RAD = [0.4, -0.4] * 10


class Site:
    """A simulated robot with a head, a screen that drives it, and the page in a headset."""

    def __init__(self):
        self.system, self.headset = System(), None
        try:
            self._start()
        except BaseException:
            self.close(AssertionError)
            raise

    def _start(self):
        self.system.screen()
        self.system.start_master()
        # The operator has chosen the page.
        rows = os.path.join(self.system.home, 'mux.yaml')
        with open(rows, 'w', encoding='utf-8') as file:
            file.write((RESOURCE / 'mux.yaml').read_text().replace('default: joy', 'default: web'))
        for name, *words in (('mux', '__name:=mux', '_config:=' + rows),
                             ('mhri_web', '__name:=mhri_web', '_port:=0', '_local_port:=0')):
            self.system.node(name, *words)
        self.system.launch('sim.launch', 'n:=1', 'types:=turtlebot2')
        self.system.node('panel', '--select', 'bot1', '--fresh')
        import rospy
        rospy.init_node('headset_test', disable_signals=True)
        from geometry_msgs.msg import Twist, Vector3
        from mhri.msg import DriveState
        from mhri.srv import GiveLink
        from sensor_msgs.msg import Joy
        self.state, self.speeds, self.heads, self.sticks = None, [], [], []
        rospy.Subscriber(graph.DRIVE_STATE, DriveState, self._on_state, tcp_nodelay=True)
        robot = wait_for(lambda: self.robot() if self.robot() and self.robot().topic
                         and self.robot().selected else None, LONG_S, 'the robot')
        rospy.Subscriber(robot.topic, Twist, lambda twist: self.speeds.append(twist.linear.x))
        rospy.Subscriber('/bot1/head', Vector3, lambda place: self.heads.append(
            (time.time(), place.x)), tcp_nodelay=True)
        rospy.Subscriber('/mux_in/web', Joy, lambda joy: self.sticks.append(list(joy.axes)))
        rospy.wait_for_service('/mhri_web/give', LONG_S)
        self._give = rospy.ServiceProxy('/mhri_web/give', GiveLink)
        self.headset = Headset(self.system.home + '/browser')

    def _on_state(self, state):
        self.state = state

    def robot(self):
        """Return what the drive says of the robot, None if it does not know it."""
        return next((robot for robot in self.state.robots if robot.name == 'bot1'), None) \
            if self.state else None

    def link(self, role, head=False):
        """Return the URL of a new link."""
        answer = self._give(role, role, False, head, 1.0)
        assert answer.success, answer.message
        return answer.url

    def wear(self, url, blind=True):
        """Wear the headset until it shows the robot."""
        self.headset.wear(url, blind)
        self.headset.until('const {store} = await import("/store.js");'
                           'return store.drive.active && store.state?.robots.length === 1',
                           what='the screen in the page')

    def drive(self):
        """Close the grip and push the stick until the robot is told to move.

        Where frames come too slowly the page loses the stick.
        """
        def moves():
            if self.headset.run('const {store} = await import("/store.js");'
                                'return store.drive.you'):
                waits = self.state.waits_for or self.robot().stands
                self.headset.hold(True, ahead=0.0 if waits else 1.0)
            return any(speed > 0.05 for speed in self.speeds)

        def pushed():
            self.headset.hold(False)
            self.frames(2)
            self.headset.hold(True)
            return wait_for(moves, 9.0, lambda: 'the robot: ' + self.state.waits_for, poll_s=0.1)
        self.speeds.clear()
        insist(pushed, 'the grip to drive', LONG_S)

    def frames(self, count):
        """Wait for so many more frames."""
        drawn = self.headset.run('return headset.frames')
        self.headset.until('return headset.frames > words[0]', drawn + count, what='frames')

    def stands(self):
        """Wait until the drive sends zero."""
        wait_for(lambda: self.robot().sent.linear.x == 0.0 and self.speeds[-1:] == [0.0], LONG_S,
                 'the robot to stand')

    def close(self, failure=None):
        """End everything."""
        import rospy
        if self.headset is not None:
            self.headset.close()
        rospy.signal_shutdown('done')
        self.system.__exit__(failure)


@pytest.fixture(scope='module')
def site():
    built = Site()
    yield built
    built.close()


def is_like(pixel, colour):
    return np.abs(np.array(pixel) - colour).max() < 40


def percentile(values):
    return 1000.0 * float(np.percentile(values, 95))


@pytest.fixture(scope='module')
def two_cameras(site):
    """Wear the headset, which shows a robot with two cameras."""
    site.headset.wear(site.link('drive') + '?demo')
    site.headset.run(TWO_CAMERAS)
    return site.headset


def test_each_eye_has_its_own_picture_and_the_head_looks_around_it(two_cameras):
    headset = two_cameras

    def eyes():
        left, right = headset.pixels(CENTRE)
        return is_like(left, RED) and is_like(right, BLUE)
    wait_for(eyes, LONG_S, 'a picture for each eye', poll_s=0.05)
    headset.turn(left=1.3)
    wait_for(lambda: not any(is_like(pixel, colour) for pixel in headset.pixels(CENTRE)
                             for colour in (RED, BLUE)), LONG_S, 'the picture to go', poll_s=0.05)
    headset.turn(left=0.0)
    wait_for(eyes, LONG_S, 'the picture to be where it was', poll_s=0.05)


def test_the_edge_is_dark_while_the_robot_turns(two_cameras):
    def edge():
        return headset.pixels(CORNER)[0][0]
    headset = two_cameras
    before = wait_for(edge, LONG_S, 'the edge of the picture')
    headset.run('turning(1)')
    wait_for(lambda: edge() < 0.9 * before, LONG_S, 'a dark edge', poll_s=0.05)
    assert is_like(headset.pixels(CENTRE)[0], RED)
    headset.run('turning(0)')
    wait_for(lambda: edge() == before, LONG_S, 'the edge', poll_s=0.05)


def test_a_grip_drives_by_a_link_to_drive_until_it_opens_or_the_headset_is_taken_off(site):
    site.wear(site.link('drive'))
    headset = site.headset
    for let_go, back in ((lambda: headset.hold(False, ahead=1.0), lambda: None),
                         (lambda: headset.show('hidden'), lambda: headset.show('visible'))):
        site.drive()
        let_go()
        site.stands()
        back()
        # What was held meanwhile has to be let go first.
        site.frames(5)
        assert site.robot().sent.linear.x == 0.0
    headset.hold(False)


def test_a_grip_moves_nothing_by_a_link_to_watch(site):
    site.wear(site.link('watch'))
    site.sticks.clear()
    site.headset.hold(False)
    site.frames(5)
    site.headset.hold(True, ahead=1.0)
    site.frames(30)
    assert not [axes for axes in site.sticks if any(axes)]
    assert site.headset.run(
        'return headset.sent.filter(([, frame]) => "hold" in frame || "head" in frame)') == []


def test_the_head_of_the_robot_follows_by_a_link_that_allows_it(site):
    site.wear(site.link('drive', head=True))
    follows, hops = [], []
    for left in STEPS_RAD:
        site.heads.clear()
        begun = site.headset.turn(left)
        arrived = wait_for(lambda left=left: next(
            (at for at, pan in list(site.heads) if abs(pan - left) < 0.02), None), LONG_S,
            'the head of the robot')
        sent = site.headset.run(
            'return headset.sent.find(([at, {head}]) => at >= words[0] && head '
            '&& Math.abs(head[0] - words[1]) < 0.02)[0]', begun, left)
        follows.append(arrived - begun)
        hops.append(arrived - sent)
    print('the robot\'s head, p95: {:.0f} ms after the headset, {:.0f} ms after its frame'.format(
        percentile(follows), percentile(hops)))


def test_pictures_are_drawn_soon_after_they_came(site):
    site.wear(site.link('watch'), blind=False)
    count = 'const {drawnAfter} = await import("/xr.js"); return drawnAfter.length >= 40'
    site.headset.until(count, what='forty pictures')
    drawn = site.headset.run('const {drawnAfter} = await import("/xr.js"); return drawnAfter')
    print('received to drawn, p95: {:.0f} ms of {} pictures'.format(
        percentile(drawn) / 1000.0, len(drawn)))
    assert min(drawn) >= 0.0

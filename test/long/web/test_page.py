# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page in a browser, from a node ``mhri_web`` that hears a real drive.

The operator's screen is played by this test.
"""
import io
import threading

import numpy
import pytest

from mhri.base.opencv import cv2
from support.browser import browser
from support.ros_system import free_port, insist, NotYet, System, wait_for

RED, BLUE = (220, 30, 30), (30, 30, 220)
NASTY = '<img src=x onerror="document.title=1">'
ROBOTS = ('bot1', 'bot2', NASTY)
STAGE, PICTURE = '.tile.large', '.tile.large .picture'


class Screen:
    """An operator's screen as far as the page hears it: state at 5 Hz, pictures at 10 Hz."""

    def __init__(self):
        import rospy
        from mhri.msg import PanelRobot, PanelState, SeenPicture, SessionEvent
        from sensor_msgs.msg import CompressedImage
        self._kinds = PanelRobot, PanelState, CompressedImage
        self._state = rospy.Publisher('/panel/state', PanelState, queue_size=1)
        self._pictures = rospy.Publisher('/panel/pictures', SeenPicture, queue_size=10)
        #: the publisher of events
        self.events = rospy.Publisher('/panel/events', SessionEvent, queue_size=10)
        #: {robot: (format, bytes) of its picture}; one without is sent none
        self.pictures = {name: ('jpeg', jpeg(RED)) for name in ROBOTS}
        self.reason = ''
        self._done = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()

    def close(self):
        self._done.set()

    def event(self, text):
        self.events.publish(kind='link.lost', severity='alarm', robot='bot2', text=text)

    def _run(self):
        number = 0
        while not self._done.wait(0.1):
            number += 1
            if number % 2:
                self._state.publish(self.state())
            for name, (kind, data) in list(self.pictures.items()):
                self._pictures.publish(topic=topic_of(name), picture=serialized(
                    self._kinds[2](format=kind, data=data)))

    def state(self):
        robot, state, _ = self._kinds
        robots = [robot(name=name, number=number, colour='#E9C428', level='calm', state='live',
                        reason=self.reason, selected=name == 'bot2', battery=0.5,
                        picture=topic_of(name)) for number, name in enumerate(ROBOTS, 1)]
        return state(driving='Driving bot2', mode='Tablet', linear_mps=0.5, angular_rad_s=1.0,
                     robots=robots)


def topic_of(robot):
    return '/{}/camera/image_raw/compressed'.format(robot)


def serialized(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def jpeg(rgb):
    """Return the bytes of a picture of one colour."""
    return cv2.imencode('.jpg', numpy.full((120, 160, 3), rgb[::-1], numpy.uint8))[1].tobytes()


def near(found, wanted):
    return max(abs(one - other) for one, other in zip(found, wanted)) < 40


@pytest.fixture(scope='module')
def system():
    with System() as built:
        built.start_master()
        import rospy
        rospy.init_node('screen_of_the_test', disable_signals=True)
        built.node('mux', '__name:=mux')
        built.web_port = free_port()
        built.node('mhri_web', '__name:=mhri_web', '_local_port:={}'.format(built.web_port),
                   '_port:={}'.format(free_port()))
        yield built
        rospy.signal_shutdown('done')


@pytest.fixture(scope='module')
def screen(system):
    opened = Screen()
    yield opened
    opened.close()


@pytest.fixture(scope='module')
def give(system):
    """Return a function that returns (address of the page, id) of a new link of a role."""
    import rospy
    from mhri.srv import GiveLink
    rospy.wait_for_service('/mhri_web/give', 60.0)

    def call(role, may_stop=False):
        answer = rospy.ServiceProxy('/mhri_web/give', GiveLink)('Ann', role, may_stop, False, 1.0)
        assert answer.success, answer.message
        return 'http://127.0.0.1:{}/t/{}'.format(
            system.web_port, answer.url.rpartition('/t/')[2]), answer.id
    return call


@pytest.fixture(scope='module')
def page(system, screen, give):
    with browser(system) as opened:
        yield opened


@pytest.fixture
def watched(page, screen, give):
    """The page of a watcher who looks at bot1."""
    screen.pictures = {name: ('jpeg', jpeg(RED)) for name in ROBOTS}
    address, page.link = give('watch')
    page.open(address)
    page.wait('return document.querySelectorAll(".tile.cell").length === 3')
    page.run('document.querySelector(".tile.cell[data-name=bot1]").click()')
    wait_for(lambda: near(page.colour(PICTURE), RED), what='the picture of bot1')
    return page


def test_the_picture_looked_at_is_the_newest_one(watched, screen):
    for colour in (BLUE, RED):
        screen.pictures['bot1'] = 'jpeg', jpeg(colour)
        wait_for(lambda: near(watched.colour(PICTURE), colour), what='the next picture')


def test_a_picture_that_is_not_followed_by_another_does_not_look_live(watched, screen):
    del screen.pictures['bot1']

    def is_grey():
        r, g, b = watched.colour(PICTURE, 0.5, 0.2)
        return max(r, g, b) - min(r, g, b) < 10 and watched.text('.tile.large .old')
    wait_for(is_grey, what='a grey picture with its age')
    wait_for(lambda: near(watched.colour('.cell[data-name=bot2] .picture'), RED),
             what='the picture of bot2, which goes on')


def test_depth_is_coloured_by_distance(watched, screen):
    depth_mm = numpy.repeat(numpy.linspace(500, 5000, 160)[None], 120, axis=0).astype(numpy.uint16)
    png = cv2.imencode('.png', depth_mm)[1].tobytes()
    screen.pictures['bot1'] = '16UC1; compressedDepth png', bytes(12) + png

    def is_coloured():
        near_end, far_end = (watched.colour(PICTURE + ' canvas', right) for right in (0.1, 0.9))
        return near_end[1] > 150 > 90 > near_end[2] and far_end[1] < 90 < far_end[2] + 40
    wait_for(is_coloured, what='yellow where it is near, purple where it is far')


def test_what_others_have_named_is_text_and_never_markup(watched, screen):
    watched.run('self.title_before = document.title')
    wait_for(lambda: screen.events.get_num_connections(), what='mhri_web to listen to events')
    screen.reason = NASTY
    screen.event('an event ' + NASTY)
    watched.wait_text('#events li', 'an event ' + NASTY)
    watched.wait_text(STAGE, NASTY)
    watched.wait_text('.tile.cell .name', NASTY)
    screen.reason = ''
    assert watched.run('return document.images.length === 0 && document.title === title_before')


@pytest.mark.parametrize('size', [(390, 844), (1024, 768), (1920, 1080)],
                         ids=['phone', 'tablet', 'wall'])
def test_the_picture_is_large_and_nothing_is_beside_the_window(watched, size):
    watched.resize(size, touch=size[0] < 1920)
    watched.wait('return innerWidth === arguments[0]', size[0])

    def parts():
        return watched.run(
            'return [".tile.large .picture", ".tile.cell", "#map", "#events", "#status"].map('
            'one => document.querySelector(one).getBoundingClientRect()).map('
            'box => [box.left, box.right, box.width * box.height])')
    wait_for(lambda: all(-1 < left and right < size[0] + 1 and area > 4000
                         for left, right, area in parts()), what=parts)
    wait_for(lambda: parts()[0][2] > 0.25 * size[0] * size[1], what=parts)
    assert watched.run('return document.scrollingElement.scrollWidth <= innerWidth')


def test_a_page_that_is_sent_away_says_so_and_nothing_on_it_looks_live(watched):
    import rospy
    from mhri.srv import TakeLink
    watched.wait('return document.getElementById("lost").hidden')
    assert rospy.ServiceProxy('/mhri_web/take', TakeLink)(watched.link).success
    watched.wait('return !document.getElementById("lost").hidden')
    assert not near(watched.colour(PICTURE, 0.5, 0.2), RED)
    watched.wait('return document.querySelectorAll(".tile.stale").length === 4')


def test_a_finger_on_the_stick_drives_until_the_page_is_hidden(page, screen, give, system):
    import rospy
    from mhri.msg import ControlMode
    from sensor_msgs.msg import Joy
    from support import graph
    from support.fake_mux import FakeOperator
    heard = []
    rospy.Subscriber('/mux_in/web', Joy, lambda message: heard.append(message.axes))
    operator = FakeOperator()
    operator.check('bot2')
    operator.take()
    page.open(give('drive')[0], touch=True)
    page.wait('return document.getElementById("stick").dataset.is === "off"')
    mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
    mode.publish(source='web')
    page.wait('return document.getElementById("stick").dataset.is === "free"')
    x, y = page.middle('#pad')

    def pushes():
        page.touch('touchStart', (x, y))
        page.touch('touchMove', (x, y - 60))
        try:
            return wait_for(lambda: heard and heard[-1][1] > 0.5 and abs(heard[-1][0]) < 0.1, 5.0,
                            'a stick that goes ahead')
        except NotYet:
            # mhri has let go meanwhile, as it does on a slow network.
            page.touch('touchEnd')
            raise
    insist(pushes, 'the finger to drive')
    tab = page.driver.current_window_handle
    page.driver.switch_to.new_window('tab')
    wait_for(lambda: not any(heard[-1]), what='a stick at its centre')
    page.driver.close()
    page.driver.switch_to.window(tab)
    # Seen again, it stays as it is until it is pressed again.
    page.wait('return document.getElementById("stick").dataset.is === "free"')
    assert not any(heard[-1])
    page.touch('touchEnd')


def test_a_watcher_stops_every_robot_where_the_operator_has_allowed_it(watched, give):
    from support.fake_mux import StateEar
    assert watched.run('return document.getElementById("stop").hidden')
    drive = StateEar()
    watched.open(give('watch', may_stop=True)[0], touch=True)
    watched.wait('return !document.getElementById("stop").hidden')
    drive.wait(lambda state: not state.stop_all, 'a drive without a stop')
    place = watched.middle('#stop')
    watched.touch('touchStart', place)
    watched.touch('touchEnd')
    drive.wait(lambda state: state.stop_all, 'the stop of every robot')

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page drives a robot through the real mux: with a link to drive, and while it is held."""
import io
import os
import ssl
import stat
import time
import urllib.error
import urllib.request

from nav_msgs.msg import OccupancyGrid
import roslib.packages
import rospy
from sensor_msgs.msg import CompressedImage

from mhri.graph.ros.addresses import own_addresses
from mhri.msg import (ControlMode, PanelRobot, PanelState, SeenPicture, SessionEvent,
                      WebState)
from mhri.srv import GiveLink, TakeLink
from support import graph
from support.drive_case import DriveCase
from support.heard import Heard
from support.own_node import own_node
from support.ros_system import free_port, insist, wait_for
from support.node_tools import measured, Process
from support.velocity import VelocityEnd
from support.web_page import AHEAD, CENTRE, Page

system = own_node('web')

# Promised: at once, and 0.3 s for silence. What this process or another may be late by [s].
LATE_S = 5.0


class VelocityRobot:
    """The robot that is driven, added once."""

    def __init__(self, case):
        self.name = case.new_name()
        self.end = VelocityEnd('/{}/cmd_vel'.format(self.name))

    def select(self, case):
        """Select it, and wait until it may be driven."""
        case.operator.check(self.name)
        case.choose('joy')
        case.ready(self.name)


def bytes_of(message):
    """Return a message as it is on the wire."""
    stream = io.BytesIO()
    message.serialize(stream)
    return stream.getvalue()


class WebTest(DriveCase):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ports = free_port(), free_port()
        cls.mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)
        cls.panel = rospy.Publisher('/panel/state', PanelState, queue_size=10)
        cls.pictures = rospy.Publisher('/panel/pictures', SeenPicture, queue_size=10)
        cls.events = rospy.Publisher('/panel/events', SessionEvent, queue_size=10)
        cls.web_state = Heard('/mhri_web/state', WebState)
        cls.start_web()
        cls.addClassCleanup(lambda: cls.web.end())
        cls.robot = VelocityRobot(cls)

    @classmethod
    def start_web(cls):
        """Start the server; wait until it serves."""
        cls.web = Process([roslib.packages.find_node('mhri', 'mhri_web')[0],
                           '_port:={}'.format(cls.ports[0]), '_local_port:={}'.format(
                               cls.ports[1])], {'ROS_HOME': os.path.dirname(cls.home)})
        rospy.wait_for_service('/mhri_web/take', 60.0)
        wait_for(cls.events.get_num_connections, what='the server to listen')

    @classmethod
    def give(cls, role='drive', may_stop=False):
        """Return (id, URL on this computer) of a new link."""
        answer = rospy.ServiceProxy('/mhri_web/give', GiveLink)('Ann', role, may_stop, False, 1.0)
        assert answer.success, answer.message
        return answer.id, 'http://127.0.0.1:{}/t/{}'.format(
            cls.ports[1], answer.url.rpartition('/')[2])

    def page(self, url, **more):
        """Return an open page."""
        page = Page(url, **more)
        self.addCleanup(page.close)
        return page

    def choose(self, mode):
        """Choose a source."""
        wait_for(self.mode.get_num_connections, what='the mux to listen')
        self.mode.publish(source=mode)
        self.state.wait(lambda state: state.mode == mode, mode)

    def set_out(self, page):
        """Drive by a page."""
        def moved():
            page.stick = CENTRE
            page.send('hold', True)
            wait_for(page.holds, 5.0, 'the hold')
            self.state.wait(lambda state: not state.waits_for, 'the stick at its centre', 5.0)
            page.stick = AHEAD
            return wait_for(lambda: self.robot.end.moves(), 5.0, 'the robot')
        insist(moved, lambda: 'motion: {}, {}'.format(page.said['drive'],
                                                      self.state.message.waits_for))

    def stands(self, what, when):
        """Wait for the zero after an end, and that nothing follows while the stick is held out."""
        def zero():
            return next((at for at, *value in self.robot.end.after(when) if not any(value)), None)
        wait_for(zero, what='zero after ' + what)
        self.assertLess(measured(what + ' to zero', zero() - when), LATE_S)
        wait_for(lambda: self.robot.end.is_silent(1.0), what='the end of the zeros')
        self.assertFalse(self.robot.end.moves(), what)

    def test_whatever_ends_a_hold_stops_the_robot_and_a_stick_held_out_does_not_move_it(self):
        name, url = self.give()
        self.robot.select(self)
        self.choose('web')
        take = rospy.ServiceProxy('/mhri_web/take', TakeLink)
        ends = {
            'let go': lambda page: page.send('hold', False),
            'hidden': lambda page: page.send('visible', False),
            'silent': lambda page: page.silence(),
            'closed': lambda page: page.close(),
            'a broken frame': lambda page: page.raw('{"stick": [0, 2, 0]}'),
            'another source': lambda page: (time.monotonic(), self.choose('joy'))[0],
            'taken back': lambda page: (time.monotonic(), take(name))[0],
        }
        for what, end in ends.items():
            self.choose('web')
            page = self.page(url)
            self.set_out(page)
            self.stands(what, end(page))
            page.close()
        self.assertEqual(page.close_code, 1008)
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(url)
        self.assertEqual(refused.exception.code, 403)

    def test_a_killed_server_stops_the_robot_and_the_next_one_knows_its_links(self):
        _, url = self.give()
        self.robot.select(self)
        self.choose('web')
        page = self.page(url)
        self.set_out(page)
        when = time.monotonic()
        self.web.end()
        self.stands('a killed server', when)
        self.start_web()
        again = self.page(url)
        self.set_out(again)
        self.stands('let go', again.send('hold', False))

    def test_one_holds_a_watcher_never_and_nothing_moves_while_another_source_drives(self):
        first, second = self.page(self.give()[1]), self.page(self.give()[1])
        self.robot.select(self)
        self.choose('web')
        self.set_out(first)
        second.stick = AHEAD
        second.send('hold', True)
        wait_for(lambda: second.said['drive']['why'] and not second.holds(), what='the refusal')
        state = self.web_state.newest(lambda state: any(viewer.holds for viewer in state.viewers))
        self.assertEqual([viewer.holds for viewer in state.viewers].count(True), 1)
        self.stands('let go', first.send('hold', False))
        self.choose('joy')
        second.send('hold', True)
        wait_for(lambda: not second.said['drive']['active'] and not second.holds(),
                 what='that another source drives')
        watcher = self.page(self.give('watch')[1])
        watcher.raw('{"hold": true}')
        wait_for(lambda: watcher.close_code, what='the refusal')
        self.assertEqual(watcher.close_code, 1008)
        self.assertFalse(self.robot.end.moves())

    def test_a_viewer_stops_all_only_with_a_link_that_may(self):
        page = self.page(self.give('watch')[1])
        page.raw('{"stop": true}')
        wait_for(lambda: page.close_code, what='the refusal')
        self.assertFalse(self.state.message.stop_all)
        page = self.page(self.give('watch', True)[1])
        page.raw('{"stop": true}')
        self.state.wait(lambda state: state.stop_all, 'the stop')

    def test_a_page_shows_what_the_screen_says_and_passes_pictures_on_as_they_came(self):
        page = self.page(self.give('watch')[1])
        wait_for(self.pictures.get_num_connections, what='the server to want pictures')
        camera = '/bot1/camera/compressed'
        robot = PanelRobot(name='bot1', number=1, picture=camera, placed=True, x=1.0, y=2.0,
                           battery=float('nan'))
        data = b'\xff\xd8' + bytes(range(256)) * 4
        picture = SeenPicture(camera, bytes_of(CompressedImage(format='jpeg', data=data)))
        self.events.publish(kind='link.lost', severity='alarm', robot='bot1', text='<b>lost</b>')

        def shown():
            self.panel.publish(driving='Driving bot1', robots=[robot])
            self.pictures.publish(picture)
            return page.pictures and page.said['places']['robots']
        wait_for(shown, what='a picture', poll_s=0.05)
        header, received = page.pictures[0]
        self.assertEqual((header['robot'], header['topic'], header['format'], received),
                         ('bot1', camera, 'jpeg', data))
        self.assertEqual(page.said['state']['driving'], 'Driving bot1')
        self.assertIsNone(page.said['state']['robots'][0]['battery'])
        self.assertEqual(page.said['places']['robots'][0]['x'], 1.0)
        wait_for(lambda: page.events, what='the event')
        self.assertEqual(page.events[0]['text'], '<b>lost</b>')

    def test_the_map_is_a_picture_with_its_place(self):
        publisher = rospy.Publisher('/map', OccupancyGrid, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        grid = OccupancyGrid(data=[0, 100, -1, 0])
        grid.info.width = grid.info.height = 2
        grid.info.resolution, grid.info.origin.orientation.w = 0.5, 1.0
        publisher.publish(grid)
        page = self.page(self.give('watch')[1])
        wait_for(lambda: page.said['map'], what='the map')
        self.assertEqual((page.said['map']['width'], page.said['map']['resolution_m']), (2, 0.5))

    def test_the_certificate_is_of_this_computer_and_its_key_of_its_owner(self):
        folder = os.path.join(self.home, 'web')
        for name in ('key.pem', 'links.json'):
            self.give()
            self.assertEqual(stat.S_IMODE(os.stat(os.path.join(folder, name)).st_mode), 0o600)
        context = ssl.create_default_context(cafile=os.path.join(folder, 'certificate.pem'))
        for address in own_addresses():
            with self.assertRaises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen('https://{}:{}/'.format(address, self.ports[0]),
                                       context=context)
            self.assertEqual(refused.exception.code, 403)
            self.assertIn('Content-Security-Policy', refused.exception.headers)

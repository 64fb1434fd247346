# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lamp, head, gripper and gas of a simulated robot, used through the drive, and seen by its camera.

The pictures are compared pixel by pixel with those that a camera in the same place would see.
"""
import itertools
import math
import threading

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Float32, Int32

from mhri.base.accessories import looks_ahead
from mhri.base.robot_types import resolve_robot_type
from mhri.base.views import AccessoryView
from mhri.graph.ros.resources import read_text, resource_path, robot_types
from mhri.msg import Accessory
from mhri.robots.ros.tf_feed import TfFeed
from mhri.sim.camera import Camera
from mhri.sim.lens import CENTRE_Y_PX
from mhri.sim.plan import parse_plan
from mhri.sim.tools import DIM, MAX_TILT_RAD, rows_of_tilt
from support import graph
from support.drive_case import DriveCase
from support.own_node import own_node
from support.ros_system import insist, NotYet, wait_for

system = own_node('sim_tools', 'sim_tools.launch')

# Where the launch file puts the robot; the gas is 0.6 m ahead.
POSE = (9.8, 7.4, 0.0)
BASE, EYE = 'bot1/base_link', 'bot1/camera_rgb_optical_frame'
PICTURE = '/bot1/camera/rgb/image_raw'
NOBODY = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                      ('colour', 'u1', 3)])
TIMEOUT_S = 60.0


class Newest:
    """The newest message of a topic."""

    def __init__(self, topic, kind):
        self.message = None
        self._subscriber = rospy.Subscriber(topic, kind, self._note, queue_size=1,
                                            buff_size=2 ** 24, tcp_nodelay=True)
        self.close = self._subscriber.unregister

    def _note(self, message):
        self.message = message


class SimToolsTest(DriveCase):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        path = resource_path('sim', 'plan.yaml')
        cls.camera = Camera(parse_plan(read_text(path), path), rows_of_tilt(MAX_TILT_RAD))
        cls.hand = rospy.Publisher(graph.ACCESSORY, Accessory, queue_size=10, tcp_nodelay=True)
        cls.held = {}
        done = threading.Event()
        thread = threading.Thread(target=cls.keep_holding, args=(done,), daemon=True)
        thread.start()
        cls.addClassCleanup(thread.join)
        cls.addClassCleanup(done.set)
        wait_for(cls.hand.get_num_connections, TIMEOUT_S, 'the drive to listen')

    @classmethod
    def keep_holding(cls, done):
        """Repeat what is held, as the program of the operator does."""
        while not done.wait(0.05):
            for key, value in list(cls.held.items()):
                cls.use(key, '', *value)

    @classmethod
    def use(cls, key, choice='', *value):
        cls.hand.publish(robots=['bot1'], key=key, choice=choice, value=value)

    def setUp(self):
        super().setUp()
        self.addCleanup(self.held.clear)
        self.operator.check('bot1')
        self.ready('bot1')
        wait_for(lambda: all(one is not None and one.known and not one.stands for one in map(
            self.reported, ('lamp', 'head', 'gripper'))), TIMEOUT_S,
                 lambda: 'the accessories: {}'.format(self.state.robot('bot1')))

    def reported(self, key):
        """Return the ``mhri/AccessoryState`` of one, None for none."""
        robot = self.state.robot('bot1')
        return next((one for one in robot.accessories if one.key == key), None) if robot else None

    def wait_reported(self, key, good, what):
        """Wait until the drive reports it so; return it."""
        wait_for(lambda: good(self.reported(key)), TIMEOUT_S,
                 lambda: '{}: {}'.format(what, self.reported(key)))
        return self.reported(key)

    def use_until(self, key, choice, good=None):
        """Ask for a choice until it is reported, or until something else is so."""
        def done():
            self.use(key, choice)
            return wait_for(lambda: good() if good else self.reported(key).choice == choice, 5.0,
                            lambda: '{} {}: {}'.format(key, choice, self.reported(key)))
        insist(done, 'the use of ' + key)

    def stops_half_way(self, begin, place, ends, margin):
        """Stop a motion before its end; return where that is.

        :param begin: function of one of the ends; begins to move there
        :param place: function that returns where it is
        """
        ends = itertools.cycle(ends)

        def stopped():
            start, end = place(), next(ends)
            begin(end)
            wait_for(lambda: abs(place() - start) > margin, TIMEOUT_S, 'a motion')
            self.operator.stop()
            self.held.clear()
            last = []

            def rests():
                last.append(place())
                return len(last) > 10 and len(set(last[-10:])) == 1
            wait_for(rests, TIMEOUT_S, 'it to rest', poll_s=0.1)
            if abs(last[-1] - end) > margin:
                return last[-1:]
            self.operator.release()
            self.ready('bot1')
            raise NotYet('it was at its end')
        return insist(stopped, 'a stop half way')[0]

    def hear(self, topic, kind):
        newest = Newest(topic, kind)
        self.addCleanup(newest.close)
        return newest

    def sees(self, picture, pan, tilt, light):
        """Wait until the picture is that of a camera turned so [rad], this bright."""
        view = self.camera.look(POSE[0], POSE[1], POSE[2] + pan, NOBODY, rows_of_tilt(tilt))
        wanted = self.camera.rgb(view, light).tobytes()
        wait_for(lambda: picture.message and picture.message.data == wanted, TIMEOUT_S,
                 'the picture at {}, {}, {}'.format(pan, tilt, light))

    def test_the_lamp_brightens_the_picture(self):
        picture = self.hear(PICTURE, Image)
        head = self.reported('head').value
        for choice, light in (('on', 1.0), ('off', DIM), ('on', 1.0), ('off', DIM)):
            self.use_until('lamp', choice)
            self.sees(picture, *head[:2], light)

    def test_the_head_turns_the_camera_and_stays_where_it_is_stopped(self):
        picture, info = self.hear(PICTURE, Image), self.hear(
            PICTURE.rpartition('/')[0] + '/camera_info', CameraInfo)
        frames = TfFeed(rospy.get_time)
        frames.open()
        self.addCleanup(frames.close)
        for share, place in (((1.0, -1.0), (1.5, -0.3)), ((-0.5, 0.5), (-0.75, 0.15)),
                             ((0.0001, 0.0001), (0.0, 0.0))):
            self.held['head'] = share
            self.wait_reported('head', lambda one, place=place: np.allclose(
                one.value, place, atol=0.001), place)
            del self.held['head']
            pan, tilt = self.reported('head').value
            self.sees(picture, pan, tilt, DIM)
            wait_for(lambda tilt=tilt: info.message.K[5] == CENTRE_Y_PX + rows_of_tilt(tilt),
                     TIMEOUT_S, 'camera_info')

            def turned(pan=pan):
                matrix = frames.matrix(BASE, EYE)
                return matrix is not None and np.allclose(
                    matrix[:3, 2], (math.cos(pan), math.sin(pan), 0.0), atol=0.001)
            wait_for(turned, TIMEOUT_S, lambda: 'tf: {}'.format(frames.matrix(BASE, EYE)))
            # The screen's rule for the path on the floor.
            self.assertEqual(self.looks_ahead(), place == (0.0, 0.0))
        self.stops_half_way(lambda end: self.held.update(head=(end / 1.5, 0.0)),
                            lambda: self.reported('head').value[0], (1.5, -1.5), 0.1)

    def looks_ahead(self):
        own = {'robot_type': 'turtlebot2', 'mhri': rospy.get_param('/bot1/mhri')}
        spec = next(row for row in resolve_robot_type(robot_types()[0], 'bot1', own)[0].accessories
                    if row.key == 'head')
        return looks_ahead([AccessoryView(spec, True, value=tuple(self.reported('head').value))])

    def test_the_gripper_opens_closes_and_stops_half_way(self):
        opening = self.hear('/bot1/gripper_state', Int32)
        for choice, place in (('open', 80), ('close', 0)):
            self.use_until('gripper', choice)
            wait_for(lambda place=place: opening.message.data == place, TIMEOUT_S, 'its state')

        def begin(end):
            start = opening.message.data
            self.use_until('gripper', 'open' if end else 'close',
                           lambda: opening.message.data != start)
        place = self.stops_half_way(begin, lambda: opening.message.data, (80, 0), 2)
        # Under a stop it moves no more; afterwards it does.
        self.use('gripper', 'close')
        self.operator.release()
        self.ready('bot1')
        self.assertEqual(opening.message.data, place)
        self.use_until('gripper', 'close')

    def test_the_gas_is_noticed(self):
        gas = self.hear('/bot1/gas', Float32)
        wait_for(lambda: gas.message and gas.message.data > 300.0, TIMEOUT_S, 'gas')

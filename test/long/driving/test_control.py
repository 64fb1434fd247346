# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One operator at a time, as the screens see it: two programs, two screens in one program."""
import gc
import threading
import time
import unittest
import xmlrpc.client

from diagnostic_msgs.msg import DiagnosticArray
import psutil
import rosgraph
import rospy
from sensor_msgs.msg import Joy

from mhri.msg import DriveSettings, RobotDrive
from mhri.screen.ros.backend import ScreenBackend
from support import graph
from support.fake_drive import FakeDrive, moving
from support.own_node import own_node
from support.ros_system import wait_for
from support.screen_end import Screen, START_S

system = own_node('control')


class ControlTest(unittest.TestCase):

    def setUp(self):
        self.drive = FakeDrive()
        self.addCleanup(self.drive.close)

    def screen(self, name):
        screen = Screen(name)
        self.addCleanup(screen.end)
        screen.wait('the connection', lambda view: view['ros'] == 'connected')
        return screen

    def said_by(self, name, count):
        return [robots for caller, robots in self.drive.selections[count:] if caller == name]

    def in_control(self, screen):
        wait_for(lambda: self.drive.state.operator == screen.name, START_S, 'control')
        screen.wait('its control', lambda view: view['ours'])

    def test_the_second_operator_is_shown_the_first_and_takes_over_when_asked(self):
        first = self.screen('first_screen')
        self.in_control(first)
        first.do('add', 'bot1')
        first.do('select', 'bot1')
        first.wait('the selection', lambda view: view['selected'] == ['bot1'])
        wait_for(lambda: ('/first_screen', ('bot1',)) in self.drive.selections, START_S, 'bot1')
        self.drive.say(computer='lab-pc1', since=rospy.Time.from_sec(time.time()))
        second = self.screen('second_screen')
        second.wait('who drives', lambda view: not view['ours']
                    and view['who'].startswith('first_screen on lab-pc1 since '))
        wait_for(lambda: '/second_screen' not in publishers(graph.SELECT),
                 START_S, 'the topic of the selection to be given back')
        count = len(self.drive.selections)
        second.do('add', 'bot2')
        second.do('select', 'bot2')
        wait_for(lambda: len(self.said_by('/first_screen', count)) > 3, START_S, 'the lease')
        self.assertEqual(self.said_by('/second_screen', count), [], 'it has no say')
        self.assertEqual(second.shown['selected'], [])
        second.do('take')
        second.wait('its control', lambda view: view['ours'])
        first.wait('who drives', lambda view: not view['ours']
                   and view['who'].startswith('second_screen'))
        self.assertEqual(self.drive.takers, ['/second_screen'])
        first.wait('that nothing is selected', lambda view: view['selected'] == [])
        count = len(self.drive.selections)
        wait_for(lambda: len(self.said_by('/second_screen', count)) > 3, START_S, 'the new lease')
        self.assertEqual(self.said_by('/first_screen', count + 1), [])

    def test_a_panel_sets_nothing_before_its_operator_has_moved_a_control(self):
        """And then what is in force stays but for that."""
        self.drive.say(settings=DriveSettings(0.125, 0.75, True, False, False))
        first = self.screen('first_screen')
        self.in_control(first)
        wait_for(lambda: len(self.drive.wishes) > 4, START_S, 'the lease')
        self.assertEqual({settings for _, settings in self.drive.wishes}, {None})
        first.do('brake', 'on')
        wait_for(lambda: self.drive.wishes[-1][1], START_S, 'the wish')
        self.assertEqual(self.drive.wishes[-1][1], DriveSettings(0.125, 0.75, True, False, True))
        count = len(self.drive.wishes)
        wait_for(lambda: len(self.drive.wishes) > count + 3, START_S, 'the lease')
        self.assertEqual(self.drive.wishes[-1][1].brake, True, 'it is repeated')
        second = self.screen('second_screen')
        second.do('limits', '1.0', '2.0')
        second.do('take')
        second.wait('its control', lambda view: view['ours'])
        count = len(self.drive.wishes)
        wait_for(lambda: len(self.drive.wishes) > count + 3, START_S, 'the new lease')
        first.do('take')
        first.wait('its control', lambda view: view['ours'])
        wait_for(lambda: len(self.drive.wishes) > count + 8, START_S, 'the first lease again')
        self.assertEqual({settings for _, settings in self.drive.wishes[count + 1:]}, {None})

    def test_a_drive_that_hangs_is_said_in_every_row(self):
        screen = self.screen('looking_screen')
        self.in_control(screen)
        screen.do('add', 'bot1')
        screen.wait('bot1', lambda view: 'bot1' in view['robots'])
        self.drive.say_robot('bot1', obeys=RobotDrive.OPERATOR, sent=moving(),
                             topic='/bot1/cmd_vel')
        screen.wait('that bot1 is driven', lambda view: view['robots']['bot1'][0])
        self.drive.hang()
        begun = time.monotonic()
        screen.wait('the silence', lambda view: 'does not answer' in view['robots']['bot1'][2])
        print('MEASURED drive hangs: said in the row after {:.2f} s, promised: 1 s'.format(
            time.monotonic() - begun))
        self.assertFalse(screen.shown['robots']['bot1'][0], 'what was said before counts no more')
        self.drive.hang(False)
        screen.wait('that they are back', lambda view: view['robots']['bot1'][0])
        for stands, words in ((RobotDrive.JOINING, 'joining'), (RobotDrive.NOT_HEARD, 'not_heard')):
            self.drive.say_robot('bot1', stands=stands)
            screen.wait(words, lambda view: view['robots']['bot1'][1] == words)

    def test_a_stop_is_called_taken_only_when_the_drive_says_so(self):
        screen = self.screen('stopping_screen')
        self.in_control(screen)
        screen.do('stop')
        screen.wait('the press', lambda view: view['stop_all'])
        self.assertFalse(screen.shown['stop_taken'])
        self.assertIn('not confirmed', screen.shown['status'])
        self.drive.say(stop_all=True)
        screen.wait('the stop', lambda view: view['stop_taken'])
        self.drive.say(stop_all=False)

    def test_a_screen_whose_node_is_ended_says_that_it_is_cut_off(self):
        screen = self.screen('ended_screen')
        self.in_control(screen)
        uri = rosgraph.Master('/control_test').lookupNode('/ended_screen')
        xmlrpc.client.ServerProxy(uri).shutdown('/control_test', 'as rosnode kill does')
        screen.wait('that it is cut off', lambda view: view['ros'] == 'cut_off')
        self.assertIn('cut off', screen.shown['status'])

    def screens(self, count):
        """Start screens in this program, one after the other; the first has its say."""
        made = [ScreenBackend(['panel']) for _ in range(count)]
        self.addCleanup(self.leave, made)
        for screen in made:
            screen.start()
            wait_for(lambda: screen.view().ros == 'connected', START_S, 'a screen')
            screen.add('bot1')
            screen.add('bot2')
        return made

    @staticmethod
    def leave(made):
        """Close screens of this program; the next test must not meet their selection."""
        for screen in made:
            screen.close(forget=True)
        wait_for(lambda: rospy.get_name() not in publishers(graph.SELECT),
                 START_S, 'its topics to be given back')

    def test_the_word_to_cut_the_power_of_the_motors_arrives_as_it_is_meant(self):
        screen, = self.screens(1)
        screen.set_motor_power(False)
        wait_for(lambda: screen.view().stop_note == 'bot1: motor power cut', START_S, 'the answer')
        self.assertEqual(self.drive.power, [False])
        screen.set_motor_power(True)
        wait_for(lambda: self.drive.power == [False, True], START_S, 'the word to restore it')

    def test_two_screens_in_one_program(self):
        """To the drive they are one node: of the two one has a say, and closed it leaves none.

        Nor has it a stick, also before it has given its topics back.
        """
        one, other = self.screens(2)
        heard = []
        ear = rospy.Subscriber(graph.STICK, Joy, lambda joy: heard.append(joy.axes[1]))
        self.addCleanup(ear.unregister)

        def drives(screen, forward):
            """Hold the stick of a screen until it is heard."""
            wait_for(lambda: screen.repeat_selection() or screen.send_stick(forward, 0.0)
                     or forward in heard, START_S, 'the stick', 0.05)
        drives(one, 0.25)
        other.send_stick(1.0, 0.0)
        drives(one, 0.5)
        self.assertTrue(one.view().control.ours)
        self.assertFalse(other.view().control.ours)
        self.assertIn('another screen', other.view().control.who)

        def last(robots):
            one.repeat_selection()
            other.repeat_selection()
            return bool(self.drive.selections) and self.drive.selections[-1][1] == robots
        one.select(['bot1'])
        wait_for(lambda: last(('bot1',)), START_S, 'the selection of the one')
        other.select(['bot2'])
        count = len(self.drive.selections)
        wait_for(lambda: last(('bot1',)) and len(self.drive.selections) > count + 3, START_S)
        self.assertFalse([robots for _, robots in self.drive.selections if 'bot2' in robots])
        other.take_control()
        one.send_stick(1.0, 0.0)
        drives(other, 0.75)
        self.assertNotIn(1.0, heard)
        wait_for(lambda: last(()), START_S, 'the selection to be dropped')
        other.select(['bot2'])
        wait_for(lambda: last(('bot2',)), START_S, 'the selection of the other')
        self.assertEqual(one.selection.selected, ())
        other.close(forget=True)
        wait_for(lambda: self.drive.selections[-1][1] == (), START_S, 'its selection to end')
        wait_for(lambda: one.view().control.ours, START_S, 'the seat of the one')
        count = len(self.drive.selections)
        wait_for(lambda: (one.repeat_selection(), len(self.drive.selections) > count)[-1], START_S)
        self.assertFalse(any(robots for _, robots in self.drive.selections[count:]))

    def test_a_screen_that_is_closed_while_it_starts_leaves_nothing(self):
        """Nor does it take the seat of the next one."""
        self.drive.hang()
        early = ScreenBackend(['panel'])
        early.start()
        self.addCleanup(early.close)
        wait_for(lambda: rospy.get_name() in publishers(graph.MODE_SELECT), START_S, 'it')
        early.close(forget=True)
        wait_for(lambda: rospy.get_name() not in {
            *publishers('/mhri_joy/rumble'), *publishers(graph.MODE_SELECT)},
            START_S, 'its topics to be given back')
        late, = self.screens(1)
        self.assertTrue(late.view().control.ours)

    def test_ten_screens_that_were_closed_leave_nothing(self):
        """As plugins of rqt, which lives on: no thread, no handle, and no status of theirs."""
        statuses = []
        subscriber = rospy.Subscriber(
            '/diagnostics', DiagnosticArray, lambda message: statuses.extend(
                one.name for one in message.status if one.name.endswith(': robots')))
        self.addCleanup(subscriber.unregister)

        def open_and_close():
            screen = ScreenBackend(['panel'])
            screen.start()
            wait_for(lambda: screen.view().ros == 'connected', START_S, 'a screen')
            screen.add('bot1')
            wait_for(lambda: screen.robot_view('bot1').type_label, START_S, 'its robot')
            screen.close(forget=True)

        def held():
            gc.collect()
            return len(threading.enumerate()), psutil.Process().num_fds()
        open_and_close()
        time.sleep(1.5)
        before = held()
        for _ in range(10):
            open_and_close()
        try:
            wait_for(lambda: held()[0] <= before[0] + 3 and held()[1] <= before[1] + 5, 20.0,
                     'what is ending to have ended', 0.1)
        finally:
            print('MEASURED ten screens closed: threads {} -> {}, handles {} -> {}'.format(
                before[0], held()[0], before[1], held()[1]),
                sorted(thread.name for thread in threading.enumerate()))
        del statuses[:]
        time.sleep(2.5)
        self.assertEqual(statuses, [])


def publishers(topic):
    return dict(rosgraph.Master('/control_test').getSystemState()[0]).get(topic, ())

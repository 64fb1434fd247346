# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An act that nobody gets, that nobody could cancel, or that a server refuses is answered."""
import threading

import pytest

pytest.importorskip('rospy')

import rospy  # noqa: E402

from mhri.base.accessories import Act, CANCELLED, read_accessories  # noqa: E402
from mhri.base.config import Section  # noqa: E402
from mhri.base.reasons import NO_LISTENER  # noqa: E402
from mhri.driving.ros import accessory_line as module  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

ROWS = {
    'claw': {'kind': 'tap', 'topic': 'claw', 'choices': {'open': {'data': True}},
             'on_stop': 'stop'},
    'flipper': {'kind': 'hold', 'topic': 'flipper', 'type': 'std_msgs/Float64', 'on_stop': 'stop'},
    'arm': {'kind': 'tap', 'action': 'arm', 'type': 'actionlib/Test',
            'choices': {'open': {'goal': 3}}, 'on_stop': 'cancel'},
    'horn': {'kind': 'tap', 'service': 'horn', 'type': 'std_srvs/SetBool',
             'choices': {'hoot': {'data': True}}, 'on_stop': 'keep'}}
OPEN, HOOT = Act('claw', 'open'), Act('horn', 'hoot')
GOAL, CANCEL = Act('arm', 'open'), Act('arm', CANCELLED, ends=True)
DRIVER = '/bot1/driver'


class Link:
    """A connection to a node of the robot."""

    def __init__(self, watched=True):
        self.endpoint_id, self.line, self.watched, self.owed = DRIVER, self, watched, 0

    def moves(self):
        """Note that the process that stands by owes an end."""
        self.owed += 1


class Publisher:
    """A topic; ``left`` are the connections that remain once those that have ended are closed."""

    def __init__(self, name, kind, **_):
        self.sent, self.open, self.left = [], [Link()], None

    def links(self):
        return tuple(self.open)

    def drop_ended(self):
        self.open = self.open if self.left is None else self.left

    def publish(self, message, urgent=False):
        self.sent.append(message)

    publish_packed = publish


class Ends:
    """The connections of one robot's accessories, with everything below them made up."""

    def __init__(self, monkeypatch):
        self.topics, self.now, self.finished = {}, 100.0, []
        monkeypatch.setattr(module, 'NonBlockingPublisher', self._publisher)
        monkeypatch.setattr(rospy, 'Subscriber', lambda *_, **options: None)
        monkeypatch.setattr(rospy, 'ServiceProxy', self._proxy)
        monkeypatch.setattr(rospy.Time, 'now', rospy.Time)
        # What is logged asks for the time, which a node has.
        monkeypatch.setattr(rospy.rostime, '_rostime_initialized', True)
        self.serve = lambda request: None
        self.proxies = []
        robot_type = type('Type', (), {'accessories': read_accessories(Section(
            {'accessories': ROWS}, 'file'))})
        self.lines = module.AccessoryLines('bot1', robot_type, lambda *_, **options: None,
                                           lambda *_: None, self.finished.append,
                                           lambda: self.now)

    def _publisher(self, name, kind, **options):
        return self.topics.setdefault(name.replace('/bot1/', ''), Publisher(name, kind))

    def _proxy(self, name, kind):
        """Return a new client of the service."""
        def call(request):
            return self.serve(request)
        call.request_class = kind._request_class
        self.proxies.append(call)
        return call


@pytest.fixture
def ends(monkeypatch):
    return Ends(monkeypatch)


def test_a_tap_whose_listener_has_just_gone_is_answered_and_may_be_tried_again(ends):
    claw = ends.topics['claw']
    ends.lines.send(OPEN)
    assert len(claw.sent) == 1 and ends.lines.stands('claw') == ''
    claw.left = []
    ends.lines.send(OPEN)
    assert len(claw.sent) == 1
    assert ends.lines.stands('claw') not in ('', NO_LISTENER), 'the act is answered'
    ends.now += module.ANSWER_S
    assert ends.lines.stands('claw') == NO_LISTENER
    claw.left = [Link()]
    claw.drop_ended()
    assert ends.lines.stands('claw') == ''
    ends.lines.send(OPEN)
    assert len(claw.sent) == 2


def test_a_recorder_that_listens_is_nobody_who_gets_it(ends):
    claw = ends.topics['claw']
    claw.open[0].endpoint_id = '/record_1'
    ends.lines.send(OPEN)
    assert claw.sent == [] and ends.lines.stands('claw')


def test_an_answer_ends_with_the_next_act_that_is_delivered(ends):
    claw = ends.topics['claw']
    claw.left = []
    ends.lines.send(OPEN)
    claw.left = [Link()]
    ends.lines.send(OPEN)
    assert len(claw.sent) == 1 and ends.lines.stands('claw') == ''


def test_what_is_held_is_sent_and_ended_whoever_listens(ends):
    flipper = ends.topics['flipper']
    flipper.left = []
    ends.lines.send(Act('flipper', '', (1.0,)))
    ends.lines.send(Act('flipper', '', (0.0,), ends=True))
    assert len(flipper.sent) == 2


@pytest.mark.parametrize('links', [[], [Link(watched=False)], [Link(), Link(watched=False)]])
def test_no_goal_starts_that_nobody_could_cancel(ends, links):
    goal, cancel = ends.topics['arm/goal'], ends.topics['arm/cancel']
    cancel.open = links
    ends.lines.send(GOAL)
    assert goal.sent == [] and ends.finished == ['arm'] and ends.lines.stands('arm')
    assert [link.owed for link in links] == [0] * len(links)
    cancel.open = [Link()]
    ends.lines.send(GOAL)
    assert len(goal.sent) == 1 and ends.finished == ['arm'] and not ends.lines.stands('arm')
    assert cancel.open[0].owed == 1, 'a killed drive cancels it'
    ends.lines.send(CANCEL)
    assert [message.id for message in cancel.sent] == ['']


def test_a_goal_that_nobody_gets_is_over(ends):
    ends.topics['arm/goal'].left = []
    ends.lines.send(GOAL)
    assert ends.finished == ['arm'] and ends.lines.stands('arm')
    assert ends.topics['arm/cancel'].open[0].owed == 0


def test_each_call_has_a_client_of_its_own_and_its_answer_is_said(ends):
    answers = iter([rospy.ServiceException('no such service'),
                    type('Answer', (), {'success': False, 'message': 'no air'}),
                    type('Answer', (), {'success': True})])

    def serve(request):
        answer = next(answers)
        if isinstance(answer, Exception):
            raise answer
        return answer
    ends.serve, before = serve, len(ends.proxies)
    for count, said in enumerate(('no such service', 'no air', ''), 1):
        ends.lines.send(HOOT)
        wait_for(lambda said=said: ends.lines.stands('horn') == said, what=said or 'the success')
        assert len(ends.proxies) == before + count


def test_a_server_that_hangs_has_so_many_calls_and_the_next_is_refused(ends):
    goes_on, asked = threading.Event(), []

    def serve(request):
        asked.append(request)
        goes_on.wait(60.0)
    ends.serve = serve
    try:
        for _ in range(module.MAX_CALLS):
            ends.lines.send(HOOT)
            assert ends.lines.stands('horn') == ''
        wait_for(lambda: len(asked) == module.MAX_CALLS, what='the calls')
        ends.lines.send(HOOT)
        assert 'horn' in ends.lines.stands('horn') and len(asked) == module.MAX_CALLS
    finally:
        goes_on.set()
    wait_for(lambda: ends.lines.stands('horn') == '', what='the answers')

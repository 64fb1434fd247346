# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list: every change is told once, in words; what flaps or repeats does not flood."""
from dataclasses import replace
import json

import pytest

from mhri.base.accessories import Accessory, READOUT, TOGGLE
from mhri.base.battery import battery_level, FINE, FLAT, LOW
from mhri.base.reasons import NO_PUBLISHER, Reason
from mhri.base.views import (
    AccessoryView, ControlView, GONE, LinkFigures, LIVE, PROOF_NOT_CONFIRMED, PROOF_STOPPED,
    PROOF_WAITING, ProofView, RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER, ROS_STARTING,
    ScreenView, SILENT, WAITING)
from mhri.events.changes import BACK_S, GOOD_LINK_S
from mhri.events.events import (
    ALARM, ATTENTION, CALM, clock_text, EventLog, KINDS, LOST_TONE, MARKED, REPEAT_S, SEVERITIES)
from mhri.recording.recording import ENDED, FAILED, RECORDING, RecordingStatus

WALL_S = 1.8e9
GAS = Accessory(name='gas', key='gas', kind=READOUT, label='gas', unit='ppm', warn_above=50.0,
                warn_below=1.0)
BUMPER = Accessory(name='core', key='bumper', kind=READOUT, label='bumper', warn_above=0.0,
                   bits=('right', 'centre', 'left'))
LAMP = Accessory(name='lamp', key='lamp', kind=TOGGLE, label='lamp')
BOT = RobotView('bot1', link=LIVE, age_s=0.1, battery=0.8)
PANEL = ScreenView(ros=ROS_CONNECTED, mode='joy', robots=(BOT,),
                   sources=(('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller')))
BAD = LinkFigures(round_trip_s=0.9)
MUTE = {'link': SILENT, 'note': 'nothing for 1.2 s'}
AWAY = {'link': GONE, 'note': 'switched off or out of reach; last heard 14:02:04'}


def gas(*value, stands='', spec=GAS):
    return (AccessoryView(spec, bool(value), value=value, stands=stands),)


def lamp(choice=''):
    return (AccessoryView(LAMP, bool(choice), choice),)


class Screen:
    """A log that is fed with one view after the other, at times of the test's choosing."""

    def __init__(self, view=PANEL, **settings):
        self.log = EventLog(**settings)
        self.view, self.now = view, 100.0
        self.told = []
        self.show()
        self.told.clear()

    def show(self, after_s=0.0, robot=None, **values):
        """Show a view with some values changed, ``robot`` those of its first robot."""
        self.now += after_s
        if robot is not None:
            values['robots'] = (replace(self.view.robots[0], **robot), *self.view.robots[1:])
        self.view = replace(self.view, **values)
        events = self.log.feed(self.view, self.now, WALL_S + self.now)
        self.told += events
        return events

    def show_for(self, seconds, **values):
        """Show a view 20 times a second for a while; return what was told in it."""
        first = len(self.told)
        for _ in range(round(20 * seconds)):
            self.show(0.05, **values)
        return self.told[first:]


# Name: the steps, each (values, of the first robot or of the panel); what is told in the end.
ROBOT_CASES = {
    'another host has control': ([{'said': 'desk may not drive: lab has control'}],
                                 'linked.said', 'desk may not drive: lab has control'),
    'silent': ([MUTE], 'link.silent', 'silent: nothing for 1.2 s'),
    'gone': ([AWAY], 'link.gone', 'gone: switched off'),
    'lost': ([{'selected': True}, dict(MUTE, selected=True)], 'link.lost', 'lost while driven'),
    'lost_on_a_task': ([{'driven': True}, dict(AWAY, driven=False)], 'link.lost', 'lost while'),
    'silent_then_gone': ([MUTE, AWAY], 'link.gone', 'gone: switched off'),
    'lost_then_gone': ([{'driven': True}, MUTE, AWAY], 'link.lost', 'still gone: switched off'),
    'back': ([MUTE, {'link': LIVE}], 'link.back', 'back after 8 s'),
    'found': ([{'link': WAITING}, {'link': LIVE}], None, ''),
    'checked': ([{'selected': True}], 'drive.checked', 'selected'),
    'unchecked': ([{'selected': True}, {'selected': False}], 'drive.unchecked', 'deselected'),
    'stopping': ([{'proof': ProofView(PROOF_WAITING, 'stopping')}], None, ''),
    'stopped': ([{'proof': ProofView(PROOF_STOPPED, 'stopped in 180 ms')}], 'proof.stopped',
                'stopped in 180 ms'),
    'moved_again': ([{'proof': ProofView(PROOF_STOPPED, 'stopped')},
                     {'proof': ProofView(PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: moves')}],
                    'proof.doubtful', 'NOT CONFIRMED: moves'),
    'proof_over': ([{'proof': ProofView(PROOF_WAITING, 'x')}, {'proof': None}], None, ''),
    'low': ([{'battery': 0.295}], 'battery.low', 'battery 30 %: charge it soon'),
    'flat': ([{'battery': 0.29}, {'battery': 0.14}], 'battery.flat', 'battery 14 %: charge it now'),
    'charged': ([{'battery': 0.1}, {'battery': 0.9}], 'battery.fine', 'battery 90 % again'),
    'charge_unknown': ([{'battery': None}], None, ''),
    'no_number': ([{'battery': float('nan')}], None, ''),
    'gas': ([{'accessories': gas(50.0)}, {'accessories': gas(61.5)}], 'readout.beyond',
            'gas 61.5 ppm, above 50'),
    'cold': ([{'accessories': gas(0.5)}], 'readout.beyond', 'gas 0.5 ppm, below 1'),
    'gas_over': ([{'accessories': gas(61.5)}, {'accessories': gas(49.0)}], 'readout.within',
                 'gas 49 ppm again'),
    'bumped': ([{'accessories': gas(5.0, spec=BUMPER)}], 'readout.beyond', 'bumper right, left'),
    'free': ([{'accessories': gas(5.0, spec=BUMPER)}, {'accessories': gas(0.0, spec=BUMPER)}],
             'readout.within', 'bumper clear again'),
    'gas_silent': ([{'accessories': gas(61.5)}, {'accessories': gas(2.0, stands='gone')}],
                   'readout.beyond', ''),
    'no_gas': ([{'accessories': gas(float('nan'))}, {'accessories': gas()}], None, ''),
    'lamp_on': ([{'accessories': lamp('off')}, {'accessories': lamp('on')}], 'accessory.reported',
                'lamp on'),
    'lamp_found': ([{'accessories': lamp()}, {'accessories': lamp('on')}], None, ''),
    'lamp_forgotten': ([{'accessories': lamp('on')}, {'accessories': lamp()}], None, ''),
    'bad_link': ([{'figures': BAD}], 'quality.bad', 'slow link: 900 ms round trip'),
    'losing_link': ([{'figures': LinkFigures(loss=0.06)}], 'quality.bad',
                    'bad link: 6 % of its messages lost'),
    'good_link': ([{'figures': BAD}, {'figures': LinkFigures()}], 'quality.good',
                  'the link is good again'),
    'guarded': ([{'guarded': True}], None, ''),
    'guard_lost': ([{'guarded': True}, {'guarded': False}], 'guard.lost', 'its guard does not'),
    'guard_back': ([{'guarded': True}, {'guarded': False}, {'guarded': True}], 'guard.back',
                   'its guard is back'),
    'guard_of_a_robot_that_is_off': ([{'guarded': True}, dict(AWAY, guarded=False)], 'link.gone',
                                     'gone'),
    'pressed': ([{'hardware_stop': True}], 'hardware.pressed', 'its own emergency stop is pressed'),
    'pressed_unheard': ([{'hardware_stop': True}, {'hardware_stop': None}], 'hardware.pressed', ''),
    'let_go': ([{'hardware_stop': True}, {'hardware_stop': False}], 'hardware.released', 'its own'),
    'no_switch': ([{'hardware_stop': False}], None, ''),
    'cut_asked': ([{'power': 'cut_asked'}], None, ''),
    'cut': ([{'power': 'cut_asked'}, {'power': 'cut'}], 'power.cut', 'motor power cut'),
    'cut_sent': ([{'power': 'cut_sent'}], 'power.cut', 'which cannot confirm it'),
    'cut_failed': ([{'power': 'failed'}], 'power.failed', 'not changed'),
    'power_back': ([{'power': 'cut'}, {'power': 'restore_asked'}, {'power': 'on'}], 'power.back',
                   'motor power restored'),
    'power_on': ([{'power': 'on'}, {'power': 'cannot'}], None, ''),
}
UNHEARD = Reason(NO_PUBLISHER, ('/joy',))
HIS = ControlView(False, 'panel on lab-pc2', '14:02')
PANEL_CASES = {
    'no_master': ([{'ros': ROS_NO_MASTER}], 'master.lost', 'no ROS master'),
    'master_back': ([{'ros': ROS_NO_MASTER}, {'ros': ROS_CONNECTED}], 'master.back', 'is back'),
    'cut_off': ([{'ros': ROS_CUT_OFF}], 'screen.cut_off', 'restart it'),
    'no_drive': ([{'answers': False}], 'mux.silent', 'the drive service does not answer'),
    'drive_back': ([{'answers': False}, {'answers': True}], 'mux.back', 'answers again'),
    'guard_unknown': ([{'robots': (replace(BOT, guarded=True, power='cut'),)},
                       {'answers': False, 'robots': (BOT,)}], 'mux.silent', ''),
    'stop': ([{'stop_all': True}], 'stop.engaged', 'STOP ALL'),
    'release': ([{'stop_all': True}, {'stop_all': False}], 'stop.released', 'STOP ALL released'),
    'mode': ([{'mode': 'ps3joy'}], 'mode.changed', 'driving with PS3 Controller'),
    'strange_mode': ([{'mode': 'brain'}], 'mode.changed', 'driving with brain'),
    'control_lost': ([{'control': HIS}], 'control.lost',
                     'lab-pc2 since 14:02 is in control'),
    'nobody_named': ([{'control': ControlView(False)}], 'control.lost',
                     'somebody else is in control'),
    'control_taken': ([{'control': HIS}, {'control': ControlView()}], 'control.taken', 'this scre'),
    'refused': ([{'stop_note': 'not released: no', 'stop_refused': True}], 'request.refused',
                'not released: no'),
    'granted': ([{'stop_note': 'motor power of 2 robots cut'}], None, ''),
    'pad_away': ([{'advice': UNHEARD}], 'source.trouble', 'nobody publishes /joy: start its node'),
    'pad_back': ([{'advice': UNHEARD}, {'advice': None}], 'source.fine', 'sends again'),
    'limits': ([{'limits': (0.3, 1.0)}], 'limits.changed', 'speed limit 0.30 m/s, 1.00 rad/s'),
    'added': ([{'robots': (BOT, RobotView('bot2'))}], 'robot.added', 'added to the list'),
    'added_live': ([{'robots': (BOT, replace(BOT, name='bot2'))}], 'link.found', 'found'),
    'removed': ([{'robots': ()}], 'robot.removed', 'removed from the list'),
    'only_numbers': ([{'robots': (replace(BOT, age_s=0.2, linear_mps=0.3, moving=True),)}], None,
                     ''),
}


def last_told(steps, of_robot):
    """Return what the last of some steps leads to, each of which lasts for 8 s."""
    screen, told = Screen(), []
    for step in steps:
        told = screen.show_for(8.0, **({'robot': step} if of_robot else step))
    return [*screen.told], told


@pytest.mark.parametrize('case', [*ROBOT_CASES, *PANEL_CASES])
def test_what_changes_is_told_once(case):
    of_robot = case in ROBOT_CASES
    steps, kind, text = (ROBOT_CASES if of_robot else PANEL_CASES)[case]
    every, told = last_told(steps, of_robot)
    if kind is None:
        assert told == [] and len(every) <= len(steps)
        return
    event = (told or every)[-1]
    assert event.kind == kind and text in event.text
    assert event.robot == ('' if kind.split('.')[0] in (
        'master', 'screen', 'mux', 'stop', 'mode', 'control', 'request', 'source',
        'limits') else every[-1].robot or 'nobody')
    assert sum(other.kind == kind and other.text == event.text for other in every) == 1
    assert (event.severity, event.sound) == KINDS[kind] or case.endswith('_then_gone')


def test_every_kind_is_shown_by_a_case_or_is_a_note():
    shown = {kind for _, kind, _ in (*ROBOT_CASES.values(), *PANEL_CASES.values())}
    other = {kind for kind in KINDS if kind.startswith((
        'drill.', 'recording.', 'session.', 'task'))}
    assert set(KINDS) - shown == other | {
        'accessory.used', 'accessory.refused', 'screen.note', 'screen.trouble', 'screen.remote',
        'stick.let_go', 'camera.budget'}
    assert {severity for severity, _ in KINDS.values()} == set(SEVERITIES)
    assert len({sound for _, sound in KINDS.values()} - {''}) <= 3
    assert [kind for kind, (_, sound) in KINDS.items() if sound == LOST_TONE] == ['link.lost']


def test_what_was_so_from_the_beginning_is_told_where_it_matters():
    log = EventLog()
    robots = (replace(BOT, battery=0.1), replace(BOT, name='bot2', selected=True))
    told = log.feed(replace(PANEL, robots=robots, stop_all=True), 0.0, WALL_S)
    assert [(event.robot, event.kind) for event in told] == [
        ('', 'stop.engaged'), ('bot1', 'link.found'), ('bot1', 'battery.flat'),
        ('bot2', 'link.found'), ('bot2', 'drive.checked')]


def test_a_screen_that_starts_tells_nothing_of_its_start():
    screen = Screen(ScreenView(ros=ROS_STARTING))
    screen.show_for(0.2, ros=ROS_CONNECTED, mode=None, answers=False)
    screen.show_for(3.0, mode='joy', answers=True, limits=(0.4, 1.0))
    assert [event.kind for event in screen.told] == []


def test_no_master_at_the_start_is_told():
    screen = Screen(ScreenView(ros=ROS_STARTING))
    assert [event.kind for event in screen.show(ros=ROS_NO_MASTER)] == ['master.lost']


@pytest.mark.parametrize('one, other', [
    ({'link': SILENT}, {'link': LIVE}), ({'link': GONE}, {'link': LIVE}),
    ({'battery': 0.305}, {'battery': 0.295}), ({'battery': 0.145}, {'battery': 0.155}),
    ({'figures': BAD}, {'figures': LinkFigures()}), ({'guarded': False}, {'guarded': True})])
def test_what_flaps_is_told_once(one, other):
    screen = Screen()
    for _ in range(200):
        screen.show_for(0.5, robot=one)
        screen.show_for(0.5, robot=other)
    assert len(screen.told) <= 2


def test_each_sensor_is_a_line_of_its_own():
    """Though their words differ by a number alone; one that is within covers no other."""
    screen = Screen()
    one, two = (replace(GAS, key='gas{}'.format(number), label='gas {}'.format(number))
                for number in (1, 2))
    high, low = (60.0,), (20.0,)
    told = screen.show(robot={'accessories': (
        AccessoryView(one, True, value=high), AccessoryView(two, True, value=high))})
    assert [(event.kind, event.data) for event in told] == [
        ('readout.beyond', {'readout': spec.key, 'value': 60.0, 'unit': 'ppm'})
        for spec in (one, two)]
    assert [event.count for event in told] == [1, 1]
    told = screen.show_for(3.0, robot={'accessories': (
        AccessoryView(one, True, value=high), AccessoryView(two, True, value=low))})
    assert [event.data['readout'] for event in told] == ['gas2']
    assert 'gas 1' in screen.log.headline().text


def test_slow_flapping_is_two_lines_with_a_count():
    screen = Screen()
    for _ in range(10):
        screen.show_for(1.0, robot=dict(MUTE, note='nothing for {:.1f} s'.format(screen.now)))
        screen.show_for(BACK_S + 1.0, robot={'link': LIVE})
    assert [(event.kind, event.count) for event in screen.log.events[1:]] == [
        ('link.silent', 10), ('link.back', 10)]
    assert [event.sound for event in screen.told if event.sound] == ['attention', 'calm']
    assert len({event.number for event in screen.told}) == len(screen.told) == 20
    assert [event.replaces for event in screen.told[:4]] == [0, 0, *(
        event.number for event in screen.told[:2])]


def test_a_robot_lost_while_driven_again_and_again_is_heard_each_time():
    screen = Screen()
    for _ in range(3):
        screen.show_for(1.0, robot=dict(MUTE, selected=True))
        screen.show_for(BACK_S + 1.0, robot={'link': LIVE})
    assert [event.sound for event in screen.told].count(LOST_TONE) == 3
    lost = screen.log.events[-2]
    assert (lost.kind, lost.count, lost.severity) == ('link.lost', 3, ALARM)


def test_a_robot_that_is_unchecked_as_it_is_lost_was_lost_while_driven():
    screen = Screen()
    screen.show(robot={'selected': True})
    told = screen.show(robot=dict(MUTE, selected=False))
    assert [event.kind for event in told] == ['link.lost', 'drive.unchecked']


def test_one_outage_sounds_once():
    screen = Screen()
    screen.show(robot={'selected': True})
    screen.show_for(3.0, robot=dict(MUTE))
    screen.show_for(3.0, robot=dict(AWAY))
    assert [(event.kind, event.sound) for event in screen.told] == [
        ('drive.checked', ''), ('link.lost', LOST_TONE), ('link.lost', '')]


def test_what_repeats_after_a_while_is_a_line_of_its_own():
    screen = Screen()
    for after_s in (0.0, REPEAT_S + 1.0):
        screen.show(after_s, stop_all=True)
        screen.show(stop_all=False)
    assert [event.kind for event in screen.log.events[1:]] == [
        'stop.engaged', 'stop.released'] * 2
    assert all(event.count == 1 for event in screen.log.events)


def test_a_robot_is_back_only_once_it_has_been_for_a_while():
    screen = Screen()
    screen.show(robot=MUTE)
    assert [event.kind for event in screen.show_for(BACK_S - 0.1, robot={'link': LIVE})] == []
    assert [event.kind for event in screen.show_for(0.3)] == ['link.back']


def test_a_good_link_takes_longer_to_be_believed_than_a_bad_one():
    screen = Screen()
    assert len(screen.show_for(2.2, robot={'figures': BAD})) == 1
    assert screen.show_for(GOOD_LINK_S - 0.2, robot={'figures': LinkFigures()}) == []
    assert len(screen.show_for(0.4)) == 1


def test_a_slider_that_is_drawn_is_one_line():
    screen = Screen()
    for step in range(100):
        screen.show(0.05, limits=(0.1 + 0.005 * step, 1.0))
    event, = screen.show_for(2.0)
    assert '0.59' in event.text


@pytest.mark.parametrize('statuses, kinds', [
    (['', RECORDING, RECORDING, ENDED, ENDED], ['begun', 'ended']),
    (['', FAILED, FAILED], ['failed']),
    (['', RECORDING, FAILED, RECORDING, ENDED], ['begun', 'failed', 'begun', 'ended']),
    (['', (RECORDING, 'disk nearly full'), (RECORDING, 'disk nearly full'), ENDED],
     ['begun', 'warning', 'ended'])])
def test_recordings(statuses, kinds):
    now = {}
    screen = Screen(status_of=lambda name: now.get(name, RecordingStatus()))
    for status in statuses:
        state, note = status if isinstance(status, tuple) else (status or 'off', '')
        now['bot1'] = RecordingStatus(state, '/tmp/a.bag', note=note or 'why', attention=bool(note))
        screen.show(1.0)
    assert [event.kind for event in screen.told] == ['recording.' + kind for kind in kinds]
    assert all(event.robot == 'bot1' for event in screen.told)


def test_the_end_of_a_recording_is_told_of_a_robot_that_has_left_the_list():
    now = {'bot1': RecordingStatus(RECORDING, '/tmp/a.bag')}
    screen = Screen(status_of=lambda name: now.get(name, RecordingStatus()))
    screen.show(1.0, robots=())
    now['bot1'] = RecordingStatus(ENDED, '/tmp/a.bag', note='saved /tmp/a.bag, 12 messages')
    assert [event.text for event in screen.show(1.0)] == ['saved /tmp/a.bag, 12 messages']
    assert screen.show(1.0) == []


def test_a_mark_and_its_note_are_one_line():
    log = EventLog()

    def mark(now_s, name, words, **note):
        return log.note(MARKED, words, now_s, WALL_S + now_s, 'bot1', {'mark': name, **note})
    first, second = mark(1.0, 'm1', 'mark 1, 2 stills'), mark(2.0, 'm2', 'mark 2, 2 stills')
    late_s = 3 * REPEAT_S
    noted = mark(late_s, 'm1', 'mark 1: a door', note='a door')
    assert log.events == (second, noted), 'two marks are never equal'
    assert (noted.replaces, noted.count, noted.time_s) == (first.number, 1, first.time_s)
    assert mark(late_s, 'm1', 'mark 1, 2 stills').replaces == 0, 'that of another session'
    assert mark(late_s, 'm9', 'mark 9: mine', note='mine').replaces == 0


def test_the_oldest_go_first():
    log = EventLog(most=10)
    for number in range(25):
        log.note('screen.note', 'x' * number, number, WALL_S)
    assert [event.number for event in log.events] == list(range(16, 26))


def test_a_note_of_an_unknown_kind_is_refused():
    with pytest.raises(KeyError):
        EventLog().note('weather', 'rain', 0.0, WALL_S)


def test_texts_of_others_are_made_fit_for_a_line():
    event = EventLog().note('screen.note', 'a\nb' + 'x' * 999, 0.0, WALL_S)
    assert event.text.startswith('a b') and len(event.text) == 200


def test_an_event_is_plain_data():
    event = Screen().show(robot=MUTE)[0]
    kept = json.loads(json.dumps(event.as_dict()))
    assert kept == {
        'number': 2, 'time_s': WALL_S + 100.0, 'robot': 'bot1', 'severity': ATTENTION,
        'kind': 'link.silent', 'text': 'silent: ' + MUTE['note'], 'sound': 'attention',
        'count': 1, 'since_s': WALL_S + 100.0, 'replaces': 0, 'data': {}}


def test_the_headline_names_the_worst_and_counts_the_others():
    screen = Screen(replace(PANEL, robots=(BOT, replace(BOT, name='bot2'))))
    screen.log.mark_seen()
    assert screen.log.headline() == ('', CALM, '') and screen.log.unseen == 0
    screen.show(robot={'selected': True})
    assert screen.log.headline().severity == CALM and '1' in screen.log.headline().text
    screen.show(robot=MUTE)
    at = clock_text(WALL_S + screen.now)
    assert 'bot1' in screen.log.headline().text and at in screen.log.headline().text
    assert screen.log.headline().severity == ALARM
    screen.show(5.0, stop_note='centre the stick', stop_refused=True)
    assert at in screen.log.headline().text and '(1 ' in screen.log.headline().text
    screen.show_for(3.0, robot={'link': LIVE})
    assert at not in screen.log.headline().text and screen.log.headline().severity != ALARM
    assert screen.log.unseen == 4
    screen.log.mark_seen()
    assert screen.log.headline() == ('', CALM, '') and screen.log.events


@pytest.mark.parametrize('fraction, before, level', [
    (None, FINE, FINE), (None, LOW, LOW), (float('nan'), FLAT, FLAT), (1.0, FLAT, FINE),
    (0.31, FINE, FINE), (0.30, FINE, LOW), (0.31, LOW, LOW), (0.331, LOW, FINE),
    (0.16, FINE, LOW), (0.15, LOW, FLAT), (0.17, FLAT, FLAT), (0.19, FLAT, LOW),
    (0.32, FLAT, LOW), (0.0, FINE, FLAT), (-1.0, FINE, FLAT)])
def test_the_level_of_a_battery(fraction, before, level):
    assert battery_level(fraction, before) == level

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of the link to a robot on a master of its own: link/."""
import math
import struct

import pytest

from mhri.base.robot_types import parse_robot_type
from mhri.base.wire import Wire
from mhri.link.carried import (
    Pace, PICTURE, STATE, up_streams, worth_carrying)
from mhri.link.frames import (
    About, Beat, DEFLATED, Frame, FrameError, LinkStats, pack, pack_about, pack_beat, PIECE,
    Thinned, unpack, unpack_about, unpack_beat)
from mhri.link.peer import BEAT_S, GONE_S, held_s, may_pass, Peer, SURE_S
from mhri.link.renaming import first_text, renamer, rewritten, transforms, Transforms

KIND = parse_robot_type('''
name: r
limits: {linear_mps: 1.0, angular_rad_s: 1.0}
command: [cmd_vel]
odometry: [odom]
rgb: [camera/image_raw]
scan: [/scan]
''', 'r.yaml')

# A beat around the four parts that come first.
BEAT = b'[%s,[0,0,0],null]'


# --- what is carried

def test_no_velocity_topic_is_carried():
    assert not {stream.topic for stream in up_streams(KIND)} & {'cmd_vel', '/cmd_vel'}


def test_what_a_type_has_goes_up():
    found = {stream.topic: stream for stream in up_streams(KIND)}
    assert found['odom'].urgency == STATE and found['odom'].rate_hz == 50.0
    assert found['camera/image_raw/compressed'].urgency == PICTURE
    assert found['/tf_static'].latched and not found['/tf'].latched
    assert 'scan' in found and 'imu' not in found


@pytest.mark.parametrize('published, carried', [
    (['camera/image_raw'], ['camera/image_raw']),
    (['camera/image_raw', 'camera/image_raw/compressed'], ['camera/image_raw/compressed']),
    (['odom', 'cmd_vel', 'other'], ['odom']),
    ([], []),
])
def test_raw_pictures_only_where_there_are_no_packed_ones(published, carried):
    assert [stream.topic for stream in worth_carrying(up_streams(KIND), published)] == carried


@pytest.mark.parametrize('rate_hz, source_hz, passed', [
    (10.0, 50, 10), (10.0, 10, 10), (10.0, 5, 5), (0.0, 50, 50), (20.0, 30, 20)])
def test_pace(rate_hz, source_hz, passed):
    pace = Pace(rate_hz)
    found = sum(pace.lets(100.0 + number / source_hz) for number in range(10 * source_hz))
    assert abs(found - 10 * passed) <= 2


# --- what goes over the air

def test_a_frame_comes_back_as_it_was():
    assert unpack(pack(7, 3, 12.5, b'body')) == Frame(7, 3, 12.5, b'body')
    assert unpack(pack(7, 3, 12.5, b'piece', PIECE)) == Frame(7, 3, 12.5, b'piece', PIECE)


def test_a_state_is_packed_smaller_and_comes_back_as_it_was():
    body = bytes(600) + b'odometry'
    data = pack(7, 3, 12.5, body, DEFLATED)
    assert len(data) < 100 and unpack(data) == Frame(7, 3, 12.5, body)


@pytest.mark.parametrize('data', [
    b'', b'GET / HTTP/1.1\r\n\r\n.......', b'mh\x01' + bytes(17), pack(1, 1, math.nan, b''),
    pack(1, 1, 1.0, b'')[:-1], pack(1, 1, 1.0, b'', 9), pack(1, 1, 1.0, b'x' * 999, DEFLATED)[:-1],
    pack(1, 1, 1.0, bytes(1 << 23), DEFLATED),
    pack(1, 1, 1.0, b'body')[:3] + b'\x01' + pack(1, 1, 1.0, b'body')[4:]])
def test_a_malformed_frame_is_refused(data):
    with pytest.raises(FrameError):
        unpack(data)


@pytest.mark.parametrize('beat', [
    Beat(), Beat((1.5, 0.25), 'abc', (0, 4)), Beat(None, '', (1,)),
    Beat(stats=LinkStats(94000.0, 0.0312, 0.2), thinned=Thinned(80000.0, 0.5, True), to=7)])
def test_a_beat_comes_back_as_it_was(beat):
    assert unpack_beat(pack_beat(beat)) == beat


@pytest.mark.parametrize('body', [
    b'', b'{}', b'[]', b'[null,"",[]]', BEAT % b'1,"",[],null', BEAT % b'null,3,[],null',
    BEAT % b'null,"",[1.5],null', BEAT % b'null,"",[true],null', BEAT % b'[1],"",[],null',
    BEAT % b'[1,NaN],"",[],null', BEAT % b'["1",2],"",[],null', b'[null,"",' + b'[' * 5000,
    BEAT % (b'null,"",[' + b','.join([b'1'] * 200) + b'],null'), b'\xff',
    BEAT % b'null,"",[],null' + b' ' * 70000, BEAT % b'[1e999,0],"",[],null',
    BEAT % b'null,"",[],[1,2]', BEAT % b'null,"",[],[1,NaN,0]', b'[null,"",[],null,[1]]',
    b'[null,"",[],null,null]', b'[null,"",[],null,[0,0,0]]', b'[null,"",[],null,[0,0,0],"7"]',
    b'[null,"",[],null,[0,0,0],true]'])
def test_a_beat_that_is_none(body):
    with pytest.raises(FrameError):
        unpack_beat(body)


def test_what_a_robot_says_of_itself_comes_back():
    about = About({'robot_type': 'turtlebot3', 'mhri': {'limits': {'linear_mps': 0.1}}},
                  (('odom', 'nav_msgs/Odometry'),))
    again = unpack_about(pack_about(about))
    assert again == about and again.name == about.name
    assert About({}, about.topics).name != about.name


@pytest.mark.parametrize('body', [
    b'', b'[]', b'[[],[]]', b'[{},{}]', b'[{},[["odom"]]]', b'[{},[["odom",1]]]',
    b'[{},[[null,"a/B"]]]', b'[{},[7]]'])
def test_a_robot_that_says_nonsense(body):
    with pytest.raises(FrameError):
        unpack_about(body)


# --- the other side

def talk(peer, now, offset_s, down_s, up_s, number=1, session=9):
    """Let a beat come: ours took ``down_s``, was held 0.05 s, and its answer took ``up_s``."""
    heard_s = now + down_s
    said_s = heard_s + 0.05
    beat = Beat((now, 0.05))
    peer.on_beat(Frame(session, number, said_s + offset_s, b''), beat, said_s + up_s)
    return said_s + up_s


@pytest.mark.parametrize('offset_s', [0.0, 1e6, -1e6])
@pytest.mark.parametrize('down_s, up_s', [(0.001, 0.001), (0.2, 0.2), (0.05, 0.15)])
def test_age_needs_no_common_clock(offset_s, down_s, up_s):
    peer = Peer()
    now = talk(peer, 100.0, offset_s, down_s, up_s)
    assert peer.round_trip_s() == pytest.approx(down_s + up_s, abs=1e-6)
    sent_at = now + 1.0
    frame = Frame(9, 2, sent_at + offset_s, b'')
    assert peer.age_s(frame, sent_at + up_s) == pytest.approx(
        up_s, abs=0.5 * abs(up_s - down_s) + 1e-6)


def test_of_ways_that_differ_the_age_is_wrong_by_half_the_difference():
    """As the documents say: what bounds it then is the guard's own clock (test_guard: late)."""
    peer = Peer()
    # The robot's side: its beat went up in 20 ms, the host's came down in 400.
    now = talk(peer, 100.0, 7.0, 0.02, 0.4)
    sent_at = now + 1.0
    age_s = peer.age_s(Frame(9, 2, sent_at + 7.0, b''), sent_at + 0.4)
    assert age_s == pytest.approx(0.21, abs=1e-6)
    assert may_pass('abc:1:tok', age_s)


def test_nobody_knows_the_age_of_what_another_run_said_or_after_a_long_silence():
    peer = Peer()
    assert peer.age_s(Frame(9, 1, 1.0, b''), 1.0) is None
    now = talk(peer, 100.0, 0.0, 0.01, 0.01)
    assert peer.age_s(Frame(9, 2, now, b''), now) is not None
    assert peer.age_s(Frame(8, 2, now, b''), now) is None
    later = now + SURE_S + 0.1
    assert peer.age_s(Frame(9, 3, later, b''), later) is None


@pytest.mark.parametrize('echo', [(200.0, 0.0), (99.0, -1.0), (0.0, 0.0)])
def test_an_echo_that_cannot_be_is_not_believed(echo):
    peer = Peer()
    peer.on_beat(Frame(9, 1, 1.0, b''), Beat(echo), 100.0)
    assert math.isnan(peer.round_trip_s())


def test_heard_and_gone():
    peer = Peer()
    assert not peer.is_live(0.0) and math.isinf(peer.silence_s(0.0)) and peer.echo(0.0) is None
    peer.on_beat(Frame(9, 1, 50.0, b''), Beat(), 10.0)
    assert peer.is_live(10.0 + GONE_S) and not peer.is_live(10.1 + GONE_S)
    assert peer.echo(10.5) == (50.0, 0.5)


def test_loss_is_what_did_not_come():
    peer = Peer()
    assert math.isnan(peer.loss())
    for number in (1, 2, 4, 5, 6, 8, 9, 10):
        peer.on_beat(Frame(9, number, 0.0, b''), Beat(), number * BEAT_S)
    assert peer.loss() == pytest.approx(0.2)


@pytest.mark.parametrize('frame_id, age_s, passes', [
    ('abc:1:tok', 0.1, True), ('abc:1:tok', 0.3, True), ('abc:1:tok', 0.31, False),
    ('abc:1:tok', None, False), ('abc!:1:tok', 5.0, True), ('abc!:1:', None, True),
    ('nonsense', 0.0, False), ('', 0.0, False)])
def test_what_goes_on_to_the_guard(frame_id, age_s, passes):
    assert may_pass(frame_id, age_s) is passes


@pytest.mark.parametrize('said_at, now, held', [
    (100.0, 100.4, 0.4), (100.0, 99.0, 0.0), (100.0, 200.0, 0.0), (100.0, 100.0, 0.0)])
def test_what_waited_on_its_own_computer_is_as_old_as_that(said_at, now, held):
    assert held_s(said_at, now) == pytest.approx(held)


# --- frames of tf

def text(words):
    data = words.encode()
    return struct.pack('<I', len(data)) + data


def headed(frame, *rest, number=7):
    return struct.pack('<III', number, 11, 22) + text(frame) + b''.join(rest)


@pytest.mark.parametrize('frame, new', [
    ('odom', 'bot1/odom'), ('/odom', 'bot1/odom'), ('bot1/odom', 'bot1/odom'), ('map', 'map'),
    ('/map', 'map'), ('', ''), ('bot12/odom', 'bot1/bot12/odom')])
def test_names_of_frames(frame, new):
    assert renamer('bot1')(frame.encode()) == new.encode()


def test_a_message_gets_its_number_and_its_frames():
    rename = renamer('bot1')
    data = headed('odom', text('base_link'), b'the rest')
    assert first_text(data) == 'odom'
    assert Wire('message', data).header()[1] == pytest.approx(11.000000022)
    assert rewritten(data, 9, 2, rename) == headed(
        'bot1/odom', text('bot1/base_link'), b'the rest', number=9)
    assert rewritten(data, 9, 1, rename) == headed(
        'bot1/odom', text('base_link'), b'the rest', number=9)
    assert rewritten(b'no header', 9, 0, rename) == b'no header'


@pytest.mark.parametrize('data', [b'', bytes(12), bytes(15), headed('odom')[:-1],
                                  bytes(12) + b'\xff\xff\xff\xff'])
def test_a_message_that_ends_too_early(data):
    with pytest.raises(ValueError):
        rewritten(data, 1, 1, renamer('bot1'))
    with pytest.raises(ValueError):
        first_text(data)


def tf_message(*pairs, mark=b'\x01'):
    return struct.pack('<I', len(pairs)) + b''.join(
        headed(parent, text(child), mark * 56) for parent, child in pairs)


def test_transforms_of_several_nodes_go_together():
    kept = Transforms(renamer('bot1'), keep=False)
    assert kept.take() is None
    kept.add(tf_message(('odom', 'base_link')))
    kept.add(tf_message(('base_link', 'laser'), ('map', 'odom')))
    kept.add(tf_message(('odom', 'base_link'), mark=b'\x02'))
    data = kept.take()
    assert [child for child, _ in transforms(data, lambda name: name)] == [
        b'bot1/base_link', b'bot1/laser', b'bot1/odom']
    assert b'\x02' * 56 in data and kept.take() is None


def test_static_transforms_stay():
    kept = Transforms(renamer('bot1'), keep=True)
    kept.add(tf_message(('base_link', 'laser')))
    assert kept.take() == kept.take() == tf_message(('bot1/base_link', 'bot1/laser'))


@pytest.mark.parametrize('data', [
    b'', b'\x01', struct.pack('<I', 2) + tf_message(('a', 'b'))[4:], struct.pack('<I', 1 << 30),
    tf_message(('a', 'b'))[:-1]])
def test_a_tf_message_that_is_none(data):
    kept = Transforms(renamer('bot1'), keep=True)
    with pytest.raises(ValueError):
        kept.add(data)
    assert kept.take() is None

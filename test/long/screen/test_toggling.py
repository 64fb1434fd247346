# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Views switched on and off 260 times leave nothing behind; one not seen costs nothing.

The switches of the real window are clicked, against a simulated robot that goes on all the while.
"""
import ctypes
import faulthandler
import gc
import logging
import os
import sys
import threading
import time

import psutil
import pytest
import rosgraph

from support.panel_session import PanelSession
from support.ros_system import processes_with

TOGGLES = 200
WARM_UP = 60
# One turn of the switches, every step another set of views; it ends as it began.
STEPS = (('view_imu', False), ('camera_depth', True), ('view_scan', True), ('camera_off', True),
         ('view_imu', True), ('camera_rgb', True), ('view_scan', False), ('camera_off', True),
         ('camera_depth', True), ('camera_rgb', True))
CAMERAS = ('camera_off', 'camera_rgb', 'camera_depth')
# One thread, handle, object or picture left behind by each toggle, or by each turn, would be more
# than these; a connection that is just ending is no leak. What the process holds beside that rises
# and falls by 70 MB with what malloc keeps for later: the panel's memory is what it uses of that.
LIBC = ctypes.CDLL(None)
MARGINS = {'threads': 10, 'handles': 30, 'memory [MB]': 16.0, 'objects': 500}
RGB_TOPIC = '/bot1/camera/rgb/image_raw/compressed'
DEPTH_TOPIC = '/bot1/camera/depth_registered/image_raw/compressedDepth'
IMU_TOPIC, SCAN_TOPIC = '/bot1/mobile_base/sensors/imu_data', '/bot1/scan'
TOPIC_OF = {'imu': IMU_TOPIC, 'rgb': RGB_TOPIC, 'depth': DEPTH_TOPIC, 'scan': SCAN_TOPIC}

# rospy uses names of Python 3.9; pytest would keep a note of each time.
pytestmark = [pytest.mark.filterwarnings('ignore::DeprecationWarning')]


@pytest.fixture(scope='module')
def session():
    # pytest keeps every line that is logged, and rospy logs each connection: that is no leak.
    logging.disable(logging.WARNING)
    running = PanelSession((('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2'),), ('bot1',))
    yield running
    running.close()
    logging.disable(logging.NOTSET)


@pytest.fixture(scope='module')
def master(session):
    return rosgraph.Master('/test_toggling')


@pytest.fixture
def window(session):
    """The tile of bot1 with graph and RGB."""
    opened = session.open('bot1')
    session.presenter.screen.showNormal()
    for name in ('view_imu', 'camera_rgb'):
        session.switch(opened, name)
    session.switch(opened, 'view_scan', False)
    session.until(lambda: fed_keys(session) == {'imu', 'rgb', 'scan'}, what='graph and picture')
    return opened


def fed_keys(session):
    """Return the keys of the views that are fed now."""
    feeds = session.operator.feeds('bot1')
    return {key for key in TOPIC_OF if feeds is not None and feeds.get(key) is not None}


def listeners(master, topic):
    """Return the nodes that subscribe a topic."""
    return dict(master.getSystemState()[1]).get(topic, [])


def panel_topics(master):
    """Return the topics of the views that the panel subscribes, by the master."""
    return {topic for topic in TOPIC_OF.values() if '/mhri_panel' in listeners(master, topic)}


def toggle(session, window, number):
    """Click the next switch and wait until the feeds are those of the switches."""
    name, on = STEPS[number % len(STEPS)]
    assert session.hands.widget(name, window).isChecked() != on
    session.hands.click(name, window)
    # The scan is fed for the nearest thing, too, which a large tile always shows.
    session.until(lambda: fed_keys(session) == window.active_views() | {'scan'},
                  what='{} {}'.format(name, on))
    if name in ('camera_rgb', 'camera_depth') and number // len(STEPS) % 5 == 0:
        # As an operator would: look at it. Else the next click comes while it is being subscribed.
        session.until(lambda: window.view('rgb').picture.frame is not None, what='a picture')


class Allocated(ctypes.Structure):
    """The answer of ``mallinfo2`` (glibc 2.33 and later; see malloc/malloc.h), in bytes."""

    _fields_ = [(name, ctypes.c_size_t) for name in (
        'arena', 'ordblks', 'smblks', 'hblks', 'hblkhd', 'usmblks', 'fsmblks', 'uordblks',
        'fordblks', 'keepcost')]


def use(process):
    """Return what a process holds; of this one the objects, too."""
    held = {'threads': process.num_threads(), 'handles': process.num_fds()}
    if process.pid != os.getpid():
        held['memory [MB]'] = process.memory_info().rss / 1e6
        return held
    held['objects'] = len(gc.get_objects())
    if hasattr(LIBC, 'mallinfo2'):
        LIBC.mallinfo2.restype = Allocated
        allocated = LIBC.mallinfo2()
        held['memory [MB]'] = (allocated.uordblks + allocated.hblkhd) / 1e6
    return held


def growth(now, before):
    return {key: now[key] - before[key] for key in before}


def row(name, figures):
    return 'MEASURED {:<26} {}'.format(name, ', '.join(
        '{} {:.1f}'.format(*item) if 'MB' in item[0] else '{} {}'.format(*item)
        for item in figures.items()))


def test_hundreds_of_toggles_leave_nothing_behind(session, window):
    robot = processes_with('sim_robot', master=session.system.env['ROS_MASTER_URI'])[0]
    panel = psutil.Process()
    for number in range(WARM_UP):
        toggle(session, window, number)
    session.until(lambda: window.view('rgb').picture.frame is not None, what='the picture')
    before = {'panel': use(panel), 'robot': use(robot)}
    for name in before:
        print(row('{}, warm'.format(name), before[name]))
    begun = time.monotonic()
    for number in range(TOGGLES):
        toggle(session, window, number)
        if number % 100 == 99:
            print(row('panel after {} toggles'.format(number + 1), use(panel)), flush=True)
    took_s = time.monotonic() - begun
    session.until(lambda: window.view('rgb').picture.frame is not None, what='the picture')

    def settled():
        return all(value <= MARGINS[key] for name, process in (('panel', panel), ('robot', robot))
                   for key, value in growth(use(process), before[name]).items())
    try:
        session.until(settled, what='what is ending to have ended')
    finally:
        for name, process in (('panel', panel), ('robot', robot)):
            print(row(name + ' at the end', use(process)))
            print(row(name + ' has grown by', growth(use(process), before[name])))
        print('MEASURED {} toggles in {:.1f} s; threads: {}'.format(
            TOGGLES, took_s, ', '.join(sorted({thread.name.split('-')[0]
                                               for thread in threading.enumerate()}))))


class Decodings:
    """Counts the pictures that are really decoded."""

    def __init__(self, monkeypatch):
        from mhri.camera.ros import camera_decoder
        self.count = 0
        self._real = camera_decoder.read_picture
        monkeypatch.setattr(camera_decoder, 'read_picture', self._read)

    def _read(self, *args):
        self.count += 1
        return self._real(*args)


class Onlooker:
    """Another node's eye on the picture, so that the robot goes on sending it."""

    def __init__(self):
        import rospy
        self.count = 0
        self._subscriber = rospy.Subscriber('/bot1/camera/rgb/camera_info', rospy.AnyMsg,
                                            self._on_info, tcp_nodelay=True)

    def _on_info(self, _):
        self.count += 1

    def close(self):
        self._subscriber.unregister()


@pytest.fixture
def onlooker():
    made = Onlooker()
    yield made
    made.close()


def said(session, master, window):
    """Return what is known where the topics are not given back; print where each thread is."""
    faulthandler.dump_traceback(all_threads=True, file=sys.__stdout__)
    return 'the topics to be given back: registered {}, fed {}, wanted {}, visible {}'.format(
        panel_topics(master), fed_keys(session), window.active_views(), window.isVisible())


def hide(window):
    window.window().hide()


def switch_off(window):
    window.findChild(type(window.switches), 'switches').choose(())


@pytest.mark.parametrize('way', [hide, switch_off],
                         ids=lambda way: way.__name__)
def test_a_window_not_seen_costs_nothing(session, master, window, onlooker, monkeypatch, way):
    decodings = Decodings(monkeypatch)
    session.until(lambda: decodings.count > 5, what='pictures to be decoded')
    everything = {IMU_TOPIC, RGB_TOPIC, SCAN_TOPIC}
    rest = {SCAN_TOPIC} if way is switch_off else set()
    session.until(lambda: panel_topics(master) == everything, what='graph and picture')
    begun = time.monotonic()
    way(window)
    session.until(lambda: panel_topics(master) == rest, what=lambda: said(session, master, window))
    gone_s = time.monotonic() - begun
    assert {TOPIC_OF[key] for key in fed_keys(session)} == rest
    session.until(lambda: not any(thread.name == 'camera bot1' for thread in threading.enumerate()),
                  what='the decoder to end')
    counted, sent = decodings.count, onlooker.count
    session.until(lambda: onlooker.count >= sent + 30, what='a second of the camera')
    print('MEASURED {}: the topics are given back after {:.0f} ms; {} pictures decoded while the '
          'camera made {}'.format(way.__name__, 1e3 * gone_s, decodings.count - counted,
                                  onlooker.count - sent))
    assert decodings.count == counted
    again(session, window, way)
    session.until(lambda: decodings.count > counted + 3
                  and panel_topics(master) == everything, what='pictures to come again')


def again(session, window, way):
    """Bring back what was hidden."""
    if way is switch_off:
        for name in ('view_imu', 'camera_rgb'):
            session.switch(window, name)
    else:
        window.window().showNormal()

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen as a plugin of a program that has its ROS node already; the drive says little."""
import gc
import threading
import time

import psutil
import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLabel, QWidget

from support import graph
from support.ros_system import child_processes, System
from support.rqt_stand_in import Context, plugin_class
from support.rich_text import takes_for_html

NODE = '/rqt_gui_py_node'
# More than any text of others may be; what names several robots is a few of them long.
LONG, LONG_LIST = 300, 20_000
HOSTILE = '<img src="/tmp/x.png"><b>\n\u202e' + 'a' * 100_000


@pytest.fixture(scope='module')
def drive():
    """The drive of a master of our own; this process is a node of it, as rqt is."""
    import rospy
    from support.fake_drive import FakeDrive
    with System() as system:
        system.start_master()
        rospy.init_node(NODE[1:], disable_signals=True)
        rospy.set_param(graph.SOURCES, [
            {'name': 'ps3joy', 'label': 'Pad', 'suspend_service': '/mhri_joy/set_suspended'}])
        drive = FakeDrive()
        yield drive
        drive.close()


@pytest.fixture
def plugins(drive, operator, monkeypatch):
    """A function that opens a plugin with one robot, and one that closes it as rqt does."""
    from mhri.events.presenters import event_presenter
    # Its player is to be there as well.
    monkeypatch.setattr(event_presenter, 'START_MS', 1)
    make, presenters = plugin_class(monkeypatch)
    opened = []

    def begin():
        opened.append(make(Context('--robots', 'bot1')))
        presenter = presenters[-1]
        # A window that becomes active later lets go of what a test holds by then.
        operator.show(presenter.screen)
        view = presenter.operator.view
        operator.wait_until(lambda: view().ros == 'connected' and view().control.ours
                            and presenter.windows)
        return presenter

    def end():
        opened.pop().shutdown_plugin()
        presenters.pop().screen.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.DeferredDelete)
    yield begin, end
    while opened:
        end()


def test_stop_all_held_cuts_the_power_of_the_motors(drive, plugins, operator):
    bar = plugins[0]().screen.stop_bar
    del drive.power[:]
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    operator.wait_until(lambda: drive.power)
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert drive.power == [False]
    operator.wait_until(lambda: 'bot1' in bar.findChild(QLabel, 'stop_note_label').text())


def sent(topic, kind, operator, **fields):
    """Publish a message once somebody listens; return the publisher."""
    import rospy
    publisher = rospy.Publisher(topic, kind, queue_size=1, latch=True)
    operator.wait_until(publisher.get_num_connections)
    publisher.publish(**fields)
    return publisher


def check_texts(screen):
    """Fail where a widget has a text that is long, or would be taken for HTML."""
    for widget in [screen, *screen.findChildren(QWidget)]:
        assert not takes_for_html(widget), widget.objectName()
        assert len(widget.toolTip()) < LONG_LIST
        assert not isinstance(widget, QLabel) or len(widget.text()) < LONG_LIST


def test_texts_of_others_are_shown_in_a_few_plain_words(plugins, operator):
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
    from mhri.msg import Heard, PanelRequest
    presenter = plugins[0]()
    publishers = [
        sent(graph.PANEL_REQUEST, PanelRequest, operator, action=HOSTILE),
        sent(graph.HEARD, Heard, operator, text=HOSTILE, command=HOSTILE, reason=HOSTILE),
        sent('/mhri_joy/device_state', DiagnosticStatus, operator, name=HOSTILE, message=HOSTILE,
             hardware_id=HOSTILE, values=[KeyValue('there', HOSTILE)] * 5)]

    def refusals():
        return [event.text for event in presenter.parts['events'].log.events
                if event.kind == 'request.refused']
    operator.wait_until(refusals)
    publishers[0].publish(action='select', robots=(HOSTILE[:500],) * 2000)
    operator.wait_until(lambda: len(refusals()) == 2)
    said = presenter.screen.look_label.text()
    assert said and len(said) < LONG_LIST and said.isprintable()
    view = presenter.operator.view
    operator.wait_until(lambda: view().heard and view().devices)
    heard, device = view().heard, view().devices[0]
    for text in (*refusals(), heard.text, heard.command, heard.reason, device.name, device.note,
                 device.kind, *device.there, *sum(view().sources, ())):
        assert len(text) < LONG and text.isprintable()
    presenter.draw()
    check_texts(presenter.screen)
    for publisher in publishers:
        publisher.unregister()


def registered():
    """Return what the master has of this process: {(publishers, ... ; name)}."""
    import rosgraph
    return {(kind, name) for kind, rows in enumerate(rosgraph.Master(NODE).getSystemState())
            for name, nodes in rows if NODE in nodes}


def held():
    """Return what this process holds: (threads, handles, child processes)."""
    gc.collect()
    process = psutil.Process()
    return len(threading.enumerate()), process.num_fds(), len(process.children(recursive=True))


def test_four_plugins_that_were_closed_leave_nothing(drive, plugins, operator):
    """No thread, no process, no topic, and no status of theirs: rqt lives on."""
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    begin, end = plugins
    statuses = []
    subscriber = rospy.Subscriber('/diagnostics', DiagnosticArray, lambda message: statuses.extend(
        (time.monotonic(), one.name) for one in message.status))
    at_first = registered()

    def open_and_close():
        begin()
        operator.wait_until(lambda: {
            (0, '/panel/events'), (0, graph.STICK), (1, graph.TASK_LIST)} <= registered())
        operator.wait_until(lambda: child_processes('stop_watch_process')
                            and child_processes('speaker'))
        operator.wait_until(lambda: statuses)
        end()
        try:
            operator.wait_until(lambda: registered() <= at_first)
        finally:
            print('left at the master:', sorted(registered() - at_first))
    open_and_close()
    operator.settle()
    before = held()
    for _ in range(4):
        del statuses[:]
        open_and_close()
    try:
        # Less than one of each plugin: some are on their way.
        operator.wait_until(lambda: all(now <= then + few for now, then, few in zip(
            held(), before, (3, 3, 0))))
    finally:
        print('MEASURED four plugins closed: threads, handles, children {} -> {}'.format(
            before, held()), sorted(thread.name for thread in threading.enumerate()))
    # Each plugin publishes once a second; one message may still be on its way.
    operator.wait_until(lambda: time.monotonic() - statuses[-1][0] > 2.5)
    subscriber.unregister()

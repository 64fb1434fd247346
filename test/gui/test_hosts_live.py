# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen as a plugin of a program that has its ROS node already, with gates that say little."""
import gc
import os
import sys
import threading
import time

import psutil
import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLabel, QWidget

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.graph import SET_STOP_ALL  # noqa: E402
from support.ros_system import System  # noqa: E402
from support.rqt_stand_in import Context, plugin_class  # noqa: E402
from test_hostile_text import takes_for_html  # noqa: E402

NODE = '/rqt_gui_py_node'
# More than any text of others may be; what names several robots is a few of them long.
LONG, LONG_LIST = 300, 20_000
HOSTILE = '<img src="/tmp/x.png"><b>\n\u202e' + 'a' * 100_000


@pytest.fixture(scope='module')
def gates():
    """The gates of a master of our own; this process is a node of it, as rqt is."""
    import rospy
    from support.fake_gates import FakeGates
    with System() as system:
        system.start_master()
        rospy.init_node(NODE[1:], disable_signals=True)
        rospy.set_param('/mux/sources', [
            {'name': 'ps3joy', 'label': 'Pad', 'suspend_service': '/mhri_joy/set_suspended'}])
        gates = FakeGates()
        yield gates
        gates.close()


@pytest.fixture
def plugins(gates, operator, monkeypatch):
    """A function that opens a plugin with one robot, and one that closes it as rqt does."""
    from mhri.screen.presenters import event_host
    # Its player is to be there as well.
    monkeypatch.setattr(event_host, 'START_MS', 1)
    make, opened = plugin_class(monkeypatch), []

    def begin():
        plugin = make(Context('--robots', 'bot1'))
        opened.append(plugin)
        plugin._host.screen.show()
        view = plugin._host.operator.view
        operator.wait_until(lambda: view().ros == 'connected' and view().control.ours
                            and plugin._host.windows)
        return plugin

    def end(plugin):
        opened.remove(plugin)
        plugin.shutdown_plugin()
        plugin._host.screen.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.DeferredDelete)
    yield begin, end
    for plugin in list(opened):
        end(plugin)


def test_stop_all_held_cuts_the_power_of_the_motors(gates, plugins, operator):
    import rospy
    from std_srvs.srv import SetBool
    # Where nobody takes the stop, that is said again and again, and is worth more.
    mux = rospy.Service(SET_STOP_ALL, SetBool, lambda _: (True, ''))
    bar = plugins[0]()._host.screen.stop_bar
    del gates.power[:]
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    operator.wait_until(lambda: gates.power)
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert gates.power == [False]
    operator.wait_until(lambda: bar.findChild(QLabel, 'stop_note_label').text()
                        == 'bot1: motor power cut')
    mux.shutdown()


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


@pytest.mark.parametrize('action, robots', [(HOSTILE, ()), ('select', (HOSTILE,) * 3),
                                            ('select', ('x' * 500,) * 2000)],
                         ids=['action', 'robots', 'many robots'])
def test_a_request_of_any_length_is_told_in_a_few_plain_words(plugins, operator, action, robots):
    from mhri.msg import PanelRequest
    host = plugins[0]()._host
    publisher = sent('/panel_in/request', PanelRequest, operator, action=action, robots=robots)

    def told():
        return [event.text for event in host.events.log.events if event.kind == 'request.refused']
    operator.wait_until(told)
    publisher.unregister()
    text, = told()
    assert text.startswith('not done: ') and len(text) < LONG and text.isprintable()
    said = host.screen.look_label.text()
    assert said.startswith('not done: ') and len(said) < LONG_LIST and said.isprintable()
    check_texts(host.screen)


def test_what_input_nodes_say_is_shown_in_a_few_plain_words(plugins, operator):
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
    from mhri.msg import Heard
    host = plugins[0]()._host
    publishers = [
        sent('/mhri_voice/heard', Heard, operator, text=HOSTILE, command=HOSTILE, reason=HOSTILE),
        sent('/mhri_joy/device_state', DiagnosticStatus, operator, name=HOSTILE, message=HOSTILE,
             hardware_id=HOSTILE, values=[KeyValue('there', HOSTILE)] * 5)]
    view = host.operator.view
    operator.wait_until(lambda: view().heard and view().devices)
    heard, device = view().heard, view().devices[0]
    for text in (heard.text, heard.command, heard.reason, device.name, device.note, device.kind,
                 *device.there, *sum(view().sources, ())):
        assert len(text) < LONG and text.isprintable()
    host.draw()
    check_texts(host.screen)
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


def test_ten_plugins_that_were_closed_leave_nothing(gates, plugins, operator):
    """No thread, no process, no topic, and no status of theirs: rqt lives on."""
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    begin, end = plugins
    statuses = []
    ear = rospy.Subscriber('/diagnostics', DiagnosticArray, lambda message: statuses.extend(
        one.name for one in message.status))
    at_first = registered()

    def open_and_close():
        plugin = begin()
        host = plugin._host
        operator.wait_until(lambda: {
            (0, '/panel/events'), (0, '/mux_in/joy'), (1, '/mhri_tasks/list')} <= registered())
        operator.wait_until(lambda: {'stop_watch_process', 'speaker'} <= {
            word.rpartition('.')[2] for child in psutil.Process().children()
            for word in child.cmdline()})
        operator.wait_until(lambda: statuses)
        end(plugin)
        del host, plugin
        try:
            operator.wait_until(lambda: registered() <= at_first)
        finally:
            print('left at the master:', sorted(registered() - at_first))
    open_and_close()
    operator.settle()
    before = held()
    for _ in range(10):
        del statuses[:]
        open_and_close()
    try:
        # Less than one of each plugin: some are on their way.
        operator.wait_until(lambda: all(now <= then + few for now, then, few in zip(
            held(), before, (3, 5, 0))))
    finally:
        print('MEASURED ten plugins closed: threads, handles, children {} -> {}'.format(
            before, held()), sorted(thread.name for thread in threading.enumerate()))
    del statuses[:]
    begun = time.monotonic()
    operator.wait_until(lambda: time.monotonic() - begun > 2.5)
    ear.unregister()
    assert statuses == []

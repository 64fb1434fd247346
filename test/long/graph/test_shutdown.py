# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A signal ends a node whatever its threads do, and its last words are said whole."""
import contextlib
import signal
import sys
import xmlrpc.client

import pytest
import rosgraph

from support import made_session
from support.paths import GUARD
from support.ros_system import System, wait_for

# The main thread holds what the last words need, as it does in the middle of a question to the
# master: rospy's own handler would wait for it on this very thread.
NODE = '''
import sys, threading, time
import rospy
from mhri.graph.ros.shutdown import init_node

def last_words():
    with lock:
        time.sleep(0.3)
        print('said', flush=True)

lock = threading.Lock()
init_node('patient')
rospy.on_shutdown(last_words)
with lock:
    print('ready', flush=True)
    while not rospy.core.is_shutdown_requested():
        time.sleep(0.01)
if sys.argv[1] == 'spin':
    rospy.spin()
'''


ASLEEP = '''
import signal, threading, time
import rospy
from mhri.graph.ros.shutdown import init_node

def last_words():
    print('said', flush=True)
    told.set()

def signal_to_another_thread():
    signal.pthread_kill(threading.get_ident(), signal.SIGHUP)
    told.wait(30.0) or print('in vain', flush=True)
    import os
    os._exit(0)

told = threading.Event()
init_node('sleeper')
rospy.on_shutdown(last_words)
threading.Thread(target=signal_to_another_thread).start()
time.sleep(60.0)
'''

# Slow where rospy has told the master that it goes, but not yet itself.
WATCHED = '''
import time
import rospy
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.shutdown import init_node

init_node('watched')
MasterWatch(period_s=0.01).start()
rospy.core.add_preshutdown_hook(lambda reason: time.sleep(0.5))
print('ready', flush=True)
rospy.spin()
'''


LOGS = '''
import rospy
from mhri.graph.ros.shutdown import init_node

init_node('logs')
rospy.loginfo('a line')
print('ready', flush=True)
rospy.spin()
'''


# A busy computer does something else in the middle of publishing: the topic is closed by then, and
# the process ends a second later.
LATE = '''
import importlib, sys, threading, time
import rospy, rospy.topics

def late(self, *words, **named):
    here.publishes = self.resolved_name == topic
    try:
        return publish(self, *words, **named)
    finally:
        here.publishes = False

def has_connections(self):
    found = connected(self)
    if found and getattr(here, 'publishes', False):
        if not begun:
            begun.append(rospy.core.add_shutdown_hook(lambda reason: time.sleep(1.0)))
            print('speaks', flush=True)
        time.sleep(0.3)
    return found

begun, here = [], threading.local()
node, topic = sys.argv[1:3]
del sys.argv[1:3]
publish, rospy.Publisher.publish = rospy.Publisher.publish, late
connected = rospy.topics._PublisherImpl.has_connections
rospy.topics._PublisherImpl.has_connections = has_connections
importlib.import_module('mhri.nodes.' + node).main()
'''


@pytest.fixture(scope='module')
def system():
    with System(adopt=False) as made:
        made.start_master()
        yield made


def text(process):
    with open(process.log) as log:
        return log.read()


@pytest.mark.parametrize('number, then', [
    (signal.SIGINT, 'spin'), (signal.SIGTERM, 'return')])
def test_a_busy_main_thread_is_not_waited_for(system, number, then):
    process = system.start(sys.executable, '-c', NODE, then)
    wait_for(lambda: 'ready' in text(process), 60.0, lambda: text(process))
    process.send_signal(number)
    assert process.wait(60) == 0, text(process)
    assert text(process).splitlines()[-1] == 'said'


def test_a_signal_that_does_not_wake_the_main_thread_is_heard(system):
    """As one that comes just before that falls asleep: it is heard within its sleep of a minute."""
    process = system.start(sys.executable, '-c', ASLEEP)
    assert process.wait(60) == 0, text(process)
    assert text(process).splitlines()[-1] == 'said'


def test_a_node_that_goes_does_not_register_again(system):
    process = system.start(sys.executable, '-c', WATCHED)
    wait_for(lambda: 'ready' in text(process), 60.0, lambda: text(process))
    process.send_signal(signal.SIGTERM)
    assert process.wait(60) == 0 and 'registered again' not in text(process), text(process)
    with pytest.raises(rosgraph.MasterError):
        rosgraph.Master('/test', system.env['ROS_MASTER_URI']).lookupNode('/watched')


@pytest.mark.parametrize('command, name', [
    ([sys.executable, '-c', LOGS], '/logs'), ([sys.executable, GUARD], '/mhri_guard')])
def test_the_master_ends_a_node_by_its_name_alone(system, command, name):
    """It tells the address of one that has gone, where another one may listen by now."""
    process = system.start(*command)
    master = rosgraph.Master('/test', system.env['ROS_MASTER_URI'])

    def address():
        with contextlib.suppress(rosgraph.MasterError):
            return master.lookupService(name + '/get_loggers') and master.lookupNode(name)

    node = xmlrpc.client.ServerProxy(wait_for(address, what='the node'))
    assert node.shutdown('/master', '[/gone] Reason: new node registered with same name')[0] == 1
    assert node.getPid('/test')[2] == process.pid
    # It may be gone before it has answered, and the client asks a second time.
    with contextlib.suppress(OSError):
        node.shutdown('/master', '[{}] Reason: new node registered with same name'.format(name))
    assert process.wait(60) == 0, text(process)
    with pytest.raises(rosgraph.MasterError):
        master.lookupNode(name)


@pytest.mark.parametrize('node, topic, number', [
    ('mhri_replay', '/bot1/odom', signal.SIGINT),
    ('tasks', '/mhri_tasks/run/status', signal.SIGTERM)])
def test_what_is_said_at_the_end_leaves_no_traceback(system, tmp_path, node, topic, number):
    """The replay plays, and actionlib's timer comes, while the topics are being closed."""
    words = [str(made_session.write_session(tmp_path / 'session'))] if node == 'mhri_replay' else []
    listener = system.start('rostopic', 'echo', '--noarr', topic)
    process = system.start(sys.executable, '-c', LATE, node, topic, *words)
    wait_for(lambda: 'speaks' in text(process), 60.0, lambda: text(process))
    process.send_signal(number)
    assert process.wait(60) == 0 and 'Traceback' not in text(process), text(process)
    system.kill(listener)


def test_without_a_master_a_signal_ends_it(system):
    process = system.start('env', 'ROS_MASTER_URI=http://127.0.0.1:9', sys.executable, '-c', NODE,
                           'spin')
    wait_for(lambda: 'master' in text(process), 60.0, lambda: text(process))
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 128 + signal.SIGINT

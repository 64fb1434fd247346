# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU of the voice's node, with the processes it begins, and how long a spoken word takes to act.

The real node; a FIFO is its microphone, into which speech of espeak-ng is written in real time.
Times count from the end of the last word's sound: a command waits for the pause that ends it
(0.4 s), a stop waits for nothing and may come before the end of its word. Goal: suspended as good
as nothing, a quiet room below 5 % of a core.
"""
import argparse
import contextlib
import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import speech  # noqa: E402
from support.room import Room, tree_cpu_s  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

SERVICE = '/mhri_voice/set_suspended'
VOICE = speech.Voice('en-us+m3', 150, 50)
TALK = 'we measured the temperature in the hall, and the robot was on the other side of it'


def measure_cpu(node, seconds, state, busy=lambda: None):
    """Print a row; ``busy`` says something, again and again while it is measured."""
    begun, before = time.monotonic(), tree_cpu_s(node.pid)
    while time.monotonic() - begun < seconds:
        busy()
        time.sleep(0.1)
    spent = 100.0 * (tree_cpu_s(node.pid) - before) / (time.monotonic() - begun)
    print('{:<46} {:>12.2f}'.format(state, spent), flush=True)


def silent_tail_s(text):
    """Return how long espeak-ng goes on after the last sound of a sentence [s]."""
    sound = np.abs(speech.speak(text, VOICE))
    loud = np.nonzero(sound > 0.03 * sound.max())[0]
    return (len(sound) - loud[-1] - 1) / speech.RATE_HZ


def drive(room, joys):
    """Say a motion until it is obeyed: a busy computer refuses what it has understood too late."""
    for _ in range(20):
        begun = time.monotonic()
        room.say('robot drive forward', VOICE)
        with contextlib.suppress(AssertionError):
            wait_for(lambda: any(at > begun and any(axes) for at, axes in list(joys)), 5.0)
            return
    raise AssertionError('no motion is obeyed')


def measure_delay(room, joys, refused, text, good, times):
    """Print how long after the end of a sentence the first Joy comes that is good(axes).

    Sentences that are not obeyed are said again, and counted.

    :param refused: list of why utterances were refused, which goes on by itself
    """
    delays, missed = [], 0
    del refused[:]
    while len(delays) < times:
        wait_for(lambda: not any(joys[-1][1]), 10.0, 'the end of the motion before')
        if text == 'stop':
            drive(room, joys)
        del joys[:-1]
        begun = time.monotonic()
        out = room.say(text, VOICE) - silent_tail_s(text)
        try:
            found = wait_for(lambda: [at for at, axes in list(joys) if at > begun and good(axes)],
                             5.0, 'what follows from "{}"'.format(text))
        except AssertionError:
            missed += 1
            if missed > 20:
                print('refused:', refused, flush=True)
                raise
            continue
        delays.append(1000.0 * (found[0] - out))
    delays.sort()
    print('{:<46} {:>12.0f} {:>12.0f} {:>12.0f}   n = {}, missed {}'.format(
        '"{}"'.format(text), delays[len(delays) // 2], delays[len(delays) * 99 // 100], delays[-1],
        times, missed), *refused, sep='\n  refused: ', flush=True)


def measure(system, seconds, times):
    """Print both tables."""
    import rospy
    from sensor_msgs.msg import Joy
    from mhri.msg import Heard
    from mhri.srv import SetSuspended
    rospy.init_node('bench_voice_node', disable_signals=True)
    joys, refused, room = [], [], Room()
    rospy.Subscriber('/mux_in/voice', Joy, lambda joy: joys.append((time.monotonic(), joy.axes)),
                     queue_size=1000, tcp_nodelay=True)
    rospy.Subscriber('/mhri_voice/heard', Heard, lambda heard: heard.accepted or refused.append(
        '"{0.text}" ({0.confidence:.2f}): {0.reason}'.format(heard)), queue_size=100)
    node = system.node('mhri_voice', '_source:=microphone:none of this name')
    rospy.wait_for_service(SERVICE, 30.0)
    set_suspended = rospy.ServiceProxy(SERVICE, SetSuspended)
    print('{:<46} {:>12}'.format('mhri_voice', '% of a core'))
    measure_cpu(node, seconds, 'suspended, never resumed')
    set_suspended(False)
    wait_for(lambda: 'no microphone' in set_suspended(False).message, 30.0, 'the search')
    measure_cpu(node, seconds, 'looking for a microphone')
    rospy.set_param('/mhri_voice/source', room.path)
    wait_for(lambda: joys, 30.0, 'the microphone')
    measure_cpu(node, seconds, 'listening to a quiet room')
    measure_cpu(node, seconds, 'listening to talk without an end',
                lambda: room.say(TALK, VOICE))
    print('{:<46} {:>12} {:>12} {:>12}'.format(
        'end of the sound to the Joy [ms]', 'median', '99 %', 'longest'))
    measure_delay(room, joys, refused, 'robot drive forward', any, times)
    measure_delay(room, joys, refused, 'stop', lambda axes: not any(axes), times)
    set_suspended(True)
    print('{:<46} {:>12}'.format('mhri_voice', '% of a core'))
    measure_cpu(node, seconds, 'suspended again')
    room.end()


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer seconds and sentences')
    parser.add_argument('--times', type=int, default=10, help='how often each sentence is said')
    options = parser.parse_args()
    with System() as system:
        system.start_master()
        measure(system, *((1.0, 1) if options.short else (15.0, options.times)))


if __name__ == '__main__':
    main()

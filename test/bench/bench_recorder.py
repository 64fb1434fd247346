# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU for each recorded message: mhri's recorder beside ``rosbag record`` (C++), at the same time.

Four robots send IMU messages at 200 Hz each, one after the other, from one process. They are
recorded at once by one process with four of mhri's recorders (one bag for each robot), by one
``rosbag record`` with all four topics in one bag, and by four ``rosbag record`` (one bag for each
robot, as mhri does). What is measured is the time of the processor, of user and system, in
microseconds for each message.
Goal: ratio at most 1.0 to the single ``rosbag record``.
"""
import argparse
import os
import signal
import sys
import threading
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

ROBOTS = ['bot{}'.format(number + 1) for number in range(4)]
TOPICS = ['/{}/imu'.format(robot) for robot in ROBOTS]
RATE_HZ = 200.0
# Who has to be connected to each topic before anything is sent: mhri, one record, and its own.
LISTENERS = 3


def publish(seconds):
    """Send until the time is over, at the pace of a clock."""
    import rospy
    from sensor_msgs.msg import Imu
    rospy.init_node('imus', disable_signals=True)
    publishers = [rospy.Publisher(topic, Imu, queue_size=1000, tcp_nodelay=True)
                  for topic in TOPICS]
    wait_for(lambda: all(publisher.get_num_connections() >= LISTENERS
                         for publisher in publishers), 40.0, 'all recorders')
    message, due = Imu(), time.monotonic()
    for number in range(int(seconds * RATE_HZ) * len(publishers)):
        message.header.stamp = rospy.Time.from_sec(time.time())
        publishers[number % len(publishers)].publish(message)
        due += 1.0 / RATE_HZ / len(publishers)
        time.sleep(max(0.0, due - time.monotonic()))
    time.sleep(1.0)


def record(folder):
    """Record each robot into a folder until told to end."""
    import rospy
    from mhri.recording.ros.recorder import Recorder
    rospy.init_node('recorders', disable_signals=True)
    recorders = [Recorder(robot, [topic], os.path.join(folder, robot))
                 for robot, topic in zip(ROBOTS, TOPICS)]
    for recorder in recorders:
        recorder.start()
    done = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: done.set())
    done.wait()
    for recorder in recorders:
        recorder.stop()
    for recorder in recorders:
        recorder.stop(wait=True)


def cpu_s(processes):
    """Return the processor time of some processes [s]."""
    times = [psutil.Process(process.pid).cpu_times() for process in processes]
    return sum(entry.user + entry.system for entry in times)


def messages_in(folder, prefix):
    """Return the messages in the bags of a folder whose names begin alike."""
    import rosbag
    total = 0
    for name in os.listdir(folder):
        if name.startswith(prefix):
            with rosbag.Bag(os.path.join(folder, name)) as bag:
                total += bag.get_message_count()
    return total


def measure(system, seconds):
    """Return {way: (CPU [s], messages in the bags)} and the number of messages sent."""
    tool = '/opt/ros/noetic/lib/rosbag/record'
    tool = tool if os.path.exists(tool) else '/usr/lib/rosbag/record'
    one = system.start(tool, '-O', os.path.join(system.home, 'one'), *TOPICS)
    each = [system.start(tool, '-O', os.path.join(system.home, 'each_' + robot), topic)
            for robot, topic in zip(ROBOTS, TOPICS)]
    own = system.start(sys.executable, os.path.abspath(__file__), '--record', system.home)
    ways = {'mhri, a bag for each robot': ([own], 'bot'),
            'rosbag record, one bag for all': ([one], 'one'),
            'rosbag record, one for each robot': (each, 'each')}
    sender = system.start(sys.executable, os.path.abspath(__file__), '--publish', str(seconds))
    active = [os.path.join(system.home, robot + '.bag.active') for robot in ROBOTS]
    wait_for(lambda: all(os.path.exists(path) and os.path.getsize(path) > 5000
                         for path in active), 60.0, 'the first messages')
    begun = {name: cpu_s(processes) for name, (processes, _) in ways.items()}
    since = time.monotonic()
    wait_for(lambda: sender.poll() is not None, seconds + 60.0, 'the sender', poll_s=0.05)
    # The sender waits a second after the last message; the first half second is not measured.
    sent = RATE_HZ * len(ROBOTS) * (time.monotonic() - since - 1.0)
    spent = {name: cpu_s(processes) - begun[name] for name, (processes, _) in ways.items()}
    for processes, _ in ways.values():
        for process in processes:
            process.send_signal(signal.SIGTERM if process is own else signal.SIGINT)
            process.wait(20)
    return {name: (spent[name], messages_in(system.home, prefix))
            for name, (_, prefix) in ways.items()}, sent


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer seconds')
    parser.add_argument('--publish', type=float, help=argparse.SUPPRESS)
    parser.add_argument('--record', help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.publish:
        publish(options.publish)
        return
    if options.record:
        record(options.record)
        return
    seconds = 2.5 if options.short else 30.0
    with System() as system:
        system.start_master()
        found, sent = measure(system, seconds)
    print('4 robots x 200 Hz IMU               us/message     % of a core   messages in the bags')
    for name, (spent_s, messages) in found.items():
        print('{:<36} {:>9.1f} {:>13.2f} {:>17} of {}'.format(
            name, spent_s / sent * 1e6, spent_s / sent * 100 * RATE_HZ * len(ROBOTS), messages,
            int(seconds * RATE_HZ) * len(ROBOTS)))
    own, one, each = (spent_s for spent_s, _ in found.values())
    print('ratio mhri / rosbag record: {:.2f} (one bag for all), {:.2f} (one for each)'.format(
        own / one, own / each))


if __name__ == '__main__':
    main()

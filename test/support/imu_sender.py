# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A process that sends IMU messages on some topics and knows exactly what it sent.

``imu_sender.py SECONDS HZ TOPIC...`` waits for a listener on every topic, sends no two messages
alike, and prints {topic: [count, SHA-1 of all messages in order]} as JSON at its end.
"""
import hashlib
import io
import json
import sys
import time

import rospy
from sensor_msgs.msg import Imu


class Sender:
    """One topic, with the hash of what was sent on it."""

    def __init__(self, topic):
        self.publisher = rospy.Publisher(topic, Imu, queue_size=10000)
        self.count = 0
        self.hash = hashlib.sha1()
        self._message = Imu()
        self._message.header.frame_id = topic

    def send(self):
        message = self._message
        message.header.stamp = rospy.Time.from_sec(time.time())
        message.angular_velocity.z = self.count
        self.publisher.publish(message)
        # Only now has rospy put its sequence number in.
        buffer = io.BytesIO()
        message.serialize(buffer)
        self.hash.update(buffer.getvalue())
        self.count += 1


def main():
    seconds, rate_hz, topics = float(sys.argv[1]), float(sys.argv[2]), sys.argv[3:]
    rospy.init_node('imu_sender', anonymous=True, disable_signals=True)
    senders = [Sender(topic) for topic in topics]
    while not all(sender.publisher.get_num_connections() for sender in senders):
        time.sleep(0.01)
    due = time.monotonic()
    for number in range(int(seconds * rate_hz * len(senders))):
        senders[number % len(senders)].send()
        due += 1.0 / rate_hz / len(senders)
        time.sleep(max(0.0, due - time.monotonic()))
    # The queues of the publishers are emptied by threads of their own.
    time.sleep(1.0)
    print(json.dumps({sender.publisher.name: [sender.count, sender.hash.hexdigest()]
                      for sender in senders}), flush=True)


if __name__ == '__main__':
    main()

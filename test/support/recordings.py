# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of the numbered texts that the publisher of the fault tests sends."""
import rosbag

from support.ros_system import wait_for


def record(path, messages=20, limits=None, until=None):
    """Record until there are some messages (or a condition holds); return the last status."""
    from mhri.recording.recording import RecordingLimits
    from mhri.recording.ros.recorder import Recorder
    recorder = Recorder('bot1', ['/bot1/text'], path, limits or RecordingLimits())
    recorder.start()
    try:
        wait_for(lambda: (until or (lambda status: status.messages >= messages))(
            recorder.status()), 30, 'the recording')
    finally:
        ended = recorder.stop(wait=True)
    assert ended
    return recorder.status()


def numbers_in(path):
    """Return the numbers of the messages of a bag, which must follow one another."""
    with rosbag.Bag(path) as bag:
        found = [int(message.data[:8]) for _, message, _ in bag.read_messages()]
    assert found == list(range(found[0], found[0] + len(found)) if found else [])
    return found

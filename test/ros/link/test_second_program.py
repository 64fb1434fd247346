# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two programs of one name on the link: the first is linked until it is gone, and both say so."""
import collections
import queue
import threading

import pytest

from mhri.link.carried import COMMAND
from mhri.link.ros.side import Side
from support.ros_system import wait_for


class Air:
    """Carries messages in order; whoever is in ``cut`` is neither heard nor hears.

    It does so on a thread of its own, as a network does: two ends that send at the same moment
    would wait for each other's lock.
    """

    def __init__(self):
        self.cut = set()
        self._ends = collections.defaultdict(list)
        self._sent = queue.Queue()
        threading.Thread(target=self._carry, daemon=True).start()

    def _carry(self):
        for name, way, topic, data in iter(self._sent.get, None):
            for other, call in self._ends[way]:
                if not self.cut & {name, other}:
                    call(topic, data)
            self._sent.task_done()

    def wait(self):
        """Wait until what was sent has arrived."""
        wait_for(lambda: not self._sent.unfinished_tasks, what='the messages to arrive')

    def end(self):
        """Carry nothing more."""
        self._sent.put(None)

    def between(self, name):
        """Return the carrier of one end."""
        air = self

        class Between:
            def listen(self, way, call):
                """Call a function of (topic, bytes) for each message of that way."""
                air._ends[way].append((name, call))

            def sender(self, way, topic, _):
                """Return the function that sends a stream."""
                return lambda data: air._sent.put((name, way, topic, data))
        return Between()


class End(Side):
    """One end: keeps what it takes."""

    def __init__(self, air, name, way):
        super().__init__(name, air.between(name), way)
        self.taken, self.over = [], False

    def on_peer(self, beat, now):
        """Take a beat."""

    def on_frame(self, topic, frame, now):
        """Take a message."""
        self.taken.append(frame.body)

    def said(self):
        """Return (about, requested)."""
        return '', ()

    def work(self, now):
        """Do nothing."""

    def silence_text(self, silence_s):
        """Describe the silence."""
        return 'silent'

    def second_text(self):
        """Describe a second one."""
        return 'a second one'

    def ended(self):
        """Return whether this test is over."""
        return self.over

    def linked(self):
        """Return whether it is linked, and knows of no second one."""
        with self.lock:
            now = self.clock()
            return self.peer.is_live(now), self.has_second(now)


@pytest.mark.parametrize('way, back', [('down', 'up'), ('up', 'down')])
def test_the_first_is_linked_until_it_is_gone(way, back):
    """Of two hosts of one name, and of two robots."""
    air = Air()
    other, first, second = (End(air, name, to) for name, to in (
        ('other', back), ('first', way), ('second', way)))
    try:
        other.start()
        first.start()
        wait_for(lambda: first.linked() == other.linked() == (True, False), what='the link')
        second.start()
        wait_for(lambda: second.linked() == (False, True) and other.linked() == (True, True),
                 what='both to know of the second')
        for end in (second, first):
            end.send('command', COMMAND, end.name.encode())
        air.wait()
        assert other.taken == [b'first']
        air.cut.add('first')
        wait_for(lambda: second.linked() == other.linked() == (True, False), what='the second')
        air.cut.clear()
        wait_for(lambda: first.linked() == (False, True), what='the first to know')
        other.taken.clear()
        for end in (first, second):
            end.send('command', COMMAND, end.name.encode())
        air.wait()
        assert other.taken == [b'second']
    finally:
        for end in (other, first, second):
            end.over = True
        air.end()

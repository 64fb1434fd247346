# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The end of a screen closes what its worker is opening just then."""
import threading
from types import SimpleNamespace

from mhri.graph.ros.worker import Worker
from mhri.robots.ros import bot_feeds

TIMEOUT_S = 20.0


class SlowFeed:
    """A feed that opens when it is let."""

    def __init__(self, *_):
        self.opening, self.go_on, self.was_open = (threading.Event() for _ in range(3))
        self.opened = False

    def of(self, *_):
        """Return itself: the feed of every robot."""
        return self

    def open(self):
        """Ask a master that takes its time."""
        self.opening.set()
        assert self.go_on.wait(TIMEOUT_S)
        self.opened = True
        self.was_open.set()

    def close(self):
        """Give the topics back."""
        self.opened = False


def test_a_feed_that_is_being_opened_is_closed(monkeypatch):
    feed = SlowFeed()
    monkeypatch.setattr(bot_feeds, 'VIEW_ROWS', [SimpleNamespace(key='scan', feed='')])
    monkeypatch.setattr(bot_feeds, 'load', lambda path: feed)
    monkeypatch.setattr(bot_feeds, 'MOCAP', SimpleNamespace(key='mocap', stream=SlowFeed))
    worker = Worker('feeds').start()
    feeds = bot_feeds.BotFeeds('bot1', SimpleNamespace(imu=''), worker)
    feeds.request(['scan'])
    assert feed.opening.wait(TIMEOUT_S)
    worker.stop()
    closing = threading.Thread(target=feeds.close)
    closing.start()
    # Where it does not wait for the worker, it is done before the feed is open.
    closing.join(0.2)
    feed.go_on.set()
    closing.join(TIMEOUT_S)
    assert feed.was_open.wait(TIMEOUT_S)
    assert not closing.is_alive() and not feed.opened and feeds.get('scan') is None

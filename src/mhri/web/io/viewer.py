# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One open page: what goes to it, and how fast it reads.

Everything runs on the server's loop. What waits for a slow page is bounded: of each kind of text
the newest, some events, of each picture the newest.
"""
import asyncio
from collections import deque
import time

from aiohttp import WSMsgType

from mhri.web.frames import BadFrame, FrameRate, read_frame
from mhri.web.pacing import Pacing
from mhri.web.said import frame

# A page that was not heard for so long is closed [s]; how often it is asked, and while it drives.
SILENT_S, PING_S, QUICK_PING_S = 10.0, 2.0, 0.25
# How long a page may take to read the close of its socket [s].
CLOSE_S = 2.0


class Viewer:
    """An open page.

    :param name: its id
    :param link: its :class:`mhri.web.links.Link`
    :param picture: function of a number that returns the binary frame of that picture, None if
        there is a newer one
    """

    def __init__(self, name, link, address, socket, transport, picture):
        self.name, self.link, self.address = name, link, address
        self.since_s = time.time()
        self.look, self.visible = None, True
        self.pacing = Pacing(time.monotonic)
        self._rate = FrameRate(time.monotonic)
        self._socket, self._transport, self._picture = socket, transport, picture
        self._texts, self._events = {}, deque(maxlen=50)
        self._wake = asyncio.Event()
        self._heard_at = self._asked_at = time.monotonic()
        self._unanswered_at, self._lag_s = None, 0.0
        self.ended, self._closing = False, None

    def say(self, key, text):
        """Send a text; it takes the place of one of this key that still waits."""
        self._texts[key] = text
        self.wake()

    def tell(self, text):
        """Send an event."""
        self._events.append(text)
        self.wake()

    def wake(self):
        """Send what may be sent now."""
        self._wake.set()

    def lag_s(self):
        """Return the time that a question to the page takes there and back [s]."""
        waits_s = time.monotonic() - self._unanswered_at if self._unanswered_at else 0.0
        return max(self._lag_s, waits_s)

    def tick(self, drives):
        """Ask whether the page is there; close it if it has not been for long."""
        now = time.monotonic()
        if now - self._heard_at > SILENT_S:
            self.abort()
        elif now - self._asked_at > (QUICK_PING_S if drives else PING_S) \
                and self._unanswered_at is None and not self.ended:
            self._asked_at = self._unanswered_at = now
        self.wake()

    def abort(self):
        """End the connection at once, with what is in its buffers."""
        self.ended = True
        if self._transport is not None:
            self._transport.abort()

    def end(self, code, why):
        """Send the reason, and close; return at once."""
        if not self.ended:
            self.ended = True
            self._closing = asyncio.ensure_future(self._close(code, why))

    async def closed(self):
        """Wait until a close that was begun is over."""
        if self._closing is not None:
            await self._closing

    async def _close(self, code, why):
        try:
            await asyncio.wait_for(self._socket.send_str(frame('bye', why)), CLOSE_S)
            await asyncio.wait_for(self._socket.close(
                code=code, message=why.encode()[:100]), CLOSE_S)
        except (asyncio.TimeoutError, OSError, RuntimeError):
            self.abort()

    async def run(self, on_frame):
        """Read until the page is closed.

        :param on_frame: called with (viewer, key, value) of each valid frame
        :raises BadFrame: a frame is not valid
        """
        sender = asyncio.ensure_future(self._send())
        try:
            while True:
                message = await self._socket.receive()
                self._heard_at = time.monotonic()
                if message.type == WSMsgType.TEXT:
                    self._rate.check()
                    key, value = read_frame(message.data)
                    if not self.ended:
                        on_frame(self, key, value)
                elif message.type == WSMsgType.PONG:
                    self._on_pong()
                elif message.type == WSMsgType.PING:
                    self._rate.check()
                    await self._socket.pong(message.data)
                elif message.type == WSMsgType.BINARY:
                    raise BadFrame('a binary frame')
                elif message.type == WSMsgType.ERROR:
                    raise BadFrame('a frame that is too large or broken')
                else:
                    return
        finally:
            sender.cancel()

    def _on_pong(self):
        if self._unanswered_at is not None:
            self._lag_s = self._heard_at - self._unanswered_at
            self._unanswered_at = None

    async def _send(self):
        """Send what waits, one after the other, as fast as the page takes it."""
        asked_at = self._asked_at
        try:
            while not self.ended:
                await self._wake.wait()
                self._wake.clear()
                if asked_at != self._asked_at:
                    asked_at = self._asked_at
                    await self._socket.ping()
                await self._send_texts()
                number = self.pacing.take() if self.visible else None
                data = None if number is None else self._picture(number)
                if data is not None:
                    await self._socket.send_bytes(data)
                    self._wake.set()
        except (OSError, RuntimeError):  # it was closed meanwhile
            self.abort()

    async def _send_texts(self):
        while self._texts or self._events:
            if self._texts:
                await self._socket.send_str(self._texts.pop(next(iter(self._texts))))
            else:
                await self._socket.send_str(self._events.popleft())

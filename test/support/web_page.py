# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A page of mhri_web without a browser: its cookie, its socket, its stick."""
import asyncio
import json
import struct
import threading
import time

import aiohttp

from support.ros_system import wait_for

CENTRE, AHEAD = [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]


class Page:
    """A page on a thread of its own; it reads, and acknowledges pictures while ``draws``.

    :param url: of a link, with its token
    """

    def __init__(self, url, draws=True):
        self.url, self.draws = url, draws
        self.base = url.partition('/t/')[0]
        self.said, self.events, self.pictures = {}, [], []
        self.close_code = None
        #: what is sent 20 times a second, None for nothing; when it was sent last
        self.stick, self.sent_at = None, 0.0
        self._loop = asyncio.new_event_loop()
        self._socket = None
        self._thread = threading.Thread(target=self._loop.run_until_complete,
                                        args=(self._run(),), daemon=True)
        self._thread.start()
        wait_for(lambda: 'drive' in self.said or self.close_code, what='the page')

    async def _run(self):
        # Cookies of an address without a name.
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(cookie_jar=jar) as session:
            async with session.get(self.url) as answer:
                assert answer.status == 200, answer.status
            async with session.ws_connect(self.base + '/ws', headers={
                    'Origin': self.base}, max_msg_size=1 << 24) as self._socket:
                pushing = asyncio.ensure_future(self._push())
                async for message in self._socket:
                    await self._hear(message)
                pushing.cancel()
                self.close_code = self._socket.close_code

    async def _hear(self, message):
        if message.type == aiohttp.WSMsgType.BINARY:
            size, = struct.unpack_from('>I', message.data)
            header = json.loads(message.data[4:4 + size].decode())
            self.pictures.append((header, message.data[4 + size:]))
            if self.draws:
                await self._socket.send_json({'ack': header['n']})
        else:
            (key, value), = json.loads(message.data).items()
            self.said[key] = value
            if key == 'event':
                self.events.append(value)

    async def _push(self):
        while not self._socket.closed:
            if self.stick is not None:
                self.sent_at = time.monotonic()
                await self._socket.send_json({'stick': self.stick})
            await asyncio.sleep(0.05)

    def raw(self, text):
        """Send a text as it is; return when."""
        now = time.monotonic()
        asyncio.run_coroutine_threadsafe(self._socket.send_str(text), self._loop).result(60.0)
        return now

    def send(self, key, value):
        """Send a frame; return when."""
        return self.raw(json.dumps({key: value}))

    def holds(self):
        """Return whether the server says that this page has the stick."""
        return self.said['drive']['you']

    def silence(self):
        """Send no stick any more; return when the last one left."""
        self.stick = None
        return self.sent_at

    def close(self):
        """Close the page; return when."""
        now = time.monotonic()
        if self.close_code is None and self._thread.is_alive():
            asyncio.run_coroutine_threadsafe(self._socket.close(), self._loop)
        self._thread.join(60.0)
        return now

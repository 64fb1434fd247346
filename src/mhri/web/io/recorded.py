# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded sessions by HTTP: ``/sessions.json`` and ``/session/FOLDER/...``.

``timeline.json``, ``map.png``, and ``picture?robot=NAME&t=SECONDS``, which says its kind and its
own time in headers, and answers 204 if that is the ``had`` of the request. Only folders of the
library are opened, each by a process of its own at low priority.
"""
import asyncio
import json
import math
import os

from aiohttp import web

from mhri.devices.io.child import command
from mhri.recording.folder import is_folder_name, sessions_home

READER = 'mhri.web.ros.recorded_reader'
# Readers at once, and how long one lives without a request; limit of an answer [s, s, bytes].
MAX_READERS, IDLE_S, TIMEOUT_S, MAX_BYTES = 3, 60.0, 300.0, 1 << 28
# So many requests may wait for one reader.
MAX_WAITING = 32
_TYPES = {'json': 'application/json', 'jpeg': 'image/jpeg', 'png': 'image/png',
          'depth': 'application/octet-stream'}


class _Reader:
    """A process that reads one session, or the list of all."""

    def __init__(self, path, env):
        self._path, self._env = path, {**os.environ, **env}
        self._process = None
        self._lock = asyncio.Lock()
        self._known = {}
        self.waiting = 0
        self.used_s = 0.0

    async def ask(self, *request):
        """Return (line of the answer as a dict, bytes); what does not change is read once.

        :raises web.HTTPServiceUnavailable: the process failed
        """
        self.waiting += 1
        try:
            async with self._lock:
                answer = self._known.get(request)
                if answer is None:
                    answer = await asyncio.wait_for(self._ask(request), TIMEOUT_S)
                if request[0] in ('timeline', 'map'):
                    self._known[request] = answer
                return answer
        except (asyncio.TimeoutError, OSError):
            raise web.HTTPServiceUnavailable()
        finally:
            self.waiting -= 1

    async def _ask(self, request):
        whole = False
        try:
            answer = await self._exchange(request)
            whole = True
            return answer
        finally:
            # What is left of an answer, or comes late, must not be taken for the next one.
            if not whole:
                self.end()

    async def _exchange(self, request):
        try:
            if self._process is None:
                self._process = await asyncio.create_subprocess_exec(
                    'nice', *command(READER, *self._path), stdin=asyncio.subprocess.PIPE,
                    stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL,
                    env=self._env, start_new_session=True)
            self._process.stdin.write(json.dumps(request).encode() + b'\n')
            head = json.loads((await self._process.stdout.readline()).decode())
            if not 0 <= head['size'] <= MAX_BYTES:
                raise ValueError
            return head, await self._process.stdout.readexactly(head['size'])
        except (ValueError, KeyError, EOFError) as error:
            raise OSError('the reader of the session failed: {!r}'.format(error))

    def end(self):
        """End the process, and return it; the next request starts another."""
        process, self._process = self._process, None
        if process is not None and process.returncode is None:
            process.kill()
        return process


class Recorded:
    """The routes of recorded sessions.

    :param env: environment, for ``ROS_HOME``
    """

    def __init__(self, env=os.environ):
        self._env, self._home = env, sessions_home(env)
        self._readers = {}
        #: [(path, coroutine function of a request)]
        self.routes = [('/sessions.json', self._sessions),
                       ('/session/{folder}/timeline.json', self._timeline),
                       ('/session/{folder}/map.png', self._map),
                       ('/session/{folder}/picture', self._picture)]

    async def close(self, app=None):
        """End every reader."""
        for process in [reader.end() for reader in self._readers.values()]:
            if process is not None:
                await process.wait()

    async def _sessions(self, request):
        return await self._answer('', 'sessions')

    async def _timeline(self, request):
        return await self._answer(self._folder(request), 'timeline')

    async def _map(self, request):
        return await self._answer(self._folder(request), 'map')

    async def _picture(self, request):
        folder, query = self._folder(request), request.query
        try:
            at_s, had_s = float(query['t']), float(query.get('had', '-1'))
        except (KeyError, ValueError):
            at_s = had_s = math.nan
        if not (0.0 <= at_s <= 1e6 and abs(had_s) <= 1e6) or len(query.get('robot', '')) > 100:
            raise web.HTTPBadRequest()
        return await self._answer(folder, 'picture', query.get('robot', ''), at_s, had_s=had_s)

    def _folder(self, request):
        """Return the name of the folder of a request.

        :raises web.HTTPNotFound: it is not a session of the library
        """
        name = request.match_info['folder']
        if not is_folder_name(name) or not os.path.isdir(os.path.join(self._home, name)):
            raise web.HTTPNotFound()
        return name

    async def _answer(self, name, *request, had_s=-1.0):
        """Return the response of the reader of a session; name '' is the list of all."""
        head, body = await self._reader(name).ask(*request)
        if head['kind'] not in _TYPES:
            return web.Response(status=404, text=body.decode('utf-8', 'replace'))
        at_s = head.get('at_s')
        if at_s is not None and abs(at_s - had_s) < 1e-3:
            return web.Response(status=204)
        more = {} if at_s is None else {'X-Time': '{:.4f}'.format(at_s), 'X-Kind': head['kind']}
        response = web.Response(body=body, content_type=_TYPES[head['kind']], headers=more)
        if head['kind'] == 'json':
            response.enable_compression()
        return response

    def _reader(self, name):
        """Return the reader of a session; end those that nobody has used for a while.

        :raises web.HTTPServiceUnavailable: too many are in use
        """
        now_s = asyncio.get_event_loop().time()
        idle = [key for key, one in self._readers.items() if not one.waiting and key != name]
        idle.sort(key=lambda key: self._readers[key].used_s)
        for key in idle:
            if now_s - self._readers[key].used_s > IDLE_S or len(self._readers) >= MAX_READERS:
                self._readers.pop(key).end()
        if name not in self._readers and len(self._readers) >= MAX_READERS:
            raise web.HTTPServiceUnavailable()
        reader = self._readers.setdefault(
            name, _Reader([os.path.join(self._home, name)] if name else [], self._env))
        if reader.waiting >= MAX_WAITING:
            raise web.HTTPServiceUnavailable()
        reader.used_s = now_s
        asyncio.get_event_loop().call_later(IDLE_S + 1.0, self._expire, name)
        return reader

    def _expire(self, name):
        """End a reader that nobody has used for a while; what it knew may be old then."""
        reader = self._readers.get(name)
        if reader is not None and not reader.waiting \
                and asyncio.get_event_loop().time() - reader.used_s > IDLE_S:
            self._readers.pop(name).end()

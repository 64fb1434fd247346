# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The web server, on a thread and an asyncio loop of its own.

:class:`WebServer` is called from any thread and never blocks; all else runs on the loop.
"""
import asyncio
import html
import logging
import threading
from urllib.parse import urlsplit

from aiohttp import web

from mhri.web.frames import GOING_AWAY
from mhri.web.io.hub import Hub
from mhri.web.links import WrongTokens

MAX_SOCKETS, MAX_OF_LINK = 64, 16
# Connections at once, and how long one may take until its first whole request [s].
MAX_CONNECTIONS, FIRST_S = 256, 10.0
# How often to try again for a port that another program has [s].
AGAIN_S = 5.0
COOKIE = 'mhri'
HEADERS = {
    'Content-Security-Policy':
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
        "connect-src 'self'{}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    'X-Content-Type-Options': 'nosniff', 'Cache-Control': 'no-store',
    'Referrer-Policy': 'no-referrer', 'Server': 'mhri', 'Cross-Origin-Opener-Policy': 'same-origin',
    'Permissions-Policy': 'xr-spatial-tracking=(self), camera=(), microphone=(), geolocation=()'}
TYPES = {'html': 'text/html', 'js': 'text/javascript', 'css': 'text/css',
         'svg': 'image/svg+xml', 'json': 'application/json', 'png': 'image/png'}
_PLAIN = '<!DOCTYPE html><meta charset="utf-8"><title>mhri</title><p>{}</p>'
NO_LINK = 'This page needs a link from the operator. Open that link again, or ask for a new one.'
_LOG = logging.getLogger('mhri.web.http')


def plain(status, text):
    """Return a plain page."""
    return web.Response(status=status, text=_PLAIN.format(text), content_type='text/html')


class _Refusing(asyncio.Protocol):
    """A connection beyond :data:`MAX_CONNECTIONS`."""

    def connection_made(self, transport):
        transport.abort()


class WebServer:
    """The server of the page.

    :param book: :class:`mhri.web.links.LinkBook`
    :param files: {name: bytes} of what the page is made of
    :param outputs: :class:`mhri.web.io.hub.Outputs`
    :param places: [(address, port, ``ssl.SSLContext`` or None)] to listen at
    :param routes: [(path, coroutine function of the request)] of more that a cookie opens
    :param on_end: coroutine functions of the application to call at the end
    """

    def __init__(self, book, files, outputs, places, routes=(), on_end=()):
        self._files, self._outputs, self._places = files, outputs, places
        self._routes, self._on_end = routes, on_end
        self._loop = asyncio.new_event_loop()
        self.hub = Hub(book, outputs, self._loop)
        self._wrong = WrongTokens(self._loop.time)
        self._awaited = set()
        self._thread = threading.Thread(target=self._run, name='web', daemon=True)
        self._done = None
        #: why the server cannot listen at each of ``places``, '' if it does, None before it tried
        self.problems = [None] * len(places)
        #: the port in use of each, None if there is none
        self.ports = [None] * len(places)
        self._up = threading.Event()

    def start(self):
        """Start the thread; return once every port was tried."""
        self._thread.start()
        self._up.wait(10.0)
        return self

    def stop(self):
        """Let go of the stick, close every page and end (blocking, 3 s at most)."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(lambda: self._done and self._done.set())
            self._thread.join(3.0)

    def _run(self):
        asyncio.set_event_loop(self._loop)
        self._loop.set_exception_handler(
            lambda loop, said: self._outputs.log('in the web server: {}'.format(
                said.get('exception') or said.get('message'))))
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self):
        self._done = asyncio.Event()
        app = web.Application(middlewares=[self._guard()])
        app.on_response_prepare.append(self._add_headers)
        app.on_cleanup.extend(self._on_end)
        for path, handler in [('/t/{token}', self._enter), ('/ws', self._socket),
                              ('/map.png', self._map), *self._routes, ('/', self._file),
                              ('/{name}', self._file)]:
            app.router.add_get(path, handler)
        # aiohttp would log a traceback for each request that is not HTTP.
        _LOG.setLevel(logging.CRITICAL + 1)
        runner = web.AppRunner(app, access_log=None, logger=_LOG, keepalive_timeout=15.0)
        await runner.setup()
        tries = [asyncio.ensure_future(self._listen(runner.server, index))
                 for index in range(len(self._places))]
        ticking = asyncio.ensure_future(self.hub.tick())
        while None in self.problems:
            await asyncio.sleep(0.01)
        self._up.set()
        await self._done.wait()
        for task in (*tries, ticking):
            task.cancel()
        await self.hub.close(GOING_AWAY, 'The server has ended.')
        await asyncio.wait_for(runner.cleanup(), 2.0)

    async def _listen(self, server, index):
        """Listen at a port, as soon as it is free."""
        def accept():
            if len(server.connections) >= MAX_CONNECTIONS:
                return _Refusing()
            handler = server()
            self._awaited.add(handler)
            self._loop.call_later(FIRST_S, self._expect, handler)
            return handler
        address, port, context = self._places[index]
        more = {'ssl': context, 'ssl_handshake_timeout': FIRST_S} if context else {}
        while not self.ports[index]:
            try:
                found = await self._loop.create_server(accept, address, port, backlog=128, **more)
                self.ports[index] = found.sockets[0].getsockname()[1]
                self.problems[index] = ''
            except OSError as error:
                if not self.problems[index]:
                    self._outputs.log('cannot listen at port {}: {}'.format(port, error))
                self.problems[index] = error.strerror or str(error)
                await asyncio.sleep(AGAIN_S)
        try:
            await self._done.wait()
        finally:
            found.close()

    def _expect(self, handler):
        """End a connection that has not sent a whole request in time."""
        if handler in self._awaited:
            self._awaited.discard(handler)
            if handler.transport is not None:
                handler.transport.abort()

    def _guard(self):
        @web.middleware
        async def guard(request, handler):
            self._awaited.discard(request.protocol)
            if request.path.startswith('/t/') and request.match_info.get('token'):
                return await handler(request)
            request['link'] = self.hub.link_of(request.cookies.get(COOKIE, ''))
            if request['link'] is None:
                return self._refuse(request, COOKIE in request.cookies)
            try:
                return await handler(request)
            except web.HTTPException as error:
                return plain(error.status, error.reason)
            except Exception as error:  # the page gets a plain answer, and the others their turn
                self._outputs.log('cannot answer {}: {!r}'.format(
                    request.path[:100], error)[:300])
                return plain(500, 'This cannot be shown.')
        return guard

    async def _add_headers(self, request, response):
        for name, value in HEADERS.items():
            # Some browsers do not count a WebSocket of the same host as 'self'.
            host = request.host if request.host.replace(':', '').replace('.', '').replace(
                '-', '').isalnum() else ''
            response.headers[name] = value.format(host and ' {}://{}'.format(
                'wss' if request.secure else 'ws', host)) if '{}' in value else value

    def _refuse(self, request, guessed):
        """Answer a request without a valid token; an address that guesses is not listened to."""
        address = request.remote or ''
        if not self._wrong.may_try(address):
            return plain(429, 'Too many wrong links. Try again in a minute.')
        if guessed:
            self._wrong.add(address)
            self._outputs.log('a wrong or old link was opened from {}'.format(address))
        return plain(403, NO_LINK)

    async def _enter(self, request):
        """Exchange the token of a link for a cookie."""
        address, token = request.remote or '', request.match_info['token']
        link = self.hub.link_of(token) if self._wrong.may_try(address) else None
        if link is None:
            return self._refuse(request, True)
        query = request.rel_url.raw_query_string
        place = '/' + ('?' + query if query else '')
        cookie = '{}={}; Path=/; HttpOnly; SameSite=Strict; Max-Age={:.0f}{}'.format(
            COOKIE, token, self.hub.left_s(link), '; Secure' if request.secure else '')
        if request.headers.get('Sec-Fetch-Site', 'none') in ('none', 'same-origin'):
            return web.Response(status=303, headers={'Location': place, 'Set-Cookie': cookie})
        # A strict cookie is not sent on a way that began at another site; from this page it is.
        return web.Response(
            text='<!DOCTYPE html><meta charset="utf-8"><meta http-equiv="refresh" '
            'content="0;url={}"><title>mhri</title>'.format(html.escape(place)),
            content_type='text/html', headers={'Set-Cookie': cookie})

    async def _file(self, request):
        name = request.match_info.get('name') or 'index.html'
        data = self._files.get(name)
        if data is None:
            return plain(404, 'There is no such page.')
        return web.Response(body=data, content_type=TYPES[name.rpartition('.')[2]],
                            charset='utf-8')

    async def _map(self, request):
        picture = self.hub.map_picture
        return web.Response(body=picture, content_type='image/png') if picture else plain(
            404, 'There is no map.')

    async def _socket(self, request):
        """Serve a page's socket until it is closed."""
        origin = urlsplit(request.headers.get('Origin', ''))
        if (origin.scheme, origin.netloc) != (request.scheme, request.host):
            self._outputs.log('a page of another site was refused: {}'.format(
                origin.netloc[:60]))
            return plain(403, 'Only the page of this server may connect.')
        if len(self.hub.viewers) >= MAX_SOCKETS \
                or self.hub.viewers_of(request['link']) >= MAX_OF_LINK:
            return plain(503, 'Too many pages are open.')
        return await self.hub.serve(request)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The server against what is not its page: refused, and neither the stick nor the others notice."""
import asyncio
import contextlib
import json
import os
import random
import socket
import subprocess
import sys

import aiohttp
import psutil
import pytest

from mhri.web.io.server import MAX_CONNECTIONS, MAX_OF_LINK
from mhri.web.links import TRIES
from support.paths import REPO
from support.ros_system import insist, NotYet, wait_for
from support.web_page import CENTRE, Page

COUNT = 10000 if os.environ.get('MHRI_BENCH') == 'full' else 1000
HELD = [0.25, 0.5, 0.0]
# What the heap may grow by without a leak [bytes].
NOISE = 8 << 20


class Server:
    """The server in its process."""

    def __init__(self):
        self._process = subprocess.Popen(
            [sys.executable, str(REPO / 'test/support/web_server.py')], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, text=True)
        said = json.loads(self._process.stdout.readline())
        self.port, self.tokens = said['port'], said['tokens']
        self.base = 'http://127.0.0.1:{}'.format(self.port)

    def ask(self, line=''):
        """Return what was asked of it since the last time."""
        self._process.stdin.write(line + '\n')
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def page(self, index, **more):
        """Return an open page of a link: 0 to watch, 1 to stop, too, 2 to drive."""
        return Page('{}/t/{}'.format(self.base, self.tokens[index]), **more)

    def memory(self):
        """Return what it occupies [bytes]."""
        return psutil.Process(self._process.pid).memory_info().rss

    def close(self):
        self._process.kill()
        self._process.wait()
        self._process.stdin.close()
        self._process.stdout.close()


@pytest.fixture(scope='module')
def server():
    one = Server()
    yield one
    one.close()


def holding(server, page):
    """Let a page hold the stick out."""
    def drives():
        page.stick = CENTRE
        page.send('hold', True)
        wait_for(page.holds, 5.0, 'the hold')
        wait_for(lambda: CENTRE in server.ask()['sticks'], 5.0, 'the stick at its centre')
        page.stick = HELD
        return wait_for(lambda: HELD in server.ask()['sticks'], 5.0, 'the stick')
    insist(drives, lambda: 'the stick: {}'.format(page.said['drive']))


@pytest.mark.parametrize('end', [
    lambda page: page.send('hold', False), lambda page: page.send('visible', False),
    lambda page: page.silence(), lambda page: page.close(), lambda page: page.raw('no JSON'),
    lambda page: page.raw('{"look": "%s"}' % ('x' * 5000))],
    ids=['let go', 'hidden', 'silent', 'closed', 'broken', 'too large'])
def test_whatever_ends_a_hold_says_zero_and_then_nothing(server, end):
    page = server.page(2)
    holding(server, page)
    end(page)
    said = []
    wait_for(lambda: said.extend(server.ask()['sticks']) or CENTRE in said, what='the zero')
    said = said[said.index(CENTRE):]
    other = server.page(2)
    other.send('look', 'bot1')
    wait_for(lambda: not any(holds for _, _, holds in server.ask()['viewers']), what='the end')
    assert said + server.ask()['sticks'] == [CENTRE]
    page.close()
    other.close()


def raw_request(data, port):
    """Send bytes as a connection; return the answer, b'' if it is closed without one."""
    with socket.create_connection(('127.0.0.1', port), 60.0) as end, \
            contextlib.suppress(ConnectionError):
        end.sendall(data)
        end.shutdown(socket.SHUT_WR)
        return b''.join(iter(lambda: end.recv(65536), b''))
    return b''


@pytest.mark.parametrize('data', [
    b'', b'\0' * 5000, b'GET\r\n\r\n', b'GET / HTTP/9.9\r\n\r\n', b'\x16\x03\x01\x02\x00\x01',
    b'GET /' + b'x' * 100000 + b' HTTP/1.1\r\n\r\n',
    b'POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n',
    b'GET /../../etc/passwd HTTP/1.1\r\nHost: a\r\n\r\n',
    b'GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\nHost: a\r\n\r\n',
    b'GET / HTTP/1.1\r\nHost: a\r\nCookie: mhri=\r\n\r\n'], ids=lambda data: str(data[:30]))
def test_what_is_no_request_of_the_page_is_refused(server, data):
    answer = raw_request(data, server.port)
    assert not answer or answer.split()[1][:1] == b'4', answer[:200]
    assert b'root:' not in answer and b'Traceback' not in answer


def status(url, **more):
    """Return (status, headers, text) of a GET request from an address of its own."""
    address = more.pop('address', '127.0.0.1')

    async def ask():
        connector = aiohttp.TCPConnector(local_addr=(address, 0), force_close=True)
        async with aiohttp.ClientSession(
                connector=connector, cookie_jar=aiohttp.DummyCookieJar()) as session:
            async with session.get(url, allow_redirects=False, **more) as answer:
                return answer.status, answer.headers, await answer.text()
    return asyncio.run(ask())


def test_a_token_opens_the_page_and_its_cookie_everything(server):
    found, headers, _ = status('{}/t/{}?session=a%0Db'.format(server.base, server.tokens[0]))
    assert (found, headers['Location']) == (303, '/?session=a%0Db')
    assert 'HttpOnly' in headers['Set-Cookie'] and 'SameSite=Strict' in headers['Set-Cookie']
    found, _, text = status('{}/t/{}?session="><b>'.format(server.base, server.tokens[0]),
                            headers={'Sec-Fetch-Site': 'cross-site'})
    assert found == 200 and '<b>' not in text and '/?session=' in text
    cookie = {'Cookie': headers['Set-Cookie'].partition(';')[0]}
    assert status(server.base + '/', headers=cookie)[2] == 'page'
    assert status(server.base + '/page.js', headers=cookie)[1]['Content-Type'].startswith('text/ja')
    assert status(server.base + '/none.js', headers=cookie)[0] == 404
    assert status(server.base + '/page.js')[0] == 403
    for origin in ({}, {'Origin': 'http://evil.example'}, {'Origin': 'null'}):
        assert status(server.base + '/ws', headers=dict(cookie, **origin, Connection='Upgrade',
                      Upgrade='websocket'))[0] == 403
    policy = headers['Content-Security-Policy']
    assert "default-src 'none'" in policy and "script-src 'self'" in policy


def test_whoever_guesses_is_not_listened_to_and_others_are(server):
    guess = server.base + '/t/guess{}'
    found = [status(guess.format(number), address='127.0.0.9')[0] for number in range(TRIES + 2)]
    assert found == [403] * (TRIES - 1) + [403, 429, 429]
    right = '{}/t/{}'.format(server.base, server.tokens[0])
    assert status(right, address='127.0.0.9')[0] == 429 and status(right)[0] == 303


def closed(end):
    """Return whether the server has closed a connection."""
    try:
        return end.recv(1) == b''
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def crowd(server):
    """Return more connections than there is room for, of which the last is refused."""
    def made():
        with contextlib.ExitStack() as stack:
            ends = [stack.enter_context(socket.create_connection(
                ('127.0.0.1', server.port), 60.0)) for _ in range(MAX_CONNECTIONS + 100)]
            for end in ends:
                end.setblocking(False)
            wait_for(lambda: closed(ends[-1]), 5.0, 'the last to be refused')
            if closed(ends[0]):
                raise NotYet('the first is too old')
            stack.pop_all()
            return ends
    return insist(made, 'a connection that is refused')


def test_there_is_room_for_some_and_the_stick_goes_on(server):
    page = server.page(2)
    holding(server, page)
    ends = crowd(server)
    holding(server, page)
    wait_for(lambda: all(map(closed, ends)), what='the end of who sends no request', poll_s=0.1)
    for end in ends:
        end.close()
    pages = [server.page(0) for _ in range(MAX_OF_LINK)]
    cookie = {'Cookie': 'mhri=' + server.tokens[0], 'Origin': server.base,
              'Connection': 'Upgrade', 'Upgrade': 'websocket'}
    assert status(server.base + '/ws', headers=cookie)[0] == 503
    for one in (page, *pages):
        one.close()


def test_a_page_that_draws_nothing_is_thinned_and_another_is_not(server):
    slow, quick = server.page(0, draws=False), server.page(1)

    def thinned():
        found = server.ask('pictures 1')['viewers']
        return ['watch', True, False] in found and len(quick.pictures) > 30
    wait_for(thinned, what='thinned pictures', poll_s=0.05)
    assert len(slow.pictures) == 6, 'two of each robot'
    assert ['stop', True, False] not in server.ask()['viewers']
    slow.close()
    quick.close()


def test_a_page_that_stops_reading_is_closed_and_another_goes_on(server):
    quick = server.page(1)
    with socket.create_connection(('127.0.0.1', server.port), 60.0) as end:
        end.sendall('GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nOrigin: {1}\r\nCookie: mhri={2}\r\n'
                    'Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n'
                    'Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n'.format(
                        server.port, server.base, server.tokens[0]).encode())
        labels = [['stop'], ['stop', 'watch']]
        wait_for(lambda: [one[0] for one in server.ask()['viewers']] == labels[1], what='its start')
        seen = len(quick.pictures)
        wait_for(lambda: [one[0] for one in server.ask('pictures 1')['viewers']] == labels[0],
                 what='its end', poll_s=0.05)
    assert len(quick.pictures) > seen + 30
    quick.close()


def frames(chance):
    """Return the text of a random frame, valid or not; none of them takes the stick."""
    value = chance.choice([
        None, True, False, 0, -1, 1, 2 ** 60, 1e308, 0.5, 'bot1', '<script>', 'x' * 200, [], {},
        [0, 0, 0], [0, 1, 0], [1, 1, 1], [2, 0, 0], [0, 0], ['a'], [[0, 1, 0]], {'hold': True}])
    key = chance.choice(['ack', 'look', 'visible', 'stick', 'head', 'stop', 'hold', 'state', '',
                         '__class__', 'serve'])
    if (key, value) == ('hold', True):
        value = None
    text = json.dumps({key: value})
    place = chance.randrange(len(text))
    return chance.choice([text, text, text, text[:place], text + text, '[{}]'.format(text),
                          text.replace('"', "'"), text[:place] + '\0' + text[place:]])


async def some_messages(session, server, chance, count):
    """Send random frames, by new sockets where one is closed; return how many."""
    sent = 0
    while sent < count:
        headers = {'Origin': server.base, 'Cookie': 'mhri=' + chance.choice(
            [server.tokens[0], server.tokens[2]])}
        try:
            async with session.ws_connect(server.base + '/ws', headers=headers) as page:
                for _ in range(chance.randint(1, 20)):
                    sent += 1
                    if chance.random() < 0.1:
                        await page.send_bytes(bytes(chance.randrange(5000)))
                    else:
                        await page.send_str(frames(chance) * chance.choice([1, 1, 1, 1, 900]))
        except (aiohttp.ClientError, ConnectionError):
            sent += 1
    return sent


async def some_requests(session, server, chance, count):
    """Send random requests; return how many were answered with an error of the server."""
    broken = 0
    for _ in range(count):
        path = chance.choice(['/', '/ws', '/map.png', '/t/', '/t/guess', '/page.js', '/%00', '/a/b',
                              '/' + 'x' * 3000, '/t/' + server.tokens[0], '/sessions.json'])
        method = chance.choice(['GET', 'GET', 'GET', 'HEAD', 'POST', 'PUT', 'OPTIONS', 'A'])
        headers = chance.choice([{}, {'Cookie': 'mhri=' + server.tokens[2]},
                                 {'Cookie': 'mhri=guess'}, {'Cookie': '=;;"'},
                                 {'Origin': 'null', 'Upgrade': 'websocket'}])
        query = chance.choice(['', '?a', '?v=1', '?%0d%0aA: b', '?' + 'y' * 2000])
        try:
            async with session.request(method, server.base + path + query, headers=headers,
                                       allow_redirects=False, data=b'x' * chance.choice(
                                           [0, 0, 10, 100000])) as answer:
                await answer.read()
                broken += answer.status >= 500
        except (aiohttp.ClientError, ConnectionError, ValueError):
            continue
    return broken


def test_random_requests_and_messages_move_nothing_break_nothing_and_leave_nothing(server):
    seed = int(os.environ.get('MHRI_SEED', '1'))
    print('seed', seed)

    async def run(count, seed):
        # Its guesses count for an address of its own.
        connector = aiohttp.TCPConnector(local_addr=('127.0.0.8', 0))
        async with aiohttp.ClientSession(
                connector=connector, cookie_jar=aiohttp.DummyCookieJar()) as session:
            workers = [work(session, server, random.Random(seed + number), count // 8)
                       for number in range(4) for work in (some_requests, some_messages)]
            return (await asyncio.gather(*workers))[::2]
    assert asyncio.run(run(COUNT // 2, seed)) == [0] * 4
    page = server.page(2)
    holding(server, page)
    before = server.memory()
    assert asyncio.run(run(COUNT // 2, seed + 100)) == [0] * 4
    said = server.ask()
    moved = [values for values in said['sticks'] if values not in (HELD, CENTRE)]
    assert moved == [] and said['stops'] == 0 and said['heads'] == 0
    holding(server, page)
    page.close()
    print('MEASURED memory: {:.1f} MB more'.format((server.memory() - before) / 2 ** 20))
    assert server.memory() - before < NOISE

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recorded sessions over HTTP: what was so at which time, and who asks for what is not there."""
import asyncio
import json
import threading
import urllib.error
import urllib.request

from aiohttp import web
import cv2
import numpy as np
import pytest
from support import made_session as made

from mhri.web.io import recorded
from mhri.web.io.recorded import Recorded

TIMEOUT_S = 60.0
NAME = '2023-11-14-22-13-20'
CAMERA, EVERY_S = '/bot2/camera/image_raw/compressed', 2.0


def jpeg(grey):
    """Return a JPEG in one grey."""
    return cv2.imencode('.jpg', np.full((24, 32), grey, np.uint8))[1].tobytes()


@pytest.fixture(scope='module')
def home(tmp_path_factory):
    """Return a ROS_HOME with one session: bot2 has a picture each two seconds, from 4 s on."""
    top = tmp_path_factory.mktemp('home')
    folder = made.write_session(top / 'mhri' / 'sessions' / NAME)
    made.write_pictures(folder, lambda time_s: jpeg(4 * time_s))
    (top / 'mhri' / 'secret').mkdir()
    (top / 'mhri' / 'sessions' / '2024-01-01-00-00-00').mkdir()
    return top


class Server:
    """A server of recorded sessions alone, on a thread of its own."""

    def __init__(self, home):
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._runner, self._port = self._do(self._start(home))

    def _do(self, work):
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(TIMEOUT_S)

    @staticmethod
    async def _start(home):
        app, recorded = web.Application(), Recorded({'ROS_HOME': str(home)})
        for path, handler in recorded.routes:
            app.router.add_get(path, handler)
        app.on_cleanup.append(recorded.close)
        runner = web.AppRunner(app)
        await runner.setup()
        site = web.TCPSite(runner, '127.0.0.1', 0)
        await site.start()
        return runner, runner.addresses[0][1]

    def ask(self, path):
        """Return (status, headers, body) of a request; JSON is read."""
        try:
            with urllib.request.urlopen('http://127.0.0.1:{}{}'.format(self._port, path),
                                        timeout=TIMEOUT_S) as answer:
                body = answer.read()
                return answer.status, answer.headers, json.loads(body.decode()) \
                    if 'json' in answer.headers.get('Content-Type', '') else body
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def close(self):
        """End it."""
        self._do(self._runner.cleanup())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


@pytest.fixture(scope='module')
def ask(home):
    """Return the function that asks one server for all tests."""
    server = Server(home)
    yield server.ask
    server.close()


def test_the_list_has_the_sessions_the_newest_first(ask):
    status, _, rows = ask('/sessions.json')
    assert status == 200 and [row['name'] for row in rows] == ['2024-01-01-00-00-00', NAME]
    assert rows[0]['problem'] and not rows[1]['problem']


def test_the_time_line_is_what_was_so(ask):
    status, _, line = ask('/session/{}/timeline.json'.format(NAME))
    assert status == 200 and line['length_s'] == pytest.approx(made.LENGTH_S, abs=0.2)
    assert [(robot['name'], robot['number'], robot['picture']) for robot in line['robots']] == [
        ('bot1', 1, ''), ('bot2', 2, CAMERA)]
    assert line['stopped'] == [[made.STOPPED[1][0], made.STOPPED[2][0]]]
    assert [12.0, pytest.approx(made.LENGTH_S, abs=0.2), 'bot2'] in line['driven']
    lost, = [event for event in line['events'] if event['kind'] == 'lost']
    assert (lost['robot'], lost['severity'], lost['at_s']) == (
        'bot2', 'alarm', made.LOST_S[0] + 1.0)
    track = line['robots'][1]['track']
    times = [row[0] for row in track]
    assert max(b - a for a, b in zip(times, times[1:])) >= made.LOST_S[1] - made.LOST_S[0]
    for at_s, x, y, *_ in [row for row in track if len(row) > 1]:
        assert (x, y) == pytest.approx(made.pose('bot2', at_s)[:2], abs=0.02)


@pytest.mark.parametrize('at_s', [4.0, 5.9, 6.0, 33.3, 59.0])
def test_a_picture_is_the_newest_of_its_time(ask, at_s):
    path = '/session/{}/picture?robot=bot2&t={}'.format(NAME, at_s)
    status, headers, body = ask(path)
    taken_s = at_s - at_s % EVERY_S
    assert status == 200 and headers['X-Kind'] == 'jpeg' and body == jpeg(4 * int(taken_s))
    assert float(headers['X-Time']) == pytest.approx(taken_s, abs=0.01)
    again, *_ = ask('{}&had={}'.format(path, headers['X-Time']))
    assert again == 204


@pytest.mark.parametrize('path, status', [
    ('picture?robot=bot2&t=1.0', 404), ('picture?robot=bot1&t=9', 404), ('picture?robot=&t=9', 404),
    ('picture?robot=../../x&t=9', 404), ('picture?robot=bot2', 400),
    ('picture?robot=bot2&t=x', 400),
    ('picture?robot=bot2&t=nan', 400), ('picture?robot=bot2&t=-1', 400),
    ('picture?robot=bot2&t=1e300', 400), ('picture?robot=bot2&t=9&had=inf', 400),
    ('picture?robot={}&t=9'.format('x' * 200), 400), ('map.png', 404), ('events.jsonl', 404)])
def test_what_is_not_there_is_refused(ask, path, status):
    found, *_ = ask('/session/{}/{}'.format(NAME, path))
    assert found == status


@pytest.mark.parametrize('folder', [
    '..', '.', '%2e%2e', '..%2f..%2fsecret', NAME + '%2f..%2f' + NAME, NAME + '%00', 'secret',
    '2099-01-01-00-00-00', '%2fetc'])
def test_no_other_folder_is_read(ask, folder):
    found, *_ = ask('/session/{}/timeline.json'.format(folder))
    assert found == 404


def test_a_folder_without_a_session_says_why(ask):
    status, _, body = ask('/session/2024-01-01-00-00-00/timeline.json')
    assert status == 404 and b'session.yaml' in body


def test_a_reader_that_ends_is_replaced_and_its_request_refused(home, monkeypatch):
    server, path = Server(home), '/session/{}/picture?robot=bot2&t=9'.format(NAME)
    with monkeypatch.context() as broken:
        broken.setattr(recorded, 'READER', 'mhri.web.no_such_module')
        status, *_ = server.ask(path)
    after, *_ = server.ask(path)
    server.close()
    assert (status, after) == (503, 200)

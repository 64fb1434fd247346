# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A report of a made-up session, of one that was killed, and of what is no session."""
import html.parser
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys

import cv2
from geometry_msgs.msg import Pose2D
from nav_msgs.msg import OccupancyGrid
import numpy as np
import pytest
import rosbag
from sensor_msgs.msg import CompressedImage
import yaml

from mhri.base.robot_colours import colour_of
from mhri.msg import Place, Places
from mhri.nodes import mhri_report
from mhri.recording.folder import event_line, EVENTS_JSONL, NotASession, SessionEvent
from mhri.session.ros.session_reader import opened, ReportBuilder
from mhri.session.timeline import Span
from support import made_session as made

FPS, EXTRA_S = 2.0, 4.0


def jpeg(shade=128):
    return cv2.imencode('.jpg', np.full((120, 160, 3), shade, np.uint8))[1].tobytes()


def last_rows():
    """Yield the last seconds of a session: pictures, map, places."""
    grid = OccupancyGrid()
    grid.info.resolution, grid.info.width, grid.info.height = 0.1, 80, 40
    grid.info.origin.position.x, grid.info.origin.position.y = -1.5, -2.0
    grid.info.origin.orientation.w = 1.0
    grid.data = [100 if place < 80 else 0 for place in range(3200)]
    places = Places()
    places.header.frame_id = 'map'
    for robot in made.ROBOTS:
        places.robots.append(Place(robot=robot, by='tf', odometry=Pose2D(0.0, 0.0, 0.0)))
    yield made.LENGTH_S, '/map', grid, True
    yield made.LENGTH_S, '/mhri_tasks/places', places, True
    for step in range(round(EXTRA_S * 5) + 1):
        time_s = made.LENGTH_S + 0.2 * step
        for robot in made.ROBOTS:
            yield time_s, '/{}/odom'.format(robot), made.odometry(robot, time_s), False
            # What is no picture is as if it had not come.
            data = b'no jpeg' if step == 7 else jpeg(10 * step)
            yield (time_s, '/{}/camera/rgb/image_raw/compressed'.format(robot),
                   CompressedImage(format='jpeg', data=data), False)


def write_unclosed(path):
    """Write a bag as a program leaves it that is killed: what was flushed, without its index."""
    with open(str(path) + '.whole', 'w+b') as stream, \
            rosbag.Bag(stream, 'w', chunk_threshold=8192) as bag:
        for time_s, topic, message, latched in last_rows():
            bag.write(topic, message, made.stamp(time_s),
                      connection_header=made.header(topic, message, latched))
        bag.flush()
        # A word on the disk at last: its own flush leaves that to the end.
        stream.flush()
        shutil.copy(str(path) + '.whole', str(path))
    os.remove(str(path) + '.whole')


def add_lines(folder, *events):
    with open(str(folder / EVENTS_JSONL), 'a', encoding='utf-8') as stream:
        stream.write('\n' + ''.join(map(event_line, events)))


def line(at_s, kind, text, **data):
    return SessionEvent(made.STARTED + at_s, made.STARTED + at_s, kind, text, data=data)


@pytest.fixture(scope='module')
def session(tmp_path_factory):
    """Return a session of a killed program, with stills."""
    folder = made.write_session(tmp_path_factory.mktemp('sessions') / '2023-11-14-22-13-20')
    write_unclosed(folder / '0003.bag.active')
    (folder / 'drill.yaml').write_text(yaml.safe_dump({
        'format': 1, 'title': 'A <maze>', 'drill': 'maze', 'operator': 'script', 'begun': 1.0,
        'ended': 'all found', 'targets': 2, 'found': 2, 'time_s': 59.5}))
    (folder / 'drill-2.yaml').write_text('format: 99\n')
    (folder / 'stills').mkdir()
    (folder / 'stills' / 'm3_bot1.jpg').write_bytes(jpeg())
    (folder / 'stills' / 'm3_bot2.jpg').write_bytes(b'no picture')
    add_lines(folder, line(61.0, 'mark', 'mark', id='m3', poses={'bot1': [1.0, 0.5, 0.0, 'map']},
                           stills=['stills/m3_bot1.jpg', 'stills/m3_bot2.jpg',
                                   '../../../etc/passwd']),
              line(62.0, 'note', 'a <b>valve</b> & "rust"', mark='m3'))
    return folder


def contents(folder):
    return {path.relative_to(folder): path.read_bytes()
            for path in folder.rglob('*') if path.is_file()}


@pytest.fixture(scope='module')
def report(session, tmp_path_factory):
    """Return the folder of its report, with a film."""
    before = contents(session)
    folder = tmp_path_factory.mktemp('report') / 'here'
    mhri_report.make(mhri_report.parse([
        str(session), '--output', str(folder), '--film', '--fps', str(FPS)]))
    assert contents(session) == before
    return folder


class Tags(html.parser.HTMLParser):
    """Collects what a page refers to, its tags, and its text."""

    def __init__(self, text):
        super().__init__()
        self.links, self.tags, self.words = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.links += [value for name, value in attributes if name in ('src', 'href')]

    def handle_data(self, data):
        self.words.append(data)


def test_the_page_says_what_happened_and_stands_alone(report):
    text = (report / 'report.html').read_text(encoding='utf-8')
    page = Tags(text)
    words = ' '.join(' '.join(page.words).split())
    for said in ('a red bag below the stairs', 'smoke', 'a <b>valve</b> & "rust"', '1:04',
                 'lost while driven', 'STOP ALL at', 'for 6.0 s', 'once, 8.1 s',
                 'Drill: A <maze>', '59.5 s', '2 of 2', 'drill-2.yaml: format: expected 1',
                 '0003.bag.active was never closed', '2 stills are not shown'):
        assert said in words, said
    assert 'script' not in page.tags and 'link' not in page.tags and 'b' not in page.tags
    assert page.links and all(link.startswith('data:image/') for link in page.links)
    assert page.tags.count('img') == 2 and page.tags.count('svg') == 1
    assert 'url(' not in text and '@import' not in text
    assert sorted(path.name for path in report.iterdir()) == [
        'film.mp4', 'map.pgw', 'map.png', 'report.html']


def test_figures_are_those_of_the_drive(session):
    with opened(str(session)) as kept:
        told = ReportBuilder(kept).read()
    by_name = {robot.name: robot.survey for robot in told.robots}
    # Ahead at 0.1 m/s but for the 6 s of the stop.
    way_m = 0.1 * (made.LENGTH_S + EXTRA_S - 6.0)
    assert by_name['bot1'].distance_m == pytest.approx(way_m, abs=0.1)
    assert [round(span.end_s - span.begin_s) for span in by_name['bot2'].silences] == [8]
    assert [sum(span.lasts_s for span in robot.driven) for robot in told.robots] == \
        pytest.approx([45.0, 52.0], abs=0.1)
    assert by_name['bot1'].on_tasks == [Span(
        pytest.approx(made.TASK_S[0], abs=0.6), pytest.approx(made.TASK_S[1], abs=0.6))]
    assert by_name['bot2'].on_tasks == []
    (stop,) = told.stops
    assert (stop.span.begin_s, stop.span.end_s) == pytest.approx((30.0, 36.0))
    assert [(proof.proved, proof.moved_m) for _, proof, _ in stop.proofs] == 2 * [
        (True, pytest.approx(0.01, abs=1e-6))]


def test_odometry_that_the_session_names_wrongly_is_found(session, tmp_path):
    folder = tmp_path / 'session'
    shutil.copytree(str(session), str(folder))
    path = folder / 'session.yaml'
    text = path.read_text().replace('odometry: /bot1/odom', 'odometry: /bot1/pose')
    path.write_text(text.replace('odometry: /bot2/odom', 'odometry: []'))
    with opened(str(folder)) as kept:
        builder = ReportBuilder(kept)
        assert all(robot.survey.readings for robot in builder.read().robots)
        assert builder.odometry_topic('bot2') == '/bot2/odom'


def test_the_map_lies_where_its_world_file_says(report):
    picture = cv2.imread(str(report / 'map.png'))
    numbers = [float(text) for text in (report / 'map.pgw').read_text().split()]
    assert len(numbers) == 6 and numbers[0] == -numbers[3] and numbers[1] == numbers[2] == 0.0

    def colour(x_m, y_m):
        """Return what the picture has at a place of the map, by the world file alone."""
        column, row = (x_m - numbers[4]) / numbers[0], (y_m - numbers[5]) / numbers[3]
        return picture[round(row), round(column)].tolist()
    assert colour(2.0, -1.95) == [60, 60, 60], 'the wall, the lowest row'
    assert colour(2.0, -1.85) == [255, 255, 255]
    # bot1 came along y = 0 and was last at x = 5.8, where its disc is.
    code = colour_of(1, dark=False)
    ink = [int(code[place:place + 2], 16) for place in (5, 3, 1)]
    assert colour(5.5, 0.0) == colour(5.86, 0.0) == colour(5.8, -0.06) == ink
    assert colour(5.8, 0.3) == [255, 255, 255]


def counted(path):
    """Return (frames, seconds) of a film."""
    said = json.loads(subprocess.run(
        ['ffprobe', '-v', 'error', '-count_frames', '-select_streams', 'v', '-show_entries',
         'stream=nb_read_frames,duration', '-of', 'json', str(path)],
        stdout=subprocess.PIPE, check=True).stdout.decode())
    return int(said['streams'][0]['nb_read_frames']), float(said['streams'][0]['duration'])


def test_the_film_is_as_long_as_the_session(report):
    frames, length_s = counted(report / 'film.mp4')
    assert frames == FPS * (made.LENGTH_S + EXTRA_S)
    assert length_s == pytest.approx(made.LENGTH_S + EXTRA_S, abs=0.01)
    video = cv2.VideoCapture(str(report / 'film.mp4'))
    shown = [video.read()[1] for _ in range(frames)]
    # No picture for a minute, then ever brighter ones; a damaged one leaves the one before it.
    shades = [int(shown[place][300, 300].mean()) for place in (0, 119, 123, 127)]
    assert shades[0] < 40 and shades[1] < 40
    assert shades[2] == pytest.approx(45, abs=12) and shades[3] == pytest.approx(170, abs=12)


def test_ctrl_c_ends_it_cleanly(session, tmp_path):
    process = subprocess.Popen(
        [sys.executable, '-c', 'from mhri.nodes.mhri_report import main; main()', str(session),
         '--output', str(tmp_path), '--film', '--fps', '60'],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        universal_newlines=True)
    # An encoder may speak before it.
    assert any(said.startswith('film: 0 %') for said in process.stderr)
    process.send_signal(signal.SIGINT)
    process.stderr.read()
    assert process.wait(timeout=60.0) == 130
    assert not list(tmp_path.glob('film*')) and (tmp_path / 'report.html').is_file()


def test_what_is_no_session_is_refused_by_name(tmp_path, session):
    (tmp_path / 'empty').mkdir()
    for path in (tmp_path / 'none', tmp_path / 'empty', session / '0000.bag'):
        with pytest.raises(NotASession, match=str(path)):
            with opened(str(path)):
                pass
    with pytest.raises(NotASession, match='--output'):
        mhri_report.make(mhri_report.parse([str(session), '--output', str(session)]))


def report_text(folder, output):
    mhri_report.make(mhri_report.parse([str(folder), '--output', str(output)]))
    return (output / 'report.html').read_text(encoding='utf-8')


@pytest.mark.parametrize('spoil', ['no bags', 'no events', 'garbage'])
def test_a_spoilt_session_still_has_a_report(session, tmp_path, spoil):
    folder = tmp_path / 'session'
    shutil.copytree(str(session), str(folder))
    chance = random.Random(3)
    for path in sorted(folder.glob('*.bag*')):
        data = path.read_bytes()
        if spoil == 'no bags':
            path.unlink()
        elif spoil == 'garbage':
            garbled = bytearray(data)
            for _ in range(40):
                garbled[chance.randrange(5000, len(data))] = chance.randrange(256)
            path.write_bytes(bytes(garbled))
    if spoil == 'no events':
        (folder / EVENTS_JSONL).unlink()
    text = report_text(folder, tmp_path / 'report')
    assert ('smoke' in text) == (spoil != 'no events')
    if spoil == 'no events':
        assert 'distance' in text and not re.search('<h2>Marks', text)


def test_a_hostile_session_has_a_report_of_bounded_size(session, tmp_path):
    folder = tmp_path / 'session'
    shutil.copytree(str(session), str(folder))
    many = [line(0.005 * number, 'mark', '<script>alert(1)</script>', id='x%d' % number,
                 poses={'bot1': [1e300, float('nan'), 0.0, 'map']}, stills=['stills/none.jpg'] * 3)
            for number in range(10000)]
    add_lines(folder, *many, line(1e300, 'mark', 'never', id='y'), line(-1e9, 'stop', 'STOP ALL'),
              line(3.0, 'found', 'x', topics='no', number='1'), line(4.0, 'note', 'x', mark=[]), *[
                  line(0.01 * number, 'stop', 'STOP ALL' + ' released' * (number % 2))
                  for number in range(2000)])
    with open(str(folder / EVENTS_JSONL), 'ab') as stream:
        stream.write(b'\xff\xfe{]\n' * 1000 + b'{"wall": NaN, "ros": 1, "kind": "x", "text": ""}\n'
                     + b'[' * 100000)
    text = report_text(folder, tmp_path / 'report')
    assert len(text) < 3000000 and '<script' not in text and '10003' in text


def test_pictures_that_cannot_be_encoded_are_said_and_the_report_goes_on(
        session, tmp_path, monkeypatch):
    def refuse(*_):
        raise cv2.error('too many pixels')
    monkeypatch.setattr(cv2, 'imencode', refuse)
    output = tmp_path / 'report'
    text = report_text(session, output)
    assert 'data:image' not in text and 'smoke' in text
    assert [path.name for path in output.iterdir()] == ['report.html']

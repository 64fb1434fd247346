# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a report of a session says: distances, silences, stops, map, film."""
from dataclasses import replace
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.base.io.pages import page
from mhri.base.views import FlagView
from mhri.map.grid import Grid
from mhri.recording.folder import NotASession, SessionEvent, SessionInfo
from mhri.robots.link import Motion
from mhri.session.film import Camera, cameras_of, frame_count, frame_of, frame_size, Headings, Tile
from mhri.session.flags import place_of
from mhri.session.report import (
    is_still, MAX_EVENTS, MAX_MARKS, MAX_STOPS, report_of, ROBOT_HEADS, spots_of)
from mhri.session.report_page import TEMPLATE, values_of
from mhri.session.sheet import drawn, ground, sheet_of
from mhri.session.survey import link_words, RobotSurvey
from mhri.session.timeline import read_time_line, Span

from support.paths import RESOURCE

START = 1700000000.0


def drive(rows, stops=(), origin=None, until_s=None):
    """Return the survey of readings (time [s], x [m], speed [m/s])."""
    survey = RobotSurvey(stops)
    survey.on_place(origin)
    for at_s, x_m, speed in rows:
        survey.on_motion(at_s, Motion(speed, 0.0, x_m, 0.0, 0.0))
    survey.end(rows[-1][0] if until_s is None else until_s)
    return survey


def steps(begin_s, end_s, mps, from_m=0.0):
    return [(begin_s + 0.1 * step, from_m + 0.1 * step * mps, mps)
            for step in range(round((end_s - begin_s) * 10) + 1)]


@pytest.mark.parametrize('rows, distance_m, pieces', [
    (steps(0.0, 10.0, 0.3), 3.0, 1),
    ([(0.1 * number, 0.005 * (number % 2), 0.0) for number in range(1000)], 0.0, 1),
    (steps(0.0, 1.0, 0.3) + steps(1.1, 2.1, 0.3, from_m=100.0), 0.6, 2),
    (steps(0.0, 1.0, 0.3) + [(1.05, math.nan, 0.3), (1.06, 1e300, 0.3)]
     + steps(1.1, 2.1, 0.3, 0.3), 0.6, 1),
    # It drove on unheard: that counts, but nobody knows the way.
    (steps(0.0, 1.0, 0.5) + steps(5.0, 6.0, 0.5, from_m=2.5), 3.0, 2),
], ids=['straight', 'jitter', 'leap', 'impossible', 'silence'])
def test_distance(rows, distance_m, pieces):
    survey = drive(rows)
    assert survey.distance_m == pytest.approx(distance_m, abs=0.05)
    assert len(survey.way(0.01)) == pieces


@pytest.mark.parametrize('rows, until_s, silences', [
    (steps(0.0, 5.0, 0.1), 5.5, []),
    (steps(0.0, 5.0, 0.1), 9.0, [(5.0, 9.0)]),
    (steps(2.0, 5.0, 0.1) + steps(8.0, 9.0, 0.1), 9.0, [(5.0, 8.0)]),
])
def test_silences(rows, until_s, silences):
    found = drive(rows, until_s=until_s).silences
    assert [(round(span.begin_s, 3), round(span.end_s, 3)) for span in found] == silences


@pytest.mark.parametrize('rows, proved, stood, moved_m', [
    (steps(0.0, 10.0, 0.5) + steps(10.1, 10.5, 0.2, 5.0) + steps(10.6, 20.0, 0.0, 5.1),
     True, False, 0.15),
    (steps(0.0, 20.0, 0.0), True, True, 0.0),
    (steps(0.0, 20.0, 0.5), False, False, 2.5),
    (steps(0.0, 9.0, 0.5), None, False, 0.0),
    (steps(0.0, 13.0, 0.0), False, True, 0.0),
    (steps(0.0, 11.0, 0.0) + [(12.0, 0.0, 0.4)] + steps(12.1, 15.0, 0.0), True, False, 0.0),
], ids=['brakes', 'stands', 'drives on', 'unheard', 'falls silent', 'moves once more'])
def test_a_stop_is_proved_as_on_the_screen(rows, proved, stood, moved_m):
    survey = drive(rows, [Span(9.95, 15.0)])
    found = survey.stopped(0)
    assert (found.proved, found.stood) == (bool(proved), stood)
    assert (found.proof is None) == (proved is None) and survey.stopped(1).proof is None
    assert found.moved_m == pytest.approx(moved_m, abs=0.01) and found.words()


def test_a_way_is_in_the_frame_of_the_map_once_it_is_placed():
    survey = drive(steps(0.0, 1.0, 1.0), origin=Pose(5.0, 1.0, math.pi / 2))
    (piece,) = survey.way(0.01)
    assert survey.placed
    assert piece == pytest.approx(np.array([(5.0, 1.0), (5.0, 2.0)]), abs=1e-3)
    late = drive(steps(0.0, 1.0, 1.0))
    late.on_place(Pose(5.0, 1.0, 0.0))
    late.on_place(Pose(math.nan, 1.0, 0.0))
    assert late.placed and late.way(0.01) == []


def test_link_in_words():
    assert link_words([]) == ('-', '-')
    assert link_words([0.001 * number for number in range(1, 101)]) == ('51 ms', '96 ms')
    survey = RobotSurvey()
    for value in (math.nan, -1.0, math.inf, 0.02):
        survey.on_round_trip(value)
    assert survey.round_trips_s == [0.02]


@pytest.mark.parametrize('origin, cells, resolution_m', [
    (Pose(-1.0, -2.0, 0.0), (40, 80), 0.1), (Pose(3.0, 4.0, 0.7), (3000, 2500), 0.05)])
def test_world_file_and_pixels_agree_on_every_cell(origin, cells, resolution_m):
    grid = Grid(resolution_m, origin, np.zeros(cells, np.int8))
    sheet = sheet_of(grid, np.zeros((0, 2)))
    assert sheet.width * sheet.px_m == pytest.approx(grid.size_m[0], abs=2 * sheet.px_m)
    a, d, b, e, c, f = map(float, sheet.world_file().split())
    for column, row in ((0, 0), (sheet.width - 1, 3), (5, sheet.height - 1)):
        place = np.array([(a * column + b * row + c, d * column + e * row + f)])
        assert sheet.pixels(place)[0] == pytest.approx((column + 0.5, row + 0.5), abs=1e-4)
    # The lower left corner of the lowest row is the map's origin.
    assert sheet.pixels(np.array([(origin.x_m, origin.y_m)]))[0] == pytest.approx(
        (0.0, sheet.height), abs=1.5)


def test_the_ground_shows_cells_where_they_are():
    cells = np.zeros((20, 30), np.int8)
    cells[0, :] = 100
    cells[:, 0] = -1
    grid = Grid(0.1, Pose(0.0, 0.0, 0.0), cells)
    for points in (np.zeros((0, 2)), np.array([(-2.0, -1.0), (6.0, 5.0)])):
        sheet = sheet_of(grid, points)
        base = ground(sheet, grid)
        shades = [int(base[int(y), int(x)]) for x, y in sheet.pixels(
            np.array([(1.55, 0.05), (1.55, 0.15), (0.05, 1.0)]))]
        assert shades == [60, 255, 232]


def line(at_s, kind, text, severity='info', robot='', **data):
    return SessionEvent(START + at_s, START + at_s, kind, text, severity, robot, data)


def report(events, robots=None, surveys=None, length_s=60.0):
    robots = {'bot1': {'number': 1, 'type': 'x'}} if robots is None else robots
    surveys = surveys or {name: drive(steps(0.0, 60.0, 0.1)) for name in robots}
    return report_of('name', SessionInfo(START), read_time_line(events, START, length_s), robots,
                     surveys)


def report_page(*values):
    """Return the page of a report."""
    return page(str(RESOURCE / 'pages'), TEMPLATE, values_of(*values))


def test_sensors_beyond_their_limits():
    """Each with its robot, from the first word on; one that was not back by the end."""
    def said(at_s, what, robot='bot1', key='gas'):
        return line(at_s, 'event', 'gas 60 ppm', 'warning', robot, code='readout.' + what,
                    readout=key, value=60.0)
    found = report([said(1.0, 'within'), said(5.0, 'beyond'), said(6.0, 'beyond', key='bumper'),
                    said(7.0, 'beyond'), said(9.0, 'within'), said(10.0, 'beyond', 'bot2')])
    assert [(row.span.robot, round(row.span.begin_s), round(row.span.end_s), row.over)
            for row in found.sensors] == [
        ('bot1', 5, 9, True), ('bot1', 6, 60, False), ('bot2', 10, 60, False)]
    assert report_page(found, '', {}).count('<td>gas 60 ppm</td>') == 3
    assert report_page(found, '', {}).count('until the end') == 2


def test_text_of_the_session_is_no_markup():
    nasty = '<script>"&\''
    events = [line(1.0, 'mark', nasty, id=nasty, poses={nasty: [1.0, 2.0, 0.0, nasty]},
                   stills=[nasty]),
              line(2.0, 'note', nasty, mark=nasty), line(3.0, 'stop', 'STOP ALL', stop_all=True),
              line(3.1, 'stop', nasty, 'error', nasty, code='proof.doubtful'),
              line(4.0, nasty, nasty, nasty, nasty)]
    found = report(events, {nasty: {'number': 1, 'type': nasty, 'model': nasty}})
    page = report_page(found, '', {}, nasty)
    assert nasty not in page and '<script' not in page and page.count('&lt;script&gt;') > 8


def test_a_page_is_of_bounded_size_and_says_what_it_leaves_out():
    names = ['stills/a_bot1.jpg', 'stills/b_bot1.jpg']
    events = [line(0.001 * number, 'mark', 'mark', robot='bot1', id='m%d' % number,
                   poses={'bot1': [1.0, 2.0, 0.0, 'map']}, stills=names if number else [])
              for number in range(MAX_MARKS + 1)]
    events += [line(1.0 + number / 10, 'stop', 'STOP ALL', stop_all=not number % 2)
               for number in range(2 * MAX_STOPS + 2)]
    events += [line(2.0, 'link', 'x', 'error', 'bot1')] * (MAX_EVENTS + 1) + [
        line(3.0, 'still', 'still', stills=names)]
    found = replace(report(events), drills=(('maze', [('time', '3 s')]),), problems=('a bag',))
    text = report_page(found, 'data:map', {names[0]: 'data:still'})
    assert text.count('class="mark"') == MAX_MARKS and text.count('src="data:map"') == 1
    # Each mark but the first, and once by itself; the other still is there for nobody.
    assert text.count('src="data:still"') == MAX_MARKS
    assert text.count('one still is not shown') == MAX_MARKS - 1
    assert text.count('<h3>STOP ALL') == MAX_STOPS and text.count('TROUBLE: x') == MAX_EVENTS
    for said in ('<td>3 s</td>', '<li>a bag</li>', *(
            'irst {} of {} '.format(most, most + 1) for most in (MAX_MARKS, MAX_STOPS)),
            '{} of {} lines'.format(MAX_EVENTS, len(found.line.events))):
        assert said in text


def test_every_stop_has_a_proof_for_each_robot():
    events = [line(10.0, 'stop', 'on', 'warning', stop_all=True),
              line(15.0, 'stop', 'off', stop_all=False),
              line(10.4, 'stop', 'seen', robot='bot1', code='proof.stopped'),
              line(10.5, 'stop', 'motor power cut', robot='bot1', code='power.cut')]
    robots = {'bot2': {'number': 2}, 'bot1': {'number': 1}, 'bot3': {'number': 'x'}}
    spans = [Span(10.0, 15.0)]
    surveys = {'bot1': drive(steps(0.0, 20.0, 0.0), spans),
               'bot2': drive(steps(0.0, 9.0, 0.1), spans), 'bot3': RobotSurvey(spans)}
    found = report(events, robots, surveys)
    assert [row.name for row in found.robots] == ['bot1', 'bot2', 'bot3']
    (stop,) = found.stops
    assert [(name, recorded.proved, said) for name, recorded, said in stop.proofs] == [
        ('bot1', True, 'seen'), ('bot2', False, '-')]
    assert 'class="bad"' in report_page(found, '', {})


def test_a_session_of_nothing_is_none():
    with pytest.raises(NotASession):
        report([], {}, {})
    assert '<h2>Robots' not in report_page(report([line(0.0, 'start', 'begins')], {}), '', {})


@pytest.mark.parametrize('name, good', [
    ('stills/m1_bot1.jpg', True), ('stills/../m1.jpg', False), ('/stills/m.jpg', False),
    ('stills/m.jpg\n', False), ('stills/m.png', False)])
def test_a_still_is_a_file_of_its_folder(name, good):
    assert is_still(name) == good


@pytest.mark.parametrize('pose, place', [
    ([1, 2.5, 0.0, 'map'], (1.0, 2.5, 'map')), ([1.0, 2.0], (1.0, 2.0, '')), ([1.0], None),
    ([None, 1.0, 0.0], None), ([math.nan, 1.0], None), ([1e300, 1.0], None), ('ab', None),
    ([True, 1.0], None)])
def test_the_place_of_a_mark(pose, place):
    assert place_of(pose) == place


def test_a_film_is_as_long_as_the_session():
    assert [frame_count(*each) for each in ((64.0, 10.0), (0.0, 10.0), (0.31, 10.0))] == [640, 1, 4]
    assert all(side % 2 == 0 for count in range(1, 17) for side in frame_size(count))


def test_the_cameras_of_a_film():
    robots = {'b': {'topics': {'rgb': '/b/cam/compressed'}}, 'a': {}, 'c': {'topics': 3}}
    pictures = ['/a/depth/compressedDepth', '/a/z/compressed', '/b/a/compressed',
                '/b/cam/compressed', '/other/compressed']
    assert cameras_of(robots, {'a': 2, 'b': 1, 'c': 3}, pictures) == [
        Camera('b', 1, '/b/cam/compressed'), Camera('a', 2, '/a/z/compressed')]


def test_a_frame_says_what_it_shows():
    camera = Camera('bot1', 1, '/bot1/camera')
    assert 'bot1' in Tile(camera).words()
    words = Tile(camera, np.zeros((2, 2, 3)), 3.2, 0.5).words()
    assert '0.50 m/s' in words and '3 s' in words
    fresh = frame_of([Tile(camera, np.full((30, 40, 3), 200, np.uint8))], 'x' * 999, False)
    old = frame_of([Tile(camera, np.full((30, 40, 3), 200, np.uint8), 9.0)], '\u00e9', True)
    assert fresh.shape == old.shape == (*frame_size(1)[::-1], 3)
    assert fresh[400, 400].tolist() == [200] * 3 and old[400, 400].tolist() == [100] * 3
    # Very wide, very high, one pixel: each fits.
    for shape in ((1, 1000, 3), (1000, 1, 3), (1, 1, 3)):
        frame_of([Tile(camera, np.zeros(shape, np.uint8))] * 5, '', False)


def test_what_stands_above_a_frame():
    found = report([line(0.0, 'start', 'begins', selected=['bot1'], stop_all=False),
                    line(5.0, 'mark', 'mark', id='m1'), line(6.0, 'note', 'a red\nbag', mark='m1'),
                    line(10.0, 'stop', '', stop_all=True), line(12.0, 'stop', '', stop_all=False)])
    headings = Headings(found)
    texts = [headings.at(at_s) for at_s in (1.0, 5.5, 9.5, 11.0, 12.0)]
    assert [stopped for _, stopped in texts] == [False, False, False, True, False]
    assert '0:01' in texts[0][0] and 'bot1' in texts[0][0]
    assert 'a red bag' in texts[1][0] and 'a red bag' not in texts[2][0]


@pytest.mark.parametrize('rows, spans', [
    ([], None), ([(0.0, False), (1.0, False)], []),
    ([(1.0, True), (1.5, True), (2.0, True), (2.4, False)], [(1.0, 2.4)]),
    # Without a word of the drive, a state counts for 2 s; so does the last one.
    ([(1.0, True), (9.0, True), (9.5, False)], [(1.0, 3.0), (9.0, 9.5)]),
    ([(20.0, True)], [(20.0, 22.0)]), ([(59.0, True)], [(59.0, 60.0)])])
def test_time_on_tasks_is_time_driven_by_itself(rows, spans):
    survey = RobotSurvey()
    for at_s, on_task in rows:
        survey.on_drive(at_s, on_task)
    survey.end(60.0)
    assert survey.on_tasks == (None if spans is None else [Span(*span) for span in spans])
    cells = dict(zip(ROBOT_HEADS, report([line(0.0, 'start', '')], surveys={
        'bot1': survey}).robots[0].cells()))
    total = sum(end_s - begin_s for begin_s, end_s in spans or ())
    assert cells['on tasks'] == ('-' if spans is None else '{:.1f} s'.format(total))
    assert cells['driven'] == '0.0 s'


def test_a_stop_that_nobody_released_ends_with_the_session():
    events = [line(10.0, 'stop', 'on', stop_all=True), line(15.0, 'stop', 'off', stop_all=False),
              line(50.0, 'stop', 'on', stop_all=True)]
    found = report(events)
    assert [(stop.span.begin_s, stop.span.end_s, stop.released) for stop in found.stops] == [
        (10.0, 15.0, True), (50.0, 60.0, False)]
    assert report_page(found, '', {}).count('not released') == 1


def test_a_flag_stands_at_its_robot_with_the_first_words_of_its_note():
    poses = {'a': [1.0, 2.0, 0.0, 'a/odom'], 'b': [3.0, 4.0, 0.0, 'map']}
    found = report([line(1.0, 'mark', 'mark 1', robot='b', id='m1', poses=poses),
                    line(2.0, 'note', 'a <red> door', mark='m1'),
                    line(20.0, 'mark', 'mark 2', robot='a', id='m2', poses=poses)])
    assert spots_of(found.marks, ['b'], 'map') == [FlagView('1 a <red> door', 3.0, 4.0, 'map')]
    assert [flag.label for flag in spots_of(found.marks, [], 'map')] == ['1 a <red> door', '2']
    assert '>1 a &lt;red&gt; door</text>' in report_page(found, '', {})
    # The words stay on the sheet, wherever the flag is.
    for x_m in (0.0, 5.0):
        flags = [FlagView('1 water on the floor\u2026', x_m, 0.0, 'map')]
        sheet = sheet_of(None, np.array([(0.0, 0.0), (5.0, 0.0)]))
        inked = drawn(sheet, ground(sheet, None), [], flags).min(axis=2) < 100
        high, wide = np.nonzero(inked[:round(0.9 * sheet.height)])
        assert wide.max() - wide.min() > 100 and 0 < wide.min() and wide.max() < sheet.width - 1

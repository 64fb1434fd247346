# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The bad radio between two network namespaces: real datagrams and streams, and what it tells."""
import json
import os
import signal
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import bad_radio, radio_traffic  # noqa: E402
from support.bad_radio import BadRadio, FAR_IP, Place  # noqa: E402

WHY_NOT = bad_radio.why_not()
pytestmark = pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))

CLEAN = [{'at_s': 0}]
LIMIT_S = 120


@pytest.fixture(scope='module')
def places():
    near, far = Place(), Place()
    yield near, far
    near.close()
    far.close()


class Link:
    """A radio with somebody at the far end who answers."""

    def __init__(self, radio, near):
        self.radio = radio
        self._near = near

    def talk(self, what, **options):
        """Return what the traffic measured."""
        words = ['--{}={}'.format(*item) for item in options.items()]
        done = subprocess.run(
            self._near.command(sys.executable, radio_traffic.__file__, what, FAR_IP, *words),
            stdout=subprocess.PIPE, timeout=LIMIT_S, check=True)
        return json.loads(done.stdout.decode())

    def under(self, row, what, **options):
        """Return (what the traffic measured, {direction: what the radio did}) under one row."""
        self.radio.follow([dict(row, at_s=0)])
        measured = self.talk(what, **options)
        report = self.radio.follow(CLEAN)
        print('\n'.join(bad_radio.lines_of(report)))
        return measured, report['rows'][0]['did']


@pytest.fixture(scope='module')
def link(places):
    near, far = places
    with BadRadio(far, near) as radio:
        answers = subprocess.Popen(
            far.command(sys.executable, radio_traffic.__file__, 'answer', FAR_IP),
            stdout=subprocess.PIPE, universal_newlines=True)
        assert answers.stdout.readline() == 'ready\n'
        yield Link(radio, near)
        answers.kill()
        answers.wait(60)
        answers.stdout.close()


def test_clean_cable_loses_nothing(link):
    took_s, did = link.under({}, 'udp', count=300)
    assert len(took_s) == 300
    for one in did.values():
        assert one['packets'] == one['passed'] == 300


def test_delay_goes_for_every_datagram(link):
    took_s, did = link.under({'delay_ms': 50, 'jitter_ms': 20}, 'udp', count=200)
    assert len(took_s) == 200 and min(took_s) >= 0.1
    for one in did.values():
        assert one['delay_p95_ms'] > one['delay_p50_ms'] >= 50.0


def test_loss_is_what_it_tells(link):
    took_s, did = link.under({'loss_percent': 20}, 'udp', count=1000)
    assert 15.0 < did['to far']['lost_percent'] < 25.0
    assert did['to far']['packets'] == 1000
    assert did['to near']['packets'] == did['to far']['passed']
    assert len(took_s) == did['to near']['passed']


def test_stream_is_whole_and_no_faster_than_the_rate(link):
    (took_s, whole), did = link.under({'rate_mbit': 2, 'delay_ms': 20}, 'tcp', count=500000)
    assert whole and took_s > 8 * 500000 / 2e6
    assert did['to far']['bytes_per_s'] < 2e6 / 8 * 1.02


def test_stream_is_whole_where_packets_are_lost(link):
    (_, whole), did = link.under({'loss_percent': 5, 'rate_mbit': 10}, 'tcp', count=300000)
    assert whole and did['to far']['lost'] > 0


def test_burst_overflows_the_queue(link):
    took_s, did = link.under({'rate_mbit': 0.1, 'queue_ms': 100}, 'udp', count=1000, pace=0.0)
    assert did['to far']['queue_full'] > 0
    # On a busy machine one may come when nobody listens any more.
    assert 0 <= did['to near']['passed'] - len(took_s) <= 2
    assert len(took_s) < 1000


def test_nothing_passes_while_it_is_down(link):
    down = [{'at_s': 0, 'down': True}]
    link.radio.follow(down)
    assert link.talk('udp', count=20) == []
    did = link.radio.follow(CLEAN)['rows'][0]['did']['to far']
    assert did['down'] == did['packets'] == 20
    assert len(link.talk('udp', count=20)) == 20


def test_table_is_followed_by_itself(link):
    """An outage in the middle of a stream, which takes longer than the table."""
    link.radio.follow([{'at_s': 0, 'rate_mbit': 1}, {'at_s': 1.0, 'down': True},
                       {'at_s': 1.5, 'down': False}])
    _, whole = link.talk('tcp', count=250000)
    report = link.radio.follow(CLEAN)
    print('\n'.join(bad_radio.lines_of(report)))
    before, outage, after = report['rows']
    assert whole and outage['took_s'] == pytest.approx(0.5)
    assert before['took_s'] == pytest.approx(1.0)
    assert outage['did']['to far']['passed'] == 0 < after['did']['to far']['passed']


def radio_process(places, folder, text):
    """Start the radio as a person does, with a table in a file."""
    (folder / 'table.yaml').write_text(text)
    return subprocess.Popen(
        [sys.executable, bad_radio.__file__, '--near', str(places[0].pid), '--far',
         str(places[1].pid), '--device', 'radio1', '--near-ip', '10.79.0.1', '--far-ip',
         '10.79.0.2', '--table', str(folder / 'table.yaml'), '--seed', '7'],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True)


def test_it_tells_a_person(places, tmp_path):
    process = radio_process(places, tmp_path, '- {at_s: 0, delay_ms: 5}\n- {at_s: 900, down: true}')
    assert process.stdout.readline() == 'seed 7\n'
    process.send_signal(signal.SIGINT)
    output = process.communicate(timeout=LIMIT_S)[0]
    print(output)
    assert process.returncode == 0
    assert 'from 0.00 s' in output and 'from 900.00 s, for 0.00 s: down' in output
    assert '5 ms, jitter 0 ms, loss 0 %, no limit of the rate' in output and 'cores' in output


def test_bad_table_ends_it_with_its_name(places, tmp_path):
    process = radio_process(places, tmp_path, '- {at_s: 0, colour: 5}')
    output = process.communicate(timeout=LIMIT_S)[0]
    assert process.returncode == 1 and 'bad_radio: row 1: there is no colour' in output

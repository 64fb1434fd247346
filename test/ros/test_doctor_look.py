# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the doctor looks: what nodes say of their connections, and names that change meanwhile."""
import time

import pytest

from mhri.core.doctor.facts import Connection, Facts, Node
from mhri.ros.doctor import examination as doctor
from mhri.ros.doctor.probe import _connections
from mhri.ros.graph.master_api import MasterError

TO = 'TCPROS connection on port 41374 to [{} on socket 6]'


@pytest.mark.parametrize('words, address', [
    ([TO.format('192.0.2.7:40623')], '192.0.2.7'), ([TO.format('bot1:40623')], ''),
    ([TO.format('999.0.2.7:40623')], ''), (['UDPROS to nowhere'], ''), ([None], ''), ([], '')])
def test_address_of_the_other_end(words, address):
    entry = [1, '/viewer', 'o', 'TCPROS', '/odom', True] + words
    assert _connections([entry]) == (Connection(True, '/odom', '/viewer', address),)


def watch(monkeypatch, *answers, limit_s=5.0):
    """Return where a node is registered in the end, and how often the master was asked."""
    answers = list(answers)
    asked = []

    def uris(*_):
        asked.append(1)
        answer = answers.pop(0) if len(answers) > 1 else answers[0]
        if answer is None:
            raise MasterError('gone')
        return {'/base': answer} if answer else {}
    monkeypatch.setattr(doctor, '_uris', uris)
    monkeypatch.setattr(doctor, 'WATCH_EACH_S', 0.001)
    facts = Facts(nodes={'/base': Node('/base', 'http://a:1/', uri_later='http://a:1/')})
    seen = doctor._watch_names(facts, None, time.monotonic() + limit_s)
    return seen.nodes['/base'].uri_later, len(asked)


def test_name_that_changes_is_seen_at_once(monkeypatch):
    assert watch(monkeypatch, 'http://a:1/', '', 'http://b:2/', 'http://a:1/') == (
        'http://b:2/', 3)


def test_name_is_watched_until_the_end(monkeypatch):
    begun = time.monotonic()
    uri, asked = watch(monkeypatch, 'http://a:1/', limit_s=0.1)
    assert uri == 'http://a:1/' and asked > 3 and 0.1 <= time.monotonic() - begun < 5.0
    assert watch(monkeypatch, 'http://a:1/', limit_s=-1.0) == ('http://a:1/', 0)


def test_master_that_ends_meanwhile(monkeypatch):
    assert watch(monkeypatch, 'http://a:1/', None) == ('http://a:1/', 2)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A mux has the state of the one before it, and never its address: no robot would connect."""
import json
from types import SimpleNamespace

import pytest
import rospy

from mhri.driving.drive import LOST
from mhri.driving.ros.mux_takeover import (
    has_address_of_last, keep, KEPT_PARAMETER, recalled, SOURCES_PARAMETER)
from mhri.graph.ros.stand_by import Memory


def test_an_address_is_refused_once_to_the_next_process(monkeypatch):
    memory, found = Memory(), []
    for port in (40001, 40003, 40003, 40005, 40003):
        monkeypatch.setattr(rospy, 'get_node_uri', 'http://127.0.0.1:{}/'.format(port).__str__)
        found.append(has_address_of_last(memory))
    assert found == [False, False, True, False, False]


@pytest.fixture(name='parameters')
def fixture_parameters(monkeypatch):
    found = {}
    monkeypatch.setattr(rospy, 'get_param', found.get)
    monkeypatch.setattr(rospy, 'has_param', found.__contains__)
    return found


def next_one(memory, use=len, stopped=False, callers=()):
    return recalled(memory, SimpleNamespace(stopped=lambda: stopped), use, lambda: callers)


def test_what_one_mux_keeps_the_next_one_has_also_if_its_memory_is_gone(parameters):
    watch = SimpleNamespace(keep_parameter=parameters.__setitem__)
    memory, kept = Memory(), {'seat': {'holder': ['/a', '', '']}, 'stop': True}
    keep(memory, watch, kept)
    assert next_one(memory) == kept
    assert next_one(Memory()) == dict(kept, stop=False), 'a stop has a file of its own'
    assert next_one(Memory(), stopped=True) == kept


@pytest.mark.parametrize('text', [
    '{', '[]', '7', 7, '{"seat": 1}', '["a"]', [1], '[' * 100000])
def test_what_cannot_be_read_stops_everything_and_puts_nobody_in_control(parameters, text):
    parameters[KEPT_PARAMETER] = text

    def use(kept):
        kept['seat']['holder']
    assert next_one(Memory(), use) == LOST


@pytest.mark.parametrize('before, kept', [
    ({}, {'stop': False}), ({KEPT_PARAMETER: ''}, {'stop': False}),
    ({SOURCES_PARAMETER: [], KEPT_PARAMETER: ''}, {'stop': False, 'forgotten': True}),
    ({SOURCES_PARAMETER: [], KEPT_PARAMETER: json.dumps({'seat': 0})}, {'seat': 0, 'stop': False})])
def test_only_the_first_mux_of_a_master_has_nothing_to_remember(parameters, before, kept):
    parameters.update(before)
    assert next_one(Memory(), callers=['http://lab:5001/']) == kept
    kept.pop('forgotten', None)
    assert next_one(Memory()) == kept, 'nobody is there who could have been refused'

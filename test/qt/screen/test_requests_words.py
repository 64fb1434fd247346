# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How several recordings ended, in few words; and an accessory used by a request."""
from dataclasses import replace
import types

import pytest

from mhri.recording.recording import RecordingStatus
from mhri.driving.selection import Selection
from mhri.screen.presenters.requests_presenter import RequestsPresenter, short_ends
from support.tools import robot, screen_of, specs

SAVED = RecordingStatus('ended', note='saved 21 messages, 4 kB: /ros/a.bag')
ELSEWHERE = replace(SAVED, elsewhere='no permission')
FAILED = RecordingStatus('failed', note='cannot record')


@pytest.mark.parametrize('ends, texts', [
    ([('bot1', SAVED), ('bot2', SAVED)], ('saved bot1, bot2', '2 saved')),
    ([('bot1', SAVED), ('bot2', ELSEWHERE), ('bot3', FAILED)],
     ('not saved bot3, saved elsewhere bot2, saved bot1',
      '1 not saved, 1 saved elsewhere, 1 saved')),
    ([('bot1', RecordingStatus())], ('not saved bot1', '1 not saved')),
])
def test_what_went_wrong_comes_first(ends, texts):
    assert short_ends(ends) == texts


@pytest.mark.parametrize('names, key, choice, done', [
    (['bot1'], 'gripper', 'open', True), ([], 'arm', 'rest', True),
    (['bot1'], 'gripper', 'bite', False), (['bot2'], 'gripper', 'open', False)])
def test_an_accessory_is_used_or_the_reason_said(names, key, choice, done):
    used, shown = [], []
    backend = types.SimpleNamespace(
        selection=Selection(), use_accessory=lambda *act: used.append(act),
        view=lambda: screen_of(robot(specs())))
    for name in ('bot1', 'bot2'):
        backend.selection.add(name)
    requests = RequestsPresenter(backend, shown.append, None, None)
    text = requests.carry_out('accessory', names, key, choice)
    assert (text == '') == done and shown == [text] * (not done)
    assert used == [(names, key, choice)] * done

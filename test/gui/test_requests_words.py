# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How several recordings ended, in the few words that fit beside a button."""
import pytest

from mhri.recording.recording import fallback_note, RecordingStatus
from mhri.screen.presenters.requests_host import short_ends

SAVED = RecordingStatus('ended', note='saved 21 messages, 4 kB: /ros/a.bag')
ELSEWHERE = RecordingStatus('ended', note='{}; saved 21 messages, 4 kB: /ros/a.bag'.format(
    fallback_note('/proc/x', 'no permission', '/ros/a.bag')))
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

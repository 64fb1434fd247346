# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of recorded sessions."""
import pytest

from mhri.recording.folder import event_line, info_text, SessionEvent, SessionInfo
from mhri.session.catalogue import row_of

DAY, YEAR = 86400.0, 3e7


@pytest.mark.parametrize('times, length_s', [
    ((), None), ((5.0,), 0.0), ((5.0, 7.0, 6.5, 25.0), 20.0), ((5.0, 5.0 + 0.9 * DAY), 0.9 * DAY),
    ((5.0, YEAR, YEAR + 20.0), 20.0), ((YEAR, YEAR + 20.0, 3.0, 4.0), 21.0)])
def test_a_leap_of_the_clock_is_no_part_of_the_length(times, length_s):
    """A computer without a clock of its own is set while the session runs."""
    events = ''.join(event_line(SessionEvent(at_s, at_s, 'record', 'words')) for at_s in times)
    row = row_of('name', info_text(SessionInfo(5.0)), events, {'a.bag': 1})
    assert row.length_s == (None if length_s is None else pytest.approx(length_s))

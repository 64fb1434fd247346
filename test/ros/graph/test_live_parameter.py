# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A parameter that takes effect while a node runs: only what has changed is applied."""
import threading

import pytest

from mhri.graph.ros import live_parameter

NAN = float('nan')


class Master:
    """Answers with the next of its values, then with NaN; asked once more, the trial is over."""

    def __init__(self, values, done):
        self._values = iter(values)
        self._done = done
        self._over = False

    def call_many(self, _):
        """Return (known, value)."""
        try:
            return True, next(self._values)
        except StopIteration:
            if self._over:
                self._done.set()
            self._over = True
            return True, NAN


@pytest.mark.parametrize('values, applied', [
    ([NAN] * 4, ['', 'nan']), (['a', 'a', 'b'], ['', 'a', 'b', 'nan']),
    ([1, True, 1.0], ['', '1', 'True', '1.0', 'nan'])])
def test_a_value_is_applied_once(values, applied, monkeypatch):
    """NaN is not equal to itself: it was applied, and logged, every second."""
    ended, got = threading.Event(), []
    monkeypatch.setattr(live_parameter, 'PERIOD_S', 0.0)
    monkeypatch.setattr(live_parameter, 'MasterApi', lambda *_, **__: Master(values, ended))
    for name, call in (('get_param', lambda name, default: default),
                       ('on_shutdown', lambda call: None), ('get_name', lambda: '/test')):
        monkeypatch.setattr(live_parameter.rospy, name, call)
    wanted = threading.Event()
    wanted.set()
    live_parameter.LiveParameter('/device', '', lambda value: got.append(str(value)),
                                 wanted).start()
    assert ended.wait(60.0)
    wanted.clear()
    assert got == applied

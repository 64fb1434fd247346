# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every benchmark runs to its end and prints its table; short unless MHRI_BENCH is ``full``."""
import os
from pathlib import Path
import subprocess
import sys

import pytest

BENCHMARKS = sorted(Path(__file__).parent.glob('bench_*.py'))
FULL = os.environ.get('MHRI_BENCH') == 'full'
LIMIT_S = 900 if FULL else 300


@pytest.mark.timeout(2 * LIMIT_S)
@pytest.mark.parametrize('path', BENCHMARKS, ids=lambda path: path.stem)
def test_benchmark(path):
    command = [sys.executable, str(path)] + ([] if FULL else ['--short'])
    print('\n' + ' '.join(command[1:]), flush=True)
    assert subprocess.run(command, stdin=subprocess.DEVNULL, timeout=LIMIT_S).returncode == 0


def test_there_are_benchmarks():
    assert BENCHMARKS

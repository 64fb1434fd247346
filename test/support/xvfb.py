# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Virtual screens that do not take each other's place."""
import contextlib
from pathlib import Path
import random
import subprocess
import time

_FIRST, _LAST = 200, 9999
_START_S = 60.0


def _holds(process, number):
    """Return whether a display is this server's: until it ends, another's would answer for it."""
    with contextlib.suppress(OSError):
        return Path('/tmp/.X{}-lock'.format(number)).read_text().split() == [str(process.pid)]
    return False


def start_xvfb(size='1920x1080x24', host=''):
    """Start Xvfb on a display of its own and wait until it answers.

    The number is chosen here: with ``-displayfd`` a server takes no lock, and one that starts while
    another ends may lose its socket to it.

    :param size: width x height x depth
    :param host: "localhost": the display is reached over the network, as one that ssh forwards
    :returns: (process, display such as ``:4711``)
    :raises RuntimeError: no server answered in a minute
    """
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        number = random.randint(_FIRST, _LAST)
        display = '{}:{}'.format(host, number)
        process = subprocess.Popen(
            # Without -noreset it refuses whoever comes just as the last one has gone.
            ['Xvfb', ':{}'.format(number), '-noreset', '-screen', '0', size,
             '-listen' if host else '-nolisten', 'tcp'],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        while process.poll() is None and time.monotonic() < deadline:
            if _holds(process, number) and subprocess.call(
                    ['xdpyinfo', '-display', display], stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL) == 0:
                return process, display
            time.sleep(0.05)
        process.kill()
        process.wait()
    raise RuntimeError('no Xvfb answers')

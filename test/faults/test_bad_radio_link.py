# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot linked by keys behind a radio that loses a fifth of 1 Mbit/s, and then everything."""
import os
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import bad_radio  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

WHY_NOT = bad_radio.why_not()
BAD = {'at_s': 0, 'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}
LONG_S = 120.0


@pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))
def test_pictures_get_small_the_row_says_so_and_nothing_moves_after_an_outage():
    # In a network of its own, so that the radio's addresses meet nobody else's.
    done = subprocess.run(['unshare', '--net', sys.executable, os.path.abspath(__file__)],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=6 * LONG_S,
                          universal_newlines=True)
    print(done.stdout)
    assert done.returncode == 0, done.stdout[-3000:]


def inside():
    """Be the operator; end with an AssertionError where something is not so."""
    from support.behind_radio import path_m, World
    subprocess.run(['ip', 'link', 'set', 'lo', 'up'], check=True)
    with World(['tls'], 1) as world:
        world.start()
        world.look('tls')
        world.settle('tls')
        shown = world.shown['tls1']
        world.radio.follow([BAD])
        shown.forget()
        wait_for(lambda: any(size < 8000 for _, _, size in shown.pictures), LONG_S,
                 'a picture made small')
        words = []
        read_row(words)
        wait_for(lambda: any('the radio bears' in text for text in words), LONG_S,
                 lambda: 'the words of the row, not {}'.format(words))
        print('MEASURED in the row:', words[-1])
        world.operator.hold()
        wait_for(lambda: moves(world), LONG_S, 'it to move', poll_s=0.3)
        world.radio.follow([dict(BAD, down=True)])
        wait_for(lambda: not moves(world), LONG_S, 'it to stand by its lease', poll_s=0.3)
        world.operator.let_go()
        world.at_the_robots('tls')
        world.radio.follow([dict(BAD, down=False)])
        wait_for(lambda: shown.pose_age_s() < 2.0 and world.operator.ready(), LONG_S,
                 'it to be back')
        went_m = path_m(world.at_the_robots('tls')['tls1'][1], 0.0)
        print('MEASURED after the outage it went {:.4f} m'.format(went_m))
        assert went_m < 0.005


def moves(world):
    """Tell whether the robot got anywhere since the last look."""
    from support.behind_radio import path_m
    _, been = world.at_the_robots('tls')['tls1']
    return path_m(been, 0.0) > 0.005


def read_row(words):
    """Append what the row of the robot would say, as it comes."""
    import rospy
    from std_msgs.msg import String
    from mhri.core.link.figures import FIGURES, read_figures, thinned_words
    rospy.Subscriber('/tls1/' + FIGURES, String, lambda message: words.append(
        '; '.join(thinned_words(read_figures(message.data)))))


if __name__ == '__main__':
    inside()

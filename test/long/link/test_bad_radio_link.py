# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot linked by keys behind a radio that loses a fifth of 1 Mbit/s, and then everything."""
import math

from support.ros_system import wait_for

BAD = {'at_s': 0, 'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}
LONG_S, STANDS_M = 120.0, 0.005


def test_pictures_get_small_the_row_says_so_and_nothing_moves_after_an_outage(in_own_network):
    in_own_network(6 * LONG_S)


def inside():
    """Be the operator; end with an AssertionError where something is not so."""
    from support.behind_radio import World
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
        wait_for(lambda: any('the radio carries' in text for text in words), LONG_S,
                 lambda: 'the words of the row, not {}'.format(words))
        print('MEASURED in the row:', words[-1])
        world.operator.hold()
        wait_for(lambda: went_m(world) > STANDS_M, LONG_S, 'it to move', poll_s=0.3)
        world.radio.follow([dict(BAD, down=True)])
        wait_for(lambda: went_m(world) <= STANDS_M, LONG_S, 'it to stand by its lease', poll_s=0.3)
        world.operator.let_go()
        world.at_the_robots('tls')
        world.radio.follow([dict(BAD, down=False)])
        wait_for(lambda: shown.pose_age_s() < 2.0 and world.operator.ready(), LONG_S,
                 'it to be back')
        moved_m = went_m(world)
        print('MEASURED after the outage it went {:.4f} m'.format(moved_m))
        assert moved_m <= STANDS_M


def went_m(world):
    """Return how far the robot went since the last look, nan where too little was seen of it."""
    from support.behind_radio import path_m
    _, been = world.at_the_robots('tls')['tls1']
    return path_m(been, 0.0) if len(been) > 2 else math.nan


def read_row(words):
    """Append what the row of the robot would say, as it comes."""
    import rospy
    from std_msgs.msg import String
    from mhri.robots.figures import FIGURES, read_figures, thinned_words
    rospy.Subscriber('/tls1/' + FIGURES, String, lambda message: words.append(
        '; '.join(thinned_words(read_figures(message.data)))))


if __name__ == '__main__':
    inside()

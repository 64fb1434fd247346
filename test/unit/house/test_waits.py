# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tests' own ways to wait: what they say as they give up, and what they do not hide."""
import pytest

from support.ros_system import insist, NotYet, wait_for


class Robot:
    """Has a speed, and another robot behind it."""

    def __init__(self, speed, behind=None):
        self.speed, self.behind = speed, behind


def test_a_wait_that_gives_up_says_what_there_is():
    robot, others = Robot(0.5, Robot(0.25)), ['bot2']
    for condition, said in (
            (lambda: robot.behind.speed > 1.0, 'robot.behind.speed=0.25'),
            (lambda: next(name for name in others if name == 'bot1'), "others=['bot2']")):
        with pytest.raises(NotYet) as gave_up:
            wait_for(condition, 0.01, lambda: 'bot1')
        assert 'bot1' in str(gave_up.value) and said in str(gave_up.value)
    robot.behind = robot
    with pytest.raises(NotYet):
        wait_for(lambda: robot.behind.behind.speed > 1.0, 0.01)


def attempts(*ends):
    """Return an attempt that ends like this, one after the other."""
    left = list(ends)

    def attempt():
        end = left.pop(0)
        if isinstance(end, Exception):
            raise end
        return end
    return attempt


@pytest.mark.parametrize('ends, said', [
    (['done'], ''), ([None, 'done'], 'INSISTED 2 times: the drive\n'),
    ([None, NotYet('it is\nlate'), 'done'], 'INSISTED 3 times: the drive; before: it is late\n')],
    ids=['at once', 'again', 'late'])
def test_how_often_something_was_done_is_printed(capsys, ends, said):
    assert insist(attempts(*ends), 'the drive') == 'done'
    assert capsys.readouterr().out == said


def test_what_is_wrong_is_not_done_again():
    with pytest.raises(AssertionError, match='moved'):
        insist(attempts(AssertionError('it moved'), 'done'), 'the drive')
    with pytest.raises(NotYet, match='the drive; before: late'):
        insist(attempts(NotYet('late')), 'the drive', -1.0)

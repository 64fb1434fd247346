# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The accessories that a robot uses on its way."""
import pytest

from mhri.base.accessories import Accessory, HOLD, KEEP, TOGGLE
from mhri.tasks.acts import MAX_ACTS, read_acts
from mhri.tasks.base import Act, Body, DONE, Senses, Start
from mhri.base.geometry import Pose
from mhri.base.robot_types import Limits
from mhri.tasks.rows import BY_KEY

OWN = (Accessory('lamp', key='lamp', kind=TOGGLE, choices=(('on', ()), ('off', ())), on_stop=KEEP),
       Accessory('horn', key='horn', choices=(('', ()),)),
       Accessory('flipper', key='flipper', kind=HOLD))
ON, OFF, HORN = Act('lamp', 'on'), Act('lamp', 'off'), Act('horn')

READ = {'': {}, ' ': {}, 'lamp on': {0: (ON,), 1: (ON,), 2: (ON,)},
        '2 lamp on, 3 lamp off,3 horn': {1: (ON,), 2: (OFF, HORN)},
        'horn, 1 lamp on': {0: (HORN, ON), 1: (HORN,), 2: (HORN,)}}


@pytest.mark.parametrize('text', READ)
def test_read(text):
    assert read_acts(text, 3, OWN) == READ[text]


WRONG = {'lamp': 'no choice', 'lamp up': 'on, off', 'horn on': 'no choice', 'flipper': 'from -1',
         'gripper open': 'gripper', '4 lamp on': '1 to 3', '0 lamp on': '1 to 3', '2': 'expected',
         'lamp on now please': 'expected', ',': 'expected', 'lamp on,': 'expected',
         ', '.join(['horn'] * (MAX_ACTS + 1)): 'at most'}


@pytest.mark.parametrize('text', WRONG)
def test_what_is_wrong_is_named(text):
    with pytest.raises(ValueError, match='act: .*' + WRONG[text]):
        read_acts(text, 3, OWN)


@pytest.mark.parametrize('task, parameters, expected', [
    ('goto', '{x: 1, y: 0, frame: odom, act: lamp on}', [(ON,)]),
    ('patrol', '{route: [[1, 0], [0, 0]], rounds: 2, frame: odom, act: "1 lamp on, 2 lamp off"}',
     [(ON,), (OFF,)] * 2)])
def test_a_robot_uses_them_once_at_each_arrival(task, parameters, expected):
    kind, pose, found, step = BY_KEY[task], Pose(0.0, 0.0, 0.0), [], None
    made = kind.make(kind.read(parameters), Start('bot1', ('bot1',), Body(0.2, Limits(0.5, 1.0)),
                                                  accessories=OWN))
    for number in range(4 if task == 'patrol' else 1):
        pose = Pose(1.0 - number % 2, 0.0, 0.0)
        step = made.step(Senses(float(number), pose, pose))
        found.append(step.acts)
    assert found == expected and step.state == DONE

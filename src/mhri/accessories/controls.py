# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The controls of accessories, the same ones in the tile, in a menu and on the second page of keys.

Axes count as in ROS: the first value of two is + to the left, the second one + upwards, as is the
only one of an axis.
"""
import math
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from mhri.base.accessories import (
    Accessory, AXIS, AXIS2, CHOICE, HEAD, HELD, HOLD, LOOKED_AT, OFF, ON, POSITION, READOUT,
    TAP, TOGGLE)
from mhri.base.reasons import (
    DRIVE_SILENT, NEUTRAL, NO_CONNECTION, NOT_OURS, NOT_REACHED, NOT_SELECTED, Reason)
from mhri.base.views import AccessoryView, RobotView, ROS_CONNECTED, ScreenView
from mhri.driving.robot_rule import CLOSED

UNKNOWN = '?'
# Reasons whose words are about driving.
_WHY = {NEUTRAL: 'let go of it first', NOT_SELECTED: 'the robot is not selected',
        CLOSED: 'the drive service does not have it yet'}
_MINUS = '\u2212'
# The least value of a head that is held.
_LEAST = 1e-3


class Control(NamedTuple):
    """A button, a menu or a pad of an accessory.

    :param kind: PRESS, SWITCH, MENU, HELD_DOWN or PAD
    :param spec: :class:`mhri.base.accessories.Accessory`
    :param label: words for it, without its state
    :param choice: what it asks for when pressed
    :param value: what is held while it is pressed, from -1 to 1
    """

    kind: str
    spec: Accessory
    label: str
    choice: str = ''
    value: Tuple[float, ...] = ()


#: once; on or off; one of several; while it is pressed; proportional
PRESS, SWITCH, MENU, HELD_DOWN, PAD = 'press', 'switch', 'menu', 'held_down', 'pad'


def controls_of(spec: Accessory) -> Tuple[Control, ...]:
    """Return the controls of an accessory, none for a sensor.

    A switch that does not report its state has two buttons, as nobody knows what is next.
    """
    if spec.kind == READOUT:
        return ()
    if spec.kind == TAP or spec.kind == TOGGLE and spec.state is None:
        return tuple(Control(PRESS, spec, _joined(spec.label, choice), choice)
                     for choice, _ in spec.choices)
    if spec.kind == HOLD:
        (low, high), (rest,) = spec.ranges[0], spec.neutral
        ways = [way for way, there in ((-1.0, low < rest), (1.0, rest < high)) if there]
        return tuple(Control(HELD_DOWN, spec, spec.label if len(ways) == 1 else _joined(
            spec.label, '+' if way > 0.0 else _MINUS), value=(way,)) for way in ways)
    kind = {TOGGLE: SWITCH, CHOICE: MENU, AXIS: PAD, AXIS2: PAD}[spec.kind]
    return (Control(kind, spec, spec.label),)


def _joined(label: str, word: str) -> str:
    return ' '.join(filter(None, (label, word.replace('_', ' '))))


def reported(view: AccessoryView) -> str:
    """Return the reported choice as a word, :data:`UNKNOWN` before any report."""
    return view.choice.replace('_', ' ') if view.known and view.choice else UNKNOWN


def next_choice(view: AccessoryView) -> Optional[str]:
    """Return the choice after the reported one, in a circle; None while that is unknown."""
    choices = [choice for choice, _ in view.spec.choices]
    if not view.known or view.choice not in choices:
        return None
    if view.spec.kind == TOGGLE:
        return OFF if view.choice == ON else ON
    return choices[(choices.index(view.choice) + 1) % len(choices)]


def readout_text(view: AccessoryView) -> str:
    """Return the label of a sensor with its value and unit, a dash while that is unknown."""
    return '{} {}'.format(view.spec.label, view.spec.reading(
        view.value[0] if view.value and not view.stands else math.nan))


def widest_readout(spec: Accessory) -> str:
    """Return the longest text of a sensor that is usual."""
    return '{} {}'.format(spec.label, spec.reading(
        float(2 ** len(spec.bits) - 1) if spec.bits else -888.8))


def warns(view: AccessoryView) -> bool:
    """Return whether a sensor reports a value beyond its limits."""
    return bool(view.value and not view.stands and view.spec.warns(view.value[0]))


def why_not(screen: ScreenView, robot: RobotView, view: AccessoryView) -> str:
    """Return why an accessory does not obey this screen, as words; '' if it does."""
    code = view.stands
    if screen.ros != ROS_CONNECTED:
        code = NO_CONNECTION
    elif not screen.control.ours:
        return Reason(NOT_OURS, (screen.control.who,)).sentence
    elif not screen.answers:
        code = DRIVE_SILENT
    elif robot.sent is None:
        # The drive does not have the robot.
        code = NOT_REACHED
    return _WHY.get(code) or (Reason(code).sentence if code else '')


def refusal(robots: Sequence[RobotView], key: str, choice: str,
            screen: ScreenView) -> str:
    """Return why a request for an accessory cannot be carried out, '' if it can.

    :param robots: those that are named; none: those that are selected
    """
    named = robots or [robot for robot in screen.robots if robot.selected]
    if not named:
        return 'name a robot, or select one'
    views = [(robot, view) for robot in named for view in (found(robot, key),) if view]
    missing = [robot.name for robot in robots if found(robot, key) is None]
    if missing or not views:
        return '{} has no accessory {!r}'.format(
            ', '.join(missing) or 'no selected robot', key)
    if not views[0][1].spec.team and (len(views) > 1 or not robots):
        return '{} acts on one robot at a time: name it'.format(key)
    for robot, view in views:
        problem = 'what is held cannot be used by a request' if view.spec.kind in HELD \
            else view.spec.problem(choice, ()) or why_not(screen, robot, view)
        if problem:
            return '{}: {}: {}'.format(robot.name, key, problem)
    return ''


def meant(screen: ScreenView, key: str, looked_at: str) -> List[str]:
    """Return the robot that a request without names means; none: all that are selected.

    It is the only selected one that has it, or the one looked at, where its row says so.

    :param looked_at: name of the robot in the large tile, '' for none
    """
    own = {robot.name: view for robot in screen.robots for view in (found(robot, key),) if view}
    if looked_at in own and own[looked_at].spec.of == LOOKED_AT:
        return [looked_at]
    selected = [robot.name for robot in screen.robots if robot.selected and robot.name in own]
    return selected if len(selected) == 1 and not own[selected[0]].spec.team else []


def found(robot: RobotView, key: str) -> Optional[AccessoryView]:
    """Return an accessory of a robot, None if it has none of that name."""
    return next((view for view in robot.accessories if view.spec.key == key), None)


def use_words(spec: Accessory, choice: str = '') -> str:
    """Describe an action: "gripper open", "flipper held"."""
    return _joined(spec.label, choice) if spec.kind not in HELD else spec.label + ' held'


def shares(spec: Accessory, value: Sequence[float]) -> Tuple[float, ...]:
    """Return values of an accessory's own units as fractions in [-1, 1] of its range."""
    found_shares = []
    for one, rest, (low, high) in zip(value, spec.neutral, spec.ranges):
        room = high - rest if one > rest else rest - low
        found_shares.append(min(1.0, max(-1.0, (one - rest) / room)) if room else 0.0)
    return tuple(found_shares)


def looks_words(views: Iterable[AccessoryView]) -> str:
    """Return where a robot's head looks: "head 40 % left, 10 % up"; '' if it has not said."""
    view = head_of(views)
    if view is None or not view.known or len(view.value) != HELD[AXIS2]:
        return ''
    left, up = (round(100.0 * share) for share in shares(view.spec, view.value))
    words = [template.format(abs(part)) for part, template in (
        (left, '{} % left' if left > 0 else '{} % right'),
        (up, '{} % up' if up > 0 else '{} % down')) if part]
    return '{} {}'.format(view.spec.label, ', '.join(words) or 'straight ahead')


def drag_share(view: AccessoryView, left: float, up: float) -> Tuple[float, float]:
    """Return the values of a head that is dragged in its picture, from -1 to 1.

    A position goes on from the one reported when the drag began; of a rate, half the way to the
    edge is all of it. It is never all zeros, which would release it.

    :param left: way of the pointer, in halves of the picture, like ``up``
    """
    if view.spec.mode == POSITION:
        begin = shares(view.spec, view.value)
    else:
        begin, left, up = (0.0, 0.0), 2.0 * left, 2.0 * up
    return _held(tuple(min(1.0, max(-1.0, at + part)) for at, part in zip(begin, (left, up))))


def aim_share(view: AccessoryView, left: float, up: float) -> Tuple[float, float]:
    """Return the values of a head with positions that looks in a direction, from -1 to 1.

    A direction beyond its range is its end. It is never all zeros, which would release it.

    :param left: in the units of its range, like ``up``
    """
    return _held(shares(view.spec, (left, up)))


def _held(value: Sequence[float]) -> Tuple[float, float]:
    return (value[0], value[1]) if any(value) else (0.0, _LEAST)


def head_of(views: Iterable[AccessoryView]) -> Optional[AccessoryView]:
    """Return what turns a robot's camera: its head, else its first pair of axes, or None."""
    pairs = [view for view in views if view.spec.kind == AXIS2]
    return next((view for view in pairs if view.spec.key == HEAD), pairs[0] if pairs else None)


#: the arrows of the second page: {key: (left +, up +)}
ARROWS = {'Up': (0.0, 1.0), 'Down': (0.0, -1.0), 'Left': (1.0, 0.0), 'Right': (-1.0, 0.0)}
_DIGITS = '1234567890'


def key_page(views: Sequence[AccessoryView]) -> Dict[str, Control]:
    """Return the second page of keys of a robot: {key: its control}, in their order.

    The arrows are those of its head, else of its first axis; every other control has a digit, as
    long as there are any.
    """
    by_arrows = head_of(views) or next((view for view in views if view.spec.kind == AXIS), None)
    rest: List[Control] = []
    for view in views:
        for control in controls_of(view.spec):
            if control.kind != PAD:
                rest.append(control)
            elif view is not by_arrows and view.spec.kind == AXIS:
                rest += [Control(HELD_DOWN, view.spec, _joined(view.spec.label, sign), '', (way,))
                         for sign, way in ((_MINUS, -1.0), ('+', 1.0))]
    page = dict(zip(_DIGITS, rest))
    if by_arrows is not None:
        spec = by_arrows.spec
        page.update({key: Control(HELD_DOWN, spec, spec.label, '', value[-HELD[spec.kind]:])
                     for key, value in ARROWS.items()
                     if spec.kind == AXIS2 or value[1]})
    return page


def page_rows(robot: str, page: Dict[str, Control]) -> List[Tuple[str, str]]:
    """Return (keys, what they do) of a page, for the list of keys."""
    rows = []
    for key, control in page.items():
        words = {SWITCH: '{}: on or off', MENU: '{}: the next one', PRESS: '{}',
                 HELD_DOWN: '{}, while it is held'}[control.kind].format(control.label)
        if key not in ARROWS:
            rows.append(('Alt+' + key, '{}: {}'.format(robot, words)))
        elif key == 'Up':
            rows.append(('Alt+arrows', '{}: {}'.format(robot, words)))
    return rows

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the view of a robot from all information about it."""
from dataclasses import replace
from typing import Any, Mapping, Optional, Sequence, Tuple

from mhri.base import reasons
from mhri.base.brake_view import back_words, brake_words, BrakeView
from mhri.base.limits import Velocity
from mhri.base.reasons import also_words, Reason
from mhri.base.views import AccessoryView, LIVE, PROOF_STOPPED, ProofView, RobotView
from mhri.robots.owners import shown

_TASK = 'task'
# Values of ``stands`` that the row shows elsewhere, or that matter less than the rest.
_NOT_IN_NOTE = ('', reasons.STOPPED, reasons.HARDWARE_STOP, reasons.POWER_CUT,
                reasons.LIMIT_RAISED)


def robot_view(heard: Mapping[str, Any], driven: Any = None, answers: bool = True,
               control: Any = None, problem: str = '', found: str = '',
               **ours: Any) -> RobotView:
    """Return the :class:`mhri.base.views.RobotView` of a robot.

    :param heard: fields from its own messages; ``note`` is a note on its link, ``slow`` whether
        that is a warning, ``accessories`` an :class:`AccessoryView` for each row of its type
    :param driven: its ``mhri/RobotDrive``; None if the drive does not have the robot
    :param answers: whether the drive answers; otherwise its state is ignored
    :param control: its ``mhri/LinkControl``, None without one
    :param problem: the problem with its parameters, '' for none
    :param found: the topic of its odometry if that is not proven, see
        :class:`mhri.robots.found_streams.FoundStreams`
    :param ours: fields of the screen itself
    """
    fields, live = dict(heard), heard['link'] == LIVE
    if not answers:
        fields.update(note=Reason(reasons.DRIVE_SILENT).what, slow=True)
    elif driven is not None:
        fields.update(_of_drive(driven), accessories=_reported(
            fields.get('accessories', ()), driven.accessories))
        if driven.stands == reasons.HARDWARE_STOP:
            fields['hardware_stop'] = True
        fields['odometry_follows'] &= not found
        warning = _warning(driven, fields.get('proof') is not None, found)
        if live:
            fields['note'] = (warning.sentence if warning else '') or fields.get('note', '') or \
                _calm_note(driven, fields['brake'])
        if driven.stands == reasons.UNREACHABLE:  # heard or not, only the operator can change that
            reason = Reason(driven.stands)
            fields['note'] = '{}: {}'.format(reason.what, problem) if problem else reason.sentence
        fields['slow'] = fields.get('slow', False) or bool(warning) or fields['brake'].holds
        _add_stops(fields, ours.get('selected', False))
    if control is not None and control.linked and live:
        note, ask = shown(control.host, control.may_drive, control.holder, control.asking)
        asked = bool(control.asking and not ask and note)
        fields.update(note=note or fields.get('note', ''), ask=ask, said=control.said,
                      slow=fields.get('slow', False) or asked)
    fields['note'] = fields.get('note', '') or problem
    return RobotView(**fields, **ours)


def _reported(views: Sequence[AccessoryView], states: Any) -> Tuple[AccessoryView, ...]:
    """Return the views with the states that the drive has of them.

    What is optional and has nobody who listens is left out: this robot does not have it.
    """
    by_key = {state.key: state for state in states}
    return tuple(replace(view, known=state.known, choice=state.choice, value=tuple(state.value),
                         stands=state.stands) if state is not None else view
                 for view in views for state in (by_key.get(view.spec.key),)
                 if not (view.spec.optional and state is not None
                         and state.stands == reasons.NO_LISTENER))


def _of_drive(robot: Any) -> Mapping[str, Any]:
    """Return the fields from the drive, as {key: value}."""
    return {
        'driven': _goes(robot) and bool(robot.topic), 'guarded': robot.guarded,
        'obeys': robot.obeys, 'stands': robot.stands, 'power': robot.power,
        'waits': robot.stands == reasons.JOINING,
        'brake': BrakeView(robot.brake, robot.free_way_m, robot.brake_on_robot,
                           robot.back_after_s),
        'stop_latched': robot.stop_confirmed, 'holonomic': robot.holonomic,
        'sent': Velocity(robot.sent.linear.x, robot.sent.angular.z, robot.sent.linear.y),
        'reached': bool(robot.topic), 'also_commanded_by': tuple(robot.also_commanded_by),
        'odometry_follows': robot.odometry_follows}


def _goes(robot: Any) -> bool:
    return any((robot.sent.linear.x, robot.sent.linear.y, robot.sent.angular.z))


def _warning(robot: Any, proved: bool, found: str) -> Optional[Reason]:
    """Return why a robot stands still, or another warning; None if all is well.

    :param proved: whether a proof shows that it is stopped
    """
    if robot.stands not in _NOT_IN_NOTE and not (
            proved and robot.stands == reasons.STOPPED_ALONE) and (
            robot.obeys or robot.stands in reasons.ALWAYS_SAID):
        return Reason(robot.stands)
    if robot.also_commanded_by:
        return Reason(reasons.NOT_ALONE, (also_words(robot.also_commanded_by),))
    if found:
        return Reason(reasons.ODOMETRY_FOUND, (found,))
    if not robot.odometry_follows:
        return Reason(reasons.ODOMETRY_STUCK)
    return Reason(reasons.LIMIT_RAISED) if robot.stands == reasons.LIMIT_RAISED else None


def _calm_note(robot: Any, brake: BrakeView) -> str:
    """Return the note on a robot's activity; a warning about its link takes precedence."""
    if robot.obeys == _TASK:
        return Reason(reasons.ON_TASK).what
    return brake_words(brake) or ('' if _goes(robot) else back_words(brake))


def _add_stops(fields: Any, selected: bool) -> None:
    """Add further reasons why the robot cannot move: to the proof of a stop, else to the note."""
    words = [Reason(reasons.HARDWARE_STOP).what] if fields.get('hardware_stop') else []
    power = reasons.power_reason(fields['power'])
    words += [power.what] if power else []
    proof: Optional[ProofView] = fields.get('proof')
    if proof is not None:
        if fields['stands'] == reasons.STOPPED_ALONE and proof.state == PROOF_STOPPED:
            words.append('deselect and select it to drive it' if selected
                         else 'select it to drive it')
        words = [proof.text, also_words(fields['also_commanded_by']),
                 'held by its guard' if fields['stop_latched'] else ''] + words
        fields['proof'] = replace(proof, text=', '.join(filter(None, words)))
    elif words:
        fields.update(slow=True, note='; '.join(filter(None, words + [fields.get('note', '')])))

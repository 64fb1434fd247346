# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The words of a tile: the state of its robot, and one sentence: why it stands, its troubles."""
from mhri.base import battery, views
from mhri.base.gui import theme, words
from mhri.base.task_words import interrupted_line, task_line

DRIVING = 'DRIVING'
ON_TASK = 'ON TASK'
SELECTED = 'selected'
NOT_SELECTED = 'not selected'
STOPPING = 'STOPPING'
NOT_CONFIRMED = 'NOT CONFIRMED'
STOPPED = 'STOPPED'
# Drive states during a stop, by proof.
_STOPS = {views.PROOF_STOPPED: STOPPED, views.PROOF_NOT_CONFIRMED: NOT_CONFIRMED}
_ATTENTION = theme.WARNING


def drive_state(view, stopped):
    """Return the drive state of a robot: a key of :data:`mhri.screen.gui.tile_header.LOOKS`.

    :param view: :class:`mhri.base.views.RobotView`
    :param stopped: whether STOP ALL is in force
    """
    if stopped:
        return _STOPS.get(view.proof.state, STOPPING) if view.proof else STOPPING
    if view.on_task:
        return ON_TASK
    return DRIVING if view.driven else SELECTED if view.selected else NOT_SELECTED


def trouble_of(view, charge):
    """Return the colour of a tile's edge for the robot's trouble, None without trouble.

    Lost or a flat battery comes first, then silent, a low battery or a bad link.

    :param view: :class:`mhri.base.views.RobotView`
    :param charge: level of the battery, from :mod:`mhri.base.battery`
    """
    if view.link == views.GONE or charge == battery.FLAT:
        return theme.STOP
    attention = view.link == views.SILENT or charge == battery.LOW or view.slow
    return theme.ATTENTION if attention else None


def sentence_of(view, charge, looked_at):
    """Return (text, sign, shorter texts); the text may be '', the sign None.

    :param view: :class:`mhri.base.views.RobotView`
    :param charge: level of its battery, from :mod:`mhri.base.battery`
    :param looked_at: whether the robot is in view, so that key C continues its task
    """
    why = view.why.sentence if view.why else ''
    if view.proof is not None:
        return '; '.join(filter(None, (view.proof.text, why))), \
            theme.PROOF_SIGNS[view.proof.state], words.proof_shorter(view.proof)
    if why:
        return why, _ATTENTION, ()
    troubles, sign, shorter = _troubles(view, charge)
    task = (task_line(view.task),) if view.task else ()
    if troubles:
        return '; '.join((*troubles, *task)), sign, shorter
    if task:
        return task[0], theme.TASK_WAITS if view.task.waits else theme.ON_TASK, ()
    if view.carry_on and not view.note:
        return interrupted_line(view.carry_on, 'C' if looked_at else ''), None, ()
    return view.note, None, ()


def _troubles(view, charge):
    """Return troubles of link and battery, the worst first, their sign, and short texts."""
    if view.link != views.LIVE:
        return [view.note] if view.note else [], theme.LINK_SIGNS[view.link], (
            words.LINK_WORDS[view.link],)
    found, sign, shorter = [], _ATTENTION, ()
    if view.note and view.slow:
        found.append(view.note)
    if charge != battery.FINE and view.battery is not None:
        percent = words.battery_text(view.battery)
        shorter = () if found else (percent,)
        found.append('battery ' + percent)
        if charge == battery.FLAT:
            sign = (theme.TRIANGLE, theme.STOP)
    return found, sign, shorter

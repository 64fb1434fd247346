# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a tile says in one sentence: the proof of a stop, why its robot stands, or what is wrong."""
from mhri.base import battery, views
from mhri.base.gui import theme, words
from mhri.base.task_words import interrupted_line, task_line

_ATTENTION = (theme.TRIANGLE, theme.ATTENTION)


def sentence_of(view, charge, looked_at):
    """Return (text, sign, shorter ones): '' and None where there is nothing to say, or no sign.

    :param view: :class:`mhri.base.views.RobotView`
    :param charge: level of its battery, of :mod:`mhri.base.battery`
    :param looked_at: whether this is the robot that C has continue its task
    """
    if view.proof is not None:
        return '; '.join(filter(None, (view.proof.text, view.why))), \
            theme.PROOF_SIGNS[view.proof.state], words.proof_shorter(view.proof)
    if view.why:
        return view.why, _ATTENTION, ()
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
    """Return what is wrong with link or battery, the worst first, its sign, and it in a word."""
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

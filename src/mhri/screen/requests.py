# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a pad button, a voice or a lab's node may ask the panel for (``mhri/PanelRequest``)."""
from typing import Collection, Sequence, Tuple

SELECT, DESELECT, ONLY = 'select', 'deselect', 'only'
SELECT_ALL, SELECT_NONE = 'select_all', 'select_none'
NEXT, PREVIOUS = 'next', 'previous'
RECORD, STOP_RECORDING, MARK = 'record', 'stop_recording', 'mark'
SELECTING = (SELECT, DESELECT, ONLY, SELECT_ALL, SELECT_NONE, NEXT, PREVIOUS)
ACTIONS = SELECTING + (RECORD, STOP_RECORDING, MARK)


class RequestRefused(ValueError):
    """A request that the panel refuses; the text tells the operator why."""


def check_request(action: str, names: Sequence[str], robots: Sequence[str]) -> None:
    """Refuse a request that cannot be carried out.

    :param names: the robots it names
    :param robots: those in the panel's list
    :raises RequestRefused: no such action, no such robot, or none named where one must be
    """
    if action not in ACTIONS:
        raise RequestRefused('nobody knows how to {!r}; a request is one of {}'.format(
            action, ', '.join(ACTIONS)))
    strangers = [name for name in names if name not in robots]
    if strangers:
        raise RequestRefused('{} is not in the list: add it first'.format(', '.join(strangers)))
    if action in (SELECT, DESELECT, ONLY) and not names:
        raise RequestRefused('{} needs the name of a robot'.format(action))


def selection_after(action: str, names: Sequence[str], robots: Sequence[str],
                    selected: Collection[str]) -> Tuple[str, ...]:
    """Return the robots that are selected after a request, in the order of the list.

    ``next`` and ``previous`` wrap around and select one robot alone: the one after the last
    selected robot, or before the first.

    :param action: one of :data:`SELECTING`
    :param robots: the list
    :param selected: those selected now
    :raises RequestRefused: see :func:`check_request`
    """
    check_request(action, names, robots)
    places = [place for place, name in enumerate(robots) if name in selected]
    if action in (NEXT, PREVIOUS):
        if not robots:
            raise RequestRefused('there is no robot in the list')
        step = places[-1] + 1 if places else 0
        back = places[0] - 1 if places else -1
        return (robots[(step if action == NEXT else back) % len(robots)],)
    wanted = {SELECT: set(selected) | set(names), DESELECT: set(selected) - set(names),
              ONLY: set(names), SELECT_ALL: set(robots), SELECT_NONE: set()}[action]
    return tuple(name for name in robots if name in wanted)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel from pad buttons, voice or a lab's own node (``mhri/PanelRequest``)."""
from typing import Collection, Sequence, Tuple

SELECT, DESELECT, ONLY = 'select', 'deselect', 'only'
SELECT_ALL, SELECT_NONE = 'select_all', 'select_none'
NEXT, PREVIOUS = 'next', 'previous'
RECORD, STOP_RECORDING, MARK = 'record', 'stop_recording', 'mark'
ACCESSORY = 'accessory'
SELECTING = (SELECT, DESELECT, ONLY, SELECT_ALL, SELECT_NONE, NEXT, PREVIOUS)
ACTIONS = SELECTING + (RECORD, STOP_RECORDING, MARK, ACCESSORY)


class RequestRefused(ValueError):
    """The panel refuses a request; the text gives the operator the reason."""


def check_request(action: str, names: Sequence[str], robots: Sequence[str]) -> None:
    """Validate a request.

    :param names: robots named by the request
    :param robots: robots in the panel's list
    :raises RequestRefused: the action or a robot is unknown, or a required name is missing
    """
    if action not in ACTIONS:
        raise RequestRefused('unknown request {!r}; expected one of {}'.format(
            action, ', '.join(ACTIONS)))
    strangers = [name for name in names if name not in robots]
    if strangers:
        raise RequestRefused('{} is not in the list: add it first'.format(', '.join(strangers)))
    if action in (SELECT, DESELECT, ONLY) and not names:
        raise RequestRefused('{} needs the name of a robot'.format(action))


def selection_after(action: str, names: Sequence[str], robots: Sequence[str],
                    selected: Collection[str]) -> Tuple[str, ...]:
    """Return the robots selected after a request, in list order.

    ``next`` and ``previous`` wrap around and select a single robot: the one after the last
    selected robot, or the one before the first.

    :param action: one of :data:`SELECTING`
    :param robots: the list
    :param selected: robots selected before
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

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The calibration of a pad on the screen: the order of its steps, and the page at each.

No robot drives meanwhile: it starts once STOP ALL is confirmed, and ends if that is released.

state     pad comes  pad goes  stop confirmed  stop given up  confirm()         again()
ABSENT    READY      -         -               -              -                 -
READY     -          ABSENT    -               -              ASKING, STOPPING  -
STOPPING  -          ABSENT    ASKING          -              -                 READY
ASKING    -          ABSENT    -               READY          the next step     ASKING
DONE      -          -         -               -              SAVING            READY
SAVING    -          -         -               -              -                 -
SAVED     -          READY     -               -              -                 READY

An event without an entry changes nothing. The result of saving is reported by
:meth:`CalibrationPage.saved` or :meth:`CalibrationPage.refused`.
"""
from dataclasses import dataclass
from typing import Collection, Mapping, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.devices.calibration import (
    Calibration, DONE as LAST_STEP, FORWARD, LEFT, profile_name, REST, STEPS)

ABSENT, READY, STOPPING, ASKING = 'absent', 'ready', 'stopping', 'asking'
DONE, SAVING, SAVED = 'done', 'saving', 'saved'
STATES = (ABSENT, READY, STOPPING, ASKING, DONE, SAVING, SAVED)
_LOOKING = 'looking for a pad'
_MEANINGS = {FORWARD: 'forward', LEFT: 'turn', 'dead_man': 'dead-man', 'turbo': 'full speed',
             'stop_all': 'stop all', 'next_robot': 'next robot',
             'previous_robot': 'previous robot', 'select_all': 'all robots'}


@dataclass(frozen=True)
class CalibrationView:
    """The content of the page.

    ``pad`` is the name of the pad, '' without one. ``axes`` are in [-1, 1], None for an axis that
    has not reported yet; ``buttons`` are 0 or 1. ``axis_words`` and ``button_words`` are (index,
    meaning) of the axes and buttons assigned so far. ``prompt`` is the next step, ``problem`` the
    last error or ''. ``action`` is the text of the large button, '' to disable it; ``step`` and
    ``steps`` count the questions, 0 before the first. ``can_restart``: whether there is a
    calibration to restart.
    """

    pad: str = ''
    axes: Tuple[Optional[float], ...] = ()
    buttons: Tuple[int, ...] = ()
    axis_words: Tuple[Tuple[int, str], ...] = ()
    button_words: Tuple[Tuple[int, str], ...] = ()
    prompt: str = ''
    problem: str = ''
    action: str = ''
    step: int = 0
    steps: int = len(STEPS) - 1
    can_restart: bool = False


class CalibrationPage:
    """The page of one pad at a time; see the table above.

    :param taken: names not allowed for a profile, since shipped profiles have them
    """

    def __init__(self, taken: Collection[str] = ()) -> None:
        self._taken = taken
        self.state = ABSENT
        self._pad = ('', '')
        self._axes: Tuple[Optional[float], ...] = ()
        self._buttons: Tuple[int, ...] = ()
        self._calibration: Optional[Calibration] = None
        self._stopped = False
        self._problem = _LOOKING
        self._replace = False
        self._result = ''

    @property
    def name(self) -> str:
        """The name of the profile to be saved."""
        return profile_name(self._pad[0], self._taken)

    @property
    def pad(self) -> Tuple[str, str]:
        """(name, GUID) of the pad."""
        return self._pad

    @property
    def replaces(self) -> bool:
        """Whether saving may replace a file: the operator has been asked."""
        return self._replace

    def text(self) -> str:
        """Return the profile as YAML, while it is being saved."""
        assert self._calibration is not None
        return self._calibration.text()

    def on_line(self, line: Mapping[str, object]) -> None:
        """Handle a line from the process of :mod:`mhri.devices.io.pad_stream`."""
        if line.get('kind') == 'pad':
            self._appear(tidy_text(str(line.get('name', ''))), str(line.get('guid', '')))
        elif line.get('kind') == 'absent':
            self._vanish(tidy_text(str(line.get('reason', ''))))
        elif line.get('kind') == 'state':
            self._feed(line.get('axes'), line.get('buttons'))

    def _appear(self, name: str, guid: str) -> None:
        if self.state in (ABSENT, SAVED):
            self._pad = (name, guid)
            self._begin(READY)

    def _vanish(self, reason: str) -> None:
        self._axes, self._buttons = (), ()
        if self.state in (ABSENT, READY, STOPPING, ASKING):
            self._begin(ABSENT, reason)

    def _feed(self, axes: object, buttons: object) -> None:
        if not isinstance(axes, list) or not isinstance(buttons, list) or self.state == ABSENT:
            return
        self._axes, self._buttons = tuple(axes), tuple(buttons)
        if self.state == ASKING and self._calibration is not None:
            self._calibration.feed(self._axes, self._buttons)
            self._settle()

    def on_stop(self, confirmed: bool) -> None:
        """Handle whether STOP ALL is confirmed."""
        self._stopped = confirmed
        if confirmed and self.state == STOPPING:
            self._ask()
        elif not confirmed and self.state == ASKING:
            self._begin(READY, 'The robots were released: nothing was saved.')

    def confirm(self) -> None:
        """Handle a press of the large button, or Enter."""
        if self.state == READY:
            if self._stopped:
                self._ask()
            else:
                self._begin(STOPPING)
        elif self.state == ASKING and self._calibration is not None:
            self._calibration.confirm()
            self._settle()
        elif self.state == DONE:
            self.state = SAVING

    def again(self) -> None:
        """Restart the calibration."""
        if self.state == ASKING:
            self._ask()
        elif self.state in (STOPPING, DONE, SAVED):
            self._begin(READY)

    def saved(self, sentence: str) -> None:
        """Handle that the profile was written; the sentence has its path."""
        if self.state == SAVING:
            self.state, self._result, self._problem = SAVED, sentence, ''

    def refused(self, reason: str, exists: bool = False) -> None:
        """Handle that the profile was not written; ``exists``: its file exists already."""
        if self.state == SAVING:
            self.state, self._problem, self._replace = DONE, reason, exists

    def close(self) -> None:
        """Discard the answers, unless they are being saved."""
        if self.state != SAVING:
            self._begin(ABSENT, _LOOKING)

    def _begin(self, state: str, problem: str = '') -> None:
        self.state, self._problem = state, problem
        self._calibration, self._replace = None, False
        if state == ABSENT:
            self._pad = ('', '')

    def _ask(self) -> None:
        self._begin(ASKING)
        self._calibration = Calibration(self.name, *self._pad)
        self._calibration.feed(self._axes, self._buttons)

    def _settle(self) -> None:
        """Continue once the last question has been answered."""
        if self._calibration is not None and self._calibration.step == LAST_STEP:
            self.state = DONE

    def view(self) -> CalibrationView:
        """Return the present view."""
        calibration = self._calibration
        prompt, action = self._words()
        problem = self._problem or (calibration.problem if calibration else '')
        return CalibrationView(
            pad=self._pad[0], axes=self._axes, buttons=self._buttons,
            axis_words=_meanings(calibration.axes if calibration else {}),
            button_words=_meanings(calibration.buttons if calibration else {}),
            prompt=prompt, problem=problem, action=action,
            step=STEPS.index(calibration.step) + 1 if calibration and self.state == ASKING else 0,
            can_restart=self.state in (STOPPING, ASKING, DONE, SAVED))

    def _words(self) -> Tuple[str, str]:
        """Return (prompt, text of the large button)."""
        if self.state == ASKING and self._calibration is not None:
            step = self._calibration.step
            return self._calibration.prompt, \
                'Next' if step == REST else '' if step in (FORWARD, LEFT) else 'None'
        return {
            ABSENT: ('Here you can try a pad out, and calibrate it.', ''),
            READY: ('Try its sticks and buttons: they show below. Calibrating stops all robots.'
                    if not self._stopped else 'All robots are stopped: nothing drives.',
                    'Calibrate' if self._stopped else 'Stop all and calibrate'),
            STOPPING: ('Stopping all robots ...', ''),
            DONE: ('Keep this as the profile "{}"?'.format(self.name),
                   'Replace' if self._replace else 'Save'),
            SAVING: ('Saving ...', ''),
            SAVED: (self._result, '')}[self.state]


def _meanings(indices: Mapping[str, int]) -> Tuple[Tuple[int, str], ...]:
    """Return (index, meaning) from {step: index}, in the order of the indices."""
    return tuple(sorted((index, _MEANINGS[step]) for step, index in indices.items()))

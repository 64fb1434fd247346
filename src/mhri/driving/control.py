# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is in control, as one screen sees it: one operator at a time."""
from typing import Optional

# A screen claims control only after nobody has had it for this long: the screen that had it repeats
# its selection every 0.5 s, and should get it back from gates that remember nothing.
VACANT_S = 2.0


class Claim:
    """Whether a screen may speak for the operator; times are seconds of a monotonic clock.

    States::

        DRIVES  -> WATCHES  the gates name somebody else, or nobody but refuse this one
        WATCHES -> DRIVES   the gates name this one, or nobody for VACANT_S

    A screen begins by claiming; the gates decide. Nothing changes while they are not heard. One
    that they refuse while nobody is in control claims nothing more: its operator takes control.

    :param name: the node of this screen, as the gates call it
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._vacant_since: Optional[float] = None
        self._refused = False
        self.drives = True

    def hear(self, operator: str, now: float, refused: bool = False) -> None:
        """Take in whom the gates call the operator ('' for nobody), and if they refuse this one."""
        self._refused = not operator and (self._refused or refused)
        if operator or self._refused:
            self.drives = operator == self._name
        if operator or self.drives or self._refused:
            self._vacant_since = None
        elif self._vacant_since is None:
            self._vacant_since = now
        elif now - self._vacant_since >= VACANT_S:
            self.drives = True
            self._vacant_since = None


def operator_name(node: str) -> str:
    """Return the everyday name of a node in control: "panel", "panel in rqt", or its own name."""
    name = node.strip('/')
    if name.startswith('rqt'):
        return 'panel in rqt'
    return 'panel' if name.startswith('mhri_panel') else name


def who_drives(node: str, computer: str = '', since: str = '') -> str:
    """Return who is in control in words, e.g. "panel on lab-pc2 since 14:02".

    :param node: its name
    :param computer: the one it runs on, '' if unknown
    :param since: local time as text, '' if unknown
    """
    return operator_name(node) + (' on ' + computer if computer else '') + (
        ' since ' + since if since else '')

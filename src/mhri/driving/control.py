# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which screen is in control, from the view of one screen: one operator at a time."""
from typing import Optional

# A screen claims control only after it has been free for this long: the previous screen repeats its
# selection every 0.5 s, and should regain control from a drive that has lost its state.
VACANT_S = 2.0


class ScreenRole:
    """Whether a screen may send the operator's commands; times are seconds of a monotonic clock.

    States::

        DRIVES  -> WATCHES  the drive names another screen, or none but refuses this one
        WATCHES -> DRIVES   the drive names this screen, or none for VACANT_S

    A screen starts by claiming control; the drive decides. Nothing changes while the drive is
    silent. A screen that is refused while nobody is in control stops claiming it: its operator has
    to take control.

    :param name: node name of this screen, as the drive reports it
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._vacant_since: Optional[float] = None
        self._refused = False
        self.drives = True

    def update(self, operator: str, now: float, refused: bool = False) -> None:
        """Handle the operator that the drive reports ('' for none).

        :param refused: whether the drive refuses this screen
        """
        self._refused = not operator and (self._refused or refused)
        if operator or self._refused:
            self.drives = operator == self._name
        if operator or self.drives or self._refused:
            self._vacant_since = None
        elif self._vacant_since is None:
            self._vacant_since = now
        elif now - self._vacant_since >= VACANT_S:
            self.drives = True


def operator_name(node: str) -> str:
    """Return the display name of a node in control: "panel", "panel in rqt", or its own name."""
    name = node.strip('/')
    if name.startswith('rqt'):
        return 'panel in rqt'
    return 'panel' if name.startswith('mhri_panel') else name


def who_drives(node: str, computer: str = '') -> str:
    """Describe the node in control, e.g. "panel on lab-pc2".

    :param node: its name
    :param computer: the computer it runs on, '' if unknown
    """
    return operator_name(node) + (' on ' + computer if computer else '')

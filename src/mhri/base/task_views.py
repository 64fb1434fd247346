# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The available and the running tasks, as plain values for the screen."""
from dataclasses import dataclass
import math
from typing import Optional, Tuple

from mhri.base.config import yaml_value


@dataclass(frozen=True)
class TaskView:
    """The task of one robot.

    ``text`` is its progress, or why it waits, ``left_m`` the remaining distance [m], None if
    unknown.
    """

    label: str
    text: str = ''
    waits: bool = False
    left_m: Optional[float] = None


@dataclass(frozen=True)
class FieldView:
    """A parameter of a task.

    ``default`` is YAML: '' if the parameter is required, 'null' if it is optional. ``least`` and
    ``greatest`` are NaN unless it is a number. ``choices`` are the allowed texts; empty allows any.
    """

    name: str
    unit: str = ''
    text: str = ''
    default: str = ''
    least: float = math.nan
    greatest: float = math.nan
    choices: Tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make equal tasks equal: a NaN of another message equals none."""
        if not self.is_number:
            object.__setattr__(self, 'least', math.nan)
            object.__setattr__(self, 'greatest', math.nan)

    @property
    def is_number(self) -> bool:
        """Whether its value is a number."""
        return not math.isnan(self.least)

    @property
    def default_value(self) -> object:
        """The parsed default, None if there is none or it is unreadable."""
        try:
            return yaml_value(self.default)
        except ValueError:
            return None


def typed_value(text: str) -> object:
    """Parse typed text: a list if it begins with a bracket, else the text; None if empty.

    :raises ValueError: its brackets or commas are malformed
    """
    text = text.strip()
    if not text.startswith('['):
        return text or None
    try:
        return yaml_value(text)
    except ValueError:
        raise ValueError('its brackets do not fit; write e.g. [[1, 0], [1, 2]]') from None


@dataclass(frozen=True)
class KindView:
    """A task that can be started."""

    key: str
    label: str
    text: str = ''
    fields: Tuple[FieldView, ...] = ()


@dataclass(frozen=True)
class Progress:
    """The progress of one robot: ``state`` is one of :mod:`mhri.tasks.base`.

    ``said`` are the lines reported since the start.
    """

    robot: str
    state: str
    text: str = ''
    left_m: Optional[float] = None
    said: Tuple[str, ...] = ()


@dataclass(frozen=True)
class RunView:
    """A running task: id of its goal, its key and parameters (YAML) as given, its robots."""

    id: str
    key: str
    parameters: str = ''
    robots: Tuple[Progress, ...] = ()


@dataclass(frozen=True)
class TasksView:
    """All tasks at one instant; ``problem`` is why no task can be started, '' if one can.

    ``marks`` are the names of the marks on the map.
    """

    problem: str = ''
    kinds: Tuple[KindView, ...] = ()
    runs: Tuple[RunView, ...] = ()
    marks: Tuple[str, ...] = ()

    def label(self, key: str) -> str:
        """Return the label of a task, its key if it is unknown."""
        return next((kind.label for kind in self.kinds if kind.key == key), key or 'task')

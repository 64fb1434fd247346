# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks as the screen shows them, as plain values: what can be started, and what is under way."""
from dataclasses import dataclass
import math
from typing import Optional, Tuple

import yaml


@dataclass(frozen=True)
class TaskView:
    """What one robot does by itself.

    ``text`` says how it is getting on, or why it waits, ``left_m`` the way that is left [m], None
    where that is not known.
    """

    label: str
    text: str = ''
    waits: bool = False
    left_m: Optional[float] = None


@dataclass(frozen=True)
class FieldView:
    """A parameter of a task.

    ``default`` is YAML: '' where it has to be given, 'null' where it may be left out. ``least`` and
    ``greatest`` are NaN of what is no number. ``choices`` are what a text may be, none: anything.
    """

    name: str
    unit: str = ''
    text: str = ''
    default: str = ''
    least: float = math.nan
    greatest: float = math.nan
    choices: Tuple[str, ...] = ()

    @property
    def is_number(self) -> bool:
        """Whether its value is a number."""
        return not math.isnan(self.least)

    @property
    def default_value(self) -> object:
        """What the default says, None for none and where it cannot be read."""
        try:
            return yaml.safe_load(self.default)
        except yaml.YAMLError:
            return None


def typed_value(text: str) -> object:
    """Return what was typed: a list if it begins with a bracket, else the text; None of nothing.

    :raises ValueError: its brackets and commas do not fit
    """
    text = text.strip()
    if not text.startswith('['):
        return text or None
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
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
    """How one robot is getting on: ``state`` is one of :mod:`mhri.tasks.base`.

    ``said`` is what was worth a line since the start.
    """

    robot: str
    state: str
    text: str = ''
    left_m: Optional[float] = None
    said: Tuple[str, ...] = ()


@dataclass(frozen=True)
class RunView:
    """A task under way: id of its goal, key and parameters (YAML) as they were given, robots."""

    id: str
    key: str
    parameters: str = ''
    robots: Tuple[Progress, ...] = ()


@dataclass(frozen=True)
class TasksView:
    """All of it at one instant; ``problem`` says why no task can be started, '' where one can.

    ``marks`` are the names of the marks on the map.
    """

    problem: str = ''
    kinds: Tuple[KindView, ...] = ()
    runs: Tuple[RunView, ...] = ()
    marks: Tuple[str, ...] = ()

    def label(self, key: str) -> str:
        """Return what a task is called; an unknown one by its key."""
        return next((kind.label for kind in self.kinds if kind.key == key), key or 'task')

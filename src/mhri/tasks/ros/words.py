# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of tasks: available kinds, and the progress of each robot."""
import math

from mhri.base.config import yaml_text
from mhri.msg import TaskField, TaskKind, TaskState
from mhri.tasks.base import REQUIRED


def kind_message(kind):
    """Return the ``mhri/TaskKind`` of a row."""
    return TaskKind(key=kind.key, label=kind.label, text=kind.text,
                    fields=[_field_message(field) for field in kind.fields])


def _field_message(field):
    default = '' if field.default == REQUIRED else yaml_text(field.default)
    return TaskField(name=field.name, unit=field.unit, text=field.text, default_value=default,
                     least=field.least, greatest=field.greatest,
                     choices=list(field.choices))


def state_message(run):
    """Return the ``mhri/TaskState`` of a :class:`mhri.tasks.run.RobotRun`."""
    return TaskState(robot=run.robot, state=run.state, text=run.text,
                     left_m=math.nan if run.left_m is None else run.left_m, said=list(run.said))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parses a task typed in a terminal: ``bot1 goto 2.0 1.5``."""
from typing import Dict, List, Mapping, Sequence, Tuple

from mhri.base.config import ConfigError, yaml_text, yaml_value
from mhri.tasks.base import REQUIRED, TaskKind


class TaskWordsError(ValueError):
    """Invalid words; the text names the expected ones."""


def parameters_of(words: Sequence[str], kinds: Mapping[str, TaskKind]
                  ) -> Tuple[List[str], str, Dict[str, object]]:
    """Return (robots, key of the task, its parameters).

    :param words: robots with commas between, the task, and its parameters: in the order of its
        fields, or ``name=value``
    :raises TaskWordsError: they are invalid
    """
    if len(words) < 2:
        raise TaskWordsError('name a robot and a task, e.g. bot1 goto 2.0 1.5')
    kind = kinds.get(words[1])
    if kind is None:
        raise TaskWordsError('no task {}; there are {}'.format(words[1], ', '.join(kinds)))
    names = [row.name for row in kind.fields]
    parameters: Dict[str, object] = {}
    for number, word in enumerate(words[2:]):
        name, equals, value = word.partition('=')
        if not equals:
            if number >= len(names):
                raise TaskWordsError('{}: {} takes no more than {}'.format(
                    word, kind.key, ', '.join(names)))
            name, value = names[number], word
        try:
            parameters[name] = yaml_value(value)
        except ValueError:
            raise TaskWordsError('{}: {} cannot be read'.format(name, value)) from None
    try:
        kind.read(yaml_text(parameters))
    except ConfigError as error:
        raise TaskWordsError(str(error)) from None
    return [name for name in words[0].split(',') if name], kind.key, parameters


def usage(kinds: Sequence[TaskKind]) -> str:
    """Return the help: each task with its parameters, units and defaults."""
    lines = ['usage: mhri_task ROBOT[,ROBOT...] TASK [VALUE | NAME=VALUE]...', '',
             'Ctrl-C ends the task. Robots have to be in the list, and not selected.', '']
    for kind in kinds:
        lines.append('{:<8} {}'.format(kind.key, kind.text))
        for row in kind.fields:
            default = 'required' if row.default == REQUIRED else \
                'may be left out' if row.default is None else 'else {:g}'.format(row.default) \
                if isinstance(row.default, float) else 'else {}'.format(row.default)
            lines.append('    {:<9} {}{}; {}'.format(
                row.name, row.text, ' [{}]'.format(row.unit) if row.unit else '', default))
    return '\n'.join(lines)

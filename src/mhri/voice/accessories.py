# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is said to use the accessories of the present robots: "lamp on", "gripper open", "horn"."""
from typing import Callable, Container, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from mhri.base.accessories import Accessory
from mhri.voice.names import spoken_names


class SpokenRow(NamedTuple):
    """An accessory that a voice may use; see :class:`mhri.base.accessories.Accessory`."""

    key: str
    label: str
    words: Optional[Sequence[str]]
    choices: Sequence[str]


def spoken_rows(accessories: Iterable[Accessory]) -> Tuple[SpokenRow, ...]:
    """Return the rows of those accessories that a voice may use, each once, in their order."""
    return tuple(dict.fromkeys(
        SpokenRow(one.key, one.label, one.words, tuple(choice for choice, _ in one.choices))
        for one in accessories if one.is_spoken))


def call_accessories(rows: Iterable[SpokenRow], knows: Callable[[str], bool],
                     taken: Container[str]) -> Tuple[Dict[str, Tuple[str, str]], List[str]]:
    """Return what is said for each choice of accessories: the words or the label, and the choice.

    :param knows: function that returns whether the dictionary has a word
    :param taken: words with another meaning
    :returns: ({phrase: (key, choice)}, [sentence about a phrase that is left out])
    """
    called: Dict[str, Tuple[str, str]] = {}
    notes: List[str] = []
    for row in rows:
        for choice in row.choices:
            endings = spoken_names(choice, knows) if choice else ('',)
            written = [' '.join((name, choice.replace('_', ' '))).strip()
                       for name in row.words or (row.label,)]
            phrases = [' '.join((name, ending)).strip() for name in
                       row.words or spoken_names(row.label, knows) for ending in endings]
            for phrase in phrases or written[:1]:
                problem = _problem(phrase, bool(phrases), knows, taken)
                if not problem and called.setdefault(phrase, (row.key, choice)) != (
                        row.key, choice):
                    problem = 'means {} already'.format(called[phrase][0])
                if problem:
                    notes.append('accessory {}: "{}" {}'.format(row.key, phrase, problem))
    return called, notes


def _problem(phrase: str, spoken: bool, knows: Callable[[str], bool],
             taken: Container[str]) -> str:
    """Return why a phrase cannot be said, '' if it can."""
    clash = [word for word in phrase.split() if word in taken]
    if clash:
        return 'has the word "{}", which means something else'.format(clash[0])
    unknown = [word for word in phrase.split() if not knows(word)]
    if unknown or not spoken:
        return ('has the word "{}", which is not in the dictionary: give its sounds below '
                'pronunciations of the language, or other words in the robot type'.format(
                    (unknown or [phrase])[0]))
    return ''

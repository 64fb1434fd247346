# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen kept from its last run, checked: anybody may have edited it.

A state is a dict of JSON values: ``robots`` (names), ``numbers`` ({robot: its own number}),
``mode`` (a source), ``windows`` ({robot: geometry}: where its tile was when it was torn off),
``torn_off`` (robots), ``looks`` ({robot: what its tile shows}), ``panel`` (``splitter``,
``drawer``, ``geometry``, ``layout``, ``theme``, ``numbers``), ``events`` (``sounds``) and ``map``
(``shown``, ``follow``, ``turn``, ``by_link``). A geometry is [x, y, width, height, maximised] in
pixels: a text that can be read, and no blob that Qt would have to trust.
"""
from typing import Any, Callable, Dict, List, NoReturn, Optional, Tuple

from mhri.base.names import name_problem
from mhri.base.numbers import MOST_NUMBERS
from mhri.base.text import tidy_text

MOST_ROBOTS = 200
# No screen is wider, and Qt's and X's coordinates end at 32767.
_MOST_PX = 30_000
_MOST_PARTS = 10
_LONGEST_WORD = 100
_DEEPEST = 6
_MOST_VALUES = 500

State = Dict[str, Any]
_Reader = Callable[[Any], Any]
# ... that reports problems within: value, list of problems, its key.
_PartReader = Callable[[Any, List[str], str], Any]


def _refuse(expected: str) -> NoReturn:
    """Refuse a value.

    :raises ValueError: always
    """
    raise ValueError('expected ' + expected)


def is_word(value: Any) -> bool:
    """Tell whether a value is a short printable text."""
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_WORD and value.isprintable()


def _is_whole(value: Any, least: int, most: int) -> bool:
    """Tell whether a value is a whole number in a range; true and false are not."""
    return type(value) is int and least <= value <= most


def _read_robots(value: Any) -> List[str]:
    names = value if isinstance(value, list) else []
    if names != value or len(names) > MOST_ROBOTS or not all(map(_is_robot, names)):
        _refuse('a list of at most {} names of robots'.format(MOST_ROBOTS))
    return names


def _is_robot(name: Any) -> bool:
    return isinstance(name, str) and name_problem(name) is None


def _read_numbers(value: Any) -> Dict[str, int]:
    """Return {name: number}; refuse two robots with one number, since a key means one robot."""
    if not (isinstance(value, dict) and len(value) <= MOST_NUMBERS
            and all(map(_is_robot, value))
            and all(_is_whole(number, 1, MOST_NUMBERS) for number in value.values())
            and len(set(value.values())) == len(value)):
        _refuse('a number of its own, from 1 to {}, for each robot'.format(MOST_NUMBERS))
    return dict(value)


def _read_mode(value: Any) -> Optional[str]:
    if value is not None and not is_word(value):
        _refuse('the name of a source')
    return value or None


def _read_flag(value: Any) -> bool:
    if not isinstance(value, bool):
        _refuse('true or false')
    return value


def read_geometry(value: Any) -> List[Any]:
    """Return a geometry: [x, y, width, height, maximised], pixels.

    :raises ValueError: it is none
    """
    if not (isinstance(value, list) and len(value) == 5 and isinstance(value[4], bool)
            and all(_is_whole(part, -_MOST_PX, _MOST_PX) for part in value[:2])
            and all(_is_whole(part, 1, _MOST_PX) for part in value[2:4])):
        _refuse('x, y, width, height [px] and whether it is maximised')
    return list(value)


def read_sizes(value: Any) -> List[int]:
    """Return the sizes of the parts of a splitter [px].

    :raises ValueError: they are none
    """
    if not (isinstance(value, list) and len(value) <= _MOST_PARTS
            and all(_is_whole(part, 0, _MOST_PX) for part in value)):
        _refuse('the sizes of at most {} parts [px]'.format(_MOST_PARTS))
    return list(value)


def _count_values(value: Any, depth: int = 0) -> int:
    """Return how many values a JSON value contains.

    :raises ValueError: it is too deep, or has a key or text that is too long
    """
    if depth > _DEEPEST:
        _refuse('fewer levels')
    if isinstance(value, str) and len(value) > 10 * _LONGEST_WORD:
        _refuse('shorter texts')
    parts = list(value.values()) if isinstance(value, dict) else \
        value if isinstance(value, list) else []
    return 1 + sum(_count_values(part, depth + 1) for part in parts)


def _read_look(value: Any) -> State:
    """Return how a tile looked; a lab's own class may keep what it likes, within limits."""
    if not isinstance(value, dict) or _count_values(value) > _MOST_VALUES:
        _refuse('a dict of at most {} values'.format(_MOST_VALUES))
    return {**value, **{key: read(value[key]) for key, read in _LOOK.items() if key in value}}


def _read_words(value: Any) -> List[str]:
    if not (isinstance(value, list) and len(value) <= 50 and all(map(is_word, value))):
        _refuse('a list of words')
    return list(value)


def _read_word(value: Any) -> str:
    if not is_word(value):
        _refuse('a word')
    return str(value)


def _read_views(value: Any) -> State:
    """Return {view: {what was chosen in it: word, number or flag}}."""
    if not isinstance(value, dict) or not all(isinstance(kept, dict) for kept in value.values()):
        _refuse('a dict for each view')
    return {view: {key: kept for key, kept in choices.items() if is_word(kept)
                   or isinstance(kept, (bool, int, float)) and abs(kept) <= _MOST_PX}
            for view, choices in value.items()}


def _read_torn(value: Any) -> List[str]:
    if not (isinstance(value, list) and len(value) <= MOST_ROBOTS and all(map(_is_robot, value))):
        _refuse('names of robots')
    return list(value)


def _read_recording(value: Any) -> State:
    if not isinstance(value, dict):
        _refuse('a dict')
    return {'extras': _read_words(value.get('extras', []))}


def _by_robot(read: _Reader) -> _PartReader:
    """Return a reader for a dict of robots that leaves out what it cannot read."""
    def _read(value: Any, problems: List[str], key: str) -> State:
        if not isinstance(value, dict):
            _refuse('a dict of robots')
        found = {}
        for name, part in list(value.items())[:MOST_ROBOTS]:
            try:
                if not _is_robot(name):
                    _refuse('the name of a robot')
                found[name] = read(part)
            except ValueError as error:
                problems.append('{} of {}: {}'.format(key, tidy_text(str(name), 40), error))
        return found
    return _read


def _plain(read: _Reader) -> _PartReader:
    return lambda value, problems, key: read(value)


def _read_panel(value: Any, problems: List[str], key: str) -> State:
    if not isinstance(value, dict):
        _refuse('a dict')
    return _read_parts(value, _PANEL, problems, key + '.')


def _read_map(value: Any, problems: List[str], key: str) -> State:
    if not isinstance(value, dict):
        _refuse('a dict')
    flags = {name: _plain(_read_flag) for name in ('follow', 'turn', 'by_link')}
    return _read_parts(value, {'shown': _plain(_read_word), **flags}, problems, key + '.')


def _read_events(value: Any, problems: List[str], key: str) -> State:
    if not isinstance(value, dict):
        _refuse('a dict')
    return _read_parts(value, {'sounds': _plain(_read_flag)}, problems, key + '.')


_LOOK = {'views': _read_words, 'of_views': _read_views, 'recording': _read_recording,
         'splitter': read_sizes}
_PANEL: Dict[str, _PartReader] = {
    'splitter': _plain(read_sizes), 'drawer': _plain(_read_flag),
    'geometry': _plain(read_geometry), 'layout': _plain(_read_word), 'theme': _plain(_read_word),
    'numbers': _plain(_read_flag)}
_STATE: Dict[str, _PartReader] = {
    'robots': _plain(_read_robots), 'numbers': _plain(_read_numbers), 'mode': _plain(_read_mode),
    'windows': _by_robot(read_geometry), 'torn_off': _plain(_read_torn),
    'looks': _by_robot(_read_look), 'panel': _read_panel, 'events': _read_events,
    'map': _read_map}


def _read_parts(value: State, readers: Dict[str, _PartReader], problems: List[str],
                above: str) -> State:
    """Return what the readers can read of a dict; report why not for the rest."""
    found = {}
    for key, read in readers.items():
        if key in value:
            try:
                found[key] = read(value[key], problems, above + key)
            except ValueError as error:
                problems.append('{}{}: {}'.format(above, key, error))
    return found


def usable_state(state: Any) -> Tuple[State, Tuple[str, ...]]:
    """Return (the usable part of a kept state, why each other part is not).

    :param state: whatever was read
    """
    if not isinstance(state, dict):
        return {}, ('expected a dict',)
    problems: List[str] = []
    return _read_parts(state, _STATE, problems, ''), tuple(problems)

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Validates the saved state of the screen, which a user may have edited.

A state is a dict of JSON values: ``robots`` (names), ``numbers`` ({robot: its own number}),
``mode`` (a source), ``windows`` ({robot: geometry of its torn-off tile}),
``torn_off`` (robots), ``looks`` ({robot: settings of its tile}), ``panel`` (``splitter``,
``drawer``, ``geometry``, ``layout``, ``theme``, ``numbers``), ``events`` (``sounds``) and ``map``
(``shown``, ``follow``, ``turn``, ``by_link``). A geometry is [x, y, width, height, maximised] in
pixels, readable text instead of a blob that Qt would have to trust.
"""
from typing import Any, Callable, Dict, List, NoReturn, Optional, Tuple

from mhri.base.names import name_problem
from mhri.base.numbers import MAX_NUMBERS
from mhri.base.text import tidy_text

MAX_ROBOTS = 200
# Wider than any screen; coordinates of Qt and X end at 32767.
_MAX_PX = 30_000
_MAX_PARTS = 10
_LONGEST_WORD = 100
_DEEPEST = 6
_MAX_VALUES = 500

State = Dict[str, Any]
_Reader = Callable[[Any], Any]
# A reader that also reports problems: (value, list of problems, key).
_PartReader = Callable[[Any, List[str], str], Any]


def _refuse(expected: str) -> NoReturn:
    """Refuse a value.

    :raises ValueError: always
    """
    raise ValueError('expected ' + expected)


def is_word(value: Any) -> bool:
    """Return whether a value is a short printable text."""
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_WORD and value.isprintable()


def _is_whole(value: Any, least: int, most: int) -> bool:
    """Return whether a value is an integer in a range; booleans are not."""
    return type(value) is int and least <= value <= most


def _read_robots(value: Any) -> List[str]:
    names = value if isinstance(value, list) else []
    if names != value or len(names) > MAX_ROBOTS or not all(map(_is_robot, names)):
        _refuse('a list of at most {} names of robots'.format(MAX_ROBOTS))
    return names


def _is_robot(name: Any) -> bool:
    return isinstance(name, str) and name_problem(name) is None


def _read_numbers(value: Any) -> Dict[str, int]:
    """Return {name: number}; refuse duplicate numbers, because a key selects one robot."""
    if not (isinstance(value, dict) and len(value) <= MAX_NUMBERS
            and all(map(_is_robot, value))
            and all(_is_whole(number, 1, MAX_NUMBERS) for number in value.values())
            and len(set(value.values())) == len(value)):
        _refuse('a number of its own, from 1 to {}, for each robot'.format(MAX_NUMBERS))
    return dict(value)


def _read_mode(value: Any) -> Optional[str]:
    if value is not None and not is_word(value):
        _refuse('the name of a source')
    return value or None


def _read_flag(value: Any) -> bool:
    if not isinstance(value, bool):
        _refuse('true or false')
    return value


def _read_percent(value: Any) -> int:
    if not _is_whole(value, 25, 400):
        _refuse('a size of text [%]')
    return int(value)


def read_geometry(value: Any) -> List[Any]:
    """Return a geometry: [x, y, width, height, maximised], in pixels.

    :raises ValueError: the value is not a geometry
    """
    if not (isinstance(value, list) and len(value) == 5 and isinstance(value[4], bool)
            and all(_is_whole(part, -_MAX_PX, _MAX_PX) for part in value[:2])
            and all(_is_whole(part, 1, _MAX_PX) for part in value[2:4])):
        _refuse('x, y, width, height [px] and whether it is maximised')
    return list(value)


def read_sizes(value: Any) -> List[int]:
    """Return the sizes of the parts of a splitter [px].

    :raises ValueError: the value is not a list of sizes
    """
    if not (isinstance(value, list) and len(value) <= _MAX_PARTS
            and all(_is_whole(part, 0, _MAX_PX) for part in value)):
        _refuse('the sizes of at most {} parts [px]'.format(_MAX_PARTS))
    return list(value)


def _count_values(value: Any, depth: int = 0) -> int:
    """Return the number of values in a JSON value.

    :raises ValueError: the nesting is too deep, or a text is too long
    """
    if depth > _DEEPEST:
        _refuse('fewer levels')
    if isinstance(value, str) and len(value) > 10 * _LONGEST_WORD:
        _refuse('shorter texts')
    parts = list(value.values()) if isinstance(value, dict) else \
        value if isinstance(value, list) else []
    return 1 + sum(_count_values(part, depth + 1) for part in parts)


def _read_look(value: Any) -> State:
    """Return the settings of a tile; a lab's own class may save any values, within limits."""
    if not isinstance(value, dict) or _count_values(value) > _MAX_VALUES:
        _refuse('a dict of at most {} values'.format(_MAX_VALUES))
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
    """Return {view: {setting: word, number or flag}}."""
    if not isinstance(value, dict) or not all(isinstance(kept, dict) for kept in value.values()):
        _refuse('a dict for each view')
    return {view: {key: kept for key, kept in choices.items() if is_word(kept)
                   or isinstance(kept, (bool, int, float)) and abs(kept) <= _MAX_PX}
            for view, choices in value.items()}


def _read_recording(value: Any) -> State:
    if not isinstance(value, dict):
        _refuse('a dict')
    return {'extras': _read_words(value.get('extras', []))}


def _by_robot(read: _Reader) -> _PartReader:
    """Return a reader for a dict of robots that skips unusable entries."""
    def _read(value: Any, problems: List[str], key: str) -> State:
        if not isinstance(value, dict):
            _refuse('a dict of robots')
        found = {}
        for name, part in list(value.items())[:MAX_ROBOTS]:
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


def _parts(readers: Dict[str, _PartReader]) -> _PartReader:
    """Return a reader for a dict with these keys."""
    def _read(value: Any, problems: List[str], key: str) -> State:
        if not isinstance(value, dict):
            _refuse('a dict')
        return _read_parts(value, readers, problems, key + '.')
    return _read


_LOOK = {'views': _read_words, 'of_views': _read_views, 'recording': _read_recording}
_STATE: Dict[str, _PartReader] = {
    'robots': _plain(_read_robots), 'numbers': _plain(_read_numbers), 'mode': _plain(_read_mode),
    'windows': _by_robot(read_geometry), 'torn_off': _plain(_read_robots),
    'looks': _by_robot(_read_look), 'events': _parts({'sounds': _plain(_read_flag)}),
    'panel': _parts({
        'splitter': _plain(read_sizes), 'drawer': _plain(_read_flag),
        'geometry': _plain(read_geometry), 'layout': _plain(_read_word),
        'theme': _plain(_read_word), 'numbers': _plain(_read_flag),
        'text': _plain(_read_percent)}),
    'map': _parts({
        'shown': _plain(_read_word), 'follow': _plain(_read_flag), 'turn': _plain(_read_flag),
        'by_link': _plain(_read_flag)})}


def _read_parts(value: State, readers: Dict[str, _PartReader], problems: List[str],
                above: str) -> State:
    """Return the usable parts of a dict; report problems of the others."""
    found = {}
    for key, read in readers.items():
        if key in value:
            try:
                found[key] = read(value[key], problems, above + key)
            except ValueError as error:
                problems.append('{}{}: {}'.format(above, key, error))
    return found


def numbers_of(state: Any) -> State:
    """Return only the numbers of robots, which are permanent: what a fresh start restores."""
    return {'numbers': state.get('numbers', {})} if isinstance(state, dict) else {}


def without_robots(state: Any) -> State:
    """Return how the screen looks and sounds: what simulated runs keep, for themselves.

    Their robots are others each time; so are what drives, tiles and the map.
    """
    return {key: state[key] for key in ('panel', 'events')
            if key in state} if isinstance(state, dict) else {}


def usable_state(state: Any) -> Tuple[State, Tuple[str, ...]]:
    """Return (the usable parts of a saved state, problems of the other parts).

    :param state: the state as read from the file, not validated
    """
    if not isinstance(state, dict):
        return {}, ('expected a dict',)
    problems: List[str] = []
    return _read_parts(state, _STATE, problems, ''), tuple(problems)

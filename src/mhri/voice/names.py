# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The spoken names of robots: by their name if possible, and by their number in the panel."""
import re
from typing import Any, Callable, Container, Dict, Iterable, List, Mapping, Optional, Tuple

from mhri.base.names import name_problem

# Maximum number of robots, and the highest number, that can be addressed by voice.
MAX_ROBOTS = 30
_LAST_NUMBER = 99
# A word that is not in the dictionary is spelled up to this length: "tb" is "t b".
_SPELLED = 4
_VOWELS = frozenset('aeiouy')
_ONES = ('zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen '
         'fifteen sixteen seventeen eighteen nineteen').split()
_TENS = 'twenty thirty forty fifty sixty seventy eighty ninety'.split()
# A function that returns whether the dictionary has a word.
_Knows = Callable[[str], bool]
_PARTS = re.compile(r'[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+')


def number_words(number: int) -> str:
    """Return the words for a whole number from 0 to 99, e.g. 'twenty one'.

    :raises ValueError: the number is out of range
    """
    if not 0 <= number <= 99:
        raise ValueError('numbers from 0 to 99 are spoken, not {}'.format(number))
    if number < 20:
        return _ONES[number]
    tens, ones = divmod(number, 10)
    return ' '.join([_TENS[tens - 2]] + ([_ONES[ones]] if ones else []))


def _split(letters: str, knows: _Knows) -> Optional[List[str]]:
    """Return a text split into dictionary words, as few and as even as possible, or None."""
    if knows(letters):
        return [letters]
    cuts = [(letters[:at], letters[at:]) for at in range(3, len(letters) - 2)]
    both = [cut for cut in cuts if knows(cut[0]) and knows(cut[1])]
    if both:
        first, second = max(both, key=lambda cut: min(len(cut[0]), len(cut[1])))
        return [first, second]
    return None


def _word_or_letters(part: str, knows: _Knows) -> Optional[List[str]]:
    """Return the spoken words or letters of one part of a name, or None."""
    spelled = list(part) if len(part) <= _SPELLED and all(map(knows, part)) else None
    if spelled and not _VOWELS.intersection(part):
        # The dictionary has "tb" and the like, but they are not spoken as words.
        return spelled
    return _split(part, knows) or spelled


def _digits(text: str) -> List[str]:
    """Return the spoken forms of digits, the usual one first."""
    one_by_one = ' '.join(_ONES[int(digit)] for digit in text)
    if len(text) > 2 or text[0] == '0':
        return [one_by_one]
    whole = number_words(int(text))
    return [whole] if whole == one_by_one else [whole, one_by_one]


def spoken_names(name: str, knows: _Knows) -> Tuple[str, ...]:
    """Return the spoken phrases of a robot's name, () if it cannot be spoken.

    Words of the dictionary stay words (``bot1``: "bot one", ``turtlebot_2``: "turtle bot two"),
    other short ones are spelled (``tb3``: "t b three").

    :param knows: function that returns whether the dictionary has a word
    """
    ways: List[List[str]] = [[]]
    for part in _PARTS.findall(name):
        if part.isdigit():
            spoken = _digits(part)
        else:
            words = _word_or_letters(part.lower(), knows)
            spoken = [' '.join(words)] if words else []
        ways = [way + [more] for way in ways for more in spoken][:4]
    return tuple(' '.join(way) for way in ways if way)


def in_places(names: Iterable[str], numbers: Any) -> Tuple[str, ...]:
    """Return names in the order of their numbers, from 1; '' for an unused number.

    A name without a number, or with an unspeakable one, is left out.

    :param numbers: {name: number}, unchecked; if empty, the order of the names is used
    """
    if not isinstance(numbers, dict) or not numbers:
        return tuple(names)[:_LAST_NUMBER]
    places = {numbers[name]: name for name in names
              if type(numbers.get(name)) is int and 1 <= numbers[name] <= _LAST_NUMBER}
    return tuple(places.get(number, '') for number in range(1, max(places, default=0) + 1))


def numbered(robots: Iterable[Any]) -> Dict[str, int]:
    """Return {name: number} of the first robots of a list from :func:`in_places`."""
    found: Dict[str, int] = {}
    number = 0
    for name in robots:
        if name == '':
            number += 1
        elif isinstance(name, str) and not name_problem(name) and name not in found:
            number += 1
            found[name] = number
            if len(found) == MAX_ROBOTS:
                break
    return found


def call_robots(robots: Iterable[Any], knows: _Knows, taken: Container[str],
                wake_words: Container[str] = ()) -> Tuple[Dict[str, Tuple[str, ...]], List[str]]:
    """Return the spoken names of the robots in the panel's list.

    :param robots: names in the order of their numbers; invalid ones are left out
    :param taken: words with another meaning: a robot whose name has one is called by number only
    :param wake_words: a name may contain these ("robot one"), but not be one
    :returns: ({name: phrases}, [sentence about a robot called by number only])
    """
    called: Dict[str, Tuple[str, ...]] = {}
    notes: List[str] = []
    listed = numbered(robots)
    phrases = {name: spoken_names(name, knows) for name in listed}
    for name, number in listed.items():
        problem = _problem(name, phrases, taken, wake_words)
        called[name] = () if problem else phrases[name]
        if problem:
            notes.append('{} {}: say its number, "{}"'.format(name, problem, number_words(number)))
    return called, notes


def _problem(name: str, phrases: Mapping[str, Tuple[str, ...]], taken: Container[str],
             wake_words: Container[str]) -> Optional[str]:
    """Return why a robot's name cannot be used, None if it can."""
    own = phrases[name]
    if not own:
        return 'has no words that can be spoken'
    for phrase in own:
        words = phrase.split()
        if all(word in _ONES or word in _TENS for word in words):
            return 'sounds like a number'
        clash = [word for word in words if word in taken]
        if clash:
            return 'has the word "{}", which means something else'.format(clash[0])
        if phrase in wake_words:
            return 'sounds like the wake word'
        rivals = [other for other in phrases if other != name and phrase in phrases[other]]
        if rivals:
            return 'sounds like {}'.format(rivals[0])
    return None

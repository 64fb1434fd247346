# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What nobody should send: texts, numbers, messages, parameters and files made to do harm.

Stands alone: nothing but the standard library, everything from one seed, so that whatever did harm
is had again by the seed that a test printed.
"""
import math
import os
from random import Random
import re

ACCENTS, MEGABYTE = 300 * 1000, 1000 * 1000
FLOAT32_MOST = 3.4e38
_RANGES = {'int8': 7, 'int16': 15, 'int32': 31, 'int64': 63}
_UNSIGNED = {'byte': 8, 'char': 8, 'uint8': 8, 'uint16': 16, 'uint32': 32, 'uint64': 64}

TEXTS = (
    '', ' ', '\n', '\0', '\x1b[2J\x1b[31mred\x07', '\r\n\t\v\f', '\u202ebot1\u2066', '\ufeffbot1',
    'bot1\n', ' bot1', '/bot1', 'bot1/', '//', '~', '/', '.', '..', '../../../../etc/passwd', '-rf',
    '--', '$(reboot)', '`reboot`', ';reboot', '%s%s%n', '{0.__class__}', '{}', "bot'1", 'bot"1',
    '"; gui:=none "', "' OR 1=1 --", '<b>bold</b>', '<img src="/tmp/pipe">', '<a href="x">y</a>',
    '<script>alert(1)</script>', '&lt;&amp;', '\\', '\\x00', 'null', 'true', 'NaN', '1e308', '0x',
    '\U0001f916' * 10, 'bo\u0301t1', '\u0431ot1', 'a' * 64, 'a' * 65, 'a' * 255, 'a' * 4096,
    'bot1:1:token', 'x:' * 100, ':::', 'a:-1:b', 'a:99999999999999999999999999:b', 'a:1e9:b',
    'profile:../../x', 'profile: lost', ' lost', 'mhri', 'mux', 'robot_controller')
NUMBERS = (
    math.nan, math.inf, -math.inf, 1e308, -1e308, 1.7976931348623157e308, 5e-324, 1e30, -1e30,
    -0.0, 0.0, 1e-300, 2.0 ** 53, 2.0 ** 63, -2.0 ** 63, 1e9, -1.0000001, 1.0000001, 42.0)


def seed_of(default):
    """Return the seed to use (``MHRI_SEED``, else the one given), and print it."""
    seed = int(os.environ.get('MHRI_SEED', default))
    print('\nSEED {}'.format(seed))
    return seed


def is_long():
    """Return whether the long form is wanted (``MHRI_LONG=1``)."""
    return os.environ.get('MHRI_LONG', '') not in ('', '0')


class Hostile:
    """A source of hostile things.

    :param seed: of everything that comes out
    """

    def __init__(self, seed):
        self.random = Random(seed)
        self._large = 0

    def text(self, large=0.01):
        """Return a text; a share of them are huge."""
        if self.random.random() < large:
            self._large += 1
            return ('e\u0301' * (ACCENTS // 2), 'a' * MEGABYTE, '<b>' * 100000,
                    '\x1b[31m' * 50000)[self._large % 4]
        if self.random.random() < 0.2:
            return ''.join(chr(self.random.choice((
                self.random.randrange(32), self.random.randrange(128),
                self.random.randrange(0x20, 0xd800))))
                for _ in range(self.random.randrange(200)))
        return self.random.choice(TEXTS)

    def number(self):
        """Return a float."""
        return self.random.choice(NUMBERS + (self.random.uniform(-1.0, 1.0),))

    def small(self):
        """Return a number of 32 bits."""
        value = self.number()
        return value if not math.isfinite(value) else max(-FLOAT32_MOST, min(FLOAT32_MOST, value))

    def whole(self, kind):
        """Return an integer of a ROS type, with a liking for its ends."""
        if kind in _UNSIGNED:
            least, most = 0, 2 ** _UNSIGNED[kind] - 1
        else:
            least, most = -2 ** _RANGES[kind], 2 ** _RANGES[kind] - 1
        return self.random.choice((
            least, most, 0 if least else 1, self.random.randint(least, most)))

    def count(self):
        """Return how many items an array shall have."""
        return self.random.choice((0, 0, 1, 1, 2, 2, 3, 7, 64, 65, 300) + (
            (20000,) if self.random.random() < 0.02 else (8,)))

    def message(self, kind, class_of):
        """Return a message of a generated class, every field hostile.

        :param class_of: function from a ROS type, e.g. ``geometry_msgs/Twist``, to its class
        """
        return self._message(kind, class_of, False)

    def _message(self, kind, class_of, listed):
        """Return one; as an item of an array (``listed``) its own arrays are short.

        Arrays of arrays of texts would be larger than any of the other attacks.
        """
        made = kind()
        for slot, ros_type in zip(kind.__slots__, kind._slot_types):
            setattr(made, slot, self._field(ros_type, class_of, listed))
        return made

    def _field(self, ros_type, class_of, listed):
        array = re.match(r'(.+)\[(\d*)\]\Z', ros_type)
        if array:
            count = int(array.group(2)) if array.group(2) else self.count()
            if listed and not array.group(2):
                count = min(count, 3)
            item = array.group(1)
            if item in ('uint8', 'char'):
                return self.torn(count)
            if count <= 300:
                return [self._field(item, class_of, True) for _ in range(count)]
            return [self._field(item, class_of, True) for _ in range(10)] * (count // 10)
        if ros_type == 'string':
            return self.text()
        if ros_type in ('float64', 'float32'):
            return self.number() if ros_type == 'float64' else self.small()
        if ros_type == 'bool':
            return self.random.random() < 0.5
        if ros_type in _RANGES or ros_type in _UNSIGNED:
            return self.whole(ros_type)
        if ros_type in ('time', 'duration'):
            return self._time(class_of(ros_type), ros_type == 'time')
        return self._message(class_of('std_msgs/Header' if ros_type == 'Header' else ros_type),
                             class_of, listed)

    def _time(self, kind, is_time):
        made = kind()
        made.secs = self.whole('uint32' if is_time else 'int32')
        made.nsecs = self.random.choice((0, 1, 999999999))
        return made

    def torn(self, count=None):
        """Return bytes that are no message, or no more of one."""
        count = self.random.choice((0, 1, 3, 4, 5, 8, 20, 200, 5000)) if count is None else count
        fill = self.random.choice((b'\xff', b'\0', b'\x7f', None))
        return fill * count if fill else bytes(self.random.randrange(256) for _ in range(count))

    def value(self, depth=0):
        """Return what a parameter may be: any type, any shape, as XML-RPC can carry it."""
        kinds = [self._xml_text, self.number, lambda: self.whole('int32'),
                 lambda: self.random.random() < 0.5]
        if depth < 4:
            kinds += [lambda: [self.value(depth + 1) for _ in range(self.random.randrange(6))],
                      lambda: {self._xml_text()[:60]: self.value(depth + 1)
                               for _ in range(self.random.randrange(6))}] * 2
        if depth == 0 and self.random.random() < 0.15:
            return self.random.choice((self.nested(60), ['bot1'] * 20000, [[]] * 1000,
                                       {'k{}'.format(i): i for i in range(2000)}))
        return self.random.choice(kinds)()

    def nested(self, depth):
        """Return lists and dicts in each other."""
        value = 'core'
        for _ in range(depth):
            value = self.random.choice((lambda inner: [inner], lambda inner: {'a': inner}))(value)
        return value

    def _xml_text(self):
        # Control characters are no XML: the client, not the node, would fail.
        return re.sub('[\0-\x1f\ufffe\uffff\ud800-\udfff]', '?', self.text(large=0.003))

    def file(self, good):
        """Return the text of a file that was edited by somebody with bad luck, or bad will.

        :param good: one that can be used
        """
        lines = good.split('\n')
        at = self.random.randrange(len(lines))
        kind = self.random.randrange(9)
        if kind == 0:
            return good[:self.random.randrange(len(good))]
        if kind == 1:
            lines.insert(at, lines[self.random.randrange(len(lines))])
        elif kind == 2:
            del lines[at]
        elif kind == 3:
            lines[at] = ' ' * self.random.randrange(9) + lines[at].strip()
        elif kind == 4:
            return re.sub(r'-?\d+(\.\d+)?', lambda found: self._word() if self.random.random() < 0.3
                          else found.group(), good)
        elif kind == 5:
            lines[at] = re.sub(r':.*', lambda _: ': ' + self._word(), lines[at])
        elif kind == 6:
            where = self.random.randrange(len(good))
            return good[:where] + self.text(large=0.02) + good[where:]
        elif kind == 7:
            return good + self.random.choice(BOMBS)()
        else:
            return re.sub('["\\[{:,]', lambda found: '' if self.random.random() < 0.1
                          else found.group(), good)
        return '\n'.join(lines)

    def _word(self):
        return self.random.choice(WORDS)


WORDS = ('.nan', '.inf', '-.inf', '1e400', '-1', '0', '9' * 5000, '0x' + 'f' * 5000, '[]', '{}',
         '~', 'true', 'no', '!!bool maybe', '!!int ""', '!!timestamp foo', '!!float "x"',
         '!!binary "%"', '!!python/object/apply:os.system ["true"]', '!!set {a, b}', '*missing',
         '&a [*a]', '"\\ud800"', '2001-99-99', '1:99:99', '["a", [["b"]]]', '{a: {b: {c: d}}}',
         '"<img src=/tmp/pipe>"', "'''", '"', '- - - -', '? : ?', '|', '>', '%YAML 9.9', '@', '`')
BOMBS = (
    lambda: '\nbomb: &a0 [x]\n' + ''.join('b{0}: &a{0} [{1}]\n'.format(
        level, ', '.join(['*a{}'.format(level - 1)] * 9)) for level in range(1, 10)),
    lambda: '\ndeep: ' + '[' * 3000, lambda: '\ndeep: ' + '{a: ' * 500 + '}' * 500,
    lambda: '\nlong: "' + 'e\u0301' * 150000 + '"', lambda: '\nlist: [' + 'x, ' * 100000 + ']',
    lambda: '\nwords: ' + 'a ' * 200000, lambda: '\nnumber: ' + '1' * 100000)

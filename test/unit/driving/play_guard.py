# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays scripts to the guard's rule, with Python 2.7 or 3, without ROS.

Usage: play_guard.py GUARD <SCRIPTS.json >ANSWERS.json; a script is a list of lines:

    0.00 echo a                   an echo, whose token is called "a" from here on
    0.01 A:1:a 0.3 0.1            a command; the token stands as it is where no echo has that name
    0.01 A:2:a 0.3 0.1 0.2        the same, and so much to the left
    0.02 own 0.3 0.1              a program of the robot's own says this where it is passed on
    0.31 tick
    0.40 close
    0.41 move 1.0 0.0 180         where the robot is by its odometry [m, m, degrees]
    0.42 see 0.5                  a scan that meets something so far ahead, and nothing elsewhere
    0.43 heard a                  the sender is there; "heard" alone: it ends
    0.44 answer                   it answers on a new connection

Before them a line "with", and arguments of Guard as JSON: "brake" is true for one, "back" are the
arguments of WayBack without the first. The answer to a line is what the robot is
given, as "0.3 0.1", "none" for nothing, and why a command is not obeyed; to an echo its frame_id
with "*" for the part of the token that another run would not repeat.
"""
import json
import math
import sys
import types

STAND_INS = {'rospy': (), 'geometry_msgs': (), 'geometry_msgs.msg': ('Twist', 'TwistStamped'),
             'std_msgs': (), 'std_msgs.msg': ('Header', 'String')}
CALLS = {'own': 'on_own', 'answer': 'on_answer', 'tick': 'tick', 'close': 'close'}


def load(path):
    """Return what a guard's file defines; what it needs of ROS is not there, and not touched."""
    before = {name: sys.modules.get(name) for name in STAND_INS}
    for name, parts in STAND_INS.items():
        sys.modules[name] = types.ModuleType(str(name))
        for part in parts:
            setattr(sys.modules[name], part, None)
    names = {'__name__': 'mhri_guard'}
    try:
        with open(path) as source:
            exec(compile(source.read(), path, 'exec'), names)
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module
    return names


def play(names, lines):
    """Return the answers to the lines of a script."""
    options = {}
    if lines[0].startswith('with '):
        options = json.loads(lines[0][5:])
        lines = lines[1:]
    sight = names['Sight'](0.2)
    brake = sight if options.pop('brake', False) else None
    back = names['WayBack'](sight, *options.pop('back')) if 'back' in options else None
    guard = names['Guard']('run', brake=brake, back=back, **options)
    faults = {value: name.lower() for name, value in names.items()
              if name.isupper() and isinstance(value, str)}
    tokens = {}
    answers = []
    for line in lines:
        words = line.split()
        now, what = float(words[0]), words[1]
        if what == 'echo':
            said = guard.echo_id(now)
            tokens[words[2]] = said.rstrip('!').split(':')[2]
            answers.append(said.replace(tokens[words[2]], '*'))
        elif what == 'move':
            pose = float(words[2]), float(words[3]), math.radians(float(words[4]))
            sight.move(pose, now)
            if back:
                back.move(pose)
        elif what == 'see':
            sight.see([float(words[2])] + [float('inf')] * 359, 0.0, 0.017453293, 0.1, 10.0, now)
        elif what == 'heard':
            answers.append(written(guard.on_heard(tokens[words[2]] if words[2:] else '', now)))
        elif what in CALLS:
            velocity = [read(words[2:])] if words[2:] else []
            answers.append(written(getattr(guard, CALLS[what])(*velocity + [now])))
        else:
            head, _, token = what.rpartition(':')
            said, fault = guard.on_command(head + ':' + tokens.get(token, token),
                                           read(words[2:]), now)
            answers.append(' '.join([written(said)] + ([faults[fault]] if fault else [])))
    return answers


def read(words):
    """Return the velocity that a line gives: ahead, turn, and to the left, which may be missing."""
    return tuple(map(float, words + ['0'] * (3 - len(words))))


def written(velocity):
    """Return a velocity as it stands in the answers."""
    parts = 'none' if velocity is None else '{:g} {:g} {:g}'.format(*velocity)
    return parts[:-2] if parts.endswith(' 0') and velocity[2] == 0.0 else parts


if __name__ == '__main__':
    GUARD = load(sys.argv[1])
    json.dump([play(GUARD, script) for script in json.load(sys.stdin)], sys.stdout)

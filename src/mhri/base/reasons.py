# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reasons why a robot is stopped or needs attention: one code each, and one table of their texts.

A code is set where the decision is made, and is passed on unchanged: the drive's in
``mhri/DriveState``, a screen's in its view. This module converts it to text, for tile, row, status
line, event, task, doctor and terminal alike.
"""
from typing import Dict, NamedTuple, Optional, Sequence, Tuple

from mhri.base.text import listed

# Reasons of one robot, as ``stands`` of mhri/RobotDrive.
STOPPED, STOPPED_ALONE, NOT_HEARD, JOINING = 'stopped', 'stopped_alone', 'not_heard', 'joining'
NO_LEASE, HARDWARE_STOP, POWER_CUT = 'no_lease', 'hardware_stop', 'power_cut'
GUARD_VERSION, UNREACHABLE, TWO_ROBOTS = 'guard_version', 'unreachable', 'two_robots'
UNWATCHED, LIMIT_RAISED = 'unwatched', 'limit_raised'
#: the reasons that keep a robot still whether it has a commander or not
ALWAYS_SAID = (STOPPED_ALONE, GUARD_VERSION, UNREACHABLE, TWO_ROBOTS)
# Reasons of all robots, as ``waits_for`` of mhri/DriveState; RELEASE corresponds to STOPPED.
NEUTRAL, SOURCE, ENABLING, DEAD_MAN = 'neutral', 'source', 'enabling', 'dead_man'
RELEASE, UNDERTAKER = 'release', 'undertaker'
# Reasons of the active source, as ``advice`` of mhri/DriveState.
BAD_INPUT, RIVAL, NO_PUBLISHER = 'bad_input', 'rival', 'no_publisher'
SENDS_JOY, SENDS_TWIST, SENDS_OTHER = 'sends_joy', 'sends_twist', 'sends_other'
NOTHING_SENT, SCREEN_UNHEARD, FELL_SILENT = 'nothing_sent', 'screen_unheard', 'fell_silent'
# Reasons of a screen: its own connections, the drive service, the robot.
NO_CONNECTION, DRIVE_SILENT = 'no_connection', 'drive_silent'
NOT_OURS, OTHER_SOURCE, NO_SPEED = 'not_ours', 'other_source', 'no_speed'
DEVICE = 'device'
NOT_SELECTED, ON_TASK, LINK_SILENT, LINK_LOST = 'not_selected', 'on_task', 'silent', 'lost'
NOT_REACHED, POWER = 'not_reached', 'power'
# Reasons of the brake, as in mhri/RobotDrive.
SLOWS, UNSEEN, NO_SCAN, NO_PLACE = 'slows', 'unseen', 'no_scan', 'no_place'
NOT_SIDEWAYS, TOGETHER, NO_ANSWER = 'not_sideways', 'together', 'no_answer'
# Reason of an accessory.
NO_LISTENER = 'no_listener'
# Reasons for attention while the robot can move.
NOT_ALONE, ODOMETRY_STUCK = 'not_alone', 'odometry_stuck'
ODOMETRY_FOUND = 'odometry_found'

# {code: (the state, its consequence or its remedy)}; {} are names.
_WORDS: Dict[str, Tuple[str, str]] = {
    STOPPED: ('STOP ALL is in force', 'release it first'),
    STOPPED_ALONE: ('stopped alone', 'deselect and select it to drive it'),
    NOT_HEARD: ('not heard', 'the drive service holds it still'),
    NO_LEASE: ('operator not heard', 'the screen in control hangs, or has lost its connection'),
    UNWATCHED: ('not watched yet', 'the stand-by process gets its connection in a moment'),
    JOINING: ('centre the stick to drive', ''),
    GUARD_VERSION: ('guard version', 'its guard has another one, so it is held still; send it '
                    'this one with turtlebot_deploy.sh'),
    UNREACHABLE: ('held still', 'a multiplexer writes its velocity, or it only commands another '
                  'robot'),
    TWO_ROBOTS: ('two robots', 'two computers are this one, so it is held still; end one of '
                 'them'),
    NEUTRAL: ('centre the stick to drive', ''),
    SOURCE: ('nothing is heard from {} yet', ''),
    ENABLING: ('press the enabling pedal to drive', ''),
    DEAD_MAN: ('hold the dead-man button to drive', ''),
    UNDERTAKER: ('the stand-by process does not answer', 'nothing moves until it does'),
    BAD_INPUT: ('unusable input', '{}'),
    RIVAL: ('{} sends to the active source as well', 'only the first counts; end one of them'),
    NO_PUBLISHER: ('nobody publishes {}', 'start its node'),
    SENDS_JOY: ('{} sends sensor_msgs/Joy', 'write type: joy into its row of mux.yaml'),
    SENDS_TWIST: ('{} sends geometry_msgs/Twist', 'write type: twist into its row of mux.yaml'),
    SENDS_OTHER: ('{} sends another message type', 'use sensor_msgs/Joy or geometry_msgs/Twist'),
    NOTHING_SENT: ('{} has sent nothing yet', 'move the stick once'),
    SCREEN_UNHEARD: ('the screen is not heard', 'this computer may be too busy'),
    FELL_SILENT: ('{} has stopped sending', 'if it sends changes only (joy_node without '
                  'autorepeat_rate), write holds: true into its row of mux.yaml'),
    NO_CONNECTION: ('this screen has no connection', 'see the bottom line'),
    DRIVE_SILENT: ('the drive service does not answer',
                   'driven robots have stopped; if it does not come back, start mhri again'),
    NOT_OURS: ('{} drives', 'take control first'),
    OTHER_SOURCE: ('{} drives, not this stick', 'choose "{}" first'),
    NO_SPEED: ('the speed limit is 0', 'raise it'),
    DEVICE: ('{}', ''),
    NOT_SELECTED: ('not selected', '{} to drive it'),
    ON_TASK: ('on a task', '{} to take it over'),
    LINK_SILENT: ('it has sent {}', ''),
    LINK_LOST: ('{}', ''),
    NO_LISTENER: ('no node of the robot listens', 'is its driver running?'),
    NOT_REACHED: ('nothing on it takes commands', 'is its driver running?'),
    HARDWARE_STOP: ('its own emergency stop is pressed', 'unlock it on the robot'),
    POWER: ('motor power {}', ''),
    POWER_CUT: ('motor power cut', 'restore it to drive'),
    SLOWS: ('brake: something is in the way', 'back away or turn'),
    UNSEEN: ('brake: it does not see that way', 'turn less, or turn to it first'),
    NO_SCAN: ('brake: no laser or depth data', 'back away, or switch the brake off'),
    NO_PLACE: ('brake: place of a laser unknown', 'name it in tf or in the type, or switch the '
               'brake off'),
    NOT_SIDEWAYS: ('cannot go sideways', ''),
    TOGETHER: ('not sideways', 'it stays together with {}, which cannot'),
    NO_ANSWER: ('commands reach it, its motors do not answer', ''),
    NOT_ALONE: ('not alone', '{}'),
    ODOMETRY_STUCK: ('odometry stuck', 'it does not follow commands'),
    ODOMETRY_FOUND: ('odometry found', '{} is not of its type: drive a little, no stop is '
                     'confirmed before it has followed'),
    LIMIT_RAISED: ('limit raised', 'deselect and select it to use its new speed limit'),
}
# Why motors have or may have no power: {``power`` of mhri/RobotDrive: text of POWER}.
_POWER = {'cut': 'cut', 'cut_sent': 'cut, not confirmed', 'cut_asked': 'being cut',
          'restore_asked': 'being restored', 'failed': 'not changed'}
NO_WITNESS = 'its odometry has not followed its commands'
_MAX_NAMES = 3


def is_code(text: str) -> bool:
    """Return whether a text is a code of this module, not a sentence."""
    return text in _WORDS


class Reason(NamedTuple):
    """A code of this module, and the names in its text; an unknown code is its own text."""

    code: str
    names: Tuple[str, ...] = ()

    @property
    def what(self) -> str:
        """The state, for narrow places: "STOP ALL is in force"."""
        return _WORDS.get(self.code, ('{}', ''))[0].format(*self.names or (self.code,))

    @property
    def remedy(self) -> str:
        """Its consequence or its remedy: "release it first"; '' for none."""
        return _WORDS.get(self.code, ('', ''))[1].format(*self.names or (self.code,))

    @property
    def sentence(self) -> str:
        """The state with its remedy: "STOP ALL is in force: release it first"."""
        words = ': '.join(filter(None, _WORDS.get(self.code, ('{}', ''))))
        return words.format(*self.names or (self.code,))


def power_reason(state: str) -> Optional[Reason]:
    """Return the reason of the motor power, None if it does not keep the robot from moving.

    :param state: ``power`` of ``mhri/RobotDrive``
    """
    return Reason(POWER, (_POWER[state],)) if state in _POWER else None


def also_words(nodes: Sequence[str]) -> str:
    """Describe the other commanders of a robot; '' for none.

    :param nodes: their caller ids
    """
    return 'also commanded by ' + listed(nodes, _MAX_NAMES) if nodes else ''

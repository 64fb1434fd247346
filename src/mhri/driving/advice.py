# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What keeps a source from driving, and what to do about it: a sentence for the status line."""
from dataclasses import dataclass
from typing import FrozenSet, Optional, Tuple

from mhri.driving.sources import JOY, Source, TWIST

_SCREENS = '/mux_in/joy'
MESSAGE_TYPES = {JOY: 'sensor_msgs/Joy', TWIST: 'geometry_msgs/Twist'}


@dataclass(frozen=True)
class Heard:
    """What is known of the active source's topic.

    ``publishers`` are connected; ``stranger`` is (node, message type) of one that publishes another
    type; ``spoke`` is true once something was heard in this mode; ``refused`` says why the
    newest message could not be used; ``rival`` is (node, owner) if a second publisher was refused
    lately.
    """

    publishers: FrozenSet[str] = frozenset()
    stranger: Optional[Tuple[str, str]] = None
    spoke: bool = False
    refused: str = ''
    rival: Optional[Tuple[str, str]] = None


def advice(source: Source, waits_for: str, heard: Heard) -> str:
    """Return the sentence, '' if there is nothing to say.

    :param source: the active :class:`mhri.driving.sources.Source`
    :param waits_for: the text of ``/mux/waits_for``
    :param heard: :class:`Heard`
    """
    if heard.refused:
        return '{}: {}'.format(source.label, heard.refused)
    if heard.rival:
        return '{} publishes {} as well and is not listened to: {} does so'.format(
            heard.rival[0], source.topic, heard.rival[1])
    if waits_for == 'source':
        return '{}: {}'.format(source.label, _silence(source, heard))
    return ''


def _silence(source: Source, heard: Heard) -> str:
    """Say why nothing is heard."""
    if heard.stranger:
        node, kind = heard.stranger
        kinds = {name: key for key, name in MESSAGE_TYPES.items()}
        remedy = 'write type: {} into its row of mux.yaml'.format(kinds[kind]) if kind in kinds \
            else 'it needs {}'.format(MESSAGE_TYPES[source.kind])
        return '{} publishes {} on {}: {}'.format(node, kind, source.topic, remedy)
    if not heard.publishers:
        return 'nobody publishes {}: start its node'.format(source.topic)
    node = sorted(heard.publishers)[0]
    if not heard.spoke:
        return '{} has said nothing yet: move the stick once'.format(node)
    if source.topic == _SCREENS:
        # The virtual joystick, which says all the time where it is.
        return 'the screen is not heard; this computer may be too busy'
    return ('{} has fallen silent; if it sends changes only (joy_node without autorepeat_rate), '
            'write holds: true into its row of mux.yaml'.format(node))

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Why a source cannot drive, as a code whose text names the remedy."""
from dataclasses import dataclass
from typing import FrozenSet, Optional, Tuple

from mhri.base import reasons
from mhri.driving.sources import JOY, Source, TWIST

_SCREENS = '/mux_in/joy'
MESSAGE_TYPES = {JOY: 'sensor_msgs/Joy', TWIST: 'geometry_msgs/Twist'}
_SENDS = {MESSAGE_TYPES[JOY]: reasons.SENDS_JOY, MESSAGE_TYPES[TWIST]: reasons.SENDS_TWIST}


@dataclass(frozen=True)
class SourceStatus:
    """The status of the active source's topic.

    ``publishers`` are connected; ``stranger`` is (node, message type) of a publisher of another
    message type; ``spoke`` is true once a message was received in this mode; ``refused`` is the
    reason why the newest message could not be used; ``rival`` is a second publisher that was
    rejected recently.
    """

    publishers: FrozenSet[str] = frozenset()
    stranger: Optional[Tuple[str, str]] = None
    spoke: bool = False
    refused: str = ''
    rival: str = ''


def advice(source: Source, waits_for: str, heard: SourceStatus) -> Tuple[str, str]:
    """Return (a code of :mod:`mhri.base.reasons`, its subject), or ('', '') without a problem.

    :param source: the active :class:`mhri.driving.sources.Source`
    :param waits_for: ``waits_for`` of ``mhri/DriveState``
    :param heard: :class:`SourceStatus`
    :returns: the subject is a node, a topic, or the error in the input
    """
    if heard.refused:
        return reasons.BAD_INPUT, heard.refused
    if heard.rival:
        return reasons.RIVAL, heard.rival
    return _silence(source, heard) if waits_for == reasons.SOURCE else ('', '')


def _silence(source: Source, heard: SourceStatus) -> Tuple[str, str]:
    """Return why no messages arrive."""
    if heard.stranger:
        node, kind = heard.stranger
        return _SENDS.get(kind, reasons.SENDS_OTHER), node
    if not heard.publishers:
        return reasons.NO_PUBLISHER, source.topic
    node = sorted(heard.publishers)[0]
    if not heard.spoke:
        return reasons.NOTHING_SENT, node
    # The virtual joystick publishes its position continuously; others may send changes only.
    return reasons.SCREEN_UNHEARD if source.topic == _SCREENS else reasons.FELL_SILENT, node

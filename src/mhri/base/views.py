# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The content of the screen as plain values: the only interface between ros/ and gui/.

The presenter of the panel gets a :class:`ScreenView` from the backend a few times a second on the
GUI thread and passes it to the widgets, which draw it and need nothing else.
"""
from dataclasses import dataclass
from typing import Any, Mapping, NamedTuple, Optional, Tuple

from mhri.base.accessories import Accessory
from mhri.base.brake_view import BrakeView
from mhri.base.geometry import Pose
from mhri.base.limits import Velocity, ZERO
from mhri.base.mocap import Drift
from mhri.base.reasons import Reason
from mhri.base.task_views import TaskView

# Link states of a robot.
WAITING = 'waiting'   # added, no message received yet
LIVE = 'live'         # its odometry arrives
SILENT = 'silent'     # connected, but nothing has arrived for more than a second
GONE = 'gone'         # no connection: switched off, crashed or out of reach

# States of the proof of a stop.
PROOF_WAITING = 'waiting'            # zero sent, standstill not read yet
PROOF_STOPPED = 'stopped'            # its own odometry reports standstill
PROOF_NOT_CONFIRMED = 'not_confirmed'  # it moves on, moved again, or is silent

# The stick of the screen itself, one of the sources of the mux.
VIRTUAL_JOYSTICK = 'joy'

# States of the ROS connection.
ROS_STARTING = 'starting'
ROS_NO_MASTER = 'no_master'
ROS_CONNECTED = 'connected'
ROS_CUT_OFF = 'cut_off'  # this program's node was ended or its name taken: nothing is published


class Change(NamedTuple):
    """A change: its robot ('' for all), kind and sentence.

    The kind is "subject.what", a key of :data:`mhri.events.events.KINDS`; the last change of a
    subject is the valid one. ``again`` is true if it only adds to a reported change. ``data`` are
    the details for programs: plain JSON values by name.
    """

    robot: str
    kind: str
    text: str
    again: bool = False
    data: Mapping[str, Any] = {}


@dataclass(frozen=True)
class ProofView:
    """The proof that one robot stands still after stop-all: state and words."""

    state: str
    text: str


@dataclass(frozen=True)
class AccessoryView:
    """One accessory of a robot, or one of its other sensors.

    :param spec: its row in the robot's type
    :param known: whether the robot has reported its state
    :param choice: the reported choice, '' for none
    :param value: the reported values; the value of a sensor
    :param stands: why it does not obey: a code of :mod:`mhri.base.reasons` or a sentence; '' if it
        does. For a sensor: why it is silent
    """

    spec: Accessory
    known: bool = False
    choice: str = ''
    value: Tuple[float, ...] = ()
    stands: str = ''


@dataclass(frozen=True)
class LinkFigures:
    """The measurements of a robot's link; None if unknown.

    ``round_trip_s`` is the round-trip time [s], ``offset_s`` how far the robot's clock is ahead of
    the local one [s], ``loss`` the fraction of its odometry that did not arrive, in [0, 1].
    ``thinned`` describes the reduced data on a slow radio; '' while it carries everything.
    """

    round_trip_s: Optional[float] = None
    offset_s: Optional[float] = None
    loss: Optional[float] = None
    thinned: str = ''


@dataclass(frozen=True)
class RobotView:
    """The content of a robot's row and tile.

    ``number`` is its permanent number, from 1; 0 if it has none.

    ``age_s`` is the age of the newest odometry [s]; speeds are the robot's own odometry [m/s,
    rad/s], ``heading_rad`` its yaw in (-pi, pi], x and y in metres in its ``odom`` frame; None
    before the first message. ``battery`` is a fraction in [0, 1]. ``recording`` is true while a
    bag of it is open. ``note`` is a remark on the link, e.g. "nothing for 3.2 s"; '' while all is
    well. ``figures`` are the measurements of the link, ``slow`` is true if it needs attention.

    From the drive: ``driven`` is true while the velocity last sent to it is nonzero, ``guarded``
    while its commands go through a guard on the robot, ``obeys`` is its commander ('', 'operator',
    'task'), ``stands`` why it is kept still (a code of :mod:`mhri.base.reasons`),
    ``also_commanded_by`` are its other commanders, ``odometry_follows`` is false if its odometry
    stood still despite a command to move, ``waits`` is true while it waits for a centred stick,
    ``stop_latched`` once its guard has confirmed the stop. ``brake`` is the state of its obstacle
    brake. ``hardware_stop`` is true while the robot's own emergency stop holds it, None if not
    reported. ``power`` is the state of its motor power (a code of ``mhri/RobotDrive``),
    ``offers_power`` whether it can be cut. ``sent`` is the velocity last sent to it (None if
    unknown), ``reached`` is false while none of its nodes accepts commands, ``holonomic`` is true
    if it can move sideways.

    Derived by the screen: ``asked`` is the operator's command if the robot has deviated from it for
    a moment, else None; ``why`` is why it stands although the stick is held, or None. ``task`` is
    its task, None for none, ``carry_on`` the name of the task that it could continue, '' for none.
    ``accessories`` are its tools and other sensors, an :class:`AccessoryView` each.

    If other hosts are linked to it: ``ask`` is the request of its button ("Ask for control"), ''
    for none, ``said`` the last change of its control, or the last refusal.
    """

    name: str
    type_label: str = ''
    window: str = 'turtlebot'
    link: str = WAITING
    age_s: Optional[float] = None
    note: str = ''
    linear_mps: Optional[float] = None
    angular_rad_s: Optional[float] = None
    lateral_mps: Optional[float] = None
    heading_rad: Optional[float] = None
    x_m: Optional[float] = None
    y_m: Optional[float] = None
    battery: Optional[float] = None
    selected: bool = False
    driven: bool = False
    moving: bool = False
    proof: Optional[ProofView] = None
    max_linear_mps: Optional[float] = None
    max_angular_rad_s: Optional[float] = None
    recording: bool = False
    guarded: bool = False
    figures: LinkFigures = LinkFigures()
    slow: bool = False
    waits: bool = False
    obeys: str = ''
    stands: str = ''
    brake: BrakeView = BrakeView()
    stop_latched: bool = False
    also_commanded_by: Tuple[str, ...] = ()
    odometry_follows: bool = True
    power: str = ''
    offers_power: bool = False
    hardware_stop: Optional[bool] = None
    number: int = 0
    sent: Optional[Velocity] = None
    holonomic: bool = False
    reached: bool = True
    asked: Optional[Velocity] = None
    why: Optional[Reason] = None
    task: Optional[TaskView] = None
    carry_on: str = ''
    ask: str = ''
    said: str = ''
    accessories: Tuple[AccessoryView, ...] = ()

    @property
    def on_task(self) -> bool:
        """Whether it is not selected and has a task, running or about to start."""
        return not self.selected and (self.obeys == 'task' or self.task is not None)

    @property
    def changed_with(self) -> Tuple[str, str]:
        """The states with which its numbers are updated at once, so that both agree."""
        return self.link, self.proof.state if self.proof else ''


@dataclass(frozen=True)
class StateView:
    """Further data on a robot while its tile is visible.

    ``ages`` are (name of a displayed stream, age of its newest message [s], None before the first).
    ``figures`` are those of the link. ``captured`` is the robot's pose by motion capture, ``drift``
    the drift of its odometry since the tile was opened; None if it is not tracked.
    """

    ages: Tuple[Tuple[str, Optional[float]], ...] = ()
    figures: LinkFigures = LinkFigures()
    captured: Optional[Pose] = None
    drift: Optional[Drift] = None


@dataclass(frozen=True)
class HeardView:
    """The last words of the voice node, the recognised command ('' for none), or why none."""

    text: str
    command: str = ''
    accepted: bool = False
    reason: str = ''


@dataclass(frozen=True)
class DeviceView:
    """The state of a device, reported by its input node.

    ``name`` is the name of the connected device, '' for none; ``note`` is why there is none and the
    remedy, or what the device waits for; both are '' if unknown. ``kind`` is e.g. 'pad'; ``there``
    are the names of all devices that could be chosen.
    """

    source: str
    name: str = ''
    note: str = ''
    kind: str = ''
    there: Tuple[str, ...] = ()

    @property
    def absent(self) -> bool:
        """Whether the device is known to be missing."""
        return bool(self.note and not self.name)


@dataclass(frozen=True)
class ControlView:
    """The screen in control: this one (``ours``), or another, e.g. "panel on lab-pc2".

    ``since`` is a local time as text, '' if unknown.
    """

    ours: bool = True
    who: str = 'somebody else'
    since: str = ''

    @property
    def words(self) -> str:
        """The screen in control, and since when: "panel on lab-pc2 since 14:02"."""
        return self.who + (' since ' + self.since if self.since else '')


class FlagView(NamedTuple):
    """A mark of the session on the map: its words, its place [m] and the frame of that."""

    label: str
    x_m: float
    y_m: float
    frame: str


@dataclass(frozen=True)
class ScreenView:
    """The whole content of the panel at one instant.

    ``mode`` is the active source (None while the drive is silent); ``sources`` are (name, label) of
    the drop-down in order, each labelled with its device if known; ``devices`` are the states of
    these. ``stop_all`` is true while everything is stopped, ``stop_refused`` if ``stop_note``
    reports a refusal. ``limits`` are the operator's speed limits in force [m/s, rad/s]. ``status``
    is the status line at the bottom, never empty; ``status_level`` one of 'calm', 'attention',
    'stopped'.
    ``together`` is true while all selected robots are limited to the pace of the slowest, ``pace``
    describes that, ``brake`` is true while the obstacle brake is on, ``slowed`` while a slow link
    slows them down.
    ``camera_bits_per_s`` is the network load of all visible pictures. ``heard`` is the last result
    of the voice node, None before the first. ``control`` is the screen in control, ``answers`` is
    false while the drive is silent, ``stop_taken`` true once it has confirmed the stop.
    ``advice`` is why the active source cannot drive, and the remedy, or None.
    ``dead_man`` is false while the dead-man buttons of pads need not be held. ``asked`` is the
    operator's current command [m/s, rad/s], ``waits_for`` the code of what it waits for, ``pushed``
    whether the stick of the active source is held. ``flags`` are the marks of the session.
    """

    ros: str = ROS_STARTING
    sources: Tuple[Tuple[str, str], ...] = ()
    devices: Tuple[DeviceView, ...] = ()
    mode: Optional[str] = None
    stop_all: bool = False
    stop_note: str = ''
    stop_refused: bool = False
    limits: Tuple[float, float] = (0.5, 1.5)
    together: bool = False
    brake: bool = False
    pace: str = ''
    slowed: bool = False
    status: str = 'starting'
    status_level: str = 'calm'
    robots: Tuple[RobotView, ...] = ()
    camera_bits_per_s: float = 0.0
    advice: Optional[Reason] = None
    dead_man: bool = True
    heard: Optional[HeardView] = None
    control: ControlView = ControlView()
    answers: bool = True
    stop_taken: bool = True
    asked: Velocity = ZERO
    waits_for: str = ''
    pushed: bool = False
    flags: Tuple[FlagView, ...] = ()

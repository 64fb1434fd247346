# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen shows, as plain values: the only language between ros/ and gui/.

The host of the panel takes a :class:`PanelView` from the ROS side a few times a second on the GUI
thread and hands it to the widgets, which draw it and know nothing else.
"""
from dataclasses import dataclass
from typing import Optional, Tuple

from mhri.base.brake_view import BrakeView
from mhri.base.mocap import Drift, Pose
from mhri.base.task_views import TaskView

# Link states of a robot.
WAITING = 'waiting'   # added, nothing heard yet
LIVE = 'live'         # its odometry arrives
SILENT = 'silent'     # connected, but nothing has arrived for more than a second
GONE = 'gone'         # no connection: switched off, crashed or out of reach
LINK_STATES = (WAITING, LIVE, SILENT, GONE)

# States of the proof of a stop.
PROOF_WAITING = 'waiting'            # zero sent, standstill not read yet
PROOF_STOPPED = 'stopped'            # its own odometry reads standstill
PROOF_NOT_CONFIRMED = 'not_confirmed'  # it moves on, moved again, or cannot be heard

# What every row says while the gates are not heard.
UNANSWERED = 'the drive service does not answer'

# The stick of the screen itself, one of the sources of the mux.
VIRTUAL_JOYSTICK = 'joy'

# States of the ROS connection.
ROS_STARTING = 'starting'
ROS_NO_MASTER = 'no_master'
ROS_CONNECTED = 'connected'
ROS_CUT_OFF = 'cut_off'  # this program's node was ended or its name taken: nothing goes out


@dataclass(frozen=True)
class ProofView:
    """The proof that one robot stands still after stop-all: state and words."""

    state: str
    text: str


@dataclass(frozen=True)
class LinkFigures:
    """The measurements of a robot's link; None if unknown.

    ``round_trip_s`` is the round-trip time [s], ``offset_s`` how far the robot's clock is ahead of
    the local one [s], ``loss`` the fraction of its odometry that did not arrive, in [0, 1].
    ``thinned`` says in words what a radio that does not bear all lets through; '' while it does.
    """

    round_trip_s: Optional[float] = None
    offset_s: Optional[float] = None
    loss: Optional[float] = None
    thinned: str = ''


@dataclass(frozen=True)
class RobotView:
    """One robot as its row and its tile show it.

    ``number`` is its own for good, from 1; 0 if it has none.

    ``age_s`` is the age of the newest odometry [s]; speeds are the robot's own odometry [m/s,
    rad/s], ``heading_rad`` its yaw in (-pi, pi], x and y in metres in its ``odom`` frame; None
    if nothing was heard. ``battery`` is a fraction in [0, 1]. ``recording`` is true while a
    bag of it is open. ``note`` is a remark on the link in words, e.g. "nothing for 3.2 s"; '' while
    all is well. ``figures`` are the measurements of the link, ``slow`` is true if something needs
    attention.

    What the gates say: ``driven`` is true while the velocity last sent to it is not zero,
    ``guarded`` while its commands go through a guard on the robot, ``obeys`` is whom it obeys ('',
    'operator', 'task'), ``stands`` why it is kept still (a code of
    :data:`mhri.robots.gate_words.STANDS_WORDS`), ``also_commanded_by`` who else commands it,
    ``odometry_follows`` is false where its odometry stood still while it was told to move,
    ``waits`` is true while it waits for a centred stick, ``stop_latched`` once its guard has
    confirmed the stop. ``brake`` is what its obstacle brake does. ``hardware_stop`` is true while
    the robot's own emergency stop holds it, None if nothing reports it. ``power`` says in words
    what was done to its motor power (:mod:`mhri.driving.motor_power`), '' for nothing,
    ``offers_power`` whether it can be cut.
    ``sent_mps`` and ``sent_rad_s`` are the velocity last sent to it (None: not known), ``reached``
    is false while nothing on it takes commands.

    What the screen makes of it: ``asked`` is the operator's command [m/s, rad/s] where the robot
    has done something else for a moment, else None; ``why`` says in a sentence why it stands though
    the stick is held, '' for nothing. ``task`` is what it does by itself, None for nothing,
    ``carry_on`` the name of the task that it could continue, '' for none.

    Where other hosts are linked to it: ``ask`` is what its button asks for ("Ask for control"), ''
    for nothing, ``said`` the last change of its control, or the last refusal.
    """

    name: str
    type_label: str = ''
    window: str = 'turtlebot'
    link: str = WAITING
    age_s: Optional[float] = None
    note: str = ''
    linear_mps: Optional[float] = None
    angular_rad_s: Optional[float] = None
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
    sent_mps: Optional[float] = None
    sent_rad_s: Optional[float] = None
    reached: bool = True
    asked: Optional[Tuple[float, float]] = None
    why: str = ''
    task: Optional[TaskView] = None
    carry_on: str = ''
    ask: str = ''
    said: str = ''

    @property
    def on_task(self) -> bool:
        """Whether it drives by itself, or is about to."""
        return not self.selected and (self.obeys == 'task' or self.task is not None)

    @property
    def changed_with(self) -> Tuple[str, str]:
        """The states with which its numbers change at once, so that both say the same."""
        return self.link, self.proof.state if self.proof else ''


@dataclass(frozen=True)
class StateView:
    """What else is known about a robot while its tile is on show.

    ``ages`` are (name of a stream that is shown, age of its newest message [s], None if nothing
    has come yet). ``figures`` are those of the link. ``captured`` is where motion capture sees the
    robot, ``drift`` how far its odometry has drifted since the tile was opened; None if nobody
    tracks it.
    """

    ages: Tuple[Tuple[str, Optional[float]], ...] = ()
    figures: LinkFigures = LinkFigures()
    captured: Optional[Pose] = None
    drift: Optional[Drift] = None


@dataclass(frozen=True)
class HeardView:
    """What the voice node heard last, the command it understood ('' for none), or why none."""

    text: str
    command: str = ''
    accepted: bool = False
    reason: str = ''


@dataclass(frozen=True)
class DeviceView:
    """What an input node says of its device.

    ``name`` is the name of the connected device, '' if there is none; ``note`` says why there is
    none and what to do, or what the device waits for; both are '' if the node cannot tell.
    ``kind`` is e.g. 'pad'; ``there`` are the names of all that could be chosen.
    """

    source: str
    name: str = ''
    note: str = ''
    kind: str = ''
    there: Tuple[str, ...] = ()

    @property
    def absent(self) -> bool:
        """Whether there is certainly no device."""
        return bool(self.note and not self.name)


@dataclass(frozen=True)
class ControlView:
    """Who is in control: this screen (``ours``), or who, e.g. "panel on lab-pc2 since 14:02"."""

    ours: bool = True
    who: str = ''


@dataclass(frozen=True)
class PanelView:
    """Everything the panel shows at one instant.

    ``mode`` is the source in force as the mux last said (None: the mux has not been heard);
    ``sources`` are (name, label) of the drop-down in order, each called by its device where that is
    known; ``devices`` are what is known of these. ``stop_all`` is true while everything
    is stopped. ``limits`` are the operator's speed limits in force [m/s, rad/s]. ``status`` is the
    one line at the bottom, never empty; ``status_level`` one of 'calm', 'attention', 'stopped'.
    ``together`` is true while all selected robots are held to the pace of the slowest, ``pace``
    says in words what that is, ``brake`` while the obstacle brake is on, ``slowed`` is true while a
    slow link holds them back.
    ``camera_bits_per_s`` is what all pictures on show take of the network. ``heard`` is what the
    voice node heard last, None before that. ``control`` is who drives, ``answers`` is false while
    the gates are not heard, ``stop_taken`` true once they have said that the stop is in force.
    ``advice`` says what keeps the source that drives from doing so, and the remedy; '' for nothing.
    ``dead_man`` is false while the dead-man buttons of pads need not be held. ``asked`` is what the
    mux commands now [m/s, rad/s], ``waits_for`` its word on what it waits for, ``pushed`` whether
    the stick of the source that drives is held.
    """

    ros: str = ROS_STARTING
    sources: Tuple[Tuple[str, str], ...] = ()
    devices: Tuple[DeviceView, ...] = ()
    mode: Optional[str] = None
    stop_all: bool = False
    stop_note: str = ''
    limits: Tuple[float, float] = (0.5, 1.5)
    together: bool = False
    brake: bool = False
    pace: str = ''
    slowed: bool = False
    status: str = 'starting'
    status_level: str = 'calm'
    robots: Tuple[RobotView, ...] = ()
    camera_bits_per_s: float = 0.0
    advice: str = ''
    dead_man: bool = True
    heard: Optional[HeardView] = None
    control: ControlView = ControlView()
    answers: bool = True
    stop_taken: bool = True
    asked: Tuple[float, float] = (0.0, 0.0)
    waits_for: str = ''
    pushed: bool = False

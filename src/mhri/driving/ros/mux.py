# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mux node: the ROS interface of :class:`mhri.driving.drive.Drive`, which has all rules.

It is the only node that sends commands to robots. Interfaces (global names; SI units):

- subscribes to each source's topic (``sensor_msgs/Joy`` or ``geometry_msgs/Twist``),
  ``/mux_in/mode_select`` (``mhri/ControlMode``), ``/robot_controller/robot_select``
  (``mhri/RobotSelect``: the operator's wish), ``/mux_in/task`` (``mhri/TeamTwist``) and
  ``/mux_in/accessory`` (``mhri/Accessory``); ``/tf`` and ``/tf_static`` while the obstacle brake is
  requested
- publishes ``/mux/state`` (``mhri/DriveState``, latched), for each robot the topics of
  :class:`mhri.driving.ros.robot_line.RobotLine`, and ``/panel_in/request`` (``mhri/PanelRequest``:
  requests to the panel by the pad's buttons); mirrors for recorders and other programs, which no
  robot obeys: ``/robot_controller/twist`` (``geometry_msgs/Twist``: the operator's command),
  ``/robot_controller/stop_all`` (``std_msgs/Bool``, latched) and ``/mux/mode``
  (``mhri/ControlMode``, latched)
- serves ``/mux/set_stop_all`` (``std_srvs/SetBool``), ``/mux/stop_robots`` (``mhri/StopRobots``),
  ``/mux/take_control`` (``std_srvs/Trigger``) and ``/mux/set_motor_power`` (``std_srvs/SetBool``:
  false cuts the motor power of every robot that supports it)
- parameters: ``~config`` (path of the sources' YAML, default ``resource/mux.yaml``), ``~enabling``,
  ``~automatic_switching`` and ``~dead_man`` (default: the values in that file), ``~journal`` (path
  of the journal to write, see :mod:`mhri.driving.journal`; default: none), ``/mux/sources``
  (written: list of {name, label}), ``/mux/kept`` (written: the state for the next mux as JSON, see
  :meth:`mhri.driving.drive.Drive.kept`; '' for none); file: ``$ROS_HOME/mhri/stop`` (a stop-all in
  force)

Everything runs on ROS threads and one thread of the mux; a single lock guards all of it.
"""
from functools import partial
import os
import threading
import time
import traceback
import uuid

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.base.limits import ZERO
from mhri.base.names import names_in
from mhri.base.reasons import SOURCE
from mhri.devices.profile import (
    is_pressed, JoyRefused, MARK, NEXT_ROBOT, PREVIOUS_ROBOT, read_twist, SELECT_ALL)
from mhri.devices.ros.device_profiles import DeviceProfiles
from mhri.driving.arbiter import DRIVING, REPEAT_HZ, ZEROS_S
from mhri.driving.drive import Drive
from mhri.driving.operator_lease import Caller, LEASED, MAX_ROBOTS
from mhri.driving.pad_accessories import PadAccessories
from mhri.driving.ros.drive_speaker import DriveSpeaker
from mhri.driving.ros.mux_advice import Advice
from mhri.driving.ros.mux_diagnostics import MuxDiagnostics
from mhri.driving.ros.mux_takeover import keep, recalled, SOURCES_PARAMETER
from mhri.driving.ros.robot_lines import RobotLines
from mhri.driving.ros.source_topic import LONGEST_TEXT, SourceTopic
from mhri.driving.ros.suspender import Suspender
from mhri.driving.ros.wish_topic import wished_settings, WishTopic
from mhri.driving.sources import TWIST
from mhri.driving.task_relay import MAX_ROBOTS as MAX_ON_TASKS
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import caller_of, others_only
from mhri.graph.ros.service_owner import RejectedSenders, STOP_SERVICE, TAKE_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.msg import Accessory, ControlMode, DriveSettings, DriveState, PanelRequest, TeamTwist
from mhri.robots.ros.convert import packed_twist, to_twist
from mhri.srv import StopRobots, StopRobotsResponse

# How often the master is called, and the timeout of a call [s]; a hanging master counts as lost
# after at most the sum of both.
MASTER_PERIOD_S, MASTER_PATIENCE_S = 0.25, 1.1
# How often a silent input node is asked again to resume [s].
ASK_S = 0.5
# How long a refused node is reported [s].
REFUSED_S = 30.0
# A node that takes control has this long to connect as a publisher of the selection [s].
CONNECT_S, LOOK_S = 1.0, 0.05
# Other publishers of these topics are reported; no robot obeys them.
MIRRORS = TWIST_MIRROR, STOP_MIRROR = '/robot_controller/twist', '/robot_controller/stop_all'
# The node of the tasks; the most values of an accessory that are read.
TASKS, MAX_VALUES = '/mhri_tasks', 4
# {action of a button: request to the panel}
_REQUESTS = {NEXT_ROBOT: PanelRequest.NEXT, PREVIOUS_ROBOT: PanelRequest.PREVIOUS,
             SELECT_ALL: PanelRequest.SELECT_ALL, MARK: PanelRequest.MARK}


def boot_s():
    """Return monotonic seconds that also count while the computer is suspended."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


class Mux:
    """The node around one :class:`Drive`.

    :param config: :class:`mhri.driving.sources.MuxConfig`
    :param types: {name: RobotType}
    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the previous drive
    :param stop_file: :class:`mhri.driving.io.stop_file.StopFile`
    :param undertaker: :class:`mhri.graph.ros.undertaker.Undertaker`
    :param journal: :class:`mhri.driving.ros.journal_writer.JournalWriter`, None to write none
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, config, types, memory, stop_file, undertaker, journal=None, clock=boot_s):
        self._clock, self._memory, self._stop_file = clock, memory, stop_file
        self._undertaker = undertaker
        self._changed = threading.Condition(threading.RLock())
        self._strangers = RejectedSenders(clock)
        self._topics = {source.name: SourceTopic(source, clock) for source in config.sources}
        self._pads = {source.name: PadAccessories() for source in config.sources}
        self._run_id, self._journal = uuid.uuid4().hex[:12], journal
        kept = recalled(memory, stop_file, lambda found: Drive(config, clock(), found).kept())
        self._drive = drive = (partial(journal.drive, self._run_id) if journal else Drive)(
            config, clock(), kept, self._strangers.refuse,
            lambda name: self._topics[name].connected())
        self._lines = RobotLines(drive, self._changed, types, memory, clock, self._changed.notify,
                                 self._on_foreign_stop, self._strangers.refuse, undertaker,
                                 self._run_id, self._safely, *([journal.watch] if journal else []))
        self._told = None, None, ZERO, None
        self._kept = None
        self._advice_said = '', ''
        self._due = self._asked_at = 0.0
        self._closing = False
        self._twist = NonBlockingPublisher(TWIST_MIRROR, Twist)
        self._mode = rospy.Publisher('/mux/mode', ControlMode, queue_size=10, latch=True)
        self._stop = rospy.Publisher(STOP_MIRROR, Bool, queue_size=10, latch=True)
        self._ask = rospy.Publisher('/panel_in/request', PanelRequest, queue_size=10,
                                    tcp_nodelay=True)
        services = {source.name: source.suspend_service for source in config.sources
                    if source.suspend_service}
        # Nodes that may change the mode without being in control: "use pedal".
        self._inputs = frozenset(service.rsplit('/', 1)[0] for service in services.values())
        self._suspender = Suspender(services.values(), awake=[
            service for name, service in services.items()
            if config.automatic_switching or name == config.enabling])
        self._profiles = DeviceProfiles(config.dead_man)
        self._keeper, self._keeping = Worker('stop_memory'), threading.Lock()
        self._watch = MasterWatch(
            on_lost=lambda reason: self._decide(drive.on_hold, 'master'),
            parameters={SOURCES_PARAMETER: [
                {'name': source.name, 'label': source.label,
                 'suspend_service': source.suspend_service or ''} for source in config.sources]},
            period_s=MASTER_PERIOD_S, patience_s=MASTER_PATIENCE_S)
        self._config = config
        self._wish = WishTopic(self._safely(self._on_wish), self._safely(self._on_gone))
        self._advice = Advice(self._facts, self._on_advice)
        self._speaker = DriveSpeaker(self._message, lambda: self._lines.moving)
        self._diagnostics = MuxDiagnostics(
            drive, self._changed, clock, config, self._topics,
            {'suspend': self._suspender.state, 'strangers': self._strangers.words})

    def start(self):
        """Start publishing, subscribing and serving."""
        rospy.on_shutdown(self.close)
        self._watch.start()
        self._keeper.start()
        stop = self._drive.on_stop
        for name, kind, *serve in ((STOP_SERVICE, SetBool, self._on_stop_all, stop),
                                   ('/mux/stop_robots', StopRobots, self._on_stop_robots, stop),
                                   (TAKE_SERVICE, Trigger, self._on_take),
                                   ('/mux/set_motor_power', SetBool, self._on_motor_power)):
            rospy.Service(name, kind, self._safely(*serve))
        for mirror in MIRRORS:
            others_only(mirror)
        for begin in (
                partial(rospy.Subscriber, '/mux_in/mode_select', ControlMode,
                        self._safely(self._on_mode), queue_size=10),
                partial(rospy.Subscriber, '/mux_in/task', TeamTwist, self._safely(self._on_task),
                        queue_size=1, tcp_nodelay=True),
                partial(rospy.Subscriber, '/mux_in/accessory', Accessory,
                        self._safely(self._on_accessory), queue_size=10, tcp_nodelay=True),
                *(partial(rospy.Subscriber, mirror, rospy.AnyMsg, self._safely(self._on_stranger),
                          mirror, queue_size=1) for mirror in MIRRORS),
                self._lines.start, self._wish.start, self._advice.start,
                *(partial(topic.open, self._safely(self._on_source))
                  for topic in self._topics.values())):
            # Registering after a newer mux has taken the name would end it as well (ros_comm#2018).
            if not self._closing:
                begin()
        self._suspender.activate(self._drive.source.suspend_service)
        threading.Thread(target=self._run, name='drive', daemon=True).start()
        self._diagnostics.start()
        self._speaker.start()
        with self._changed:
            self._mode.publish(source=self._drive.mode)
            self._stop.publish(data=self._drive.stop_all)

    def _decide(self, event, *facts):
        """Pass an event to the drive, send its orders, and publish what has changed."""
        with self._changed:
            before = self._drive.changes
            self._carry_out(event(*facts, self._clock()))
            self._settle(before)

    def _carry_out(self, orders):
        """Send what the drive orders, and mirror the command; call with the lock held."""
        self._lines.carry_out(orders)
        said, self._drive.said = self._drive.said, None
        if said is not None and not self._closing:
            self._mirror(said)

    def _mirror(self, command):
        """Publish the operator's command for recorders and other programs."""
        self._twist.publish_packed(packed_twist(*command),
                                   urgent=command.is_zero())

    def _settle(self, before):
        """Apply the changes since ``before``, and wake the loop if it is due earlier."""
        now, drive = self._clock(), self._drive
        told, self._told = self._told, (drive.waits_for(now), drive.arbiter.pushed(now),
                                        drive.command.is_zero(), drive.stop_all)
        changed = drive.changes != before
        if changed:
            self._remember()
            self._lines.follow(now)
        if drive.stop_all != told[3]:
            self._undertaker.stop(drive.stop_all)
            self._stop.publish(data=drive.stop_all)
            self._lines.on_stop(drive.stop_all)
            self._keeper.do(self._keep_stop)
        if changed or self._told != told:
            self._speaker.on_change()
        if drive.next_tick(now) < self._due:
            self._changed.notify()

    def _remember(self):
        """Store the state for the next drive, if it has changed."""
        before, self._kept = self._kept, self._drive.kept()
        if self._kept != before:
            keep(self._memory, self._watch, self._kept)

    # The operator's input.

    def _on_source(self, message, topic):
        """Handle a message of a source, on that source's thread."""
        name, switched, problem = topic.source.name, False, ''
        device, frame, lost = topic.device_of(message)
        drive = self._drive
        try:
            read, pressed, enables, pad = self._read(topic.source, message, device, frame)
            with self._changed:
                now, before, mode = self._clock(), drive.changes, drive.mode
                self._lines.look_at_listeners(now)
                caller = caller_of(message)
                driving = drive.arbiter.state == DRIVING
                orders, refusal = drive.on_source(name, caller, device, read, now, pressed,
                                                  enables, lost)
                self._carry_out(orders)
                topic.on_heard(caller, drive.owner(name))
                # A further command while driving changes nothing that has to be published.
                if not (driving and drive.arbiter.state == DRIVING) or drive.changes != before:
                    self._settle(before)
                if pad is not None:
                    problem = self._use(pad, name == drive.mode and not refusal
                                        and caller == drive.owner(name))
                while drive.asked:
                    self._ask.publish(action=_REQUESTS[drive.asked.pop()])
                switched = drive.mode != mode
                if switched:
                    self._tell_mode()
        except JoyRefused as error:
            refusal = str(error)
        topic.refuse(refusal)
        # Log without the lock: a log call must not delay a zero.
        if refusal or problem:
            rospy.logwarn_throttle(1.0, 'refused from {}: {}'.format(name, refusal or problem))
        if switched:
            rospy.loginfo('driving with %s, which was touched', name)

    def _use(self, pad, counts):
        """Use accessories as a pad asks, with the lock held; return what is refused, or ''."""
        before, now = self._drive.changes, self._clock()
        orders, problem = pad.act(self._drive, counts, now)
        self._carry_out(orders)
        self._settle(before)
        return problem

    def _read(self, source, message, device, frame):
        """Return (function that reads the command, pressed actions, whether button 0 is down, what
        its bindings do or None).

        :raises JoyRefused: its profile is unusable
        """
        if source.kind == TWIST:
            vectors = [(vector.x, vector.y, vector.z)
                       for vector in (message.linear, message.angular)]
            return partial(read_twist, *vectors), frozenset(), False, None
        profile = self._profiles.of(source.name, frame) or source.profile
        axes, buttons, pad = message.axes, message.buttons, None
        if profile.bindings:
            pad = self._pads[source.name]
            axes, pressed = pad.read(profile, device, axes, buttons, self._clock())
        else:
            pressed = profile.pressed(buttons)
        return partial(profile.read, axes, buttons), pressed, is_pressed(buttons, 0), pad

    def _on_task(self, message):
        """Handle the commands of robots on a task."""
        # One more than allowed is enough to detect too many.
        robots = message.robots[:MAX_ON_TASKS + 1]
        twists = [(twist.linear.x, twist.linear.y, twist.linear.z,
                   twist.angular.x, twist.angular.y, twist.angular.z)
                  for twist in message.twists[:MAX_ON_TASKS + 1]]
        with self._changed:
            now = self._clock()
            orders, problem = self._drive.on_task(robots, twists, now)
            self._lines.carry_out(orders)
            self._lines.on_task(caller_of(message), robots, now)
        if problem:
            rospy.logwarn_throttle(1.0, 'refused from /mux_in/task: {}'.format(problem))

    def _on_accessory(self, message):
        """Handle an action of an accessory."""
        caller, names = caller_of(message), list(dict.fromkeys(names_in(message.robots)))
        problem = '' if len(names) == len(message.robots) else 'not the name of a robot'
        with self._changed:
            if not problem:
                before = self._drive.changes
                orders, problem = self._drive.on_accessory(
                    caller, names, message.key[:LONGEST_TEXT], message.choice[:LONGEST_TEXT],
                    tuple(message.value[:MAX_VALUES]), self._clock(), caller == TASKS)
                self._carry_out(orders)
                self._settle(before)
        if problem:
            rospy.logwarn_throttle(1.0, 'refused from {}: {}'.format(caller, problem))

    def _on_stranger(self, message, mirror):
        """Report another publisher of a mirror; it has no other effect."""
        self._strangers.refuse(caller_of(message), mirror)

    # Who is in control, and how.

    def _on_wish(self, caller, message):
        """Handle the operator's wish."""
        names = tuple(dict.fromkeys(names_in(message.robots)))
        with self._changed:
            before, mode, wishes = self._drive.changes, self._drive.mode, self._drive.wishes
            orders, problem = self._drive.on_wish(
                caller, names, wished_settings(message), message.mode[:LONGEST_TEXT], self._clock())
            self._carry_out(orders)
            if self._drive.wishes > wishes and self._drive.changes > before:
                self._strangers.forget(caller.name)
            self._settle(before)
            if self._drive.mode != mode:
                self._tell_mode()
        if problem:
            rospy.logwarn_throttle(1.0, 'refused from {}: {}'.format(caller.name, problem))
        if len(message.robots) > MAX_ROBOTS:
            rospy.logwarn_throttle(10.0, '{} selects {} names: no more than {} robots count'.format(
                caller.name, len(message.robots), MAX_ROBOTS))

    def _on_gone(self, caller):
        """Handle the loss of a publisher of the wish."""
        self._strangers.forget(caller.name)
        self._decide(self._drive.on_gone, caller)

    def _on_mode(self, message):
        """Handle a request for another source."""
        caller, wanted = caller_of(message), message.source[:LONGEST_TEXT]
        with self._changed:
            before, mode = self._drive.changes, self._drive.mode
            orders, problem = self._drive.on_mode(caller, wanted, self._clock(),
                                                  caller in self._inputs)
            self._carry_out(orders)
            self._settle(before)
            changed = self._drive.mode != mode
            self._tell_mode(changed)
        if problem:
            rospy.logwarn_throttle(1.0, '{}: mode {!r}: {}'.format(caller, wanted, problem))
        elif changed:
            rospy.loginfo('driving with %s', wanted)

    def _tell_mode(self, changed=True):
        """Publish a new mode, and wake and suspend the input nodes (with the lock held)."""
        self._suspender.activate(self._drive.source.suspend_service)
        if changed:
            self._mode.publish(source=self._drive.mode)
            self._profiles.forget()

    def _on_take(self, request):
        """Put the caller in control; every robot gets a zero and waits for neutral."""
        name = caller_of(request)
        caller = self._connected(name)
        if caller is None:
            return TriggerResponse(False, '{} publishes no selection of robots: publish '
                                   '/robot_controller/robot_select, then ask again'.format(name))
        self._strangers.clear()
        self._decide(self._drive.on_take, caller)
        rospy.loginfo('%s has taken control', name)
        return TriggerResponse(True, name + ' is in control now: centre the stick to drive')

    def _connected(self, name):
        """Return the :class:`Caller` of that name once it publishes the selection, else None."""
        until = time.monotonic() + CONNECT_S
        while True:
            found = [caller for caller in self._wish.there() if caller.name == name]
            if found or time.monotonic() >= until:
                return found[-1] if found else None
            time.sleep(LOOK_S)

    # Stops.

    def _on_stop_all(self, request):
        """Serve ``/mux/set_stop_all``."""
        problem = ''
        if request.data:
            self._undertaker.stop(True)
        with self._changed:
            before, now = self._drive.changes, self._clock()
            if request.data:
                orders = self._drive.on_stop(now)
            else:
                orders, problem = self._drive.on_release(now)
            self._carry_out(orders)
            self._settle(before)
        self._keep_stop()
        return SetBoolResponse(not problem, problem or (
            'everything is stopped' if request.data else 'released: centre the stick'))

    def _keep_stop(self):
        """Store stop-all for the next mux, before answering."""
        with self._keeping:
            stopped = self._drive.stop_all
            try:
                self._stop_file.keep(stopped)
            except OSError as error:
                rospy.logwarn('stop-all is %s, but after a restart of everything nobody will know: '
                              '%s', stopped, error)

    def _on_foreign_stop(self, name):
        """Stop everything because a guard holds a stop that was not released since."""
        if not self._drive.stop_all:
            rospy.logwarn('%s holds a stop of before this start: stop-all is in force until it is '
                          'released', name)
            self._decide(self._drive.on_stop)

    def _on_stop_robots(self, request):
        """Serve ``/mux/stop_robots``."""
        names = list(dict.fromkeys(names_in(request.robots)))[:MAX_ROBOTS]
        self._decide(self._drive.on_stop_robots, names)
        with self._changed:
            kept = self._drive.alone
            unknown = [name for name in names if name not in self._drive.robots]
        if not names or not kept.issuperset(names):
            return StopRobotsResponse(False, 'name the robots to stop, at most {}'.format(
                MAX_ROBOTS))
        words = 'stopped: ' + ', '.join(names)
        return StopRobotsResponse(not unknown, words + (
            '; not known here, and stopped as soon as it is: ' + ', '.join(unknown)
            if unknown else ''))

    def _on_motor_power(self, request):
        """Cut the power of all motors at any time; restore it unless a stop is in force."""
        with self._changed:
            if request.data and self._drive.stop_all:
                return SetBoolResponse(False, 'release the stop first: that restores the power')
            without = self._lines.set_power(request.data)
            self._speaker.on_change()
        words = 'motor power is being ' + ('restored' if request.data else 'cut')
        return SetBoolResponse(True, words + (
            '; not for {}: it cannot be cut there'.format(', '.join(without)) if without else ''))

    # The published state.

    def _facts(self):
        """Return (the active source's topic, why the operator cannot drive)."""
        with self._changed:
            return self._topics[self._drive.mode], self._drive.waits_for(self._clock())

    def _on_advice(self, code, about):
        self._advice_said = code, about
        self._speaker.on_change()

    def _message(self):
        """Return the current ``mhri/DriveState``."""
        with self._changed:
            drive, now = self._drive, self._clock()
            lease, holder = drive.lease, drive.lease.holder or Caller('')
            command = drive.command
            message = DriveState(
                run=self._run_id, mode=drive.mode, waits_for=drive.waits_for(now),
                advice=self._advice_said[0], advice_about=self._advice_said[1],
                stop_all=drive.stop_all, dead_man=self._config.dead_man,
                pushed=drive.arbiter.pushed(now), enabling=self._config.enabling or '',
                enabled=drive.arbiter.enabled(now), operator=holder.name, computer=holder.computer,
                leased=lease.state == LEASED, wishes=drive.wishes,
                settings=DriveSettings(*drive.settings),
                command=to_twist(*command), share=drive.share,
                refused=self._strangers.words(REFUSED_S))
            if lease.since is not None:
                message.since = rospy.Time.from_sec(max(0.0, time.time() - (now - lease.since)))
        message.robots = self._lines.messages()
        return message

    # Time.

    def _run(self):
        """Run the drive's loop; if it fails, end the process."""
        try:
            self._loop()
        except Exception:  # in doubt, stop: the standby process sends zeros at once
            traceback.print_exc()
            os._exit(1)

    def _safely(self, act, event=None):
        """Return a ROS callback; if it fails, driven robots get a zero and wait for neutral.

        :param event: event of the drive in this case; None ends the operator's command
        """
        def call(*args):
            try:
                return act(*args)
            except Exception:
                try:
                    self._decide(event or partial(self._drive.on_hold, 'failed'))
                except Exception:  # even a zero fails, e.g. without memory
                    os._exit(1)
                raise  # rospy logs it with its traceback

        return call

    def _loop(self):
        """Send due commands: repetitions, the zero of a silent source, later zeros."""
        with self._changed:
            while not self._closing:
                now, before = self._clock(), self._drive.changes
                self._carry_out(self._drive.on_undertaker(self._undertaker.alive(), now))
                self._ask_silent(now)
                self._carry_out(self._drive.tick(now, self._wish.there()))
                if self._lines.tick(now):
                    self._speaker.on_change()
                self._settle(before)
                self._remember()
                later = self._lines.next_tick()
                self._due = min(self._drive.next_tick(now), later if later else now + LOOK_S)
                # After everything else: a loop that fails in its first turn must not count as
                # alive.
                self._undertaker.beat()
                self._changed.wait(max(0.0, self._due - self._clock()))

    def _ask_silent(self, now):
        """Handle sources that have lost their publisher, and ask a silent input node again."""
        for name, topic in self._topics.items():
            if topic.has_gone():
                self._carry_out(self._drive.on_lost(name, 'lost', now))
        if now - self._asked_at >= ASK_S:
            self._asked_at = now
            if self._drive.waits_for(now) == SOURCE:
                self._suspender.resume_again()

    def close(self):
        """Stop the robots: send a zero now, more for half a second, then nothing."""
        with self._changed:
            if self._closing:
                return
            self._closing = True
            self._lines.carry_out(self._drive.close(self._clock()))
            self._mirror(ZERO)
            self._lines.leave()
            self._changed.notify()
        # Every robot has its zero.
        self._undertaker.end()
        for part in (self._diagnostics, self._keeper, self._watch, self._advice):
            part.stop()
        for _ in range(int(ZEROS_S * REPEAT_HZ)):
            time.sleep(1.0 / REPEAT_HZ)
            if self._undertaker.orphaned():
                # The next drive sends the next zeros: two nodes of one name would end each other.
                os._exit(1)
            with self._changed:
                self._lines.carry_out(self._drive.tick(self._clock()))
                self._mirror(ZERO)
        if self._journal:
            self._journal.stop()

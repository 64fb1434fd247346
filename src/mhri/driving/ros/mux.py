# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mux node: ROS around :class:`mhri.driving.arbiter.Arbiter`, which holds every rule.

Interfaces (all global names; units SI):

- subscribes to each source's topic (``sensor_msgs/Joy`` or ``geometry_msgs/Twist``),
  ``/mux_in/mode_select`` (``mhri/ControlMode``), ``/robot_controller/robot_select``
  (``mhri/RobotSelect``), ``/gates/state`` (``mhri/GatesState``: the limits in force, and who may
  choose the mode) and ``/mux_in/task`` (``mhri/TeamTwist``)
- publishes ``/robot_controller/twist`` (``geometry_msgs/Twist``, on events and at 20 Hz),
  ``/robot_controller/stop_all`` (``std_msgs/Bool``, latched, and at 2 Hz: the mux's sign of life),
  ``/robot_controller/task_twist`` (``mhri/TeamTwist``), ``/mux/mode`` (``mhri/ControlMode``,
  latched), ``/mux/speed_limit`` (``geometry_msgs/Twist``, latched), ``/mux/waits_for``
  (``std_msgs/String``, latched: '' or one of release, source, neutral, enabling, dead_man),
  ``/mux/pushed`` (``std_msgs/Bool``, latched: whether the active source's stick is held),
  ``/mux/asked`` (``geometry_msgs/Twist``: the command as screens show it, at most 20 Hz),
  ``/mux/advice`` (``std_msgs/String``, latched: a sentence, or ''), ``/mux/dead_man``
  (``std_msgs/Bool``, latched: whether dead-man buttons must be held) and ``/panel_in/request``
  (``mhri/PanelRequest``: what the pad's buttons ask of the panel)
- serves ``/mux/set_stop_all`` (``std_srvs/SetBool``)
- parameters: ``~config`` (path of the sources' YAML, default ``resource/mux.yaml``), ``~enabling``,
  ``~automatic_switching`` and ``~dead_man`` (default: what that file says),
  ``/mux/sources`` (written: list of {name, label}), ``/mux/stop_all`` (written, and read at start,
  so that a mux that crashed while everything was stopped comes back stopped)
"""
from functools import partial
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, SetBoolResponse

from mhri.base.limits import ZERO
from mhri.base.pulse import Pulse
from mhri.devices.profile import (
    is_pressed, JoyRefused, MARK, NEXT_ROBOT, PREVIOUS_ROBOT, read_twist, SELECT_ALL, STOP_ALL)
from mhri.devices.ros.device_profiles import DeviceProfiles
from mhri.driving.arbiter import Arbiter, DRIVING, READY, REPEAT_HZ, ZEROS_S
from mhri.driving.buttons import ButtonEdges
from mhri.driving.ros.mux_advice import Advice
from mhri.driving.ros.mux_diagnostics import MuxDiagnostics
from mhri.driving.ros.mux_gates import GatesWatch
from mhri.driving.ros.source_topic import LONGEST_TEXT, SourceTopic
from mhri.driving.ros.suspender import Suspender
from mhri.driving.ros.task_mux import TaskMux
from mhri.driving.ros.wish_topic import wished_settings, WishTopic
from mhri.driving.settings import Settings, settings_problem
from mhri.driving.sources import TWIST
from mhri.graph.ros.in_force import STOP_SERVICE, Strangers
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.rospy_inside import caller_of
from mhri.graph.ros.worker import Worker
from mhri.msg import ControlMode, PanelRequest
from mhri.robots.ros.convert import packed_twist, to_twist

# How often the mux repeats its stop-all and asks the master, and how long it waits for an answer
# [s]; a hanging master is lost after at most the second and the third together.
BEAT_S = 0.5
MASTER_PERIOD_S = 0.25
MASTER_PATIENCE_S = 1.1
# The loop runs at least this often: only then can it know that it was asleep.
LOOP_S = 0.1
STOP_PARAMETER = '/mux/stop_all'
SOURCES_PARAMETER = '/mux/sources'
# What a button asks of the panel, as in its messages.
_REQUESTS = {NEXT_ROBOT: PanelRequest.NEXT, PREVIOUS_ROBOT: PanelRequest.PREVIOUS,
             SELECT_ALL: PanelRequest.SELECT_ALL, MARK: PanelRequest.MARK}


class Mux:
    """The only publisher of ``/robot_controller/twist``.

    :param config: :class:`mhri.driving.sources.MuxConfig`
    :param beat: called twice a second while the mux works
    :param clock: function returning seconds that never go back
    """

    def __init__(self, config, beat=lambda: None, clock=time.monotonic):
        self._clock, self._beat = clock, beat
        self._arbiter = Arbiter(config, clock())
        self._pulse = Pulse(clock())
        self._next_beat = self._due = 0.0
        self._changed = threading.Condition(threading.RLock())
        # What it waits for, and whether the stick is held, as it was said last.
        self._said = None, None
        self._sent = self._told = ZERO  # the last command, and what the screens were told
        self._driving = self._closing = False
        self._twist = PromptPublisher('/robot_controller/twist', Twist)
        self._mode = rospy.Publisher('/mux/mode', ControlMode, queue_size=10, latch=True)
        self._stop = rospy.Publisher('/robot_controller/stop_all', Bool, queue_size=10, latch=True)
        self._limit = rospy.Publisher('/mux/speed_limit', Twist, queue_size=10, latch=True)
        self._waits = rospy.Publisher('/mux/waits_for', String, queue_size=10, latch=True)
        self._pushed = rospy.Publisher('/mux/pushed', Bool, queue_size=1, latch=True)
        # Not the command itself: a screen that hears that would keep this processor from the gates.
        self._asked = rospy.Publisher('/mux/asked', Twist, queue_size=1)
        self._dead_man = rospy.Publisher('/mux/dead_man', Bool, queue_size=1, latch=True)
        self._ask = rospy.Publisher('/panel_in/request', PanelRequest, queue_size=10,
                                    tcp_nodelay=True)
        services = {source.name: source.suspend_service for source in config.sources
                    if source.suspend_service}
        # Nodes that may choose the mode though they are not in control: "use pedal".
        self._inputs = frozenset(service.rsplit('/', 1)[0] for service in services.values())
        self._suspender = Suspender(services.values(), awake=[
            service for name, service in services.items()
            if config.automatic_switching or name == config.enabling])
        self._profiles = DeviceProfiles(config.dead_man)
        self._buttons = ButtonEdges()
        self._memory = Worker('stop_memory')
        self._watch = MasterWatch(
            on_lost=lambda reason: self._hold('master'),
            parameters={SOURCES_PARAMETER: [
                {'name': source.name, 'label': source.label,
                 'suspend_service': source.suspend_service or ''} for source in config.sources]},
            period_s=MASTER_PERIOD_S, patience_s=MASTER_PATIENCE_S)
        self._config = config
        self._strangers = strangers = Strangers(clock)
        self._wish = WishTopic(self._on_wish)
        # The last mode that an operator wished, and who that was.
        self._wished = None
        self._topics = {source.name: SourceTopic(source, strangers, clock)
                        for source in config.sources}
        self._remembering = threading.Lock()
        self._gates = GatesWatch(self._on_gates, lambda: self._arbiter.stop_all,
                                 lambda: self._hold('gates'), strangers, clock)
        self._tasks = TaskMux(self._changed, self._task_allowed)
        self._advice = Advice(self._facts)
        self._diagnostics = MuxDiagnostics(
            self._arbiter, self._changed, clock, config, self._topics,
            {'gates': self._gates.words, 'suspend': self._suspender.state,
             'tasks': self._tasks.counts, 'strangers': strangers.words})

    def start(self, stopped):
        """Start publishing, subscribing and serving.

        :param stopped: start with stop-all in force
        """
        rospy.on_shutdown(self.close)
        if stopped:
            self._arbiter.engage_stop_all(self._clock())
        self._watch.start()
        self._memory.start()
        rospy.Service(STOP_SERVICE, SetBool, self._on_stop_all)
        for begin in (
                partial(rospy.Subscriber, '/mux_in/mode_select', ControlMode, self._on_mode,
                        queue_size=10),
                self._wish.start, self._gates.start, self._tasks.start, self._advice.start,
                *(partial(topic.open, self._on_source) for topic in self._topics.values())):
            # Registering after a newer mux has taken the name would end it as well (ros_comm#2018).
            if not self._closing:
                begin()
        self._suspender.activate(self._arbiter.source.suspend_service)
        threading.Thread(target=self._run, name='mux_timer', daemon=True).start()
        self._diagnostics.start()
        with self._changed:
            self._announce()

    def _announce(self):
        """Publish the latched state anew."""
        self._mode.publish(source=self._arbiter.mode)
        self._stop.publish(data=self._arbiter.stop_all)
        self._dead_man.publish(data=self._config.dead_man)
        self._limit.publish(to_twist(*self._arbiter.limits))

    def _send(self, velocity):
        """Publish what a rule returned; call with the lock held.

        Publishing inside the lock keeps a zero behind the command it ends. What else has changed is
        told, but for one command after another: the gates may be waiting for this processor.
        """
        if self._closing:
            return
        if velocity is not None:
            self._sent = velocity
            self._twist.publish_packed(packed_twist(
                velocity.linear_mps, velocity.angular_rad_s), urgent=velocity.is_zero())
        was_driving, self._driving = self._driving, self._arbiter.state == DRIVING
        if not (was_driving and self._driving):
            self._tell(self._clock())

    def _tell(self, now):
        """Publish what screens show, and let the timer look when it is due (lock held)."""
        said = self._said
        self._said = self._arbiter.waits_for(now), self._arbiter.pushed(now)
        for topic, word, before in zip((self._waits, self._pushed), self._said, said):
            if word != before:
                topic.publish(data=word)
        told, self._told = self._told, self._sent
        if not (told.is_zero() and self._sent.is_zero()):
            self._asked.publish(to_twist(*self._sent))
        if self._arbiter.next_tick(now) < self._due:
            self._changed.notify()

    def _awake(self, now):
        """Tell whether a message heard now is new (with the lock held).

        After the mux was asleep, it may have waited in a socket meanwhile.
        """
        if self._pulse.slept(now):
            self._send(self._arbiter.on_hung(now))
        return not self._pulse.deaf(now)

    def _on_source(self, message, topic):
        """Guard of the thread of one source."""
        name, refusal = topic.source.name, ''
        device, frame, lost = topic.device_of(message)
        try:
            read, pressed, enables = self._read(topic.source, message, frame)
            with self._changed:
                before, now = self._arbiter.mode, self._clock()
                counts = self._awake(now) and topic.admits(message)
                self._press(name, device, pressed, counts)
                if counts:
                    self._send(self._arbiter.on_message(name, device, now, read, enables))
                    if lost and name == self._arbiter.mode:
                        self._send(self._arbiter.on_hold('lost', now))
                switched = self._arbiter.mode != before
                if switched:
                    self._tell_mode(True)
        except JoyRefused as error:
            refusal, switched = error, False
            # Not while the lock is held: a log call must not delay a zero.
            rospy.logwarn_throttle(1.0, 'refused from {}: {}'.format(name, refusal))
        topic.refuse(refusal)
        if switched:
            rospy.loginfo('driving with %s, which was touched', name)

    def _read(self, source, message, frame):
        """Return (function that reads what it asks for, pressed actions, first button is down).

        :raises JoyRefused: its profile is unusable
        """
        if source.kind == TWIST:
            vectors = [(vector.x, vector.y, vector.z)
                       for vector in (message.linear, message.angular)]
            return partial(read_twist, *vectors), frozenset(), False
        profile = self._profiles.of(source.name, frame) or source.profile
        buttons = message.buttons
        return (partial(profile.read, message.axes, buttons), profile.pressed(buttons),
                is_pressed(buttons, 0))

    def _press(self, name, device, pressed, counts):
        """Act on newly pressed buttons (with the lock held).

        A stop counts from every source, even one that is not listened to; all else only from the
        source that drives.
        """
        newly = self._buttons.newly(name, device, pressed)
        if STOP_ALL in newly:
            self._engage_stop()
            self._memory.do(self._remember_stop)
        if counts and name == self._arbiter.mode:
            for action in newly - {STOP_ALL}:
                self._ask.publish(action=_REQUESTS[action])

    def _engage_stop(self):
        """Stop everything and publish it (with the lock held)."""
        self._send(self._arbiter.engage_stop_all(self._clock()))
        self._stop.publish(data=True)

    def _on_gates(self, must_stop, operator, settings):
        """Take in the state of the gates."""
        with self._changed:
            limits = settings.linear_mps, settings.angular_rad_s
            # Zero: gates that have none.
            if limits != self._arbiter.limits and not settings_problem([Settings(*limits)]):
                self._send(self._arbiter.set_limits(*limits, self._clock()))
                self._limit.publish(to_twist(*limits))
            if must_stop:
                self._engage_stop()
            for topic in self._topics.values() if operator else ():
                if topic.ownership.take(operator, topic.connected()):
                    self._send(self._arbiter.on_lost(topic.source.name, 'operator', self._clock()))
        if must_stop:
            self._memory.do(self._remember_stop)
            rospy.logwarn('the gates hold a stop that this mux did not know of: it is in force')

    def _task_allowed(self):
        """Return (stopped, enabled, message is new) for the robots on a task."""
        now = self._clock()
        self._awake(now)
        return (self._closing or self._arbiter.stop_all, self._arbiter.enabled(now),
                self._pulse.is_new(now))

    def _facts(self):
        """Return (the active source's topic, what the mux waits for)."""
        with self._changed:
            return (self._topics[self._arbiter.mode], self._arbiter.waits_for(self._clock()))

    def _on_wish(self, caller, message):
        """Take in the operator's wish: who joins, and the mode where that is another than before.

        From others it is nothing: two operators taking turns would look like robots that join,
        twice a second.
        """
        if not self._gates.in_control(caller.name) or wished_settings(message)[1]:
            return
        with self._changed:
            self._send(self._arbiter.on_selection(message.robots, self._clock()))
        mode = message.mode[:LONGEST_TEXT]
        if caller.name == self._gates.operator and self._wished != (caller, mode):
            self._wished = caller, mode
            if mode:
                self._choose(mode)

    def _tell_mode(self, changed):
        """Publish a new mode, and wake and suspend the input nodes (with the lock held)."""
        self._suspender.activate(self._arbiter.source.suspend_service)
        if changed:
            self._mode.publish(source=self._arbiter.mode)
            self._profiles.forget()

    def _on_mode(self, message):
        """Take in a request; from others than the operator only while nobody is in control."""
        caller = caller_of(message)
        if self._gates.in_control(caller) or caller in self._inputs:
            self._choose(message.source[:LONGEST_TEXT])
            return
        self._strangers.refuse(caller, '/mux_in/mode_select')
        rospy.logwarn_throttle(1.0, '{} may not choose the mode: {} is in control'.format(
            caller, self._gates.operator))

    def _choose(self, wanted):
        try:
            with self._changed:
                before = self._arbiter.mode
                self._send(self._arbiter.on_mode(wanted, self._clock()))
                changed = self._arbiter.mode != before
                self._tell_mode(changed)
        except KeyError:
            rospy.logwarn_throttle(
                1.0, 'no source {!r}: the mode stays {!r}. Sources are rows of mux.yaml'.format(
                    wanted, before))
            return
        if changed:
            rospy.loginfo('driving with %s', wanted)

    def _on_stop_all(self, request):
        """Serve ``/mux/set_stop_all``."""
        with self._changed:
            self._awake(self._clock())
            if request.data:
                self._engage_stop()
                answer = SetBoolResponse(True, 'everything is stopped')
            else:
                problem = self._arbiter.release_stop_all(self._clock())
                if not problem:
                    self._gates.on_release()
                self._send(None)
                self._stop.publish(data=self._arbiter.stop_all)
                answer = SetBoolResponse(problem is None, problem or 'released: centre the stick')
        self._remember_stop()
        return answer

    def _remember_stop(self):
        """Store stop-all where the next mux finds it, before answering."""
        with self._remembering:
            stopped = self._arbiter.stop_all
            try:
                self._watch.set_parameter(STOP_PARAMETER, stopped)
            except MasterError as error:
                rospy.logwarn('stop-all is %s, but the next mux will not know: %s', stopped, error)

    def _hold(self, cause):
        with self._changed:
            self._send(self._arbiter.on_hold(cause, self._clock()))

    def _run(self):
        """Send what is due: repetitions, the zero of a silent source, later zeros."""
        with self._changed:
            while not self._closing:
                now = self._clock()
                self._awake(now)
                self._pulse.beat(now)
                self._send_due(now)
                self._gates.look(now)
                self._tell(now)
                self._due = min(self._arbiter.next_tick(now), now + LOOP_S)
                self._changed.wait(max(0.0, self._due - self._clock()))

    def _send_due(self, now):
        """Let the arbiter's time pass; ask a silent input node once more."""
        was_waiting, _ = self._said
        for name, topic in self._topics.items():
            moving = self._arbiter.state in (READY, DRIVING)
            if topic.has_gone() and (moving or topic.source.rests):
                self._send(self._arbiter.on_lost(name, 'lost', now))
        self._send(self._arbiter.tick(now))
        if now >= self._next_beat:
            self._next_beat = now + BEAT_S
            self._stop.publish(data=self._arbiter.stop_all)
            self._beat()
            if self._said[0] == was_waiting == 'source':
                self._suspender.resume_again()

    def close(self):
        """Stop the robots: a zero now, more for half a second, then nothing."""
        zero = Twist()
        with self._changed:
            if self._closing:
                return
            self._closing = True
            self._twist.publish(zero, urgent=True)
            self._changed.notify()
        for part in (self._diagnostics, self._memory, self._watch, self._gates, self._advice):
            part.stop()
        for _ in range(int(ZEROS_S * REPEAT_HZ)):
            time.sleep(1.0 / REPEAT_HZ)
            self._twist.publish(zero, urgent=True)

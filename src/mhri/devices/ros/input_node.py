# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of every input device: costs nothing while suspended, neutral at once when lost.

Interfaces of the node (the names are passed in):

- publishes ``sensor_msgs/Joy`` on its topic, on change (at most 100 Hz) and at 20 Hz;
  ``header.frame_id`` is ``profile:<name>``, the profile with the meanings of the axes, or ''; the
  last message of a device that is lost or suspended has `` lost`` appended
- serves ``mhri/SetSuspended``; a node starts suspended
- ``device_state`` beside the service (:mod:`mhri.devices.ros.device_state`): the present device
- ``/diagnostics`` at 1 Hz: the open device, or why none is open
"""
import threading
import time

from diagnostic_msgs.msg import DiagnosticStatus
import rospy
from sensor_msgs.msg import Joy

from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.publish_throttle import Pacer
from mhri.devices.ros.device_state import DeviceState
from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.srv import SetSuspended, SetSuspendedResponse

SUSPENDED = 'suspended'
LOOKING = 'looking'
READING = 'reading'
CLOSED = 'closed'

LOOK_PERIOD_S = 1.0
# Period at which a suspended node looks for its device [s].
FIND_PERIOD_S = 2.0
# Appended to header.frame_id of a device's last message: the mux then wants neutral before it
# drives again.
LOST = ' lost'
# Silence after it [s], for subscribers that only detect losses by time-out.
SILENCE_S = 1.0
HANGING_S = 2.0
# A hanging driver delays the end of the node by at most this [s].
END_S = 0.1
# An idle node registers again within this time after a restart of the master [s].
MASTER_PERIOD_S = 2.0


class InputNode:
    """Reads a device on its own thread while resumed, and publishes the readings.

    The service never waits for the device: it changes the state, publishes the neutral Joy that
    ends the old one, and leaves the rest to the thread. A session is the time between two changes
    of the state by the service; a reading that a hanging driver returns for an older session is
    discarded.

    :param reader: :class:`mhri.devices.io.reader.Reader`; used only on that thread
    :param topic: name of the ``sensor_msgs/Joy`` topic
    :param service: name of the ``mhri/SetSuspended`` service
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, reader, topic, service, clock=time.monotonic):
        self._reader = reader
        self._kind = getattr(reader, 'kind', 'device')
        self._service_name = rospy.resolve_name(service)
        self._clock = clock
        self._changed = threading.Condition(threading.RLock())
        self._state = SUSPENDED
        self._session = 0
        self._words = ''
        self._device = ''
        self._pacer = Pacer()
        self._last = None
        self._published = 0
        self._losses = 0
        self._called_at = None
        self._silent_until = self._next_look = clock()
        self._diagnostics = None
        self._device_state = DeviceState(self._service_name, self._kind)
        self._thread = threading.Thread(target=self._run, name='device', daemon=True)
        self.resumed = threading.Event()
        self._joy = NonBlockingPublisher(topic, Joy)
        self._watch = MasterWatch(period_s=MASTER_PERIOD_S)

    def start(self):
        """Start serving, suspended; call it after ``rospy.init_node``."""
        rospy.on_shutdown(self.close)
        self._watch.start()
        self._thread.start()
        rospy.Service(self._service_name, SetSuspended, self._on_set_suspended)
        self._diagnostics = publish_diagnostics({self._kind: self._diagnose})

    def close(self):
        """Publish the neutral Joy and release the device; return once the Joy has been sent."""
        with self._changed:
            if self._state == CLOSED:
                return
            self._enter(CLOSED)
        if self._diagnostics:
            self._diagnostics.set()
        self._watch.stop()
        if self._thread.is_alive():
            self._thread.join(END_S)

    def describe(self):
        """Return the state of the device, as in the service's answer."""
        with self._changed:
            if self._state == SUSPENDED:
                return 'suspended: no {} is open'.format(self._kind)
            if self._state == CLOSED:
                return 'the node is ending'
            hanging_s = self._hanging_s()
            if hanging_s:
                return 'the driver of the {} has not answered for {:.0f} s'.format(
                    self._kind, hanging_s)
            if self._state == READING:
                note = getattr(self._reader, 'note', '')
                return 'reading ' + self._device + ('; ' + note if note else '')
            return 'looking for a {}'.format(self._kind) + (
                ': ' + self._words if self._words else '')

    def _hanging_s(self):
        """Return the duration of an overdue call of the driver [s], 0.0 if none is overdue.

        Call it with the lock held.
        """
        age_s = 0.0 if self._called_at is None else self._clock() - self._called_at
        return age_s if age_s > HANGING_S else 0.0

    def _on_set_suspended(self, request):
        """Handle a request; return at once, whatever the driver does."""
        with self._changed:
            if self._state == CLOSED:
                return SetSuspendedResponse(False, self.describe())
            if request.suspended and self._state != SUSPENDED:
                self._enter(SUSPENDED)
            elif not request.suspended and self._state == SUSPENDED:
                self._enter(LOOKING)
            answer = SetSuspendedResponse(True, self.describe())
        rospy.logdebug('%s: %s', self._service_name, answer.message)
        return answer

    def _enter(self, state):
        """Begin a new session; call it with the lock held."""
        self._session += 1
        self._neutral()
        self._state = state
        self._words = ''
        if state == LOOKING:
            self.resumed.set()
        else:
            self.resumed.clear()
        self._changed.notify_all()

    def _neutral(self):
        """Publish the neutral Joy that ends the stream; call it with the lock held."""
        if self._last is not None:
            self._publish(self._last.neutral(), last=True)
            self._silent_until = self._clock() + SILENCE_S
        self._last = None
        self._pacer = Pacer()

    def _publish(self, reading, last=False):
        """Publish a reading; call it with the lock held, so that nothing overtakes the neutral."""
        message = Joy(axes=reading.axes, buttons=reading.buttons)
        message.header.stamp = rospy.Time.now()
        message.header.frame_id = (
            'profile:' + reading.profile if reading.profile else '') + (LOST if last else '')
        # The last message may be late, but must not be dropped.
        self._joy.publish(message, urgent=last)
        self._published += 1

    def _run(self):
        """Run one session after the other (the thread)."""
        while True:
            self._rest()
            with self._changed:
                if self._state == CLOSED:
                    return
                session = self._session
            self._next_look = self._clock()
            self._look(session)

    def _rest(self):
        """Wait while suspended; publish the present device every other second."""
        while True:
            with self._changed:
                if self._state != SUSPENDED:
                    return
            self._device_state.publish(*self._find(), self._reader.available())
            with self._changed:
                if self._state == SUSPENDED:
                    self._changed.wait(FIND_PERIOD_S)

    def _find(self):
        """Return (name of the device that would be opened, why there is none)."""
        try:
            return self._call(self._reader.find), ''
        except DeviceAbsent as reason:
            return '', str(reason)
        except Exception as error:  # a guard of this thread: whatever a driver raises
            return '', 'the driver failed: {}: {}'.format(type(error).__name__, error)

    def _is_current(self, session):
        with self._changed:
            return session == self._session

    def _call(self, method, *args):
        """Call the driver, and record the start of the call."""
        with self._changed:
            self._called_at = self._clock()
        try:
            return method(*args)
        finally:
            with self._changed:
                self._called_at = None

    def _look(self, session):
        """Look for a device once a second and read it until it is lost or the session ends.

        This is the thread's guard: any exception of a driver means that the device is lost.
        """
        while self._pause(session):
            try:
                self._begin(session, self._call(self._reader.open))
                while self._is_current(session):
                    self._step(session)
            except (DeviceAbsent, DeviceLost) as reason:
                self._lose(session, str(reason))
            except Exception as error:
                self._lose(session, 'the driver failed: {}: {}'.format(
                    type(error).__name__, error))
            finally:
                self._close_device()
            self._next_look = self._clock() + LOOK_PERIOD_S

    def _pause(self, session):
        """Wait until the next look is due; return whether the session continues."""
        with self._changed:
            until = max(self._silent_until, self._next_look)
            while session == self._session and self._clock() < until:
                self._changed.wait(until - self._clock())
            return session == self._session

    def _close_device(self):
        """Close the device, whatever its state."""
        try:
            self._call(self._reader.close)
        except Exception as error:
            rospy.logwarn('the %s could not be closed: %s: %s', self._kind,
                          type(error).__name__, error)

    def _begin(self, session, device):
        """Handle that a device has been opened."""
        with self._changed:
            if session != self._session:
                return
            self._state, self._device, self._words = READING, device, ''
        self._device_state.publish(self._reader.name or device, '', self._reader.available())
        rospy.loginfo('reading %s', device)

    def _step(self, session):
        """Wait for a change or the next repetition, and publish the due state."""
        with self._changed:
            wait_s = self._pacer.due_in(self._clock())
            if self._pacer.holding_back and wait_s > 0.0 and session == self._session:
                # Do not call the driver before then: the changes in between would be dropped.
                self._changed.wait(wait_s)
                wait_s = 0.0
        reading = self._call(self._reader.read, wait_s)
        with self._changed:
            if session != self._session:
                return
            if reading is not None:
                self._pacer.offer(reading)
            due = self._pacer.take(self._clock())
            if due is not None:
                self._publish(due)
                self._last = due
        self._device_state.publish(self._reader.name or self._device, self._reader.note,
                                   self._reader.available())

    def _lose(self, session, reason):
        """Publish the neutral Joy, and log the reason once."""
        with self._changed:
            if session != self._session:
                return
            self._neutral()
            lost, new = self._state == READING, self._words != reason
            self._losses += lost
            self._state, self._words, self._device = LOOKING, reason, ''
        self._device_state.publish('', reason, self._reader.available())
        if lost:
            rospy.logwarn('the %s is lost: %s', self._kind, reason)
        elif new:
            rospy.loginfo('looking for a %s: %s', self._kind, reason)

    def _diagnose(self, status):
        """Fill the status of the device."""
        with self._changed:
            level = DiagnosticStatus.OK if self._state != LOOKING else DiagnosticStatus.WARN
            if self._hanging_s():
                level = DiagnosticStatus.ERROR
            words, state, device = self.describe(), self._state, self._device
            profile = self._last.profile if self._last else ''
            published, losses = self._published, self._losses
        status.summary(level, words)
        status.add('state', state)
        status.add('device', device or 'none')
        status.add('profile', profile or 'none')
        status.add('messages published', published)
        status.add('devices lost', losses)
        return status

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A made-up session: what was so at which time is known, so that a replay can be compared with it.

``bot1`` drives ahead, ``bot2`` in a circle. ``python3 made_session.py FOLDER`` writes one.
"""
import math
from pathlib import Path
import sys

from geometry_msgs.msg import Twist
import genpy
from mhri.msg import (
    AccessoryState, ControlMode, DrillState, DriveSettings, DriveState, RobotDrive, RobotSelect)
from mhri.recording.folder import (
    bag_name, event_line, EVENTS_JSONL, info_text, SESSION_YAML, SessionEvent, SessionInfo)
from mhri.session.topics import DRIVE
from nav_msgs.msg import Odometry
import rosbag
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Bool, Float32

STARTED = 1700000000.0
ROBOTS = ('bot1', 'bot2')
LENGTH_S, BAG_S = 60.0, 20.0
# (from when, what holds from then on)
MODES = ((0.0, 'joy'), (20.0, 'ps3joy'))
SELECTED = ((0.0, ()), (5.0, ('bot1',)), (12.0, ('bot1', 'bot2')), (50.0, ('bot2',)))
STOPPED = ((0.0, False), (30.0, True), (36.0, False))
# bot2 says nothing then.
LOST_S = (40.0, 48.0)
ASKED_MPS, LIMITS = 0.1, (0.5, 1.5)
# A drill is waited for, under way and over from these on; its target is found as it ends.
DRILL_S = (6.0, 10.0, 24.0)
# bot1 drives by itself then.
TASK_S = (51.0, 58.0)
# The lamp of bot1 is on, and its gas sensor measures 60 ppm, from then on.
LAMP_S = 20.0
ACCESSORIES = {'lamp': {'kind': 'toggle', 'topic': 'lamp', 'on_stop': 'keep'},
               'gas': {'kind': 'readout', 'topic': 'gas', 'type': 'std_msgs/Float32'}}
# The screen showed its depth camera then.
DEPTH_S, DEPTH = (20.0, 30.0), '/bot1/camera/depth/image_raw/compressedDepth'
MARKS = ((15.0, 'm1', 'a red bag below the stairs'), (45.0, 'm2', 'smoke'))


def at(rows, time_s):
    """Return what holds at a time."""
    return [value for since_s, value in rows if since_s <= time_s][-1]


def obeyed(robot, time_s):
    """Return whom a robot obeyed."""
    if robot in at(SELECTED, time_s):
        return 'operator'
    return 'task' if robot == 'bot1' and TASK_S[0] <= time_s < TASK_S[1] else ''


def pose(robot, time_s):
    """Return (x, y, yaw) of a robot [m, m, rad]; it stands while everything is stopped."""
    stopped_s = STOPPED[2][0] - STOPPED[1][0]
    time_s = min(time_s, STOPPED[1][0]) + max(0.0, time_s - STOPPED[1][0] - stopped_s)
    if robot == 'bot1':
        return 0.1 * time_s, 0.0, 0.0
    return math.cos(0.1 * time_s), math.sin(0.1 * time_s), 0.0


def odometry(robot, time_s):
    """Return the odometry of a robot; it stands while everything is stopped."""
    message = Odometry()
    message.header.stamp = stamp(time_s)
    x_m, y_m, _ = pose(robot, time_s)
    message.pose.pose.position.x, message.pose.pose.position.y = x_m, y_m
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear.x = 0.0 if at(STOPPED, time_s) else 0.1
    return message


def drive_state(time_s, robots=ROBOTS):
    """Return what the mux said."""
    stopped, selected = at(STOPPED, time_s), at(SELECTED, time_s)
    state = DriveState(operator='/mhri_panel', computer='here', stop_all=stopped,
                       mode=at(MODES, time_s), share=1.0, settings=DriveSettings(
                           linear_mps=LIMITS[0], angular_rad_s=LIMITS[1]))
    state.command.linear.x = 0.0 if stopped else ASKED_MPS
    for robot in robots:
        drive = RobotDrive(name=robot, topic='/{}/cmd_vel'.format(robot), round_trip_s=math.nan,
                           odometry_follows=True, selected=robot in selected,
                           obeys=obeyed(robot, time_s),
                           stands='stopped' if stopped and robot in selected else '')
        drive.sent.linear.x = 0.1 if robot in selected and not stopped else 0.0
        if robot == 'bot1':
            drive.accessories = [AccessoryState(
                'lamp', True, 'on' if time_s >= LAMP_S else 'off', [], '')]
        state.robots.append(drive)
    return state


def stamp(time_s):
    """Return a time of the session as ROS counts."""
    return genpy.Time.from_sec(STARTED + time_s)


def drill_state(time_s):
    """Return what the referee of the drill said."""
    phase = sum(time_s >= since for since in DRILL_S) - 1
    targets, over = ['red can'], phase == DrillState.ENDED
    state = DrillState(
        title='Short', about='Find the can.', phase=phase, limit_s=60.0,
        elapsed_s=max(0.0, time_s - DRILL_S[1]), found=targets if over else [],
        left=[] if over else targets, ended='all found' if over else '')
    state.header.stamp = stamp(time_s)
    return state


def rows_between(begin_s, end_s):
    """Yield (time [s], topic, message, latched) of a part of the session, in order."""
    found = []

    def latched(time_s, topic, message):
        found.append((time_s, topic, message, True))
    for rows, topic, kind in ((MODES, '/mux/mode', ControlMode),
                              (STOPPED, '/robot_controller/stop_all', Bool),
                              (SELECTED, '/robot_controller/robot_select', RobotSelect)):
        for time_s in {begin_s, *(since for since, _ in rows if begin_s < since < end_s)}:
            value = at(rows, time_s)
            latched(time_s, topic, kind(robots=value) if kind is RobotSelect else kind(value))
    for second in range(max(6, round(begin_s)), min(25, round(end_s))):
        latched(float(second), '/mhri_drill/state', drill_state(float(second)))
    for step in range(round(10 * begin_s), round(10 * end_s)):
        time_s = 0.1 * step
        if DEPTH_S[0] <= time_s < DEPTH_S[1] and step % 5 == 0:
            found.append((time_s, DEPTH, CompressedImage(format='compressedDepth'), False))
        lit = time_s >= LAMP_S
        found.append((time_s, '/bot1/gas', Float32(60.0 if lit else 12.0), False))
        found.append((time_s, '/bot1/lamp', Bool(lit), False))
        asked = Twist()
        asked.linear.x = 0.0 if at(STOPPED, time_s) else ASKED_MPS
        found.append((time_s, '/robot_controller/twist', asked, False))
        if step % 5 == 0 or any(abs(time_s - since) < 0.01 for rows in (MODES, SELECTED, STOPPED)
                                for since, _ in rows):
            latched(time_s + 0.001, DRIVE, drive_state(time_s + 0.001))
        for robot in ROBOTS:
            if robot == 'bot2' and LOST_S[0] <= time_s < LOST_S[1]:
                continue
            found.append((time_s, '/{}/odom'.format(robot), odometry(robot, time_s), False))
            found.append((time_s, '/{}/cmd_vel'.format(robot), Twist(), False))
    return sorted(found, key=lambda row: row[0])


def header(topic, message, latched):
    """Return the connection header that a publisher would have sent."""
    return {'topic': topic, 'type': message._type, 'md5sum': message._md5sum,
            'message_definition': message._full_text, 'latching': '1' if latched else '0',
            'callerid': '/made'}


def write_bag(path, rows):
    """Write messages as a bag."""
    with rosbag.Bag(str(path), 'w') as bag:
        for time_s, topic, message, latched in rows:
            bag.write(topic, message, stamp(time_s),
                      connection_header=header(topic, message, latched))


def events():
    """Return the lines of the session."""
    def line(time_s, kind, text, severity='info', robot='', **data):
        return SessionEvent(STARTED + time_s, STARTED + time_s, kind, text, severity, robot, data)
    found = [line(0.0, 'start', 'the session begins', mode='joy', stop_all=False, selected=[])]
    found += [line(since, 'mode', 'driving with ' + mode, mode=mode) for since, mode in MODES[1:]]
    found += [line(since, 'selection', 'selected: ' + ', '.join(names), selected=list(names))
              for since, names in SELECTED[1:]]
    found += [line(since, 'stop', 'STOP ALL' if stopped else 'STOP ALL released',
                   'warning' if stopped else 'info', stop_all=stopped)
              for since, stopped in STOPPED[1:]]
    found.append(line(LOST_S[0] + 1.0, 'lost', 'lost while driven', 'error', 'bot2'))
    found.append(line(LOST_S[1], 'link', 'back after 8 s', 'info', 'bot2'))
    for since, mark, text in MARKS:
        found.append(line(since, 'mark', 'mark', id=mark, poses={
            robot: [*pose(robot, since), 'map'] for robot in ROBOTS}, stills=[]))
        found.append(line(since + 2.0, 'note', text, mark=mark))
    return sorted(found, key=lambda event: event.ros)


def write_session(folder):
    """Write the whole session into a folder, which is made."""
    folder = Path(folder)
    folder.mkdir(parents=True)
    for number in range(round(LENGTH_S / BAG_S)):
        write_bag(folder / bag_name(number), rows_between(BAG_S * number, BAG_S * (number + 1)))
    (folder / EVENTS_JSONL).write_text(
        ''.join(map(event_line, events())) + '{"wall": 17', encoding='utf-8')
    robots = {robot: {'number': number, 'type': 'turtlebot3', 'model': 'burger',
                      'parameters': {'robot_type': 'turtlebot3', 'robot_model': 'burger'},
                      'topics': {'odometry': '/{}/odom'.format(robot)}}
              for number, robot in enumerate(ROBOTS, 1)}
    robots['bot1']['parameters']['mhri'] = {'accessories': ACCESSORIES}
    (folder / SESSION_YAML).write_text(info_text(SessionInfo(STARTED, robots=robots)),
                                       encoding='utf-8')
    return folder


def write_pictures(folder, jpeg, camera='/bot2/camera/image_raw/compressed', from_s=4, every_s=2):
    """Write pictures of a camera into a session's folder, as one more bag.

    :param jpeg: function from a time [s] to the bytes of its picture
    """
    write_bag(Path(folder) / bag_name(round(LENGTH_S / BAG_S)), [
        (float(time_s), camera, CompressedImage(format='jpeg', data=jpeg(time_s)), False)
        for time_s in range(from_s, round(LENGTH_S), every_s)])


if __name__ == '__main__':
    write_session(sys.argv[1])

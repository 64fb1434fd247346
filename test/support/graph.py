# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The names on the ROS graph that end-to-end tests use, in one table.

A test that says what a robot does is written with these names and with what robots receive, so
that it outlives a change of what is inside. Where a name changes, it changes here.
"""
# Inputs.
STICK, PAD, PEDAL, VOICE = '/mux_in/joy', '/mux_in/ps3joy', '/mux_in/pedal', '/mux_in/voice'
MODE_SELECT, MODE = '/mux_in/mode_select', '/mux/mode'
TASK_INPUT, ACCESSORY = '/mux_in/task', '/mux_in/accessory'
SOURCES = '/mux/sources'
HEARD, PANEL_REQUEST = '/mhri_voice/heard', '/panel_in/request'

# The operator's wish, and what is done with it.
SELECT = '/robot_controller/robot_select'
DRIVE_STATE = '/mux/state'
TAKE_CONTROL = '/mux/take_control'
SET_MOTOR_POWER = '/mux/set_motor_power'
SET_STOP_ALL, STOP_ROBOTS = '/mux/set_stop_all', '/mux/stop_robots'
STOP_ALL, COMMAND = '/robot_controller/stop_all', '/robot_controller/twist'

# Tasks.
RUN_TASK, TASK_LIST = '/mhri_tasks/run', '/mhri_tasks/list'


def guard(robot, what):
    """Return a topic of a robot's guard: 'command', 'echo' or 'dropped'."""
    return '/{}/mhri_guard/{}'.format(robot, what)


def navigation(robot, what):
    """Return a topic of a robot's own navigation: 'goal', 'cancel' or 'status'."""
    return '/{}/move_base/{}'.format(robot, what)

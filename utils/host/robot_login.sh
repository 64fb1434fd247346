# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Shared by connect_turtlebot.sh and turtlebot_deploy.sh: checks of what goes to ssh and, through
# it, to a shell on the robot. Sourced after common.sh, never run.

# check_login USER IP
check_login() {
  [[ $1 =~ ^[A-Za-z_][A-Za-z0-9_.-]{0,31}$ ]] ||
    usage_error "USER: '$1' is not a user name such as turtlebot"
  check_ip IP "$2" 192.168.0.7
}

# check_ssh_port PORT: empty is fine, too.
check_ssh_port() {
  [ -n "$1" ] || return 0
  check_port --ssh-port "$1"
}

# check_folder FOLDER: a folder in the home on the robot, never one outside it.
check_folder() {
  [[ $1 =~ ^[A-Za-z0-9_][A-Za-z0-9_.-]*(/[A-Za-z0-9_][A-Za-z0-9_.-]*)*$ ]] ||
    usage_error "--to: '$1' is not a folder in the home of the robot's user, such as mhri"
}

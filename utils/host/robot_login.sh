# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Shared by connect_turtlebot.sh, turtlebot_deploy.sh and mhri_keys.sh: checks of what goes to ssh
# and, through it, to a shell on the robot; and one connection for several commands. Sourced after
# common.sh, never run.

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

# The connection; those who make one set ROBOT_USER, ROBOT_IP and SSH_PORT, and make_scratch first.
SOCKET=

# connect: opens it, or dies.
connect() {
  SOCKET="$SCRATCH/ssh"
  # The connection that carries the next ones; here ssh asks its own questions: the password, or
  # whether a new robot's key is right. Should this script be killed, it ends by itself.
  ssh -M -S "$SOCKET" -o ControlPersist=20 -o ConnectTimeout=10 \
    -l "$ROBOT_USER" ${SSH_PORT:+-p "$SSH_PORT"} -- "$ROBOT_IP" true ||
    die "ssh could not log in to $ROBOT_USER@$ROBOT_IP: see its message above. A robot that is" \
      "new here, or was set up anew: log in once with 'ssh $ROBOT_USER@$ROBOT_IP' and compare its key"
}

# disconnect: for the exit trap; removes the scratch folder, too.
disconnect() {
  if [ -S "$SOCKET" ]; then
    ssh -S "$SOCKET" -O exit -- "$ROBOT_IP" 2>/dev/null || true
  fi
  [ -z "$SCRATCH" ] || rm -rf "$SCRATCH"
}

# over_connection COMMAND
over_connection() {
  ssh -S "$SOCKET" -o ControlMaster=no -l "$ROBOT_USER" ${SSH_PORT:+-p "$SSH_PORT"} \
    -- "$ROBOT_IP" "$1"
}

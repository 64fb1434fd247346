#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Starts a robot and joins it to the host; runs on the robot; --help is the manual.
# Works with the bash of Ubuntu 16.04, where an empty array counts as unset.
set -eo pipefail

HERE=$(cd -P "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
# shellcheck source-path=SCRIPTDIR source=turtle_arguments.sh
. "$HERE/turtle_arguments.sh"
# shellcheck source-path=SCRIPTDIR source=turtle_bringup.sh
. "$HERE/turtle_bringup.sh"
# shellcheck source-path=SCRIPTDIR source=turtle_link.sh
. "$HERE/turtle_link.sh"

help_text() {
  cat <<'HELP'
Usage: turtle_remote.sh HOST_IP NAME [OPTION]...
       turtle_remote.sh --link NAME [OPTION]...

Starts this robot under the name NAME and joins it to mhri on the host. Runs on the robot, in a
terminal or through connect_turtlebot.sh. First it sets the ROS variables and checks that the
host's master answers, that the host reaches this robot, and that the name is free; for each problem
it says how to fix it. Then it starts the robot's own bringup and its camera. Press Ctrl-C, or close
the terminal, to end everything. When you restart mhri on the host, the robot joins again by itself.

  HOST_IP              the host's address, e.g. 192.168.0.103
  NAME                 the robot's name: a letter, then letters, digits and _ (at most 32)

Robot
  --type TYPE          turtlebot2, turtlebot3, turtlebot3_burger, turtlebot3_waffle,
                       turtlebot3_waffle_pi, generic, or your lab's own type (with --launch).
                       Default: by whether turtlebot_bringup or turtlebot3_bringup is installed
  --model MODEL        TurtleBot3: burger, waffle or waffle_pi. Default: TURTLEBOT3_MODEL from this
                       shell or ~/.bashrc
  --launch FILE        any other robot: its own launch file, as PACKAGE/FILE.launch or a path
                       (relative to here, or to the robot's home through connect_turtlebot.sh)
  --no-camera          do not start the camera
  --no-smoother        TurtleBot2: leave out the velocity smoother
  --no-guard           do not start mhri_guard, which drops late commands, stops the robot when none
                       arrive, and holds a stop-all on the robot when the network is lost
  --brake              mhri_guard slows down for what the laser meets in the way, to a stop before
                       it; without laser data there is no way forward. No depth camera: that is
                       for the brake on the screen
  --back-after SECONDS once mhri was not heard for so long (1 to 3600), mhri_guard drives the robot
                       back along its trail, slowly and braking, until it is heard again, 5 m at
                       most. Only where a robot may drive while nobody looks

Network
  --ip ADDR            this robot's address. Default: the one from 'hostname -I' on the host's
                       network
  --port PORT          the master's port on the host (default 11311); with --link, that of the
                       robot's own

A bad radio
  --link               give this robot a ROS master of its own, which only the robot itself
                       reaches, and link it to the host with mhri_link: see "Robots on a bad radio"
                       in the guide. No HOST_IP: the host calls, now or later. Needs ROS Noetic,
                       and 'turtlebot_deploy.sh --link' once
  --listen ENDPOINT    with --link: where the host calls (default 0.0.0.0:7447). A radio that loses
                       packets drives with keys alone (mhri_keys.sh)
  --router ENDPOINT    with --link: instead call a router that the host calls, too, such as
                       192.0.2.1:7447
                       With a key in place (mhri_keys.sh put), the link uses keys only; without
                       one nobody is listened to
  --keys off           with --link: without keys, on a network that you trust: anyone who reaches
                       the link may drive this robot
  --keep-mb MB         with --link: of what the host missed while it was out of reach this robot
                       keeps so much on its disk, the newest (default 500)

Other
  --setup FILE         the setup.bash of the robot's workspace. Default: what this shell has already
                       sourced, else ~/catkin_ws/devel/setup.bash, else the one in /opt/ros
  -h, --help           this text

  ROS_MASTER_URI, ROS_IP and ROS_HOSTNAME are set from these; ROS_NAMESPACE is unset.

Exit status: 0 only for --help, 1 could not start or the robot's launch ended, 2 wrong option,
129, 130 or 143 ended by the end of the terminal, Ctrl-C or a signal.

Examples
  turtle_remote.sh 192.168.0.103 bot1
  turtle_remote.sh 192.168.0.103 bot2 --type turtlebot3_burger --ip 192.168.0.8
  turtle_remote.sh 192.168.0.103 husky1 --type generic --launch husky_base/base.launch
  turtle_remote.sh --link bot1 --keys off
HELP
}

HOST_IP=
NAME=
TYPE=
MODEL=
LAUNCH=
CAMERA=true
SMOOTHER=true
GUARD=true
BRAKE=false
BACK_AFTER=
LINK=false
LISTEN=
ROUTER=
KEYS=
KEEP_MB=
IP=
PORT=11311
SETUP=
TOKEN="$$-$RANDOM$RANDOM"
STOPPED_WITH=
BASE_PID=
CAMERA_PID=
GUARD_PID=
WATCH_PID=

# A closed terminal must not keep the robot from ending.
say() { printf 'mhri: %s\n' "$(unarmed "$*")" 2>/dev/null || true; }
warn() { printf 'mhri: %s\n' "$(unarmed "$*")" >&2 || true; }
die() { warn "$*"; exit 1; }
usage_error() { warn "$(brief "$*") (--help lists every option)"; exit 2; }

parse_arguments() {
  local words=()
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --type) TYPE=$(value "$@"); shift ;;
      --model) MODEL=$(value "$@"); shift ;;
      --launch) LAUNCH=$(value "$@"); shift ;;
      --no-camera) CAMERA=false ;;
      --no-smoother) SMOOTHER=false ;;
      --no-guard) GUARD=false ;;
      --brake) BRAKE=true ;;
      --back-after) BACK_AFTER=$(value "$@"); shift ;;
      --link) LINK=true ;;
      --listen) LISTEN=$(value "$@"); shift ;;
      --router) ROUTER=$(value "$@"); shift ;;
      --keys) KEYS=$(value "$@"); shift ;;
      --keep-mb) KEEP_MB=$(value "$@"); shift ;;
      --ip) IP=$(value "$@"); shift ;;
      --port) PORT=$(value "$@"); shift ;;
      --setup) SETUP=$(value "$@"); shift ;;
      -*) usage_error "there is no option $1" ;;
      *) words+=("$1") ;;
    esac
    shift
  done
  if "$LINK"; then
    [ "${#words[@]}" = 1 ] ||
      usage_error "with --link give the robot's name alone: turtle_remote.sh --link NAME"
    words=(127.0.0.1 "${words[@]}")
  fi
  [ "${#words[@]}" = 2 ] ||
    usage_error "give the host's address and the robot's name: turtle_remote.sh HOST_IP NAME"
  HOST_IP=${words[0]}
  NAME=${words[1]}
}

check_arguments() {
  check_ip HOST_IP "$HOST_IP" 192.168.0.103
  check_name "$NAME"
  check_robot
  check_guard
  check_link_options
  LISTEN=${LISTEN:-0.0.0.0:7447}
  [ -z "$SETUP" ] || [ -f "$SETUP" ] || usage_error "--setup: there is no file '$SETUP'"
}

# choose_network: sets this robot's address and the ROS variables.
choose_network() {
  local all=() address v4=()
  read -r -a all < <(hostname -I) || true
  for address in "${all[@]}"; do
    if valid_ip "$address"; then v4+=("$address"); fi
  done
  if "$LINK"; then
    # Its nodes then listen on the robot alone: what comes from outside comes through the link.
    IP=127.0.0.1
  elif [ -z "$IP" ]; then
    IP=$("$PYTHON" "$HERE/turtle_address.py" --ip "$HOST_IP" "${v4[@]}") || exit 1
  elif [[ " ${v4[*]} 127.0.0.1 " != *" $IP "* ]]; then
    die "--ip: $IP is not an address of this robot (${v4[*]:-it has none})"
  fi
  export ROS_MASTER_URI="http://$HOST_IP:$PORT" ROS_IP=$IP ROS_HOSTNAME=$IP
  unset ROS_NAMESPACE
  say "ROS_MASTER_URI=$ROS_MASTER_URI ROS_IP=$ROS_IP ROS_HOSTNAME=$ROS_HOSTNAME"
}

# held COMMAND...: runs it in its own session, so that Ctrl-C reaches only this script, which passes
# it on once; should this script be killed, the kernel does.
held() { exec env "MHRI_REMOTE_ID=$TOKEN" "$PYTHON" "$HERE/turtle_check.py" hold $$ "$@"; }

start_all() {
  # Before anything sets a parameter: it notes the present ones.
  "$PYTHON" "$HERE/turtle_check.py" claim "$HOST_IP" "$PORT" "$NAME" "$TOKEN" || exit 1
  # First of all: should this script be killed, it ends what does not end by itself.
  "$PYTHON" "$HERE/turtle_check.py" watch "$HOST_IP" "$PORT" "$NAME" "$TOKEN" </dev/null &
  WATCH_PID=$!
  held roslaunch "${BASE_LAUNCH[@]}" </dev/null &
  BASE_PID=$!
  if "$CAMERA" && [ "${#CAMERA_LAUNCH[@]}" -gt 0 ]; then
    held roslaunch "${CAMERA_LAUNCH[@]}" </dev/null &
    CAMERA_PID=$!
  fi
  if "$GUARD"; then
    ROS_NAMESPACE="/$NAME" held "$GUARD_PYTHON" "$HERE/mhri_guard" "_command:=$GUARD_TOPIC" \
      "_brake:=$BRAKE" "_back_after_s:=${BACK_AFTER:-0}" "${GUARD_LIMITS[@]}" </dev/null &
    GUARD_PID=$!
  fi
  if "$LINK"; then start_link; fi
}

running() { [ -n "$1" ] && kill -0 "$1" 2>/dev/null; }

# nap: waits a second; a signal cuts it short, and nothing of it is left.
nap() {
  sleep 1 &
  wait $! || kill $! 2>/dev/null || true
}

# end_all: asks everything started to end, waits, and kills what did not.
end_all() {
  local pid deadline=$((SECONDS + 25))
  local pids=("$LINK_PID" "$GUARD_PID" "$BASE_PID" "$CAMERA_PID" "$WATCH_PID")
  for pid in "${pids[@]}"; do
    if running "$pid"; then kill -TERM "$pid" 2>/dev/null || true; fi
  done
  for pid in "${pids[@]}"; do
    while running "$pid" && [ "$SECONDS" -lt "$deadline" ]; do sleep 0.1; done
  done
  "$PYTHON" "$HERE/turtle_check.py" end "$TOKEN" || true
  BASE_PID='' CAMERA_PID='' GUARD_PID='' WATCH_PID='' LINK_PID=''
}

# Notes the first signal; the main loop, or the exit trap, then ends everything.
stop() {
  if [ -n "$STOPPED_WITH" ]; then return; fi
  STOPPED_WITH=$1
  say "ending"
}

clean_up() {
  trap '' INT TERM HUP
  end_all
  "$PYTHON" "$HERE/turtle_check.py" release "$HOST_IP" "$PORT" "$NAME" "$TOKEN" || true
  unlimit_callers
  end_master
}

# check_parts: restarts after a new start of the host; dies if base or guard ended; reports the
# camera once.
check_parts() {
  local status=0
  check_link
  if ! running "$BASE_PID"; then
    wait "$BASE_PID" || status=$?
    die "the robot's launch has ended (exit status $status): see its messages above"
  fi
  if [ -n "$CAMERA_PID" ] && ! running "$CAMERA_PID"; then
    warn "the camera's launch has ended: see its messages above; the robot can be driven without it"
    CAMERA_PID=
  fi
  if [ -n "$GUARD_PID" ] && ! running "$GUARD_PID"; then
    die "mhri_guard has ended: this robot must not be driven as a guarded one without it"
  fi
  if ! running "$WATCH_PID"; then
    say "mhri was restarted on $HOST_IP: restarting $NAME"
    end_all
    "$PYTHON" "$HERE/turtle_check.py" host "$HOST_IP" "$PORT" "$IP" "$NAME" || exit 1
    start_all
  fi
}

main() {
  parse_arguments "$@"
  check_arguments
  find_launch
  read_bashrc
  prepare_ros
  choose_type
  prepare_launch
  prepare_link
  choose_network
  trap end_master EXIT
  if "$LINK"; then start_master; fi
  "$PYTHON" "$HERE/turtle_check.py" host "$HOST_IP" "$PORT" "$IP" "$NAME" || exit 1
  "$LINK" || say "$HOST_IP and this robot reach each other, and the name $NAME is free"
  trap clean_up EXIT
  trap 'stop 130' INT
  trap 'stop 143' TERM
  trap 'stop 129' HUP
  if "$LINK"; then limit_callers; fi
  start_all
  if "$LINK"; then say "$NAME has a master of its own; its link: ${ROUTER:-$LISTEN}"; fi
  while [ -z "$STOPPED_WITH" ]; do
    check_parts
    nap
  done
  return "$STOPPED_WITH"
}

main "$@"

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Starts a robot from the host, over ssh; --help is the manual.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"
# shellcheck source-path=SCRIPTDIR source=robot_login.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/robot_login.sh"

help_text() {
  cat <<'HELP'
Usage: connect_turtlebot.sh USER IP NAME [OPTION]...

Logs in to a robot over ssh and starts it under the name NAME, joined to mhri on this computer.
mhri must be running here (mhri_run.sh), and the robot needs its files once (turtlebot_deploy.sh).
Shows the robot's output. Press Ctrl-C, or close the terminal, to end the robot's nodes. Asks for
the robot's password unless ssh has a key for it.

  USER                 the user name on the robot
  IP                   the robot's address, e.g. 192.168.0.7
  NAME                 the robot's name: a letter, then letters, digits and _ (at most 32)

  --host-ip ADDR       this computer's address, as the robot reaches it. Default: the one from
                       'hostname -I' on the robot's network
  --ssh-port PORT      the port of the robot's ssh server (default: from ssh's settings, else 22)
  --to FOLDER          where turtlebot_deploy.sh put the files, in USER's home (default mhri)
  -h, --help           this text

  Passed on to the robot; see 'turtle_remote.sh --help':
  --type TYPE, --model MODEL, --launch FILE, --setup FILE, --ip ADDR, --port PORT, --no-camera,
  --no-smoother, --no-guard, --brake, --back-after SECONDS

Exit status: 2 wrong option, 255 ssh could not connect or lost the robot, else that of
turtle_remote.sh: 1 could not start or the robot's launch ended, 129, 130 or 143 ended from here.

Examples
  connect_turtlebot.sh turtlebot 192.168.0.7 bot1
  connect_turtlebot.sh pi 192.168.0.8 bot2 --type turtlebot3_burger
HELP
}

ROBOT_USER=
ROBOT_IP=
NAME=
HOST_IP=
SSH_PORT=
FOLDER=mhri
# The robot's options, with the defaults of turtle_remote.sh.
TYPE=
MODEL=
LAUNCH=
IP=
PORT=11311
GUARD=true
BRAKE=false
BACK_AFTER=
PASSED_ON=()

# Runs on the robot, as sh. $0 is USER@IP, $1 the folder in the home.
# shellcheck disable=SC2016 # the dollars are the robot's
START='if [ ! -f "$1/turtle_remote.sh" ]; then
echo "mhri: this robot has no ~/$1/turtle_remote.sh: run turtlebot_deploy.sh $0 on the host" >&2
exit 1
fi
folder=$1
shift
exec bash "$folder/turtle_remote.sh" "$@"'

parse_arguments() {
  local words=() option text
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --host-ip) HOST_IP=$(value "$@"); shift ;;
      --ssh-port) SSH_PORT=$(value "$@"); shift ;;
      --to) FOLDER=$(value "$@"); shift ;;
      --type | --model | --launch | --setup | --ip | --port)
        text=$(value "$@")
        option=${1#--}
        printf -v "${option^^}" %s "$text"
        PASSED_ON+=("$1" "$text")
        shift ;;
      --back-after) BACK_AFTER=$(value "$@"); PASSED_ON+=("$1" "$BACK_AFTER"); shift ;;
      --no-guard) GUARD=false PASSED_ON+=("$1") ;;
      --brake) BRAKE=true PASSED_ON+=("$1") ;;
      --no-camera | --no-smoother) PASSED_ON+=("$1") ;;
      -*) usage_error "there is no option $1" ;;
      *) words+=("$1") ;;
    esac
    shift
  done
  [ "${#words[@]}" = 3 ] || usage_error "give the user name on the robot, the robot's address and" \
    "the robot's name: connect_turtlebot.sh USER IP NAME"
  ROBOT_USER=${words[0]}
  ROBOT_IP=${words[1]}
  NAME=${words[2]}
}

check_arguments() {
  local text
  check_login "$ROBOT_USER" "$ROBOT_IP"
  check_name "$NAME"
  [ -z "$HOST_IP" ] || check_ip --host-ip "$HOST_IP" 192.168.0.103
  check_ssh_port "$SSH_PORT"
  check_folder "$FOLDER"
  # The robot checks them again, but only after the login. Nothing that a shell could read as more
  # than one word may get there.
  check_robot
  check_guard
  for text in "${PASSED_ON[@]}"; do
    [[ $text =~ ^[A-Za-z0-9_./~+-]+$ ]] || usage_error "'$text' cannot be passed on to the robot"
  done
}

# choose_address: sets HOST_IP, by the rule that the robot uses for its own.
choose_address() {
  local all=() address v4=()
  [ -z "$HOST_IP" ] || return 0
  read -r -a all < <(hostname -I) || true
  for address in "${all[@]}"; do
    if valid_ip "$address"; then v4+=("$address"); fi
  done
  HOST_IP=$(/usr/bin/python3 "$REPO/utils/remote/turtle_address.py" --host-ip "$ROBOT_IP" \
    "${v4[@]}" 2>&1) || die "${HOST_IP#mhri: }"
}

main() {
  local command
  parse_arguments "$@"
  check_arguments
  choose_address
  # Plain words and one text in single quotes: every login shell reads those alike.
  command="exec sh -c '$START' $ROBOT_USER@$ROBOT_IP $FOLDER $HOST_IP $NAME ${PASSED_ON[*]}"
  say "starting $NAME on $ROBOT_IP; this computer is $HOST_IP. Ctrl-C ends it"
  # -tt: the robot notices when this terminal closes. Two minutes without an answer: a shorter
  # outage ends nothing.
  exec ssh -tt -o ConnectTimeout=10 -o ServerAliveInterval=15 -o ServerAliveCountMax=8 \
    ${SSH_PORT:+-p "$SSH_PORT"} -l "$ROBOT_USER" -- "$ROBOT_IP" "$command"
}

main "$@"

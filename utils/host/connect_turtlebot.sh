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

  --link               the robot gets a ROS master of its own, linked to the one here by mhri_link
                       ("Robots on a bad radio" in the guide). Needs 'turtlebot_deploy.sh --link'
                       once. --port is that of both masters. A robot out of reach for more than two
                       minutes ends with its ssh connection: start such a one on the robot itself,
                       with turtle_remote.sh, and give mhri_run.sh --link here
  --listen ENDPOINT    with --link: where the robot is called (default 0.0.0.0:7447)
  --router ENDPOINT    with --link: robot and host call this router instead, e.g. 192.0.2.1:7447
  --keys off           with --link: both sides go without keys: anyone who reaches it may drive.
                       Else both use the keys in place (mhri_keys.sh), and a robot without one does
                       not start
  --keep-mb MB         with --link: of what this computer misses the robot keeps so much (500)
  --keep WHAT          with --link, not passed on: what the robot records for later while it is out
                       of reach, see 'mhri_run.sh --help'

Exit status: 2 wrong option, 255 ssh could not connect or lost the robot, else that of
turtle_remote.sh: 1 could not start or the robot's launch ended, 129, 130 or 143 ended from here.

Examples
  connect_turtlebot.sh turtlebot 192.168.0.7 bot1
  connect_turtlebot.sh pi 192.168.0.8 bot2 --type turtlebot3_burger
  connect_turtlebot.sh ubuntu 192.168.0.9 bot3 --link --keys off
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
LINK=false
LISTEN=
ROUTER=
KEYS=
KEEP=
KEEP_MB=
PASSED_ON=()
LINK_PID=

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
      --type | --model | --launch | --setup | --ip | --port | --listen | --router | \
        --keys | --keep-mb)
        text=$(value "$@")
        option=${1#--}
        option=${option/-/_}
        printf -v "${option^^}" %s "$text"
        PASSED_ON+=("$1" "$text")
        shift ;;
      --keep) KEEP=$(value "$@"); shift ;;
      --back-after) BACK_AFTER=$(value "$@"); PASSED_ON+=("$1" "$BACK_AFTER"); shift ;;
      --link) LINK=true PASSED_ON+=("$1") ;;
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
  check_link_options
  [ -z "$KEEP" ] || "$LINK" || usage_error "--keep goes with --link"
  [[ $KEEP =~ ^(session|states|pictures|)$ ]] ||
    usage_error "--keep: '$KEEP' is none of session, states, pictures"
  for text in "${PASSED_ON[@]}"; do
    [[ $text =~ ^[A-Za-z0-9_./~+:-]+$ ]] || usage_error "'$text' cannot be passed on to the robot"
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

# link_here: starts this computer's side of the link, on the master here.
link_here() {
  local setup="$WS/devel/setup.bash" master protocol='' address="${LISTEN:-:7447}"
  [ -f "$setup" ] || setup="$REPO/../../setup.bash"
  [ -f "$setup" ] || die "mhri is not built here yet: start it first, with mhri_run.sh"
  source_setup "$setup"
  [ ! -f "$REPO/CMakeLists.txt" ] || install_link
  master=$HOST_IP
  # With simulated robots alone mhri_run.sh keeps its master to this computer.
  (: <"/dev/tcp/$master/$PORT") 2>/dev/null || master=127.0.0.1
  /usr/bin/python3 "$REPO/utils/remote/turtle_check.py" host "$master" "$PORT" "$master" "$NAME" ||
    exit 1
  # The robot may listen on another address, too, but this one it has.
  if [[ $address == */* ]]; then protocol=${address%%/*}/; fi
  address="connect:=$protocol$ROBOT_IP:${address##*:}"
  [ -z "$ROUTER" ] || address="router:=$ROUTER"
  make_scratch
  ROS_MASTER_URI="http://$master:$PORT" ROS_IP=$master ROS_HOSTNAME=$master MHRI_RUN_ID=$RUN_ID \
    setsid setpriv --pdeathsig TERM roslaunch mhri link.launch side:=host "name:=$NAME" "$address" \
    "keys:=${KEYS:-auto}" "keep:=${KEEP:-session}" </dev/null >"$SCRATCH/link.log" 2>&1 &
  LINK_PID=$!
}

# unlink_here: ends it again; says why where it had ended by itself.
unlink_here() {
  trap '' INT TERM HUP
  if ! kill -TERM "$LINK_PID" 2>/dev/null; then
    warn "the link to $NAME had ended here: $(tail -n 3 "$SCRATCH/link.log" | tr '\n' ' ')"
  fi
  wait "$LINK_PID" || true
  clean_up
}

# log_in_linked COMMAND...: runs ssh while this computer's side of the link is there.
log_in_linked() {
  local status=0 ssh
  link_here
  trap unlink_here EXIT
  "$@" <&0 &
  ssh=$!
  # shellcheck disable=SC2064 # this very process
  trap "kill -HUP $ssh 2>/dev/null || true" INT TERM HUP
  while kill -0 "$ssh" 2>/dev/null; do
    status=0
    wait "$ssh" || status=$?
  done
  return "$status"
}

main() {
  local command log_in whom
  parse_arguments "$@"
  check_arguments
  choose_address
  whom="$HOST_IP $NAME"
  ! "$LINK" || whom=$NAME
  # Plain words and one text in single quotes: every login shell reads those alike.
  command="exec sh -c '$START' $ROBOT_USER@$ROBOT_IP $FOLDER $whom ${PASSED_ON[*]}"
  # -tt: the robot notices when this terminal closes. Two minutes without an answer: a shorter
  # outage ends nothing.
  log_in=(ssh -tt -o ConnectTimeout=10 -o ServerAliveInterval=15 -o ServerAliveCountMax=8
    ${SSH_PORT:+-p "$SSH_PORT"} -l "$ROBOT_USER" -- "$ROBOT_IP" "$command")
  say "starting $NAME on $ROBOT_IP; this computer is $HOST_IP. Ctrl-C ends it"
  "$LINK" || exec "${log_in[@]}"
  log_in_linked "${log_in[@]}"
}

main "$@"

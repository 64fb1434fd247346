#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Starts mhri on the host computer; --help is the manual.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

help_text() {
  cat <<'HELP'
Usage: mhri_run.sh [OPTION]... [ARG:=VALUE]...

Starts the human-robot interface on this computer: the mux and the screen, in rqt if that is
installed. First installs what is missing and builds; if nothing is missing or has changed, it does
neither and needs no network. Press Ctrl-C, or close the screen, to end everything.

Robots
  --sim N [TYPES]      add N simulated robots (1 to 12). TYPES lists their types in turn, e.g.
                       --sim 3 "turtlebot2 turtlebot3_burger turtlebot3_waffle"; another type is
                       turtlebot3_waffle_pi
  --sim-types TYPES    the same, as an option of its own
  --demo               drive simulated robots by a script: discover, select two of four, drive
                       both, change the selection while they move, stop all; then two patrol, one
                       is driven and one follows it, on the map. Prints what each robot did,
                       writes pictures and ends: 0 if all went well, else 1. Means --sim 4
                       unless --sim is given. Uses a master of its own, so it does not
                       disturb a running system, and neither reads nor writes the settings of the
                       screen.
  --screenshot FILE    where --demo writes the picture of the screen (PNG; default mhri-demo.png,
                       here); beside it come five more, e.g. mhri-demo_panel.png, _bot_window,
                       _depth, _stopped and _map. What is there is overwritten.

  --drill NAME         practise: starts the robots and building of a drill; prints and keeps the result.
                       NAME: figure_of_eight, maze, search, two_corridors, lost_link, stop_in_time,
                       or a file of your own (.yaml)
  --scripted           with --drill: a scripted operator drives, without a screen; then all ends

  --link "NAME=ADDR..."  robots that have a ROS master of their own, e.g.
                       --link "bot1=192.168.0.7 bot2=192.168.0.8": their addresses, where mhri_link
                       runs as the operator's guide says ("Robots on a bad radio"). ADDR may also be
                       an endpoint such as tls/192.168.0.7:7447. Installs the library for it, zenoh,
                       below build/.ws. Where mhri_keys.sh has put a key in place on this computer,
                       the link is by keys (TLS) alone; without one nothing is linked, unless
                       --keys off is given here and to the robot.
  --keys FOLDER        with --link: the keys are in FOLDER; off: link without keys, on a network that
                       you trust
  --router ENDPOINT    a router, such as 192.0.2.1:7447, behind which those robots of --link are
                       that it gives no address for: --link "bot1 bot2=192.168.0.8"

  --keep WHAT          what the robots of --link record for later while they are out of reach: session
                       (all but pictures, while a session is recorded; the default), states (the
                       same, always), or pictures (always, and the cameras, too)

  --web                serve a page for phones, tablets and headsets; the screen gives out links to it

  --replay PATH        show a session again: the folder of one that was recorded, a folder of bags,
                       or a bag of any program whose topics are those of a robot type. Uses a master
                       of its own, with nothing on it that drives, so it does not disturb a running
                       system.

Network
  --ip ADDR            this computer's address, as the robots reach it. Default: the first IPv4
                       address of 'hostname -I'. With --sim, or a master on this machine:
                       127.0.0.1, and no network is needed.
  --master URI         use the ROS master at URI, e.g. http://192.168.0.103:11311. Default: port
                       11311 of this computer; uses the master running there, else starts one.
                       One master, one mhri: if mhri is already running, nothing is started. A
                       second system on one computer needs a port of its own.

  ROS_MASTER_URI, ROS_IP and ROS_HOSTNAME are set from these; values from your shell are not used.

Other
  --fresh              begin without the saved settings of the screen, except for the numbers of
                       robots; the settings stay as they are until you change robots or mode.
                       Simulated robots and drills have settings of their own anyway, which keep
                       nothing about robots
  --install-space      build and run from the install space instead of the devel space
  ARG:=VALUE           an argument of launch/mhri.launch, e.g. gui:=none or robots:="bot1 bot2"
  -h, --help           this text

Without a display (DISPLAY and WAYLAND_DISPLAY not set) the screen runs under Xvfb, 1920x1080.

Works on Debian 12, and on Ubuntu 20.04 with ROS Noetic; prepared for Ubuntu 22.04 with its own ROS
packages, but not tried there. Elsewhere mhri_docker.sh runs it in Docker. It uses sudo only if packages
are missing.
The workspace is build/.ws in the checkout; if you delete it, the next start takes a minute longer.

Exit status: 0 the screen was closed, 1 could not start, or the screen or the demo failed,
2 wrong option, 130 or 143 ended by Ctrl-C or a signal.

Examples
  mhri_run.sh                       drive the robots of the network
  mhri_run.sh --ip 192.168.0.103    the same, if the computer has several addresses
  mhri_run.sh --sim 3               three simulated robots; needs neither robots nor network
  mhri_run.sh --replay ~/.ros/mhri/sessions/2026-03-01-14-03-22
                                    look at that mission again
  mhri_run.sh --demo                proof that everything works here
HELP
}

SIM=
SIM_TYPES=
LINKS=()
ROUTER=
KEYS=
KEEP=
IP=
MASTER=
DEMO=false
REPLAY=
DRILL=
SCRIPTED=false
FRESH=false
PICTURE=
SPACE=devel
LAUNCH_ARGS=()
STOPPED_WITH=
LAUNCH_PID=

parse_arguments() {
  local links
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --sim)
        SIM=$(value "$@"); shift
        if [[ ${2:-} =~ ^[a-z] && $2 != *:=* ]]; then SIM_TYPES=$2; shift; fi ;;
      --sim-types) SIM_TYPES=$(value "$@"); shift ;;
      --keys) KEYS=$(value "$@"); shift ;;
      --keep) KEEP=$(value "$@"); shift ;;
      --link) links=$(value "$@"); read -r -a LINKS <<<"$links"; shift ;;
      --router) ROUTER=$(value "$@"); shift ;;
      --ip) IP=$(value "$@"); shift ;;
      --master) MASTER=$(value "$@"); shift ;;
      --screenshot) PICTURE=$(value "$@"); shift ;;
      --demo) DEMO=true ;;
      --replay) REPLAY=$(value "$@"); shift ;;
      --drill) DRILL=$(value "$@"); shift ;;
      --scripted) SCRIPTED=true ;;
      --fresh) FRESH=true ;;
      --web) LAUNCH_ARGS+=("web:=true") ;;
      --install-space) SPACE=install ;;
      -*) usage_error "there is no option $1" ;;
      *:=*) LAUNCH_ARGS+=("$1") ;;
      *) usage_error "'$1' is neither an option nor ARG:=VALUE" ;;
    esac
    shift
  done
}

check_arguments() {
  local arg
  [[ -z $SIM || $SIM =~ ^([1-9]|1[0-2])$ ]] ||
    usage_error "--sim: '$SIM' is not a number of robots from 1 to 12"
  [[ $SIM_TYPES =~ ^[a-z0-9_\ ]*$ ]] ||
    usage_error "--sim: '$SIM_TYPES' is not a list of robot types: names with spaces between"
  [ -z "$SIM_TYPES" ] || [ -n "$SIM" ] || "$DEMO" ||
    usage_error "--sim-types lists the types for the robots of --sim N: give --sim as well"
  check_links
  [ -z "$KEYS" ] || [ "${#LINKS[@]}" != 0 ] || usage_error "--keys goes with --link"
  [ -z "$KEEP" ] || [ "${#LINKS[@]}" != 0 ] || usage_error "--keep goes with --link"
  [[ $KEEP =~ ^(session|states|pictures|)$ ]] ||
    usage_error "--keep: '$KEEP' is none of session, states, pictures"
  check_replay
  check_drill
  [ -z "$IP" ] || check_ip --ip "$IP" 192.168.0.103
  [[ -z $MASTER || $MASTER =~ ^http://[A-Za-z0-9]([A-Za-z0-9.-]*)?:[0-9]{1,5}/?$ ]] ||
    usage_error "--master: '$MASTER' is not an address such as http://192.168.0.103:11311"
  MASTER=${MASTER%/}
  if [ -n "$MASTER" ] && [ "$((10#${MASTER##*:}))" -gt 65535 ]; then
    usage_error "--master: there is no port ${MASTER##*:}"
  fi
  if "$DEMO" && [ -n "$IP$MASTER" ]; then
    usage_error "--demo runs on this machine alone, with its own master:" \
      "leave out --ip and --master"
  fi
  if "$DEMO" && [ "${SIM:-4}" -lt 4 ]; then
    usage_error "--demo plays with four robots: leave out --sim $SIM, or give more"
  fi
  [ -z "$PICTURE" ] || "$DEMO" || usage_error "--screenshot goes with --demo"
  for arg in "${LAUNCH_ARGS[@]}"; do
    [[ $arg =~ ^[a-z][a-z0-9_]*:= ]] || usage_error "'$arg' is not ARG:=VALUE"
    [[ $arg != *[[:cntrl:]]* ]] || usage_error "${arg%%:=*}: a control character is in '$arg'"
  done
}

# check_replay: a replay has a master of its own, and nothing beside it.
check_replay() {
  [ -n "$REPLAY" ] || return 0
  if [ -n "$IP$MASTER$SIM$PICTURE$DRILL${LINKS[*]}" ] || "$DEMO" || "$FRESH"; then
    usage_error "--replay runs on this machine alone, with its own master and without robots:" \
      "leave out --ip, --master, --sim, --link, --demo, --drill, --fresh and --screenshot"
  fi
  [ -e "$REPLAY" ] || usage_error "--replay: there is no $REPLAY"
  [[ $REPLAY != *[\'\"\$]* ]] ||
    usage_error "--replay: a quote or a dollar sign is in $REPLAY: choose another name"
  REPLAY=$(realpath -- "$REPLAY")
}

# check_drill: a drill brings its own robots.
check_drill() {
  local known
  [ -n "$DRILL" ] || ! "$SCRIPTED" || usage_error "--scripted goes with --drill NAME"
  [ -n "$DRILL" ] || return 0
  [ "$DEMO$SIM$SIM_TYPES" = false ] ||
    usage_error "--drill brings its own robots: leave out --sim and --demo"
  [[ $DRILL != *[[:space:]\'\"]* ]] || usage_error "--drill: a space or quote is in '$DRILL'"
  if [[ $DRILL == *.yaml ]]; then
    [ -f "$DRILL" ] || usage_error "--drill: there is no file $DRILL"
    DRILL=$(realpath -- "$DRILL")
    return 0
  fi
  known=$(cd "$REPO/resource/drills" && printf '%s ' *.yaml)
  [[ " $known" == *" $DRILL.yaml "* ]] ||
    usage_error "--drill: there is no drill '$DRILL'; there are ${known//.yaml/}"
}

# choose_drill: sets robots and building to those of the drill.
choose_drill() {
  local lines
  [ -n "$DRILL" ] || return 0
  lines=$(rosrun mhri mhri_drill --arguments "$DRILL") || die "the drill $DRILL cannot be used: see above"
  { read -r SIM; read -r SIM_TYPES; read -r PLAN; } <<<"$lines"
  LAUNCH_ARGS=("robots:=$(seq -s ' ' -f 'bot%g' "$SIM")" "${LAUNCH_ARGS[@]}"
    "sim_plan:=$PLAN" "drill:=$DRILL")
  if "$SCRIPTED"; then LAUNCH_ARGS+=("drill_args:=--scripted" gui:=none inputs:=none); fi
}

# name_simulated: lists the robots of --sim at once: the settings of simulated runs keep none.
name_simulated() {
  if [ -n "$SIM" ] && [ -z "$DRILL" ] && ! "$DEMO" &&
    [[ " ${LAUNCH_ARGS[*]}" != *" robots:="* && " ${LAUNCH_ARGS[*]}" != *" sim_prefix:="* ]]; then
    LAUNCH_ARGS=("robots:=$(seq -s ' ' -f 'bot%g' "$SIM")" "${LAUNCH_ARGS[@]}")
  fi
  ! "$FRESH" || LAUNCH_ARGS+=("fresh:=true")
}

# check_links: makes an endpoint of each bare address in LINKS.
check_links() {
  local index link
  [ -z "$ROUTER" ] || check_endpoint --router "$ROUTER"
  [ -z "$ROUTER" ] || [ "${#LINKS[@]}" -gt 0 ] ||
    usage_error "--router: name the robots behind it, such as --link \"bot1 bot2\""
  for index in "${!LINKS[@]}"; do
    link=${LINKS[index]}
    if [ -n "$ROUTER" ] && [[ $link =~ ^[A-Za-z][A-Za-z0-9_]*$ ]]; then continue; fi
    # Without a protocol mhri_link takes tls/ where keys are in place, else tcp/.
    [[ $link == *=*:* ]] || link=$link:7447
    [[ $link != *=*/* ]] || check_endpoint --link "${link#*=}"
    [[ $link =~ ^[A-Za-z][A-Za-z0-9_]*=((tcp|tls)/)?[A-Za-z0-9.-]+:[0-9]{1,5}$ ]] ||
      usage_error "--link: '${LINKS[index]}' is not NAME=ADDRESS such as bot1=192.168.0.7"
    LINKS[index]=$link
  done
}

# look QUESTION...: asks before_start.py; on a bare machine python3 comes with the other packages.
look() {
  command -v python3 >/dev/null || return 0
  python3 "$REPO/utils/host/before_start.py" "$@"
}

# roslaunch accepts any argument, so without this a misspelled enabling:=pedal would start without
# the pedal.
check_launch_arguments() {
  local wrong args=("${LAUNCH_ARGS[@]}") file=mhri.launch
  [ -z "$REPLAY" ] || file=replay.launch
  [ -z "$SIM_TYPES" ] || args+=("sim_types:=$SIM_TYPES")
  wrong=$(look arguments "$REPO/launch/$file" "${args[@]}")
  [ -z "$wrong" ] || usage_error "$wrong"
}

# Reports a picture that cannot be written before the drive, not after it.
check_picture() {
  local folder
  "$DEMO" || return 0
  PICTURE=$(realpath -m -- "${PICTURE:-mhri-demo.png}")
  folder=$(dirname "$PICTURE")
  [[ $PICTURE != *\'* ]] || usage_error "--screenshot: a quote is in $PICTURE: choose another name"
  [ ! -d "$PICTURE" ] || usage_error "--screenshot: $PICTURE is a folder"
  [ -d "$folder" ] || usage_error "--screenshot: there is no folder $folder"
  [ -w "$folder" ] || usage_error "--screenshot: cannot write to $folder"
}

is_loopback() { [[ $1 == localhost || $1 == 127.* ]]; }

# own_addresses: sets the caller's all (this computer's addresses) and v4 (those ROS 1 can use).
own_addresses() {
  local address
  read -r -a all < <(hostname -I) || true
  for address in "${all[@]}"; do
    if valid_ip "$address"; then v4+=("$address"); fi
  done
}

# check_own_address: given the address of another computer, roslaunch would only say after the build that it
# cannot contact its own server. An address that a router forwards to this computer is right,
# though.
check_own_address() {
  local all=() v4=()
  if is_loopback "$IP"; then return 0; fi
  own_addresses
  [[ " ${v4[*]} " == *" $IP "* ]] || [ "$(look reaches "$IP")" = yes ] ||
    usage_error "--ip: $IP is not an address of this computer; it has" "${v4[@]}" 127.0.0.1
}

# choose_address: sets IP if --ip did not.
choose_address() {
  local master_host=${MASTER#http://} all=() v4=()
  master_host=${master_host%:*}
  if [ -n "$IP" ]; then
    check_own_address
    return
  fi
  if is_loopback "$master_host" || { [ -n "$SIM$REPLAY$DRILL" ] && [ -z "$MASTER" ]; }; then
    IP=127.0.0.1
    return
  fi
  own_addresses
  if [ "${#v4[@]}" = 0 ]; then
    die "this computer has no IPv4 address${all:+ (only ${all[*]}, and ROS 1 needs one)}:" \
      "connect it to the robots' network, or name an address with --ip ADDR;" \
      "simulated robots (--sim 3) need no network"
  fi
  IP=${v4[0]}
  [ "${#v4[@]}" = 1 ] || say "this computer has several addresses (${v4[*]}): taking $IP;" \
    "choose another with --ip ADDR"
}

# free_port: prints one that the kernel gives to nobody who asks for any (32768 and above), as each
# node does: one of them could have it before the master.
free_port() {
  python3 -I -c 'import random, socket
while True:
    with socket.socket() as sock:
        try:
            sock.bind(("", random.randrange(12000, 32768)))
        except OSError:
            continue
        print(sock.getsockname()[1])
        break'
}

# A second mux would take the robots from the first, and leave its panel with nothing.
check_alone() {
  local running
  running=$(look running "$MASTER")
  [ -z "$running" ] ||
    die "mhri already runs at $MASTER: $running. Close that panel first (if there is none: Ctrl-C" \
      "in the terminal it was started from), or start a second system with its own master:" \
      "--master http://$IP:$((10#${MASTER##*:} + 1))"
}

check_master() {
  local host=${MASTER#http://} who="sudo ss -ltnp 'sport = :${MASTER##*:}'"
  host=${host%:*}
  case "$(look master "$MASTER")" in
    master)
      check_alone
      say "a ROS master runs at $MASTER: joining it" ;;
    other) die "something other than a ROS master uses $MASTER: find it there with $who," \
      "or choose another port with --master http://$IP:11312" ;;
    silent) die "$MASTER takes the connection but does not answer within 3 s: a ROS master that is" \
      "overloaded or hangs, or something else. Robots may depend on it: find it there," \
      "with $who and top, and try again; or choose another port with --master http://$IP:11312" ;;
    nothing)
      # roslaunch starts a master only on its own machine.
      is_loopback "$host" || [ "$host" = "$IP" ] || [ "$host" = "$(hostname)" ] ||
        [[ " $(hostname -I) " == *" $host "* ]] ||
        die "there is no ROS master at $MASTER: start it there first, or leave out --master to" \
          "start one here" ;;
  esac
}

choose_network() {
  if "$DEMO" || [ -n "$REPLAY" ]; then MASTER="http://127.0.0.1:$(free_port)"; fi
  MASTER=${MASTER:-http://$IP:11311}
  export ROS_MASTER_URI=$MASTER ROS_IP=$IP ROS_HOSTNAME=$IP
  check_master
}

# An installed copy of this script has its setup file above it, and nothing to build.
prepare_code() {
  local installed="$REPO/../../setup.bash"
  if [ ! -f "$REPO/CMakeLists.txt" ] && [ -f "$installed" ]; then
    source_setup "$installed"
    return
  fi
  install_missing run
  [ "${#LINKS[@]}" = 0 ] || install_link
  if [ "$SPACE" = install ]; then
    needs_plain_path "catkin's installation"
    build_workspace OFF install
  else
    build_workspace OFF
  fi
  source_setup "$WS/$SPACE/setup.bash"
}

prepare_display() {
  [[ " ${LAUNCH_ARGS[*]} " != *" gui:=none "* ]] || return 0
  [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || return 0
  start_xvfb
  say "there is no display: the panel runs under Xvfb, on $DISPLAY. To look at it:" \
    "XAUTHORITY=$XAUTHORITY DISPLAY=$DISPLAY import -window root picture.png (from imagemagick)"
}

# Sends one signal, however often it is called: roslaunch then ends its nodes in order, while the
# mux and the panel send their zeros, and kills those that do not end. SIGTERM, since a shell starts
# background jobs with SIGINT ignored.
stop() {
  # bash takes a second signal for part of a $(...) that it is reading, and ends without passing on any.
  trap '' INT TERM HUP
  STOPPED_WITH=$1
  say "ending"
  if [ -z "$LAUNCH_PID" ]; then exit "$1"; fi
  kill -TERM "$LAUNCH_PID" 2>/dev/null || true
}

launch() {
  local status=0 file=mhri.launch args=("sim:=${SIM:-0}" "${LAUNCH_ARGS[@]}")
  [ -z "$SIM_TYPES" ] || args+=("sim_types:=$SIM_TYPES")
  [ "${#LINKS[@]}" = 0 ] || args+=("links:=${LINKS[*]}" "keys:=${KEYS:-auto}"
    "keep:=${KEEP:-session}")
  [ -z "$ROUTER" ] || args+=("router:=$ROUTER")
  if "$DEMO"; then
    args+=("demo:=true" "screenshot:=$PICTURE" "demo_result:=$SCRATCH/demo_result")
  fi
  [ -z "$REPLAY" ] || { file=replay.launch; args=("path:=$REPLAY" "${LAUNCH_ARGS[@]}"); }
  say "ROS_MASTER_URI=$ROS_MASTER_URI ROS_IP=$ROS_IP ROS_HOSTNAME=$ROS_HOSTNAME"
  # In its own session: Ctrl-C in the terminal reaches only this script, which passes it on once.
  # Should this script be killed, the kernel passes it on.
  MHRI_RUN_ID=$RUN_ID MHRI_PANEL_STATUS="$SCRATCH/panel_status" \
    setsid setpriv --pdeathsig TERM roslaunch mhri "$file" "${args[@]}" &
  LAUNCH_PID=$!
  while kill -0 "$LAUNCH_PID" 2>/dev/null; do
    status=0
    wait "$LAUNCH_PID" || status=$?
  done
  [ -n "$STOPPED_WITH" ] || "$DEMO" || check_panel
  return "${STOPPED_WITH:-$status}"
}

# roslaunch ends with 0, whatever the panel's exit status.
check_panel() {
  local status=0
  [ ! -s "$SCRATCH/panel_status" ] || status=$(cat "$SCRATCH/panel_status")
  [ "$status" = 0 ] || ! "$SCRIPTED" || die "the drill was not completed: see above"
  [ "$status" = 0 ] || die "the panel failed (its exit status was $status): see above"
}

demo_verdict() {
  local verdict=
  [ ! -f "$SCRATCH/demo_result" ] || verdict=$(cat "$SCRATCH/demo_result")
  [ "$verdict" = ok ] || die "the demo failed: ${verdict:-it ended without a result}"
  say "the demo succeeded; its pictures are $PICTURE and five beside it"
}

main() {
  parse_arguments "$@"
  check_arguments
  check_picture
  check_launch_arguments
  if "$DEMO"; then SIM=${SIM:-4}; fi
  os_family >/dev/null
  choose_address
  make_scratch
  trap clean_up EXIT
  trap 'stop 130' INT
  trap 'stop 143' TERM HUP
  prepare_code
  choose_drill
  name_simulated
  # Again, for a machine that had no Python or no YAML before.
  check_launch_arguments
  choose_network
  prepare_display
  launch
  if "$DEMO"; then demo_verdict; fi
}

main "$@"

# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Shared by turtle_remote.sh and the scripts of utils/host: checks of their arguments. Sourced,
# never run; usage_error is the script's own. Works with the bash of Ubuntu 16.04.

# Numbers, order, ranges such as [a-z] and the words of tools are the same in every language; the
# characters stay the user's.
[ -z "${LC_ALL:-}" ] || export LC_CTYPE=$LC_ALL
unset LC_ALL
export LC_NUMERIC=C LC_COLLATE=C LC_TIME=C LC_MESSAGES=C

# unarmed TEXT: prints it without control characters, which a terminal would obey.
unarmed() { printf '%s' "${1//[[:cntrl:]]/?}"; }

# brief TEXT: prints as much of a typed text as fits into a line or two, in ASCII.
brief() {
  local LC_ALL=C text=$1
  [ "${#text}" -le 500 ] || text="${text:0:300} ... ${text: -170}"
  printf '%s' "${text//[^[:print:]]/?}"
}

# valid_ip TEXT: true if it is an IPv4 address. Not with leading zeros, which some programs drop and
# others take for octal: 010.1.1.1 would be 10.1.1.1 here and 8.1.1.1 there.
valid_ip() {
  local part octets
  [[ $1 =~ ^(0|[1-9][0-9]{0,2})(\.(0|[1-9][0-9]{0,2})){3}$ ]] || return 1
  IFS=. read -r -a octets <<<"$1"
  for part in "${octets[@]}"; do [ "$part" -le 255 ] || return 1; done
}

# check_ip WHAT TEXT EXAMPLE: a usage error if TEXT is not an IPv4 address.
check_ip() {
  local plain=$2
  if valid_ip "$2"; then return; fi
  [ "${#plain}" -le 40 ] || plain=
  while [[ $plain =~ ^(.*\.)?0+([0-9].*)$ ]]; do plain=${BASH_REMATCH[1]}${BASH_REMATCH[2]}; done
  if valid_ip "$plain"; then
    usage_error "$1: '$2' has leading zeros, which programs read differently: write $plain"
  fi
  usage_error "$1: '$2' is not an IPv4 address such as $3"
}

# value OPTION [VALUE]: prints the value of an option; a usage error if there is none.
value() {
  case "${2:-}" in
    '' | -*) usage_error "$1 needs a value" ;;
    # One at the end would be lost on the way to the variable, before any check.
    *[[:cntrl:]]*) usage_error "$1: a control character is in '$2'" ;;
  esac
  [ "${#2}" -le 512 ] || usage_error "$1: '$2' is too long: at most 512 characters"
  printf '%s' "$2"
}

# check_name NAME
check_name() {
  [[ $1 =~ ^[A-Za-z][A-Za-z0-9_]{0,31}$ ]] ||
    usage_error "NAME: '$1' is not a robot's name: a letter, then letters, digits and _"
  case $1 in
    mhri | mux | mux_in | panel_in | robot_controller)
      usage_error "NAME: '$1' is a name of mhri itself: choose another one" ;;
  esac
}

# check_port OPTION PORT
check_port() {
  if ! [[ $2 =~ ^[0-9]{1,5}$ ]] || [ "$((10#$2))" -gt 65535 ] || [ "$((10#$2))" = 0 ]; then
    usage_error "$1: there is no port '$2'"
  fi
}

# check_guard: BRAKE and BACK_AFTER, beside GUARD.
check_guard() {
  [[ -z $BACK_AFTER || $BACK_AFTER =~ ^[1-9][0-9]{0,3}$ && $BACK_AFTER -le 3600 ]] ||
    usage_error "--back-after: '$BACK_AFTER' is not a whole number of seconds from 1 to 3600"
  if ! "$GUARD" && { "$BRAKE" || [ -n "$BACK_AFTER" ]; }; then
    usage_error "--brake and --back-after are done by mhri_guard: leave out --no-guard"
  fi
}

# check_endpoint OPTION ENDPOINT: ADDRESS:PORT, with or without a protocol.
check_endpoint() {
  local port=${2##*:}
  [[ $2 != udp/* && $2 != quic/* ]] ||
    usage_error "$1: '$2': ${2%%/*}/ is no longer a way to connect: give ${2#*/}, with keys" \
      "(mhri_keys.sh), which drive on a bad radio, or with --keys off on a network that you trust"
  if ! [[ $2 =~ ^((tcp|tls)/)?[A-Za-z0-9.-]+:[0-9]{1,5}$ ]] || [ "$((10#$port))" -gt 65535 ]; then
    usage_error "$1: '$2' is not an endpoint such as 192.168.0.7:7447 or tls/192.168.0.7:7447"
  fi
}

# check_link_options: LISTEN, ROUTER, KEYS and KEEP_MB, beside LINK, GUARD and IP.
check_link_options() {
  [ -z "$LISTEN" ] || check_endpoint --listen "$LISTEN"
  [ -z "$ROUTER" ] || check_endpoint --router "$ROUTER"
  if ! "$LINK"; then
    [ -z "$LISTEN$ROUTER$KEYS$KEEP_MB" ] ||
      usage_error "--listen, --router, --keys and --keep-mb go with --link"
    return
  fi
  [[ $KEYS =~ ^(off|)$ ]] ||
    usage_error "--keys: '$KEYS' is not off; where a key is in place (mhri_keys.sh put) it is used"
  [[ $KEEP_MB =~ ^([1-9][0-9]{1,5}|)$ ]] ||
    usage_error "--keep-mb: '$KEEP_MB' is not a number of MB from 10 to 999999"
  [ -z "$LISTEN" ] || [ -z "$ROUTER" ] || usage_error "--router replaces --listen"
  "$GUARD" || usage_error "a linked robot is driven through its guard alone: leave out --no-guard"
  [ -z "$IP" ] || usage_error "--ip does not go with --link, whose nodes stay on the robot: say where" \
    "the host calls with --listen"
}

# check_robot: checks TYPE, MODEL, LAUNCH, IP and PORT, as far as given, before anything starts or is
# sent. TYPE becomes the name of a template, and PORT a plain number.
check_robot() {
  [[ -z $TYPE || $TYPE =~ ^[a-z][a-z0-9_]{0,31}$ ]] ||
    usage_error "--type: '$TYPE' is not a robot type such as turtlebot2"
  [[ -z $MODEL || $MODEL =~ ^(burger|waffle|waffle_pi)$ ]] ||
    usage_error "--model: '$MODEL' is none of burger, waffle, waffle_pi"
  [[ -z $LAUNCH || $LAUNCH =~ ^[A-Za-z0-9_./~+-]+$ ]] ||
    usage_error "--launch: '$LAUNCH' is neither a path nor PACKAGE/FILE.launch"
  [ -z "$IP" ] || check_ip --ip "$IP" 192.168.0.7
  check_port --port "$PORT"
  PORT=$((10#$PORT))
  check_type
}

# check_type: checks that TYPE, MODEL and --launch go together.
check_type() {
  local model
  case "$TYPE" in
    turtlebot3_burger | turtlebot3_waffle | turtlebot3_waffle_pi)
      model=${TYPE#turtlebot3_}
      [ -z "$MODEL" ] || [ "$MODEL" = "$model" ] ||
        usage_error "--model $MODEL does not go with --type $TYPE"
      MODEL=$model
      TYPE=turtlebot3 ;;
  esac
  case "$TYPE" in
    turtlebot2 | turtlebot3)
      [ -z "$LAUNCH" ] || usage_error "--launch is for other robots than --type $TYPE" ;;
    '') [ -z "$LAUNCH" ] || TYPE=generic ;;
    *) [ -n "$LAUNCH" ] ||
      usage_error "--type $TYPE: name the robot's own launch file with --launch" ;;
  esac
  [ -z "$MODEL" ] || [ -z "$TYPE" ] || [ "$TYPE" = turtlebot3 ] ||
    usage_error "--model goes with --type turtlebot3"
}

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Makes the keys by which computers and robots know each other; --help is the manual.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"
# shellcheck source-path=SCRIPTDIR source=key_authority.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/key_authority.sh"
# shellcheck source-path=SCRIPTDIR source=robot_login.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/robot_login.sh"

help_text() {
  cat <<'HELP'
Usage: mhri_keys.sh COMMAND [OPTION]...

Makes an authority, a key for each operator's computer and one for each robot, and puts them in
place. With them both ends of mhri_link know each other (TLS both ways), and nobody else is let in.
Lists that are put in place again are in use within seconds.

  new                  make the authority
  host NAME            make a key for a computer that may drive
  robot NAME           make a key for a robot
  router NAME          make a key for a router between computers and robots that do not reach each
                       other; put all other keys in place again: so they know it
  put NAME             put a key in place on this computer: ~/.config/mhri/keys
  put NAME USER@IP     put a key in place on a robot or another computer, over ssh
  list                 show who has a key, and until when
  check                look for what is wrong with the keys; exit status 1 if something is
  renew NAME           make the key anew, for the same name; the old one ends on its day
  withdraw NAME        take a key back, such as one that was stolen; then put the others in place
                       again: they get the list of those withdrawn

  --watch              host: it may only watch; robot: it is only watched
  --ip ADDR            host, robot, router: its address, for programs that compare it (may be repeated)
  --days N             host, robot, router, renew: how long the key is good (default 365, at most
                       3650)
  --folder FOLDER      where the authority is (default ~/.config/mhri/authority)
  --ssh-port PORT      put: the port of the ssh server (default: from ssh's settings, else 22)
  --to FOLDER          put: the key goes into FOLDER/keys in USER's home (default mhri)
  -h, --help           this text

Exit status: 0 done, 1 not done or something is wrong, 2 wrong option, 130 or 143 ended by Ctrl-C
or a signal.

Example
  mhri_keys.sh new
  mhri_keys.sh host lab
  mhri_keys.sh put lab
  mhri_keys.sh robot bot1 --ip 192.168.0.7
  mhri_keys.sh put bot1 turtlebot@192.168.0.7
HELP
}

CONFIG=${XDG_CONFIG_HOME:-${HOME:-/root}/.config}/mhri
AUTHORITY=$CONFIG/authority
PLACE=$CONFIG/keys
AUTHORITY_DAYS=3650
# The files that a key's owner needs beside own.key and own.pem: withdrawn.pem is the list withdrawn, signed.
COMMON=(authority.pem peers withdrawn withdrawn.pem)
FILES=(own.key own.pem "${COMMON[@]}")
# A clock with a larger error than this is reported [s].
CLOCK_S=300

COMMAND=
NAME=
LOGIN=
WATCH=false
ADDRESSES=()
DAYS=
SSH_PORT=
FOLDER=
ROBOT_USER=
ROBOT_IP=

# Runs on the robot, as sh. $1 is the folder in the home; the rest are the files, in order. Prints a
# checksum of them all, and the clock.
# shellcheck disable=SC2016 # the dollars are the robot's
RECEIVE='cd || exit 1
umask 077
mkdir -p "$1" || exit 1
chmod 700 "$1" || exit 1
cd "$1" || exit 1
shift
new=.incoming.$$
trap "rm -rf $new" 0
trap "exit 1" 1 2 15
mkdir "$new" || exit 1
tar -x -o -C "$new" || exit 1
for file in "$@"; do
mv -f "$new/$file" . || exit 1
done
cat "$@" | sha256sum
date +%s'

parse_arguments() {
  local words=()
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --watch) WATCH=true ;;
      --ip) ADDRESSES+=("$(value "$@")"); shift ;;
      --days) DAYS=$(value "$@"); shift ;;
      --folder) AUTHORITY=$(value "$@"); shift ;;
      --ssh-port) SSH_PORT=$(value "$@"); shift ;;
      --to) FOLDER=$(value "$@"); shift ;;
      -*) usage_error "there is no option $1" ;;
      *) words+=("$1") ;;
    esac
    shift
  done
  COMMAND=${words[0]:-}
  NAME=${words[1]:-}
  LOGIN=${words[2]:-}
  case "$COMMAND ${#words[@]}" in
    'new 1' | 'list 1' | 'check 1' | 'put 3') ;;
    'host 2' | 'robot 2' | 'router 2' | 'put 2' | 'renew 2' | 'withdraw 2') ;;
    new\ * | list\ * | check\ *) usage_error "$COMMAND goes without a name: '$NAME'" ;;
    put\ *) usage_error "give the name of a key, and where it goes: put NAME [USER@IP]" ;;
    host\ * | robot\ * | router\ * | renew\ * | withdraw\ *) usage_error "give one name: $COMMAND NAME" ;;
    ' 0') usage_error "give a command: new, host, robot, router, put, list, check, renew or withdraw" ;;
    *) usage_error "there is no command '$COMMAND'" ;;
  esac
}

# goes_with OPTION COMMAND...: a usage error if the option is not for this command.
goes_with() {
  local option=$1
  shift
  [[ " $* " == *" $COMMAND "* ]] || usage_error "$option does not go with $COMMAND"
}

check_arguments() {
  local address
  [ "$COMMAND" = new ] || [ -z "$NAME" ] || check_name "$NAME"
  if "$WATCH"; then goes_with --watch host robot; fi
  for address in "${ADDRESSES[@]}"; do
    goes_with --ip host robot router
    check_ip --ip "$address" 192.168.0.7
  done
  if [ -n "$DAYS" ]; then
    goes_with --days host robot router renew
    [[ $DAYS =~ ^[1-9][0-9]{0,3}$ && $DAYS -le 3650 ]] ||
      usage_error "--days: '$DAYS' is not a whole number from 1 to 3650"
  fi
  [ -z "$SSH_PORT" ] || goes_with --ssh-port put
  [ -z "$FOLDER" ] || goes_with --to put
  if [ -n "$LOGIN" ]; then
    [[ $LOGIN == *@* ]] || usage_error "'$LOGIN' is not USER@IP, such as turtlebot@192.168.0.7"
    ROBOT_USER=${LOGIN%@*}
    ROBOT_IP=${LOGIN##*@}
    check_login "$ROBOT_USER" "$ROBOT_IP"
  elif [ -n "$SSH_PORT$FOLDER" ]; then
    usage_error "--ssh-port and --to go with put NAME USER@IP"
  fi
  check_ssh_port "$SSH_PORT"
  FOLDER=${FOLDER:-mhri}
  check_folder "$FOLDER"
  AUTHORITY=$(readlink -m -- "$AUTHORITY")
}

new_authority() {
  local began
  [ ! -e "$AUTHORITY/authority.pem" ] || die "there is an authority in $AUTHORITY already. Another" \
    "one makes all its keys useless: give it another --folder"
  mkdir -p "$AUTHORITY/issued" "$AUTHORITY/keys" || die "cannot write to $AUTHORITY"
  private "$AUTHORITY"
  (cd "$AUTHORITY" && : >index.txt && echo 01 >crlnumber && write_settings)
  run_openssl "make a key" genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 \
    -out authority.key
  run_openssl "ask for a certificate" req -new -config authority.cnf -key authority.key \
    -subj "/CN=authority:$(openssl rand -hex 4)" -out authority.csr
  # A day ago: the clocks of robots may be a little behind.
  began=$(moment 'now - 1 day')
  run_openssl "sign the authority" ca -batch -notext -config authority.cnf -selfsign \
    -keyfile authority.key -in authority.csr -extensions authority -startdate "$began" \
    -enddate "$(moment "now + $AUTHORITY_DAYS days")" -out authority.new
  write_lists
  mv "$AUTHORITY/authority.new" "$AUTHORITY/authority.pem"
  say "the authority is in $AUTHORITY, good for ten years. Anybody with authority.key can make keys:" \
    "keep a copy in a safe place, and share it with nobody"
  say "next: 'mhri_keys.sh host NAME' makes a key for this computer"
}

# first_key ROLE: makes the first key of a name.
first_key() {
  local role=$1 address names="DNS:$NAME"
  [ ! -e "$AUTHORITY/keys/$NAME" ] ||
    die "there is a key for $NAME already: 'renew $NAME' makes it anew, 'withdraw $NAME' takes it back"
  for address in "${ADDRESSES[@]}"; do names+=",IP:$address"; done
  case "$role $WATCH" in
    'host true') role=watch ;;
    'robot true') role=watched ;;
  esac
  make_key "$(common_name "$role")" "$names"
  say "$NAME has a key, $(meaning "$role"), until $(last_day "$NAME")"
  next_put
}

# meaning ROLE
meaning() {
  case "$1" in
    host) printf 'a computer that may drive' ;;
    watch) printf 'a computer that may only watch' ;;
    robot) printf 'a robot' ;;
    router) printf 'a router, which passes on what others say' ;;
    watched) printf 'a robot that is only watched' ;;
  esac
}

next_put() {
  say "next: put it in place with 'mhri_keys.sh put $NAME' on this computer, or with" \
    "'mhri_keys.sh put $NAME USER@IP' on another; and put those of the others in place again, which" \
    "then know it"
}

# known: dies unless NAME has a key.
known() {
  [ -e "$AUTHORITY/keys/$NAME/own.pem" ] ||
    die "there is no key for $NAME; there are: $(key_names | tr '\n' ' ')"
}

renew() {
  local common names
  known
  common=$(owner "$NAME")
  names=$(cat "$AUTHORITY/keys/$NAME/names")
  make_key "$common" "$names"
  say "$NAME has a new key, until $(last_day "$NAME"). The old one is good until its own last day:" \
    "if somebody else may have it, withdraw it instead"
  next_put
}

withdraw() {
  local common serial other others=()
  known
  common=$(owner "$NAME")
  while read -r serial other _; do
    [ "$other" = "$common" ] || continue
    run_openssl "withdraw the key" ca -config authority.cnf -revoke "issued/$serial.pem"
  done < <(with_state V)
  rm -rf "$AUTHORITY/keys/$NAME"
  write_lists
  mapfile -t others < <(key_names)
  say "the key of $NAME is withdrawn, with all that it had before. The others know it once they have" \
    "the new list: put each in place again (mhri_keys.sh put NAME [USER@IP]): ${others[*]:-nobody}"
  say "a new key for $NAME is made with 'host $NAME' or 'robot $NAME'"
}

# look: prints a line for each key; false if something is wrong.
look() {
  local wrong fine=true
  for NAME in $(key_names); do
    wrong=$(problem "$AUTHORITY/keys/$NAME" "$AUTHORITY")
    if [ -n "$wrong" ]; then fine=false; fi
    printf '%-32s %-32s %s\n' "$NAME" "$(owner "$NAME" 2>/dev/null)" "${wrong:-$(left "$NAME")}"
  done
  "$fine"
}

list() {
  local serial common
  look || true
  while read -r serial common _; do
    printf '%-32s %-32s %s\n' '' "$common" "withdrawn, serial number $serial"
  done < <(with_state R)
}

check() {
  local wrong fine=true
  look || fine=false
  if [ -e "$PLACE/own.pem" ]; then
    wrong=$(problem "$PLACE" "$AUTHORITY")
    if [ -z "$wrong" ] && ! cmp -s "$PLACE/withdrawn" "$AUTHORITY/withdrawn"; then
      wrong="its list of those withdrawn is old: put it in place again"
    fi
    if [ -n "$wrong" ]; then fine=false; fi
    say "in place on this computer ($PLACE): ${wrong:-good}"
  else
    say "no key is in place on this computer: 'mhri_keys.sh put NAME' does that"
  fi
  "$fine"
}

# collect: puts all that belongs to NAME's key into SCRATCH/put.
collect() {
  mkdir "$SCRATCH/put"
  (cd "$AUTHORITY" && cp "${COMMON[@]}" "keys/$NAME/own.key" "keys/$NAME/own.pem" "$SCRATCH/put")
  chmod 600 "$SCRATCH"/put/*
}

put_here() {
  local file
  mkdir -p "$PLACE" || die "cannot write to $PLACE"
  chmod 700 "$PLACE"
  for file in "${FILES[@]}"; do
    # Atomically: it may be read at this moment.
    { cp "$SCRATCH/put/$file" "$PLACE/.$file.new" && mv "$PLACE/.$file.new" "$PLACE/$file"; } ||
      die "cannot write to $PLACE: is the disk full?"
  done
  say "$NAME: the key is in place, in $PLACE"
}

put_there() {
  local said here off
  connect
  said=$(tar -c -C "$SCRATCH/put" --owner=0 --group=0 --mode=go-rwx -- "${FILES[@]}" |
    over_connection "exec sh -c '$RECEIVE' sh $FOLDER/keys ${FILES[*]}") ||
    die "could not write to ~/$FOLDER/keys on $ROBOT_IP: see the message above (is its disk full?)"
  here=$(cd "$SCRATCH/put" && cat "${FILES[@]}" | sha256sum)
  [ "${said%%$'\n'*}" = "$here" ] ||
    die "the files on $ROBOT_IP differ from those sent: check its disk and try again"
  say "$NAME: the key is in place on $ROBOT_IP, in ~/$FOLDER/keys"
  off=$((${said##*$'\n'} - $(date +%s)))
  if [ "${off#-}" -gt "$CLOCK_S" ]; then
    warn "the clock of $ROBOT_IP is $((${off#-} / 60)) minutes" \
      "$([ "$off" -gt 0 ] && printf ahead || printf behind): set it. A day behind," \
      "or beyond the last day of a key, it refuses every key"
  fi
}

put() {
  local wrong
  known
  wrong=$(problem "$AUTHORITY/keys/$NAME" "$AUTHORITY")
  [ -z "$wrong" ] || die "the key of $NAME is not put in place: $wrong"
  collect
  if [ -n "$LOGIN" ]; then put_there; else put_here; fi
}

main() {
  parse_arguments "$@"
  check_arguments
  command -v openssl >/dev/null || die "there is no openssl here: install the package openssl"
  # Only the owner may read the files written here.
  umask 077
  make_scratch
  trap disconnect EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM HUP
  if [ "$COMMAND" = new ]; then new_authority; return; fi
  open_authority
  case "$COMMAND" in
    host | robot | router) first_key "$COMMAND" ;;
    *) "$COMMAND" ;;
  esac
}

main "$@"

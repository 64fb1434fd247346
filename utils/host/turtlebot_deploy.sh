#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Copies the robot's part of mhri to a robot; --help is the manual.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"
# shellcheck source-path=SCRIPTDIR source=robot_login.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/robot_login.sh"

help_text() {
  cat <<'HELP'
Usage: turtlebot_deploy.sh USER@IP [OPTION]...

Copies the files of utils/remote to a robot over one ssh connection. It asks for the password once,
or not at all if ssh has a key. It sends only files that differ, then reads them back and compares
them. It replaces a file in use as a whole and never writes into it.

  USER@IP              the user name on the robot and its address, e.g. turtlebot@192.168.0.7
  --to FOLDER          where to put them, in USER's home (default mhri)
  --ssh-port PORT      the port of the robot's ssh server (default: from ssh's settings, else 22)
  --link               also send what 'turtle_remote.sh --link' needs: mhri_link, its part of mhri,
                       and the library zenoh for the robot's kind of computer, about 10 MB. The
                       robot needs no internet; this computer does, once for each kind
  -h, --help           this text

Exit status: 0 the robot has the files of this computer, 1 it does not, 2 wrong option,
130 or 143 ended by Ctrl-C or a signal.

Example
  turtlebot_deploy.sh turtlebot@192.168.0.7
  turtlebot_deploy.sh ubuntu@192.168.0.8 --link
HELP
}

SOURCE="$REPO/utils/remote"
# On the robot the TurtleBot2's launch file also has the name of the 2016 guide, as a link; not on
# this computer, where launch/mhri.launch has that name.
LINK=mhri.launch
LINK_TO=mhri_turtlebot2.launch
# The files that --link adds, packed in the scratch folder.
WITH_MHRI_LINK=false
ARCHIVE=mhri_link.tar.gz
ROBOT_USER=
ROBOT_IP=
SSH_PORT=
FOLDER=mhri

# Runs on the robot; prints its kind of computer: that of its programs, not of its kernel.
# shellcheck disable=SC2016 # the dollars are the robot's
KIND='dpkg --print-architecture 2>/dev/null || uname -m'
# Runs on the robot, as sh: any robot has that. $1 is the folder in the home, $2 the link, $3 its
# target. Links compare by target, other files by content.
# shellcheck disable=SC2016 # the dollars are the robot's
LIST='cd 2>/dev/null || exit 1
[ -d "$1" ] || exit 0
cd "$1" || exit 1
for file in *; do
if [ "$file" = "$2" ] && [ -h "$file" ]; then kind=l; sum=$(readlink "$file" | sha256sum) || exit 1
elif [ -f "$file" ]; then
if [ -x "$file" ]; then kind=x; else kind=-; fi
sum=$(sha256sum <"$file") || exit 1
else continue; fi
printf "%s %s %s\n" "${sum%% *}" "$kind" "$file"
done'
# Unpacks beside the files and moves them one by one, which replaces each in one step.
# shellcheck disable=SC2016 # the dollars are the robot's
RECEIVE='cd || exit 1
mkdir -p "$1" || exit 1
cd "$1" || exit 1
new=.incoming.$$
trap "rm -rf $new" 0
trap "exit 1" 1 2 15
mkdir "$new" || exit 1
tar -x -o -C "$new" || exit 1
for file in "$new"/*; do
[ ! -f "$file" ] || mv -f "$file" . || exit 1
done
ln -sfn "$3" "$2"'

parse_arguments() {
  local words=()
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --ssh-port) SSH_PORT=$(value "$@"); shift ;;
      --to) FOLDER=$(value "$@"); shift ;;
      --link) WITH_MHRI_LINK=true ;;
      -*) usage_error "there is no option $1" ;;
      *) words+=("$1") ;;
    esac
    shift
  done
  if [ "${#words[@]}" != 1 ] || [[ ${words[0]} != *@* ]]; then
    usage_error "give the user name on the robot and its address: turtlebot_deploy.sh USER@IP"
  fi
  ROBOT_USER=${words[0]%@*}
  ROBOT_IP=${words[0]##*@}
}

# on_robot PROGRAM [ARG]: runs one of the programs above, over the open connection.
on_robot() {
  over_connection "exec sh -c '$1' sh $FOLDER $LINK $LINK_TO"
}

# pack_link: packs what mhri_link needs on the robot, alike for the same content.
pack_link() {
  local machine folder="$SCRATCH/packed" messages="$WS/devel/lib/python3/dist-packages/mhri"
  [ -d "$REPO/src/mhri" ] ||
    die "this is an installed copy, without the sources that --link sends: use that of the checkout"
  [ -d "$messages" ] || die "mhri is not built here yet: start it once, with mhri_run.sh"
  machine=$(on_robot "$KIND") || die "$ROBOT_IP does not say what kind of computer it is"
  case "$machine" in
    amd64 | x86_64) machine=x86_64 ;;
    arm64 | aarch64) machine=aarch64 ;;
    armhf | armv7l) machine=armv7l ;;
    *) die "there is no zenoh for $ROBOT_IP, a $(unarmed "${machine:0:40}"): leave --link out" ;;
  esac
  [ "$machine" != "$(uname -m)" ] || machine=
  MACHINE=$machine install_link
  mkdir -p "$folder/src/mhri" "$folder/resource" "$folder/scripts"
  cp -r "$LIBRARY" "$folder/library"
  cp "$REPO/package.xml" "$folder"
  cp -r "$REPO/resource/robots" "$folder/resource"
  cp "$REPO/scripts/mhri_link" "$folder/scripts"
  # The modules that mhri_link imports are in these.
  (cd "$REPO/src/mhri" &&
    cp -r __init__.py base graph recording robots camera driving link nodes \
      "$folder/src/mhri")
  cp -r "$messages/msg" "$messages/srv" "$folder/src/mhri"
  find "$folder" -name __pycache__ -prune -exec rm -rf {} +
  tar -c -C "$folder" --sort=name --mtime=@0 --owner=0 --group=0 --mode=go-w . |
    gzip -n >"$SCRATCH/$ARCHIVE"
}

# listing: prints checksum, x or -, and name of each file here, one per line.
listing() {
  local file sum kind
  for file in "$SOURCE"/* "$SCRATCH/$ARCHIVE"; do
    [ -f "$file" ] || continue
    sum=$(sha256sum <"$file")
    kind=-
    if [ -x "$file" ]; then kind=x; fi
    printf '%s %s %s\n' "${sum%% *}" "$kind" "${file##*/}"
  done
}

# differing THERE: prints the names of the files here, and of the link, that differ from the robot's
# listing.
differing() {
  local line
  while IFS= read -r line; do
    grep -qxF -- "$line" <<<"$1" || printf '%s\n' "${line:67}"
  done < <(
    listing
    printf '%s l %s\n' "$(printf '%s\n' "$LINK_TO" | sha256sum | cut -d ' ' -f 1)" "$LINK"
  )
}

deploy() {
  local there file files=() sent=()
  if "$WITH_MHRI_LINK"; then pack_link; fi
  there=$(on_robot "$LIST") ||
    die "cannot read ~/$FOLDER on $ROBOT_IP: see the message above"
  mapfile -t files < <(differing "$there")
  if [ "${#files[@]}" = 0 ]; then
    say "$ROBOT_IP has all $(listing | wc -l) files, unchanged: nothing to send"
    return
  fi
  say "sending to $ROBOT_IP:$FOLDER: ${files[*]}"
  for file in "${files[@]}"; do
    case "$file" in
      "$LINK") ;;
      "$ARCHIVE") sent+=(-C "$SCRATCH" "$ARCHIVE") ;;
      *) sent+=(-C "$SOURCE" "$file") ;;
    esac
  done
  # With -T the list of files may be empty, if only the link is missing.
  tar -c --owner=0 --group=0 --mode=go-w -T /dev/null "${sent[@]}" |
    on_robot "$RECEIVE" ||
    die "could not write to ~/$FOLDER on $ROBOT_IP: see the message above (is its disk full?)"
  there=$(on_robot "$LIST") || die "cannot read ~/$FOLDER on $ROBOT_IP again"
  mapfile -t files < <(differing "$there")
  [ "${#files[@]}" = 0 ] ||
    die "the files on $ROBOT_IP differ from those sent (${files[*]}): check its disk and try again"
  say "checked: $ROBOT_IP has all $(listing | wc -l) files, unchanged"
}

main() {
  parse_arguments "$@"
  check_login "$ROBOT_USER" "$ROBOT_IP"
  check_ssh_port "$SSH_PORT"
  check_folder "$FOLDER"
  make_scratch
  trap disconnect EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM HUP
  connect
  deploy
}

main "$@"

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Starts mhri in a Docker container on any Linux; --help is the manual.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

help_text() {
  cat <<'HELP'
Usage: mhri_docker.sh [OPTION]... [OPTION OF mhri_run.sh]...

Starts mhri in a Docker container, on any Linux with Docker. First builds the image "mhri" (Debian 12 and
what mhri_run.sh installs there), if there is none or this checkout has changed. Everything else on the
command line goes to mhri_run.sh in the container: mhri_docker.sh --sim 3

  --dry-run    print the commands and start nothing
  --rebuild    build the image anew, with today's packages
  -h, --help   this text; mhri_run.sh --help lists the options of mhri

The container uses this computer's network, X server (on a Wayland desktop its Xwayland), pads and pedals
(also those plugged in later), sound and microphone, clock, and your home folder under its own name, so
that settings, sessions and files in it are the same as without Docker. It runs as you, needs no GPU, and
is removed when it ends. Without a display the screen runs under Xvfb.
HELP
}

# The tests point it elsewhere.
DEVICES=${MHRI_DEVICES:-}
IMAGE=mhri
DRY=false
REBUILD=false
REST=()
RUN=()

parse_arguments() {
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --dry-run) DRY=true ;;
      --rebuild) REBUILD=true ;;
      *) REST+=("$1") ;;
    esac
    shift
  done
}

# checksum: of all that goes into the image.
checksum() {
  (cd "$REPO" && find . \( -name build -o -name .git -o -name __pycache__ \) -prune -o -type f -print0 |
    sort -z | xargs -0 sha256sum | sha256sum | cut -d ' ' -f 1)
}

# docker_command ARGUMENT...: runs docker, or prints what would be run.
docker_command() {
  if "$DRY"; then
    printf 'docker'; printf ' %q' "$@"; printf '\n'
  else
    docker "$@"
  fi
}

build_image() {
  local sum options=()
  sum=$(checksum)
  if "$REBUILD"; then
    options=(--pull --no-cache)
  elif ! "$DRY" && [ "$sum" = "$(docker image inspect --format '{{index .Config.Labels "mhri.checksum"}}' \
    "$IMAGE" 2>/dev/null)" ]; then
    return 0
  fi
  "$DRY" || say "building the image $IMAGE, which takes some minutes"
  docker_command build "${options[@]}" --label "mhri.checksum=$sum" --tag "$IMAGE" "$REPO" ||
    die "docker could not build the image: see its message above"
}

# add_display: the X server, which mhri also asks which keys are down and watches for STOP ALL.
add_display() {
  local key=${XAUTHORITY:-$HOME/.Xauthority}
  if [ -z "${DISPLAY:-}" ]; then
    [ -z "${WAYLAND_DISPLAY:-}" ] ||
      die "DISPLAY is not set: on a Wayland desktop mhri needs Xwayland, since it watches the stop keys" \
        "through an X server. Start Xwayland, or unset WAYLAND_DISPLAY to run without a screen"
    return 0
  fi
  # Shared memory carries pictures to the X server.
  RUN+=(--ipc host --env "DISPLAY=$DISPLAY" --env QT_QPA_PLATFORM=xcb)
  [ ! -d "$DEVICES/tmp/.X11-unix" ] || RUN+=(--volume "$DEVICES/tmp/.X11-unix:/tmp/.X11-unix:ro")
  [ ! -f "$key" ] || RUN+=(--volume "$key:/run/mhri.xauthority:ro" --env XAUTHORITY=/run/mhri.xauthority)
}

# add_group FILE...: the group that owns the first of these files that exists.
add_group() {
  local file
  for file in "$@"; do
    if [ -e "$file" ]; then
      RUN+=(--group-add "$(stat -c %g "$file")")
      return
    fi
  done
}

add_devices() {
  local sound="${XDG_RUNTIME_DIR:-/run/user/$(id -u)}/pulse/native"
  if [ -d "$DEVICES/dev/input" ]; then
    # The rule (13: input) is for devices that are plugged in later; udev's folder says what they are.
    RUN+=(--volume "$DEVICES/dev/input:/dev/input" --device-cgroup-rule 'c 13:* rmw')
    [ ! -d "$DEVICES/run/udev" ] || RUN+=(--volume "$DEVICES/run/udev:/run/udev:ro")
    add_group "$DEVICES"/dev/input/event*
  fi
  if [ -d "$DEVICES/dev/snd" ]; then
    RUN+=(--device "$DEVICES/dev/snd:/dev/snd")
    add_group "$DEVICES"/dev/snd/control* "$DEVICES"/dev/snd/*
  fi
  [ ! -e "$sound" ] || RUN+=(--volume "$sound:/run/mhri.pulse" --env PULSE_SERVER=unix:/run/mhri.pulse)
}

run_container() {
  local folder=$PWD
  # Signals reach mhri_run.sh, whose zeros and end take up to half a minute at worst.
  RUN=(run --rm --init --stop-timeout 30 --network host --user "$(id -u):$(id -g)"
    --env "HOME=$HOME" --env "USER=${USER:-mhri}" --volume "$HOME:$HOME")
  [[ $folder/ == "$HOME"/* ]] || folder=$HOME
  RUN+=(--workdir "$folder")
  [ ! -t 0 ] || RUN+=(--interactive --tty)
  [ ! -e /etc/localtime ] || RUN+=(--volume "$(readlink -f /etc/localtime):/etc/localtime:ro")
  add_display
  add_devices
  RUN+=("$IMAGE" "${REST[@]}")
  if "$DRY"; then docker_command "${RUN[@]}"; else exec docker "${RUN[@]}"; fi
}

main() {
  parse_arguments "$@"
  "$DRY" || command -v docker >/dev/null ||
    die "there is no docker on this computer: install it first (Debian and Ubuntu: sudo apt-get install docker.io)"
  build_image
  run_container
}

main "$@"

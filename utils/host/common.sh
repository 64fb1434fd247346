# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Shared by the scripts in this folder: messages, arguments, packages, the workspace, a display
# without a screen. Sourced, never run.

REPO=$(cd -P "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
# shellcheck source-path=SCRIPTDIR source=../remote/turtle_arguments.sh
. "$REPO/utils/remote/turtle_arguments.sh"
WS="$REPO/build/.ws"
# The tests point these elsewhere to try other systems.
OS_RELEASE=${MHRI_OS_RELEASE:-/etc/os-release}
NOETIC=${MHRI_NOETIC:-/opt/ros/noetic}
RUN_ID="mhri-$$-$RANDOM$RANDOM"
SCRATCH=
XVFB_PID=
PACKAGES=()
LIBRARY=

# A terminal's namespace is meant for a robot, not for the host.
unset ROS_NAMESPACE

# The system's python3 must come first: ROS is not installed for any other.
[ "$(command -v python3)" = /usr/bin/python3 ] || export PATH="/usr/bin:$PATH"

DEBIAN_RUN=(
  catkin cmake g++ make python3-catkin-pkg ros-message-generation ros-message-runtime
  python3-setuptools python3-roslaunch python3-rosgraph python3-rospkg python3-rospy
  python3-rosbag python3-rosnode python3-rosparam python3-rosservice python3-rostopic rosbash
  ros-std-msgs ros-geometry-msgs ros-actionlib-msgs libactionlib-msgs-dev python3-actionlib
  python3-actionlib-msgs python3-std-msgs python3-geometry-msgs python3-sensor-msgs python3-nav-msgs python3-std-srvs
  python3-move-base-msgs
  python3-tf2-msgs python3-rosgraph-msgs python3-diagnostic-msgs python3-diagnostic-updater
  python3-cv-bridge python3-python-qt-binding python3-pyqt5 python3-pyqtgraph python3-pygame
  python3-evdev python3-pocketsphinx pocketsphinx-en-us python3-pyaudio
  python3-numpy python3-opencv python3-yaml python3-genpy python3-jinja2 python3-psutil
  python3-cryptography python3-aiohttp python3-qrcode
  fonts-dejavu-core
  libturbojpeg0 openssh-client openssl
  xvfb xauth hostname util-linux
)
DEBIAN_TEST=(
  librostest-dev python3-rostest python3-roslib topic-tools python3-pytest python3-pytest-timeout
  python3-flake8 python3-flake8-docstrings python3-pip python3-rosdep2 catkin-lint shellcheck mkdocs
  xdotool imagemagick x11-utils git procps espeak-ng sox ffmpeg openssh-server iproute2 nftables
  locales chromium chromium-driver python3-selenium
)
# Only for the fast group of tests; most have the same names on Ubuntu.
FAST=(
  python3-catkin-pkg python3-cryptography python3-evdev python3-flake8 python3-jinja2 python3-numpy python3-opencv
  python3-pip python3-psutil python3-pyaudio python3-pytest python3-pytest-timeout python3-rospkg
  python3-yaml shellcheck git util-linux
)
# On Ubuntu rosdep reads the ROS packages from package.xml; these have no key there.
UBUNTU_RUN=(
  python3-rosdep build-essential cmake fonts-dejavu-core xvfb xauth hostname util-linux
  openssh-client
)
UBUNTU_TEST=(
  python3-pytest python3-pytest-timeout python3-flake8 python3-pip python3-catkin-lint
  shellcheck mkdocs xdotool imagemagick x11-utils git procps espeak-ng sox ffmpeg openssh-server
  iproute2 nftables locales
)

say() { printf 'mhri: %s\n' "$(unarmed "$*")"; }
warn() { printf 'mhri: %s\n' "$(unarmed "$*")" >&2; }
die() { warn "$*"; exit 1; }
# A wrong command line: exit status 2, before anything starts.
usage_error() { warn "$(brief "$*") (--help lists every option)"; exit 2; }

# Prints whose names of packages this system has, debian or ubuntu, or dies with a list of the supported systems.
os_family() {
  local system
  # shellcheck disable=SC1090 # known at run time only
  system=$(. "$OS_RELEASE" 2>/dev/null && printf '%s' "${ID:-} ${VERSION_ID:-}") || system=
  case "$system" in
    "debian 12") echo debian ;;
    # Its own ROS packages are Debian's.
    "ubuntu 22.04") echo debian ;;
    "ubuntu 20.04")
      [ -f "$NOETIC/setup.bash" ] || die "Ubuntu 20.04 without ROS Noetic: install" \
        "ros-noetic-ros-base first (http://wiki.ros.org/noetic/Installation/Ubuntu)"
      echo ubuntu ;;
    *) die "this system (${system:-unknown}) is not supported: mhri runs on Debian 12 and" \
         "on Ubuntu 20.04 with ROS Noetic. Elsewhere utils/host/mhri_docker.sh runs it in Docker" ;;
  esac
}

# missing_packages NAME...: prints those that are not installed, one per line.
missing_packages() {
  local name
  for name in "$@"; do
    # shellcheck disable=SC2016 # the dollar is dpkg-query's
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] ||
      printf '%s\n' "$name"
  done
}

# as_root COMMAND...: runs it, through sudo if needed.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; return; fi
  command -v sudo >/dev/null ||
    die "this needs administrator rights, and there is no sudo; ask an administrator to run: $*"
  say "asking for administrator rights (sudo) to run: $*"
  sudo "$@"
}

# install_packages NAME...: installs missing packages; with none missing, it uses neither apt nor
# sudo nor the network.
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [ "${#missing[@]}" -gt 0 ] || return 0
  say "installing missing packages with apt: ${missing[*]}"
  as_root apt-get update ||
    warn "could not update the package lists; going on with the present ones"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
    "${missing[@]}" ||
    die "apt could not install the missing packages (${missing[*]}): see its message above"
}

# install_rosdeps: on Ubuntu, installs what package.xml asks for.
install_rosdeps() {
  local keys=(--from-paths "$REPO" --ignore-src --rosdistro noetic)
  if rosdep check "${keys[@]}" >/dev/null 2>&1; then return 0; fi
  say "installing missing packages of package.xml with rosdep"
  [ -f /etc/ros/rosdep/sources.list.d/20-default.list ] || as_root rosdep init
  rosdep update --rosdistro noetic
  # rosdep itself calls sudo if needed.
  rosdep install "${keys[@]}" -r -y || die "rosdep could not install everything: see above"
}

# install_missing run|test|fast: installs everything that this purpose needs.
install_missing() {
  local family
  family=$(os_family)
  if [ "$1" = fast ]; then
    PACKAGES=("${FAST[@]}")
    case "$family" in
      debian) PACKAGES+=(python3-flake8-docstrings catkin-lint libturbojpeg0) ;;
      ubuntu) PACKAGES+=(python3-catkin-lint libturbojpeg) ;;
    esac
    install_packages "${PACKAGES[@]}"
    return
  fi
  case "$family" in
    debian) PACKAGES=("${DEBIAN_RUN[@]}"); [ "$1" = run ] || PACKAGES+=("${DEBIAN_TEST[@]}") ;;
    ubuntu) PACKAGES=("${UBUNTU_RUN[@]}"); [ "$1" = run ] || PACKAGES+=("${UBUNTU_TEST[@]}") ;;
  esac
  install_packages "${PACKAGES[@]}"
  if [ "$family" = ubuntu ]; then
    source_setup "$NOETIC/setup.bash"
    install_rosdeps
  fi
}

# install_link: the library of mhri_link, in a place of mhri's own, for this computer; or with MACHINE
# set, such as aarch64, for one of another kind. This version has wheels for Python 3.8 and later, for PCs and for
# ARM. Only the link needs it. Sets LIBRARY to its folder.
install_link() {
  local library=eclipse-zenoh==1.5.1 machine=${MACHINE:-} options=()
  LIBRARY="$WS/link${machine:+-$machine}"
  [ "$(cat "$LIBRARY/installed" 2>/dev/null)" != "$library" ] || return 0
  if [ -n "$machine" ]; then
    # One platform, as the pip of Ubuntu 20.04 knows no more: that of this version's wheel.
    options=(--only-binary=:all: --python-version 3.8 --implementation cp --abi abi3
      --platform "$([ "$machine" = aarch64 ] && echo manylinux_2_28 || echo manylinux2014)_$machine")
  fi
  python3 -I -m pip --version >/dev/null 2>&1 || install_packages python3-pip
  mkdir -p "$WS"
  say "installing with pip, in $LIBRARY: $library"
  python3 -I -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
    "${options[@]}" --target "$LIBRARY" "$library" ||
    die "pip could not install $library${machine:+ for $machine}, which mhri_link needs: see its" \
      "message above"
  printf '%s' "$library" >"$LIBRARY/installed"
}

# source_setup FILE: sources it without set -u, as catkin's setup files read variables that may not
# be set.
source_setup() {
  set +u
  # shellcheck disable=SC1090 # known at run time only
  . "$1"
  set -u
}

# nothing_changed STAMP: true if a build of the devel space would find nothing to do. Python, launch
# and resource files are used in place, so they need no build.
nothing_changed() {
  local inputs=(CMakeLists.txt package.xml setup.py action msg srv scripts)
  if [ ! -f "$1" ] || [ "$(cat "$1")" != "$REPO" ]; then return 1; fi
  [ -z "$(cd "$REPO" && find "${inputs[@]}" -newer "$1" -print -quit)" ]
}

# needs_plain_path WHO: dies if WHO cannot cope with the checkout's path.
needs_plain_path() {
  [[ $REPO != *[[:space:]]* ]] ||
    die "$1 cannot work in a path with a space in it: move the checkout ($REPO)"
}

# is_built TESTING TARGET: true if such a build would find nothing to do.
is_built() {
  [ -z "$2" ] && [ "$1" = OFF ] && nothing_changed "$WS/built"
}

# build_workspace TESTING [MAKE_TARGET]: builds this checkout in its own workspace; TESTING is ON or
# OFF. The workspace is in build, which rosrun skips when it searches a package, and hidden, which
# roslaunch skips: either would find every file of the package twice. The checkout itself is its
# source folder: a link to it in there would be a loop for any search of the package. What runs
# from here is Python; messages for other languages take half of the build.
build_workspace() {
  local testing=$1 target=${2:-} stamp="$WS/built" log="$WS/build.log"
  [[ $REPO != *[\'\"\$\\\`\;]* ]] ||
    die "catkin and roslaunch cannot work in a path with a quote, a dollar, a backslash or a" \
      "semicolon in it: move the checkout ($REPO)"
  mkdir -p "$WS" 2>/dev/null ||
    die "cannot write to $REPO: the workspace is built there, in build/.ws"
  if ! (: >>"$WS/lock") 2>/dev/null; then
    # Another user's, or on a read-only disk: an existing build runs.
    ! is_built "$testing" "$target" || return 0
    die "cannot write to $WS, where the checkout has to be built (again, if it was): make it" \
      "writable, or copy the checkout"
  fi
  exec {BUILD_LOCK}>"$WS/lock"
  flock "$BUILD_LOCK"
  if is_built "$testing" "$target"; then
    exec {BUILD_LOCK}>&-
    return 0
  fi
  # Stamped with the time of the start: files saved during the build are built next time.
  printf '%s' "$REPO" >"$stamp.new"
  # CMake refuses a build folder made for another place: a copied or moved checkout.
  if [ -f "$WS/place" ] && [ "$(cat "$WS/place")" != "$REPO" ]; then
    rm -rf "$WS/build" "$WS/devel" "$WS/install" "$stamp"
  fi
  printf '%s' "$REPO" >"$WS/place"
  # A workspace set up for the tests stays so: a start in the middle of a test run must not remove
  # its targets.
  if grep -qs '^CATKIN_ENABLE_TESTING:[A-Z]*=ON' "$WS/build/CMakeCache.txt"; then testing=ON; fi
  say "building in $WS (log: $log)"
  # If a master's address is already set, catkin does not bake the default one into the tests'
  # environment.
  (cd -P "$WS" && ROS_MASTER_URI=${ROS_MASTER_URI:-http://127.0.0.1:11311} \
    ROS_LANG_DISABLE=gencpp:geneus:genlisp:gennodejs catkin_make \
    --source "$REPO" -DPYTHON_EXECUTABLE=/usr/bin/python3 "-DCATKIN_ENABLE_TESTING=$testing" \
    ${target:+"$target"}) >"$log" 2>&1 {BUILD_LOCK}>&- || {
    tail -n 40 "$log" >&2
    die "the build failed; the full log is $log"
  }
  mv "$stamp.new" "$stamp"
  exec {BUILD_LOCK}>&-
}

# make_scratch: makes a private folder for this run, SCRATCH; clean_up removes it.
make_scratch() { SCRATCH=$(mktemp -d "${TMPDIR:-/tmp}/mhri.XXXXXX"); }

# start_xvfb: starts a display in memory on a free number, in DISPLAY; only this run has its key.
# The number is chosen here: with -displayfd a server takes no lock, and one that starts while
# another ends may lose its socket.
start_xvfb() {
  local cookie attempt
  cookie=$(mcookie)
  export XAUTHORITY="$SCRATCH/xauthority"
  unset WAYLAND_DISPLAY
  for attempt in 1 2 3 4 5; do
    export DISPLAY=":$((10000 + RANDOM % 40000))"
    : >"$XAUTHORITY"
    xauth -q add "$DISPLAY" . "$cookie"
    # In its own session, so that Ctrl-C does not end the display before the panel has sent its last
    # zero; the kernel ends it should this script be killed.
    setsid setpriv --pdeathsig TERM Xvfb "$DISPLAY" -noreset -screen 0 1920x1080x24 -nolisten tcp \
      -auth "$XAUTHORITY" >"$SCRATCH/xvfb.log" 2>&1 &
    XVFB_PID=$!
    if xvfb_answers; then return; fi
    kill "$XVFB_PID" 2>/dev/null || true
    wait "$XVFB_PID" 2>/dev/null || true
    XVFB_PID=
  done
  die "Xvfb did not start in $attempt attempts: $(tail -n 3 "$SCRATCH/xvfb.log" | tr '\n' ' ')"
}

# xvfb_answers: waits until the new display is usable; false if it ended.
xvfb_answers() {
  local deadline=$((SECONDS + 20))
  while [ "$SECONDS" -lt "$deadline" ] && kill -0 "$XVFB_PID" 2>/dev/null; do
    if python3 -I -c 'import socket, sys
socket.socket(socket.AF_UNIX).connect("/tmp/.X11-unix/X" + sys.argv[1])' "${DISPLAY#:}" \
      2>/dev/null; then return 0; fi
    sleep 0.05
  done
  return 1
}

# end_leftovers: ends what this run started and left running, known by its mark; prints each. Looks
# again until nothing is left: a process may have started others before it ended.
end_leftovers() {
  local entry pid found=true
  while $found; do
    found=false
    for entry in /proc/[0-9]*/environ; do
      pid=${entry#/proc/}
      pid=${pid%/environ}
      if [ "$pid" != "$$" ] && grep -qzsxF "MHRI_RUN_ID=$RUN_ID" "$entry"; then
        warn "ending a leftover process: $pid $(tr '\0' ' ' 2>/dev/null <"/proc/$pid/cmdline")"
        if kill -KILL "$pid" 2>/dev/null; then found=true; fi
      fi
    done
  done
}

# clean_up: for the scripts' exit trap.
clean_up() {
  if [ -n "$XVFB_PID" ]; then
    kill "$XVFB_PID" 2>/dev/null || true
    wait "$XVFB_PID" 2>/dev/null || true
  fi
  end_leftovers
  [ -z "$SCRATCH" ] || rm -rf "$SCRATCH"
}

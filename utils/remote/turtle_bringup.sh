# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# For turtle_remote.sh: finds this robot's ROS, its kind, and the launch files that start it.
# Sourced, never run.
# shellcheck disable=SC2034 # what is set here is used there

PYTHON=
BASE_LAUNCH=()
CAMERA_LAUNCH=()
GUARD_PYTHON=
GUARD_TOPIC=cmd_vel
GUARD_LIMITS=()

# Reads what operators put into ~/.bashrc, which a non-interactive shell skips. Takes over only
# these variables, and only if they are not set.
read_bashrc() {
  local names=() name line
  for name in TURTLEBOT3_MODEL LDS_MODEL TURTLEBOT_BASE TURTLEBOT_BATTERY TURTLEBOT_STACKS \
    TURTLEBOT_3D_SENSOR TURTLEBOT_SIMULATION TURTLEBOT_SERIAL_PORT; do
    [ -n "${!name}" ] || names+=("$name")
  done
  [ "${#names[@]}" -gt 0 ] && [ -f "$HOME/.bashrc" ] || return 0
  while IFS= read -r line; do
    [[ $line =~ ^mhri:([A-Z0-9_]+)=([A-Za-z0-9_./-]+)$ ]] || continue
    export "${BASH_REMATCH[1]}=${BASH_REMATCH[2]}"
  done < <(
    # shellcheck disable=SC2016 # the dollars are those of the inner shell
    timeout 10 setsid bash -ic 'for n; do printf "\nmhri:%s=%s\n" "$n" "${!n}"; done' \
      bash "${names[@]}" </dev/null 2>/dev/null
  )
}

# package NAME: prints its folder; false if ROS or the package is missing.
package() {
  "$PYTHON" -c 'import sys, rospkg
try:
    print(rospkg.RosPack().get_path(sys.argv[1]))
except rospkg.ResourceNotFound:
    sys.exit(1)' "$1" 2>/dev/null
}

# find_python: sets PYTHON to one that finds ROS packages; false if ROS is missing, or incomplete.
find_python() {
  local python
  command -v roslaunch >/dev/null || return 1
  [ -z "$PYTHON" ] || return 0
  # Nodes look for python3 in the path.
  [ "$(command -v python3)" = /usr/bin/python3 ] || export PATH="/usr/bin:$PATH"
  for python in python3 python; do
    if "$python" -c 'import rospkg' >/dev/null 2>&1; then PYTHON=$python; return; fi
  done
  return 1
}

# has_robot: true if everything the robot needs is found now.
has_robot() {
  find_python || return 1
  case "$TYPE" in
    turtlebot2) package turtlebot_bringup >/dev/null ;;
    turtlebot3) package turtlebot3_bringup >/dev/null ;;
    '') package turtlebot_bringup >/dev/null || package turtlebot3_bringup >/dev/null ;;
    *) [[ $LAUNCH == /* ]] || package "${LAUNCH%%/*}" >/dev/null ;;
  esac
}

# find_launch: makes LAUNCH a full path if it is a file; else it must be PACKAGE/FILE.launch.
find_launch() {
  local where=
  [ -n "$LAUNCH" ] || return 0
  if [ -f "$LAUNCH" ]; then LAUNCH=$(readlink -f "$LAUNCH"); return; fi
  if [[ $LAUNCH =~ ^[A-Za-z][A-Za-z0-9_-]*/ ]]; then return; fi
  [[ $LAUNCH == /* ]] || where=" in $PWD"
  die "--launch: there is no file $LAUNCH$where; one of a package is named PACKAGE/FILE.launch"
}

prepare_ros() {
  local setup setups=("$SETUP")
  if [ -z "$SETUP" ]; then
    if has_robot; then return; fi
    setups=("$HOME/catkin_ws/devel/setup.bash" "$HOME/catkin_ws/install/setup.bash"
      /opt/ros/*/setup.bash)
  fi
  for setup in "${setups[@]}"; do
    [ -f "$setup" ] || continue
    # shellcheck disable=SC1090 # known at run time only
    . "$setup"
    if has_robot; then say "using $setup"; return; fi
  done
  find_python || die "there is no ROS here: source the robot's setup.bash first, or name it with" \
    "--setup FILE"
  case "$TYPE" in
    turtlebot2) missing_package turtlebot_bringup ;;
    turtlebot3) missing_package turtlebot3_bringup ;;
    '') missing_package "turtlebot_bringup or turtlebot3_bringup" ;;
    *) missing_package "${LAUNCH%%/*}" "--launch: there is no file $LAUNCH in $PWD, and " ;;
  esac
}

# missing_package NAME [BEFORE]: dies with the remedy; BEFORE says what else was looked for.
missing_package() {
  die "${2:-}there is no package $1 here: install it, or name the setup.bash of the workspace with" \
    "it with --setup FILE"
}

# choose_type: the type by the installed packages, unless --type names it.
choose_type() {
  local two=false three=false
  [ -z "$TYPE" ] || return 0
  if package turtlebot_bringup >/dev/null; then two=true; fi
  if package turtlebot3_bringup >/dev/null; then three=true; fi
  if "$two" && "$three"; then
    die "turtlebot_bringup and turtlebot3_bringup are both installed: say which this is with" \
      "--type turtlebot2 or --type turtlebot3"
  fi
  if "$two" && [ -n "$MODEL" ]; then
    die "--model $MODEL is a TurtleBot3's, and there is only turtlebot_bringup here: leave --model" \
      "out if this is a TurtleBot2; else install turtlebot3_bringup, or name the setup.bash of the" \
      "workspace with it with --setup FILE"
  fi
  if "$two"; then TYPE=turtlebot2; else TYPE=turtlebot3; fi
  say "this is a $TYPE, by its packages"
}

# prepare_launch: sets BASE_LAUNCH and CAMERA_LAUNCH, with their arguments.
prepare_launch() {
  case "$TYPE" in
    turtlebot2) prepare_turtlebot2 ;;
    turtlebot3) prepare_turtlebot3 ;;
    *) prepare_generic ;;
  esac
  [ -f "${BASE_LAUNCH[0]}" ] ||
    die "there is no ${BASE_LAUNCH[0]}: send the files again, with turtlebot_deploy.sh on the host"
  if ! "$GUARD"; then return; fi
  [ -f "$HERE/mhri_guard" ] ||
    die "there is no $HERE/mhri_guard: send the files again, with turtlebot_deploy.sh on the host"
  find_guard_python ||
    die "mhri_guard needs rospy and geometry_msgs, which this robot's ROS does not have: install" \
      "them, or leave the guard out with --no-guard"
}

# find_guard_python: sets GUARD_PYTHON to one with the guard's imports; up to Melodic that is Python
# 2.
find_guard_python() {
  for GUARD_PYTHON in "$PYTHON" python3 python; do
    # Not in the working folder: a rospy.py may lie there.
    if (cd / && "$GUARD_PYTHON" -c 'import rospy, geometry_msgs.msg') >/dev/null 2>&1; then
      return
    fi
  done
  return 1
}

# limit_guard LINEAR ANGULAR RADIUS AHEAD NO_RETURN: this robot's greatest speeds [m/s, rad/s], the
# disc around all of it [m], as in its type on the host, how far ahead of its middle its laser sits
# [m], and the ranges by which that says "nothing there".
limit_guard() {
  GUARD_LIMITS=("_max_linear_mps:=$1" "_max_angular_rad_s:=$2" "_radius_m:=$3"
    "_laser_x_m:=$4" "_no_return:=$5")
}

prepare_turtlebot2() {
  local folder
  folder=$(package turtlebot_bringup) || missing_package turtlebot_bringup
  GUARD_TOPIC=teleop/input
  limit_guard 0.65 3.14 0.18 -0.087 nan,inf
  # The other inputs of its multiplexer (turtlebot_bringup/param/mux.yaml) below this one.
  GUARD_LIMITS+=("_beside:=cmd_vel_mux/input/switch cmd_vel_mux/input/navi")
  if "$SMOOTHER" && ! package yocs_velocity_smoother >/dev/null; then
    warn "there is no package yocs_velocity_smoother: the robot will jerk more than necessary"
    SMOOTHER=false
  fi
  "$SMOOTHER" || GUARD_TOPIC=cmd_vel_mux/input/teleop
  BASE_LAUNCH=("$HERE/mhri_turtlebot2.launch" "name:=$NAME" "smoother:=$SMOOTHER")
  if [ -f "$folder/launch/3dsensor.launch" ]; then
    CAMERA_LAUNCH=("$HERE/mhri_sensor.launch" "name:=$NAME")
  else
    warn "turtlebot_bringup has no 3dsensor.launch: going on without a camera"
  fi
}

prepare_turtlebot3() {
  local folder
  folder=$(package turtlebot3_bringup) || missing_package turtlebot3_bringup
  MODEL=${MODEL:-$TURTLEBOT3_MODEL}
  [[ $MODEL =~ ^(burger|waffle|waffle_pi)$ ]] ||
    die "which TurtleBot3 is this? TURTLEBOT3_MODEL is '$MODEL': give --model burger, waffle or" \
      "waffle_pi"
  export TURTLEBOT3_MODEL=$MODEL
  local lds="0,inf@3.5 0,nan,inf@100"
  if [ "$MODEL" = burger ]; then limit_guard 0.22 2.84 0.22 -0.032 "$lds"
  else limit_guard 0.26 1.82 0.22 -0.064 "$lds"; fi
  if [ -z "$LDS_MODEL" ] &&
    grep -qsF 'env LDS_MODEL' "$folder/launch/turtlebot3_lidar.launch"; then
    die "LDS_MODEL is not set: put 'export LDS_MODEL=LDS-01' (or LDS-02, see the label on the" \
      "lidar) into ~/.bashrc on this robot"
  fi
  BASE_LAUNCH=("$HERE/mhri_turtlebot3.launch" "name:=$NAME" "model:=$MODEL" "guarded:=$GUARD")
  # The base listens to the guard alone, which passes on what the robot's own programs say.
  GUARD_TOPIC=mhri_guard/velocity
  GUARD_LIMITS+=("_pass_on:=cmd_vel")
  # The Burger has no camera. The Waffle Pi's starts with its base since turtlebot3_bringup 1.2.6,
  # and has its own launch file before that.
  if [ "$MODEL" = waffle ] && [ -f "$folder/launch/turtlebot3_realsense.launch" ] &&
    package realsense_camera >/dev/null; then
    CAMERA_LAUNCH=("$HERE/mhri_turtlebot3_sensor.launch" "name:=$NAME")
  elif [ "$MODEL" = waffle_pi ] && [ -f "$folder/launch/turtlebot3_rpicamera.launch" ] &&
    ! grep -qsF turtlebot3_rpicamera.launch "$folder/launch/turtlebot3_robot.launch"; then
    CAMERA_LAUNCH=("$HERE/mhri_turtlebot3_rpicamera.launch" "name:=$NAME")
  fi
}

prepare_generic() {
  local folder path=$LAUNCH
  if [[ $LAUNCH != /* ]]; then
    folder=$(package "${LAUNCH%%/*}") || missing_package "${LAUNCH%%/*}"
    path=$folder/launch/${LAUNCH#*/}
    [ -f "$path" ] || path=$folder/${LAUNCH#*/}
  fi
  [ -f "$path" ] || die "--launch: there is no file $path"
  BASE_LAUNCH=("$HERE/mhri_generic.launch" "name:=$NAME" "robot_type:=$TYPE"
    "robot_launch:=$(readlink -f "$path")")
}

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Runs every test of mhri; --help says how.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

GROUPS_IN_ORDER=(lint unit oldest scripts rostest gui faults bench)
# Targets of which three files may run at once (PAIRED), and beside them others of any number (CALM).
# Then those that measure time: alone, but for the nodes among them (LIGHT), which take a tenth of a
# processor, and of which two may. What is left of the processors meanwhile is for targets that drive
# and measure nothing (MODEST). Of the benchmarks' short form nobody reads the figures: what it tests
# is that each runs to its end.
CALM=(scripts_calm rostest_calm faults_calm gui_calm)
PAIRED=(rostest_paired gui_paired faults_paired scripts_paired)
LIGHT=(rostest_timed)
TIMED=(scripts_timed faults_timed gui_timed)
MODEST=(oldest unit scripts_modest faults_modest gui_modest lint)

help_text() {
  cat <<'HELP'
Usage: mhri_test.sh [--only GROUP]... [--jobs N] [--bench] [--once]

Installs what is missing, builds in build/.ws and runs every test, on this machine only (127.0.0.1).
The last line is the count, e.g. "412 passed, 0 failed"; the exit status is 0 only if something ran
and nothing failed.

  --only GROUP   run one group only (may be repeated): lint, unit, oldest, scripts, rostest,
                 gui, faults, bench, or fast
  --jobs N       run at most N files at once: of those that drive robots three (two if N is below 6,
                 one below 3), of nodes that are timed two, and of what else measures time one, beside
                 two that take what is left (default: four more than there are processors, at most 7)
  --bench        run the benchmarks (test/bench) in full instead of their short form
  --once         do not run a second time what failed (see below)
  -h, --help     this text

  fast     lint and rules without ROS: needs no build, no master and no screen; under a minute
  lint     flake8 with docstrings, shellcheck, catkin_lint, Python 3.8 syntax and library, types
  unit     rules, without a master          oldest   rules and widgets with Ubuntu 20.04's libraries
  scripts  the scripts and launch files     rostest  nodes on a real master
  gui      the panel, under Xvfb            faults   what happens when parts are killed
  bench    each benchmark; prints its table

What runs nodes, windows or scripts depends on what else the computer does. So where no more than
four such files failed, they run once more at the end, alone, and count if they fail again; what
failed at first is named and counted in the last line: look into it.

The result files (JUnit) are in build/.ws/build/test_results. Works on Debian 12, and on Ubuntu 20.04
with ROS Noetic. The first run needs a network to install what is missing, later runs do not.
HELP
}

ONLY=()
BENCH=short
JOBS=
AGAIN=true
RUN_PID=

parse_arguments() {
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --bench) BENCH=full ;;
      --once) AGAIN=false ;;
      --only)
        [[ " ${GROUPS_IN_ORDER[*]} fast " == *" ${2:-} "* && -n ${2:-} ]] ||
          usage_error "--only: there is no group '${2:-}'; the groups are ${GROUPS_IN_ORDER[*]} fast"
        ONLY+=("$2")
        shift ;;
      --jobs)
        [[ ${2:-} =~ ^[1-9][0-9]?$ ]] || usage_error "--jobs: '${2:-}' is not a number from 1 to 99"
        JOBS=$2
        shift ;;
      -*) usage_error "there is no option $1" ;;
      *) usage_error "'$1' is not an option" ;;
    esac
    shift
  done
  if [ "$BENCH" = full ]; then TIMED+=(bench); else CALM=(bench "${CALM[@]}"); fi
  [ "${#ONLY[@]}" -gt 0 ] || ONLY=("${GROUPS_IN_ORDER[@]}")
  if [ -z "$JOBS" ]; then JOBS=$(($(nproc) < 3 ? $(nproc) + 4 : 7)); fi
  PAIR=$((JOBS > 5 ? 3 : JOBS > 2 ? 2 : 1))
}

# Installs in the workspace, at fixed versions, the tools that Debian and Ubuntu do not package.
install_tools() {
  local tools=(vermin==1.6.0 mypy==1.14.1 mypy_extensions==1.0.0 typing_extensions==4.12.2
    tomli==2.0.1)
  # Ubuntu 20.04 has no package of it.
  [ "$(os_family)" = debian ] || tools+=(flake8-docstrings==1.6.0 pydocstyle==6.3.0)
  [ "$(cat "$WS/tools/installed" 2>/dev/null)" != "${tools[*]}" ] || return 0
  say "installing with pip, in $WS/tools: ${tools[*]}"
  if python3 -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
    --target "$WS/tools" "${tools[@]}"; then
    printf '%s' "${tools[*]}" >"$WS/tools/installed"
  else
    warn "pip could not install ${tools[*]}: the checks that need it will fail"
  fi
}

# Keeps the operator's master, screen and ~/.ros out of the tests. Files of test/gui that run at the
# same time share no screen: two windows cannot both have the keyboard. The tests start thousands of
# processes: each module is compiled once for all of them, and leaves nothing in the checkout.
isolate() {
  unset ROS_HOSTNAME ROS_NAMESPACE WAYLAND_DISPLAY
  export ROS_IP=127.0.0.1 ROS_MASTER_URI=http://127.0.0.1:9 ROS_HOME="$SCRATCH/ros"
  export QT_QPA_PLATFORM=xcb MHRI_BENCH=$BENCH MHRI_OWN_SCREEN=1
  unset PYTHONDONTWRITEBYTECODE
  export PYTHONPYCACHEPREFIX="$SCRATCH/pycache"
  start_xvfb
}

# begin JOBS NICENESS GROUP...: starts their targets, JOBS at a time; RUN_PID is the process. Where
# the kernel shares processors out between sessions, a session has a niceness of its own.
begin() {
  local jobs=$1 niceness=$2 command=(nice -n "$2" bash -c
    "{ echo $2 >/proc/self/autogroup; } 2>/dev/null || :; exec \"\$@\"" begin)
  shift 2
  say "tests: $*"
  if [ "$1" = fast ]; then
    command+=("$REPO/test/run_fast.sh" "$RESULTS")
  else
    # Its Makefile runs one goal after the other; the one behind it all that there are.
    command+=(make --no-print-directory -C "$WS/build" -f CMakeFiles/Makefile2 "-j$jobs" --keep-going)
    # Print what runs at the same time one after the other.
    if [ "$jobs" -gt 1 ] || [ "$niceness" -gt 0 ]; then command+=(--output-sync=target); fi
    command+=("${@/#/run_tests_mhri_}")
  fi
  MHRI_RUN_ID=$RUN_ID setsid setpriv --pdeathsig TERM "${command[@]}" </dev/null &
  RUN_PID=$!
}

# await PID STARTED GROUP...: waits for their end and says how long it took. A make that fails
# counts as a failed test, since then something did not run.
await() {
  local status=0 pid=$1 took
  wait "$pid" || status=$?
  took="$((SECONDS - $2)) s"
  shift 2
  # The fast group exits with 1 if a test failed; a make target ends with 0 whatever its tests say.
  [ "$status" = 0 ] || [ "$*/$status" = fast/1 ] || NOT_RUN+=("$*")
  TIMES+=("$* $took")
  say "tests: $* took $took"
}

# run JOBS GROUP...: runs their targets, JOBS at a time.
run() {
  local started=$SECONDS
  begin "$1" 0 "${@:2}"
  await "$RUN_PID" "$started" "${@:2}"
}

# run_beside: runs the calm targets beside the paired ones. These go first, but where there is not
# enough of the processors' time the others get a quarter.
run_beside() {
  local started=$SECONDS calm_pid
  begin "$((JOBS - PAIR))" 5 "${CALM[@]}"
  calm_pid=$RUN_PID
  run "$PAIR" "${PAIRED[@]}"
  await "$calm_pid" "$started" "${CALM[@]}"
  end_leftovers
}

# run_timed: runs the targets that measure time, and beside them the modest ones, but not beside
# benchmarks whose figures somebody reads.
run_timed() {
  local started=$SECONDS modest_pid='' target
  if [ "$JOBS" -gt 2 ] && [ "$BENCH" = short ] && [ "${#LIGHT[@]}${#TIMED[@]}" != 00 ] &&
    [ "${#MODEST[@]}" -gt 0 ]; then
    begin 2 15 "${MODEST[@]}"
    modest_pid=$RUN_PID
  elif [ "${#MODEST[@]}" -gt 0 ]; then
    run "$JOBS" "${MODEST[@]}"
  fi
  [ "${#LIGHT[@]}" = 0 ] || run "$((PAIR > 2 ? 2 : PAIR))" "${LIGHT[@]}"
  for target in "${TIMED[@]}"; do run 1 "$target"; done
  [ -z "$modest_pid" ] || await "$modest_pid" "$started" "${MODEST[@]}"
  end_leftovers
}

# keep_wanted: leaves only targets of the chosen groups.
keep_wanted() {
  local kind target
  for kind in CALM PAIRED LIGHT TIMED MODEST; do
    local -n targets=$kind
    for target in "${!targets[@]}"; do
      wanted "${targets[target]%_*}" || unset "targets[target]"
    done
  done
}

# run_all: runs the chosen groups.
run_all() {
  keep_wanted
  if [ "$JOBS" -gt 2 ] && [ "${#CALM[@]}" -gt 0 ] && [ "${#PAIRED[@]}" -gt 0 ]; then
    run_beside
  else
    [ "${#CALM[@]}" = 0 ] || run "$JOBS" "${CALM[@]}"
    [ "${#PAIRED[@]}" = 0 ] || run "$PAIR" "${PAIRED[@]}"
    end_leftovers
  fi
  run_timed
}

# run_again: runs what failed once more.
run_again() {
  local targets target
  targets=$(python3 "$REPO/utils/host/count_results.py" --set-aside "$RESULTS")
  for target in $targets; do run 1 "$target"; done
  end_leftovers
}

# wanted GROUP: true if it was asked for.
wanted() { [[ " ${ONLY[*]} " == *" $1 "* ]]; }

stop() {
  warn "interrupted"
  exit 130
}

# has_fast: true if python3 has what the fast group imports.
has_fast() {
  PYTHONPATH="$WS/tools" python3 -c 'import catkin_pkg, cv2, evdev, flake8, flake8_docstrings, mccabe
import numpy, pyaudio, pytest, rospkg, yaml' 2>/dev/null
}

# Runs only the fast group: no build, no screen and, if Python has what it needs, no apt.
run_fast() {
  mkdir -p "$RESULTS" 2>/dev/null || die "cannot write to $REPO: the results go to build/.ws"
  rm -rf "$RESULTS"
  if ! has_fast; then
    install_missing fast
    has_fast || install_tools
  fi
  run 1 fast
}

main() {
  local RESULTS="$WS/build/test_results/mhri" NOT_RUN=() TIMES=()
  parse_arguments "$@"
  make_scratch
  trap clean_up EXIT
  trap stop INT TERM HUP
  if [ "${ONLY[*]}" = fast ]; then
    run_fast
  else
    needs_plain_path rostest
    install_missing test
    build_workspace ON
    source_setup "$WS/devel/setup.bash"
    if wanted lint; then install_tools; fi
    if wanted unit || wanted oldest || wanted scripts || wanted rostest || wanted faults; then
      install_link
    fi
    isolate
    rm -rf "$RESULTS" "$RESULTS.first"
    if wanted fast; then run 1 fast; fi
    run_all
    if $AGAIN; then run_again; fi
    catkin_test_results "$RESULTS" || true
  fi
  say "times: $(IFS=,; printf '%s' "${TIMES[*]}")"
  python3 "$REPO/utils/host/count_results.py" "$RESULTS" "${NOT_RUN[@]}"
}

main "$@"

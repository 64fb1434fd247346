#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Runs every test of mhri; --help says how.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

GROUPS_IN_ORDER=(lint unit rostest gui scripts faults bench)

help_text() {
  cat <<'HELP'
Usage: mhri_test.sh [--only GROUP]... [--bench]

Installs what is missing, builds in build/.ws and runs every test, one after the other, on this
machine alone (127.0.0.1). The last line is the count, e.g. "412 passed, 0 failed"; the exit status
is 0 only where something ran and nothing failed.

  --only GROUP   run one group only (may be given again): lint, unit, rostest, gui, scripts, faults,
                 bench
  --bench        run the benchmarks (test/bench) in full instead of their short form
  -h, --help     this text

  lint     flake8 with docstrings, shellcheck, catkin_lint, Python 3.8 syntax and library
  unit     rules, without ROS               rostest  nodes on a real master
  gui      the panel, under Xvfb            scripts  the scripts and launch files, in real runs
  faults   what happens when parts are killed; prints the measured times
  bench    each benchmark; prints its table

The result files (JUnit) are in build/.ws/build/test_results. Works on Debian 12, and on Ubuntu 20.04
with ROS Noetic. The first run needs a network for what is missing, the second none.
HELP
}

ONLY=()
BENCH=short
RUN_PID=

parse_arguments() {
  while [ $# -gt 0 ]; do
    case "$1" in
      -h | --help) help_text; exit 0 ;;
      --bench) BENCH=full ;;
      --only)
        [[ " ${GROUPS_IN_ORDER[*]} " == *" ${2:-} "* && -n ${2:-} ]] ||
          usage_error "--only: there is no group '${2:-}'; the groups are ${GROUPS_IN_ORDER[*]}"
        ONLY+=("$2")
        shift ;;
      -*) usage_error "there is no option $1" ;;
      *) usage_error "'$1' is not an option" ;;
    esac
    shift
  done
  [ "${#ONLY[@]}" -gt 0 ] || ONLY=("${GROUPS_IN_ORDER[@]}")
}

# Tools that Debian and Ubuntu do not package, in the workspace, at fixed versions.
install_tools() {
  local tools=(vermin==1.6.0)
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

# The tests see nothing of the operator's: no master, no screen, no ~/.ros.
isolate() {
  unset ROS_HOSTNAME ROS_NAMESPACE WAYLAND_DISPLAY
  export ROS_IP=127.0.0.1 ROS_MASTER_URI=http://127.0.0.1:9 ROS_HOME="$SCRATCH/ros"
  export QT_QPA_PLATFORM=xcb MHRI_BENCH=$BENCH
  start_xvfb
}

# run_group GROUP: its targets, one after the other; a make that fails is a failed test too, since
# then something did not run.
run_group() {
  local status=0
  say "tests: $1"
  MHRI_RUN_ID=$RUN_ID setsid setpriv --pdeathsig TERM \
    make --no-print-directory -C "$WS/build" -j1 "run_tests_mhri_$1" </dev/null &
  RUN_PID=$!
  wait "$RUN_PID" || status=$?
  RUN_PID=
  [ "$status" = 0 ] || NOT_RUN+=("$1")
  end_leftovers
}

stop() {
  warn "interrupted"
  exit 130
}

main() {
  local results="$WS/build/test_results/mhri" group NOT_RUN=()
  parse_arguments "$@"
  needs_plain_path rostest
  make_scratch
  trap clean_up EXIT
  trap stop INT TERM HUP
  install_missing test
  build_workspace ON
  source_setup "$WS/devel/setup.bash"
  if [[ " ${ONLY[*]} " == *" lint "* ]]; then install_tools; fi
  isolate
  rm -rf "$results"
  for group in "${GROUPS_IN_ORDER[@]}"; do
    if [[ " ${ONLY[*]} " == *" $group "* ]]; then run_group "$group"; fi
  done
  catkin_test_results "$results" || true
  python3 "$REPO/utils/host/count_results.py" "$results" "${NOT_RUN[@]}"
}

main "$@"

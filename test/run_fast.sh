#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# The fast group: what needs no build, no ROS, no master and no screen. Usage: run_fast.sh FOLDER, which
# gets the result files; the python3 that is first on the path needs what test/fast.txt lists.
set -uo pipefail

REPO=$(cd -P "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
RESULTS=${1:?where do the result files go}
# What only a shell, Python and flake8 have to be there for.
LINT='flake8 or syntax or parse'

cd "$REPO" || exit
mkdir -p "$RESULTS" || exit
# test_files NAME PATH [ARGUMENT]...: nothing of a workspace or of ROS is on Python's path. A process that
# ended without a result file has not run, whatever its exit status.
test_files() {
  local status=0 xml="$RESULTS/pytest-fast-$1.xml"
  rm -f "$xml"
  PYTHONPATH="$REPO/src:$REPO/build/.ws/tools" timeout --kill-after=10 300 python3 -m pytest \
    -p no:cacheprovider -q -rs -o faulthandler_timeout=120 \
    --junitxml="$xml" "${@:2}" || status=$?
  [ -s "$xml" ] || status=3
  return "$status"
}

# Two processes for the unit tests, five files in turn for each, which takes both about as long.
files=(test/unit/test_*.py) second=() worst=0
for index in "${!files[@]}"; do
  if ((index % 10 > 4)); then
    second+=("${files[index]}")
    unset "files[index]"
  fi
done
test_files lint test/scripts/test_lint.py -k "$LINT" >"$RESULTS/lint.log" 2>&1 &
pids=($!)
if [ "${#second[@]}" -gt 0 ]; then
  test_files unit2 "${second[@]}" >"$RESULTS/unit2.log" 2>&1 &
  pids+=($!)
fi
# 1: a test failed; more: something did not run.
test_files unit "${files[@]}" || worst=$?
for pid in "${pids[@]}"; do
  wait "$pid" || worst=$(($? > worst ? $? : worst))
done
cat "$RESULTS"/*.log
exit "$worst"

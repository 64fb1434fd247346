#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Pure and widget tests, and what carries the link, with the oldest libraries that mhri supports, in an
# environment that is made in build/.ws/oldest. Usage: run_oldest.sh RESULT.xml. Where there is no Python 3.8,
# or pip cannot fetch the libraries, the result is a skipped test that says so.
set -uo pipefail

REPO=$(cd -P "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
XML=${1:?where does the result go}
WANTED="$REPO/test/requirements_oldest.txt"
HOME_OF_IT="$REPO/build/.ws/oldest"
# PyPI has neither pocketsphinx nor PyAudio in a form that installs without their C libraries.
LEFT_OUT=()
# Raw pictures are not here: cv_bridge belongs to ROS, and test/ros/camera has their tests.
for name in without_pocketsphinx_or_its_model without_a_source_nothing_is_loaded \
  a_language_that_cannot_be_used_is_said; do
  LEFT_OUT+=(--deselect "test/unit/voice/test_speech_reader.py::test_$name")
done

# Prints the first Python 3.8 that runs; pyenv has commands of that name that do not.
find_python() {
  local candidate
  for candidate in python3.8 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.8*/bin/python3.8; do
    if "$candidate" -c 'import sys, venv; sys.exit(sys.version_info[:2] != (3, 8))' 2>/dev/null; then
      printf '%s' "$candidate"
      return 0
    fi
  done
  return 1
}

# skip REASON: ends with a result that counts as skipped.
skip() {
  echo "skipped: $1"
  printf '<testsuite name="oldest" tests="1" skipped="1"><testcase classname="oldest" %s' \
    "name=\"libraries\"><skipped message=\"$1\"/></testcase></testsuite>" \
    >"$XML"
  exit 0
}

# make_environment PYTHON: with the libraries, and with ROS's layer over Qt, which is plain Python.
make_environment() {
  local binding
  rm -rf "$HOME_OF_IT"
  "$1" -m venv "$HOME_OF_IT" || return
  "$HOME_OF_IT/bin/python" -m pip install --quiet --disable-pip-version-check \
    --requirement "$WANTED" || return
  binding=$(/usr/bin/python3 -c 'import os, python_qt_binding
print(os.path.dirname(python_qt_binding.__file__))') || return
  ln -s "$binding" "$HOME_OF_IT/lib/python3.8/site-packages/python_qt_binding" || return
  cp "$WANTED" "$HOME_OF_IT/installed"
}

cd "$REPO" || exit
if ! cmp -s "$WANTED" "$HOME_OF_IT/installed"; then
  PYTHON=$(find_python) || skip 'there is no Python 3.8 here (python3.8 on the path, or of pyenv)'
  make_environment "$PYTHON" || skip 'pip could not install what is in test/requirements_oldest.txt'
fi
# What is in test/unit/house reads the sources, and the searches for states and arrangements and the
# simulated drills, radios and cameras use no library: they find the same whatever the versions.
# pytest ignores no file that it is given by name.
GLOBIGNORE='test/unit/house/*:test/unit/voice/test_speech_audio.py:test/unit/driving/test_every_state*'
GLOBIGNORE+=':test/unit/drill/test_drill_rehearsal.py:test/unit/link/test_link_radio.py:test/unit/link/test_link_rate.py'
GLOBIGNORE+=':test/unit/screen/test_arrangement.py:test/unit/camera/test_camera_budget.py'
TESTS=(test/unit/*/test_*.py test/qt/*/test_widgets_*.py)
# mhri_test.sh installs zenoh; its one build is for Python 3.8 and all later ones.
[ ! -d build/.ws/link/zenoh ] || TESTS+=(test/ros/link/test_carrier.py test/ros/link/test_datagrams.py)
# Nothing of a workspace or of ROS is on the path; support/qt.py starts a screen of its own.
unset DISPLAY XAUTHORITY
PYTHONPATH="$REPO/src" ROS_PACKAGE_PATH="$REPO" exec "$HOME_OF_IT/bin/python" -m pytest \
  -p no:cacheprovider -q -rs -W ignore::DeprecationWarning --timeout 600 \
  --junitxml="$XML" "${LEFT_OUT[@]}" "${TESTS[@]}"

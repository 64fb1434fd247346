#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages, builds in build/.ws and runs test/run.py: the gate, if nothing else is
# asked for; --help says what.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/common.sh"

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

# has_fast: true if the programs are there that the fast tests start, and what they import.
has_fast() {
  command -v git >/dev/null && command -v shellcheck >/dev/null && command -v catkin_lint >/dev/null &&
    PYTHONPATH="$WS/tools" python3 -c 'import catkin_pkg, cryptography, ctypes, cv2, evdev, flake8, flake8_docstrings
import jinja2, numpy, psutil, pyaudio, pytest, pytest_timeout, rospkg, vermin, yaml
ctypes.CDLL("libturbojpeg.so.0")' 2>/dev/null
}

stop() {
  trap '' INT TERM HUP
  warn "interrupted"
  exit 130
}

main() {
  local run=(python3 "$REPO/test/run.py" "$@")
  case " $* " in
    *" --help "* | *" -h "* | *" --list "*) exec "${run[@]}" ;;
  esac
  # Wrong arguments end it before anything else is installed.
  command -v python3 >/dev/null || install_packages python3
  "${run[@]}" --list >/dev/null || exit
  mkdir -p "$WS" 2>/dev/null || die "cannot write to $REPO: the results go to build/.ws"
  make_scratch
  trap clean_up EXIT
  trap stop INT TERM HUP
  if [[ " $* " =~ " --only"[=\ ]"fast " ]]; then
    if ! has_fast; then
      install_missing fast
      has_fast || install_tools
    fi
  else
    needs_plain_path rostest
    install_missing test
    build_workspace ON
    source_setup "$WS/devel/setup.bash"
    install_tools
    "$REPO/test/support/iwer.py" "$WS/tools" ||
      warn "npm's iwer could not be fetched: the test of the headset will fail"
    install_link
  fi
  MHRI_RUN_ID=$RUN_ID setpriv --pdeathsig TERM "${run[@]}" </dev/null &
  wait "$!"
}

main "$@"

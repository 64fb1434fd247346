#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Runs the panel for mhri.launch: until_closed.sh REQUIRED COMMAND...
# If it is required (true) and was closed, this asks roslaunch to end and stays until roslaunch ends
# it: roslaunch reports every required process that ends by itself as one that died. It leaves it to
# roslaunch to report a panel that failed. Writes the panel's exit status to $MHRI_PANEL_STATUS, if
# set.
set -u
required=$1
shift
told=false
# Runs once the panel, which gets the same signal, has ended.
trap 'told=true' INT TERM HUP
# Closes the panel should this script be killed.
setpriv --pdeathsig TERM "$@"
status=$?
[ -z "${MHRI_PANEL_STATUS:-}" ] || echo "$status" >"$MHRI_PANEL_STATUS"
if [ "$required" = true ] && ! "$told" && [ "$status" = 0 ]; then
  asked=$SECONDS
  # If roslaunch is gone, its number may be another's by now.
  read -r _ _ _ parent _ </proc/$$/stat
  if [ "$parent" = "$PPID" ] && kill -TERM "$PPID"; then
    # In short steps: the signal that ends this may come before the first step.
    until "$told" || [ "$SECONDS" -gt "$((asked + 20))" ]; do sleep 0.1; done
  fi
fi
exit "$status"

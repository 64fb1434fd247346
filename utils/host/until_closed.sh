#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Runs the panel for mhri.launch: until_closed.sh REQUIRED COMMAND...
# When it was closed and is required (true), this asks roslaunch to end and stays until it is ended by
# it: roslaunch calls every required process that ends by itself a process that died. A panel that
# failed is left to roslaunch to name. Writes the panel's exit status to $MHRI_PANEL_STATUS, if set.
set -u
required=$1
shift
told=false
# Runs when the panel has ended, which gets the same signal.
trap 'told=true' INT TERM HUP
# Should this be killed, the panel is closed.
setpriv --pdeathsig TERM "$@"
status=$?
[ -z "${MHRI_PANEL_STATUS:-}" ] || echo "$status" >"$MHRI_PANEL_STATUS"
if [ "$required" = true ] && ! "$told" && [ "$status" = 0 ]; then
  asked=$SECONDS
  # Where roslaunch is gone, its number may be another's by now.
  read -r _ _ _ parent _ </proc/$$/stat
  if [ "$parent" = "$PPID" ] && kill -TERM "$PPID"; then
    # In short steps: the signal that ends this may come before the first.
    until "$told" || [ "$SECONDS" -gt "$((asked + 20))" ]; do sleep 0.1; done
  fi
fi
exit "$status"

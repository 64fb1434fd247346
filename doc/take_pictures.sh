#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Takes the pictures of README.md and of the operator's guide anew, from a scripted drive.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset DISPLAY WAYLAND_DISPLAY
"$here/../utils/host/mhri_run.sh" --demo --screenshot "$folder/screen.png"
mkdir -p "$here/images"
mv "$folder/screen.png" "$here/images/screen.png"
for name in panel bot_window depth stopped map; do
  mv "$folder/screen_$name.png" "$here/images/$name.png"
done

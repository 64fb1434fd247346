#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# Takes the pictures of README.md and of the operator's guide anew, most from a scripted drive.
# With ImageMagick they become a third as large.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
touch "$folder/began"
unset DISPLAY WAYLAND_DISPLAY
"$here/../utils/host/mhri_run.sh" --demo --screenshot "$folder/screen.png"
mkdir -p "$here/images"
mv "$folder/screen.png" "$here/images/screen.png"
for name in bot_window depth stopped map; do
  mv "$folder/screen_$name.png" "$here/images/$name.png"
done
(
  # The file of the workspace reads variables that may not be set.
  set +u
  # shellcheck disable=SC1091
  . "$here/../build/.ws/devel/setup.bash"
  QT_QPA_PLATFORM=xcb python3 "$here/../test/support/guide_pictures.py" "$here/images"
  python3 "$here/../test/support/web_pictures.py" "$here/images"
)
if command -v convert > /dev/null; then
  find "$here/images" -name '*.png' -newer "$folder/began" | while read -r picture; do
    convert "$picture" +dither -colors 256 "PNG8:$folder/small.png"
    mv "$folder/small.png" "$picture"
  done
fi

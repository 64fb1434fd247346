# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# The host's side of mhri. Robots are reached over the network of the computer:
#   docker build -t mhri .
#   docker run --rm --network host -e DISPLAY -v /tmp/.X11-unix:/tmp/.X11-unix mhri
# Without the screen the panel runs under Xvfb; "mhri --demo" in place of "mhri" proves the rest.
FROM debian:12
SHELL ["/bin/bash", "-euo", "pipefail", "-c"]
WORKDIR /opt/mhri
COPY . .
RUN . utils/host/common.sh; install_missing run; build_workspace OFF; apt-get clean
ENTRYPOINT ["utils/host/mhri_run.sh"]

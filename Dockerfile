# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# The host's side of mhri; utils/host/mhri_docker.sh builds it and starts it with screen, pads, sound and network.
FROM debian:12
SHELL ["/bin/bash", "-euo", "pipefail", "-c"]
WORKDIR /opt/mhri
# The packages alone first: they stay as long as the scripts do not change.
COPY utils utils
RUN . utils/host/common.sh; install_missing run; install_link; apt-get clean
COPY . .
RUN . utils/host/common.sh; build_workspace OFF
ENTRYPOINT ["/opt/mhri/utils/host/mhri_run.sh"]

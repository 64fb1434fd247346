#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# The spelling of the 2016 guide; the same as mhri_run.sh.
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/mhri_run.sh" "$@"

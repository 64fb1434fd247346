# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# What turtle_remote.sh and the scripts of utils/host share: checks of their arguments. Sourced,
# never run; usage_error is the script's. Works with the bash of Ubuntu 16.04.

# valid_ip TEXT: whether it is an IPv4 address. Not with leading zeros, which some programs leave out
# and others take for octal: 010.1.1.1 would be 10.1.1.1 here and 8.1.1.1 there.
valid_ip() {
  local part octets
  [[ $1 =~ ^(0|[1-9][0-9]{0,2})(\.(0|[1-9][0-9]{0,2})){3}$ ]] || return 1
  IFS=. read -r -a octets <<<"$1"
  for part in "${octets[@]}"; do [ "$part" -le 255 ] || return 1; done
}

# check_ip WHAT TEXT EXAMPLE: ends where TEXT is no IPv4 address.
check_ip() {
  local plain=$2
  if valid_ip "$2"; then return; fi
  while [[ $plain =~ ^(.*\.)?0+([0-9].*)$ ]]; do plain=${BASH_REMATCH[1]}${BASH_REMATCH[2]}; done
  if valid_ip "$plain"; then
    usage_error "$1: '$2' has leading zeros, which not every program reads alike: write $plain"
  fi
  usage_error "$1: '$2' is not an IPv4 address such as $3"
}

# value OPTION [VALUE]: the value of an option, or the error that there is none.
value() {
  case "${2:-}" in
    '' | -*) usage_error "$1 needs a value" ;;
  esac
  printf '%s' "$2"
}

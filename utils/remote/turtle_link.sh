# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# For turtle_remote.sh --link: this robot's own ROS master, and its end of the link to the host.
# Sourced, never run.

CORE_PID=
LINK_PID=
LINK_ENV=()
# The table of nftables.
LIMITS=
# The folder into which the archive of turtlebot_deploy.sh --link is unpacked.
LINK_PLACE=$HERE/link

# The arguments of mhri_link.
LINK_WORDS=()

# choose_link: sets LINK_WORDS.
choose_link() {
  LINK_WORDS=(--side robot --name "$NAME" --listen "$LISTEN")
  [ -z "$ROUTER" ] || LINK_WORDS=(--side robot --name "$NAME" --router "$ROUTER")
  [ -z "$KEEP_MB" ] || LINK_WORDS+=(--keep-mb "$KEEP_MB")
  # Beside these files is where mhri_keys.sh puts them.
  if [ -n "$KEYS" ]; then
    LINK_WORDS+=(--keys "$KEYS")
  elif [ -e "$HERE/keys/own.pem" ]; then
    LINK_WORDS+=(--keys "$HERE/keys")
  fi
}

# prepare_link: unpacks mhri_link where the archive is new, and sees that it can start here, and that
# it would listen.
prepare_link() {
  local archive=$HERE/mhri_link.tar.gz sum problem status=0
  "$LINK" || return 0
  "$GUARD_PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 8))' ||
    die "mhri_link needs Python 3.8, and this robot's ROS runs $("$GUARD_PYTHON" -V 2>&1): leave" \
      "--link out, or give the robot ROS Noetic"
  [ -f "$archive" ] ||
    die "there is no $archive: send it with 'turtlebot_deploy.sh --link' on the host"
  sum=$(sha256sum <"$archive")
  if [ "$(cat "$LINK_PLACE/unpacked" 2>/dev/null)" != "$sum" ]; then
    { rm -rf "$LINK_PLACE" && mkdir "$LINK_PLACE" && tar -xzf "$archive" -C "$LINK_PLACE" &&
      printf '%s' "$sum" >"$LINK_PLACE/unpacked"; } ||
      die "could not unpack $archive: see the message above (is the disk full?)"
  fi
  LINK_ENV=("PYTHONPATH=$LINK_PLACE/src:$LINK_PLACE/library${PYTHONPATH:+:$PYTHONPATH}"
    "ROS_PACKAGE_PATH=$LINK_PLACE${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}"
    "ROS_NAMESPACE=/$NAME")
  choose_link
  problem=$(cd / && env "${LINK_ENV[@]}" "$GUARD_PYTHON" -B -c 'import sys, zenoh
from mhri.nodes.mhri_link import refuses
sys.exit(refuses(sys.argv[1:]))' "${LINK_WORDS[@]}" 2>&1) || status=$?
  [ "$status" != 2 ] || die "${problem##*$'\n'}"
  [ "$status" = 0 ] ||
    die "mhri_link cannot start on this robot (${problem##*$'\n'}): send it again with" \
      "'turtlebot_deploy.sh --link', or install what this names"
}

# start_master: this robot's own; one that runs here already is as good.
start_master() {
  if (: <"/dev/tcp/127.0.0.1/$PORT") 2>/dev/null; then
    say "something has port $PORT of this robot already: joining the ROS master there"
    return
  fi
  # Without the mark of this run: it outlives the rest, which is started again without it.
  "$PYTHON" "$HERE/turtle_check.py" hold $$ roscore -p "$PORT" </dev/null >/dev/null &
  CORE_PID=$!
  until (: <"/dev/tcp/127.0.0.1/$PORT") 2>/dev/null; do
    running "$CORE_PID" || die "roscore could not start a ROS master on this robot: see above"
    sleep 0.2
  done
}

# limit_callers: lets each address call this robot's link ten times at once, and then twice a second:
# zenoh takes a tenth of a second over each call that fails, and a host would wait behind them.
limit_callers() {
  local link_port=${LISTEN##*:} admin=(sudo -n)
  [ -z "$ROUTER" ] || return 0
  [ "$(id -u)" != 0 ] || admin=()
  LIMITS=mhri_link_$link_port
  if ! "${admin[@]}" env "PATH=$PATH:/usr/sbin:/sbin" nft -f - <<RULES 2>/dev/null
table inet $LIMITS
delete table inet $LIMITS
table inet $LIMITS {
  set callers4 { type ipv4_addr; size 65536; flags dynamic, timeout; timeout 1m; }
  set callers6 { type ipv6_addr; size 65536; flags dynamic, timeout; timeout 1m; }
  chain input {
    type filter hook input priority -10; policy accept;
    iif lo accept
    tcp dport $link_port tcp flags & (syn | ack) == syn jump limited
  }
  chain limited {
    update @callers4 { ip saddr limit rate over 2/second burst 10 packets } drop
    update @callers6 { ip6 saddr & ffff:ffff:ffff:ffff:: limit rate over 2/second burst 10 packets }\
      drop
  }
}
RULES
  then
    LIMITS=
    warn "nothing limits the rate of calls to port $link_port (nft is missing, or needs root):" \
      "anybody on its network can block the host by failing calls; see 'Keys in five minutes'"
  fi
}

# unlimit_callers: takes that back.
unlimit_callers() {
  local admin=(sudo -n)
  [ -n "$LIMITS" ] || return 0
  [ "$(id -u)" != 0 ] || admin=()
  "${admin[@]}" env "PATH=$PATH:/usr/sbin:/sbin" nft delete table inet "$LIMITS" 2>/dev/null || true
  LIMITS=
}

start_link() {
  held env "${LINK_ENV[@]}" "$GUARD_PYTHON" "$LINK_PLACE/scripts/mhri_link" "${LINK_WORDS[@]}" \
    </dev/null &
  LINK_PID=$!
}

# check_link: starts the link again if it was killed; dies if it could not start, or without a
# master.
check_link() {
  local status=0
  "$LINK" || return 0
  if [ -n "$CORE_PID" ] && ! running "$CORE_PID"; then
    die "this robot's own ROS master has ended"
  fi
  if running "$LINK_PID"; then return; fi
  wait "$LINK_PID" || status=$?
  [ "$status" -gt 128 ] || die "mhri_link has ended (exit status $status): see its messages above"
  warn "mhri_link was killed: starting it again"
  start_link
}

# end_master: the last of all.
end_master() {
  [ -n "$CORE_PID" ] || return 0
  kill -TERM "$CORE_PID" 2>/dev/null || true
  wait "$CORE_PID" 2>/dev/null || true
}

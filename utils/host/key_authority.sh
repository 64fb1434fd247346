# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# The authority of mhri_keys.sh, by openssl: certificates, who has one, which are withdrawn, and what
# is wrong with one. AUTHORITY is its folder, NAME the owner of the key in hand, DAYS how long it is
# to be good; SCRATCH is made. Sourced after common.sh, never run. Why not easy-rsa: see doc/libraries.md.

# A key is called for so many days before its end.
SOON_DAYS=30

# key_names: prints the names that have a key, one per line.
key_names() {
  local path
  for path in "$AUTHORITY"/keys/*/; do
    [ ! -d "$path" ] || basename "$path"
  done
}

# run_openssl WHAT ARG...: dies with what openssl said.
run_openssl() {
  local what=$1
  shift
  (cd "$AUTHORITY" && openssl "$@") >"$SCRATCH/openssl.log" 2>&1 </dev/null ||
    die "openssl could not $what: $(tail -n 2 "$SCRATCH/openssl.log" | tr '\n' ' ')"
}

# open_authority: dies unless there is one that only its owner can read; waits for another run's end.
open_authority() {
  [ -e "$AUTHORITY/authority.pem" ] ||
    die "there is no authority in $AUTHORITY: make it with 'mhri_keys.sh new'"
  private "$AUTHORITY"
  [ -O "$AUTHORITY" ] || die "$AUTHORITY belongs to another user: run this as its owner"
  exec {LOCK}>"$AUTHORITY/lock"
  flock "$LOCK"
  rm -rf "$AUTHORITY/.making"
}

# private FOLDER: dies if others may look into it.
private() {
  [[ $(stat -c %a "$1") == *00 ]] || die "others may look into $1: run 'chmod 700 $1', and make" \
    "new keys if anybody may have done so"
}

# moment WHEN: a time as openssl ca takes it.
moment() { date -u -d "$1" +%Y%m%d%H%M%SZ; }

write_settings() {
  cat >authority.cnf <<'SETTINGS'
[ca]
default_ca = mhri
[mhri]
dir = .
database = index.txt
new_certs_dir = issued
certificate = authority.pem
private_key = authority.key
crlnumber = crlnumber
rand_serial = yes
unique_subject = no
default_md = sha256
default_days = 365
default_crl_days = 3650
policy = policy
[policy]
commonName = supplied
[req]
distinguished_name = name
[name]
[authority]
basicConstraints = critical, CA:TRUE, pathlen:0
keyUsage = critical, keyCertSign, cRLSign
subjectKeyIdentifier = hash
SETTINGS
}

# with_state V|R: prints serial, common name and end of the certificates that are good or withdrawn.
with_state() {
  awk -F '\t' -v state="$1" '$1 == state { sub(".*/CN=", "", $6); print $4, $6, $2 }' \
    "$AUTHORITY/index.txt" | grep -v ' authority:' || true
}

# write_lists: who has a key and until when (peers), which are withdrawn, and the same signed.
write_lists() {
  local own=authority.pem
  [ -e "$AUTHORITY/$own" ] || own=authority.new
  run_openssl "look through its list" ca -config authority.cnf -cert "$own" -updatedb
  with_state V | cut -d ' ' -f 2,3 | sort -u >"$AUTHORITY/peers"
  with_state R | cut -d ' ' -f 1,2 >"$AUTHORITY/withdrawn"
  run_openssl "sign the list" ca -config authority.cnf -cert "$own" -gencrl -out withdrawn.pem
}

# common_name ROLE: prints ROLE:NAME; with a number where keys of this name were withdrawn, so that
# a program that knows names alone keeps those apart.
common_name() {
  local before
  before=$(with_state R | cut -d ' ' -f 2 | sort -u | grep -cE "^[a-z-]+:$NAME(\.[0-9]+)?\$") ||
    before=0
  if [ "$before" = 0 ]; then printf '%s' "$1:$NAME"; else printf '%s' "$1:$NAME.$((before + 1))"; fi
}

# make_key COMMON_NAME ALTERNATIVE_NAMES: makes a key and its certificate, for NAME.
make_key() {
  local new="$AUTHORITY/.making"
  mkdir "$new" "$new/key" || die "cannot write to $AUTHORITY"
  printf '%s' "$2" >"$new/key/names"
  printf '%s\n' 'basicConstraints = critical, CA:FALSE' 'keyUsage = critical, digitalSignature' \
    'extendedKeyUsage = serverAuth, clientAuth' 'subjectKeyIdentifier = hash' \
    'authorityKeyIdentifier = keyid' "subjectAltName = $2" >"$new/extensions"
  run_openssl "make a key" genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 \
    -out .making/key/own.key
  run_openssl "ask for a certificate" req -new -config authority.cnf -key .making/key/own.key \
    -subj "/CN=$1" -out .making/csr
  run_openssl "sign the key" ca -batch -notext -config authority.cnf -in .making/csr \
    -extfile .making/extensions -startdate "$(moment 'now - 1 day')" \
    -enddate "$(moment "now + ${DAYS:-365} days")" -out .making/key/own.pem
  rm -rf "$AUTHORITY/keys/$NAME"
  mv "$new/key" "$AUTHORITY/keys/$NAME"
  rm -rf "$new"
  write_lists
}

# owner NAME: prints the common name in its certificate.
owner() {
  openssl x509 -in "$AUTHORITY/keys/$1/own.pem" -noout -subject -nameopt multiline |
    sed -n 's/^ *commonName *= //p'
}

# last_day NAME [FORMAT]
last_day() {
  local text
  text=$(openssl x509 -in "$AUTHORITY/keys/$1/own.pem" -noout -enddate)
  date -d "${text#notAfter=}" "+${2:-%F}"
}

# problem FOLDER LISTS: prints the problem of the key in FOLDER; nothing if it is good. LISTS has
# the authority's certificate and the list of those withdrawn.
problem() {
  local file said
  for file in "$1/own.key" "$1/own.pem" "$2/authority.pem" "$2/withdrawn.pem"; do
    [ -r "$file" ] || { printf '%s' "there is no ${file##*/}: put it in place again"; return; }
  done
  [[ $(stat -c %a "$1/own.key") == *00 ]] ||
    { printf '%s' "others may read its key: renew it, or withdraw it and make another"; return; }
  [ "$(openssl pkey -in "$1/own.key" -pubout 2>&1)" = \
    "$(openssl x509 -in "$1/own.pem" -noout -pubkey 2>&1)" ] ||
    { printf '%s' "key and certificate do not belong together: renew it"; return; }
  said=$(openssl verify -CAfile "$2/authority.pem" -CRLfile "$2/withdrawn.pem" -crl_check \
    "$1/own.pem" 2>&1) && return
  case "$said" in
    *'certificate has expired'*) printf '%s' "it has run out: renew it" ;;
    *'not yet valid'*)
      printf '%s' "its time has not begun: the clock of this computer is behind; set it" ;;
    *'certificate revoked'*) printf '%s' "it is withdrawn" ;;
    *'unable to get'* | *'self'*'signed'* | *'signature failure'*)
      printf '%s' "it is of another authority: make a key here, and put that in place" ;;
    *) printf '%s' "openssl refuses it: ${said##*: }" ;;
  esac
}

# left NAME: prints how a good key is: until when, and that it ends soon.
left() {
  local days
  days=$((($(last_day "$1" %s) - $(date +%s)) / 86400))
  printf 'until %s' "$(last_day "$1")"
  [ "$days" -gt "$SOON_DAYS" ] || printf ', %s days from now: renew it' "$days"
}

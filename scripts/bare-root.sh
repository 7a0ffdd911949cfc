# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A bare Debian or Ubuntu for the scripts that prove something there. Not run, but sourced by them, which set -euo pipefail.
#
# In the root packages come from where this machine's apt and pip take them: apt's sources and options, pip's
# configuration, proxies and the certificates that this machine trusts are the same there. GCDT_SUITE and GCDT_MIRROR
# choose another release and mirror. The root lies under TMPDIR (/var/tmp).

suite=${GCDT_SUITE:-bookworm}
certificates=/etc/ssl/machine.pem  # in the root; installing ca-certificates there leaves it alone

say() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

# Usage: bare_begin SCRIPT ARGUMENT...
# Runs the script anew in a mount namespace, which takes the mounts with it however the script ends; then sets $work, a
# folder that is deleted in the end unless $keep is set, and $bare, the root's place in it.
bare_begin() {
  local name
  name=$(basename "$1" .sh)
  [[ $(id -u) == 0 ]] || { echo "$name: needs root" >&2; exit 2; }
  command -v debootstrap >/dev/null || { echo "$name: needs the package debootstrap" >&2; exit 2; }
  [[ ${GCDT_PROVE_NAMESPACE-} ]] ||
    GCDT_PROVE_NAMESPACE=yes exec unshare --mount --propagation private bash "$@"
  work=$(mktemp -d "${TMPDIR:-/var/tmp}/gcdt-prove-XXXXXX")
  bare=$work/root
  trap bare_end EXIT
  trap 'exit 130' INT TERM HUP
}

bare_end() {
  umount -q "$bare/dev/pts" "$bare/sys" "$bare/proc" || true
  if [[ ${keep-} ]]; then echo "kept $bare"; else rm -rf --one-file-system "$work"; fi
}

# One line "URI SUITE COMPONENT" for each source of the suite, its updates and its security fixes.
machine_sources() {
  # shellcheck disable=SC2016
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Identifier: Packages' 2>/dev/null |
    awk -v suite="$suite" '($2 == suite || $2 == suite "-updates" || $2 == suite "-security") &&
                           ($3 == "main" || $3 == "universe")' | sort -u
}

# The file with the certificates that this machine trusts, as pip is told of it; none where there is none.
machine_certificates() {
  local file
  for file in "${PIP_CERT-}" "$(python3 -m pip config get global.cert 2>/dev/null || true)" \
      "${SSL_CERT_FILE-}" /etc/ssl/certs/ca-certificates.crt; do
    [[ ! -f $file ]] || { echo "$file"; return; }
  done
}

# Usage: bare_root [DEBOOTSTRAP OPTION OR SCRIPT]...   options begin with --; a script is that of a like suite
# GCDT_PROVE_UPDATES: components of the suite and its updates, for a mirror that is not the machine's.
bare_root() {
  local mirror=${GCDT_MIRROR-} options=() script=() argument trusted
  for argument in "$@"; do
    if [[ $argument == --* ]]; then options+=("$argument"); else script+=("$argument"); fi
  done
  [[ $mirror ]] || mirror=$(machine_sources | awk -v suite="$suite" '$2 == suite { print $1; exit }')
  debootstrap --variant=minbase "${options[@]}" "$suite" "$bare" ${mirror:+"$mirror"} "${script[@]}" \
    >"$work/debootstrap.log" || { tail -20 "$work/debootstrap.log" >&2; return 1; }
  if [[ -z ${GCDT_MIRROR-} && $mirror ]]; then
    machine_sources | sed 's/^/deb /' >"$bare/etc/apt/sources.list"
  elif [[ ${GCDT_PROVE_UPDATES-} ]]; then
    printf "deb $mirror %s $GCDT_PROVE_UPDATES\n" "$suite" "$suite-updates" >"$bare/etc/apt/sources.list"
  fi
  apt-config dump | grep -E '^Acquire::(http|https)::.*[Pp]roxy|^Acquire::Check-(Valid-Until|Date) ' \
    >"$bare/etc/apt/apt.conf.d/90machine" || true
  trusted=$(machine_certificates)
  if [[ $trusted ]]; then
    install -D -m 644 "$trusted" "$bare$certificates"
    echo "Acquire::https::CAInfo \"$certificates\";" >>"$bare/etc/apt/apt.conf.d/90machine"
  fi
  [[ ! -f /etc/pip.conf ]] || cp /etc/pip.conf "$bare/etc/pip.conf"
  for argument in "$HOME/.pip/pip.conf" "${XDG_CONFIG_HOME:-$HOME/.config}/pip/pip.conf"; do
    [[ ! -f $argument ]] || install -D -m 600 "$argument" "$bare/root/.config/pip/pip.conf"
  done
  cat /etc/resolv.conf >"$bare/etc/resolv.conf"
  mount -t proc proc "$bare/proc"
  mount -t sysfs -o ro sysfs "$bare/sys"
  # Terminals of its own: the tests show progress on one.
  mkdir -p "$bare/dev/pts"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$bare/dev/pts"
  ln -sf pts/ptmx "$bare/dev/ptmx"
}

# Runs a command in the root with a fresh environment, apart from what reaches packages.
inside() {
  local name variables=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
  for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY \
      PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_TRUSTED_HOST PIP_PROXY PIP_DEFAULT_TIMEOUT PIP_RETRIES; do
    [[ -z ${!name-} ]] || variables+=("$name=${!name}")
  done
  [[ ! -f $bare$certificates ]] || variables+=("PIP_CERT=$certificates" "SSL_CERT_FILE=$certificates")
  chroot "$bare" /usr/bin/env -i "${variables[@]}" "$@"
}

# Usage: add PACKAGE...   installs them in the root
add() {
  inside apt-get -q -y install --no-install-recommends "$@" >"$work/apt.log" 2>&1 ||
    { tail -20 "$work/apt.log" >&2; exit 1; }
}

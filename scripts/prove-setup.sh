#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that demo.sh and test.sh need nothing but a bare Debian or Ubuntu: runs them in a fresh minimal root.
# Usage: scripts/prove-setup.sh [--setup | --demo] [--quick] [--keep] [--ubuntu]
#   --setup   only the installation of packages (setup.sh --tests, twice)
#   --demo    only demo.sh
#   --quick   test.sh without its slow tests
#   --keep    keep the root for a look at it, and say where it is
#   --ubuntu  Ubuntu 24.04 with its updates instead of Debian 12
# Needs root, debootstrap, about 5 GB under TMPDIR (/var/tmp). What is tested is the commit HEAD.
# Packages come from where this machine's apt takes them, proxies included; GCDT_SUITE (default bookworm)
# and GCDT_MIRROR (default: this machine's mirror of that suite, else debootstrap's) say otherwise. A release is taken
# unsigned, with debootstrap's warning, where this machine has no keyring of its distribution.
set -euo pipefail

source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
self=$source/scripts/prove-setup.sh
parts="demo test" keep="" quick=() ubuntu=""
for argument in "$@"; do
  case $argument in
    --setup) parts=setup ;;
    --demo) parts=demo ;;
    --quick) quick=(--quick) ;;
    --keep) keep=yes ;;
    --ubuntu) ubuntu=yes ;;
    *) sed -n '3,13s/^# //p' "$self"; [[ $argument == -h || $argument == --help ]] && exit 0; exit 2 ;;
  esac
done
[[ $(id -u) == 0 ]] || { echo "prove-setup.sh: needs root" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "prove-setup.sh: needs the package debootstrap" >&2; exit 2; }

# Mounts made below belong to a namespace of their own and end with it, however the script ends.
if [[ -z ${GCDT_PROVE_NAMESPACE-} ]]; then
  GCDT_PROVE_NAMESPACE=yes exec unshare --mount --propagation private bash "$self" "$@"
fi

suite=${GCDT_SUITE:-bookworm}
components=main
script=()
if [[ $ubuntu ]]; then
  suite=${GCDT_SUITE:-noble}
  GCDT_MIRROR=${GCDT_MIRROR:-http://archive.ubuntu.com/ubuntu}
  components=main,universe
  # One script serves all of Ubuntu's suites, those that came after this debootstrap, too.
  [[ -e /usr/share/debootstrap/scripts/$suite ]] || script=(gutsy)
fi
work=$(mktemp -d "${TMPDIR:-/var/tmp}/gcdt-prove-XXXXXX")
root=$work/root
clean_up() {
  umount -q "$root/dev/pts" "$root/sys" "$root/proc" || true
  if [[ $keep ]]; then
    echo "prove-setup: kept $root"
  else
    rm -rf --one-file-system "$work"
  fi
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

say() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

# One line "URI SUITE COMPONENT" for each source of the suite, its updates and its security fixes.
host_sources() {
  # shellcheck disable=SC2016
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Identifier: Packages' 2>/dev/null |
    awk -v suite="$suite" '($2 == suite || $2 == suite "-updates" || $2 == suite "-security") &&
                           ($3 == "main" || $3 == "universe")' | sort -u
}

make_root() {
  local mirror=${GCDT_MIRROR-}
  [[ $mirror ]] || mirror=$(host_sources | awk -v suite="$suite" '$2 == suite { print $1; exit }')
  debootstrap --variant=minbase --components="$components" "$suite" "$root" ${mirror:+"$mirror"} "${script[@]}" \
    >"$work/debootstrap.log" ||
    { tail -20 "$work/debootstrap.log" >&2; return 1; }
  if [[ -z ${GCDT_MIRROR-} && $mirror ]]; then
    host_sources | sed 's/^/deb /' >"$root/etc/apt/sources.list"
  elif [[ $ubuntu ]]; then
    # As Ubuntu installs it: with its updates.
    printf "deb $mirror %s ${components/,/ }\n" "$suite" "$suite-updates" >"$root/etc/apt/sources.list"
  fi
  apt-config dump | grep -E '^Acquire::(http|https)::.*[Pp]roxy|^Acquire::Check-(Valid-Until|Date) ' \
    >"$root/etc/apt/apt.conf.d/90host" || true
  if grep -q 'https:' "$root/etc/apt/sources.list"; then
    install -D -m 644 /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"
  fi
  cat /etc/resolv.conf >"$root/etc/resolv.conf"
  mount -t proc proc "$root/proc"
  mount -t sysfs -o ro sysfs "$root/sys"
  # Terminals of its own: the tests show progress on one.
  mkdir -p "$root/dev/pts"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
  ln -sf pts/ptmx "$root/dev/ptmx"
}

# Runs a command in the root with a fresh environment, apart from the machine's proxies.
inside() {
  local variables=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8)
  for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
    [[ -z ${!name-} ]] || variables+=("$name=${!name}")
  done
  chroot "$root" /usr/bin/env -i "${variables[@]}" "$@"
}

present() { [[ -s $1 ]] || { echo "prove-setup: $1 is missing or empty" >&2; exit 1; }; }

say "a bare $suite"
make_root
mkdir "$root/gcdt"
git -C "$source" archive HEAD | tar -x -C "$root/gcdt"
for absent in /etc/OpenCL /usr/bin/g++ /usr/bin/cmake; do
  [[ ! -e $root$absent ]] || { echo "prove-setup: the root is not bare, it has $absent" >&2; exit 1; }
done

for part in $parts; do
  say "$part"
  case $part in
    setup)
      inside bash /gcdt/scripts/setup.sh --tests
      inside bash /gcdt/scripts/setup.sh --tests | grep "packages are there"
      present "$root/etc/OpenCL/vendors/pocl.icd"
      present "$root/etc/OpenCL/vendors/rusticl.icd"
      ;;
    demo)
      inside bash /gcdt/scripts/demo.sh
      present "$root/gcdt/out/countries-50m.svg"
      present "$root/gcdt/out/countries-50m.vtu"
      ;;
    test)
      inside bash /gcdt/scripts/test.sh "${quick[@]}"
      ;;
  esac
done
say "proved: $parts"

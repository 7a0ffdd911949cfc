#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that demo.sh and test.sh need nothing but a bare Debian or Ubuntu: runs them in a fresh minimal root.
# Usage: scripts/prove-setup.sh [--setup | --demo] [--quick] [--keep] [--ubuntu]
#   --setup   only the installation of packages (setup.sh --tests, twice; python.sh environment)
#   --demo    only demo.sh
#   --quick   test.sh without its slow tests
#   --keep    keep the root for a look at it, and say where it is
#   --ubuntu  Ubuntu 24.04 with its updates instead of Debian 12
# Needs root, debootstrap, about 5 GB under TMPDIR (/var/tmp). What is tested is the commit HEAD.
# Packages come from where this machine's apt and pip take them, proxies and certificates included; GCDT_SUITE (default
# bookworm) and GCDT_MIRROR (default: this machine's mirror of that suite, else debootstrap's) say otherwise. A release is taken
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
if [[ $ubuntu ]]; then
  GCDT_SUITE=${GCDT_SUITE:-noble}
  GCDT_MIRROR=${GCDT_MIRROR:-http://archive.ubuntu.com/ubuntu}
fi
# shellcheck source=scripts/bare-root.sh
. "$source/scripts/bare-root.sh"
bare_begin "$self" "$@"

present() { [[ -s $1 ]] || { echo "prove-setup: $1 is missing or empty" >&2; exit 1; }; }

say "a bare $suite"
if [[ $ubuntu ]]; then
  # As Ubuntu installs it: with its updates. One script serves all of its suites, those that came after this debootstrap, too.
  script=()
  [[ -e /usr/share/debootstrap/scripts/$suite ]] || script=(gutsy)
  GCDT_PROVE_UPDATES="main universe" bare_root --components=main,universe "${script[@]}"
else
  bare_root
fi
mkdir "$bare/gcdt"
git -C "$source" archive HEAD | tar -x -C "$bare/gcdt"
for absent in /etc/OpenCL /usr/bin/g++ /usr/bin/cmake; do
  [[ ! -e $bare$absent ]] || { echo "prove-setup: the root is not bare, it has $absent" >&2; exit 1; }
done

for part in $parts; do
  say "$part"
  case $part in
    setup)
      inside bash /gcdt/scripts/setup.sh --tests
      inside bash /gcdt/scripts/setup.sh --tests | grep "packages are there"
      present "$bare/etc/OpenCL/vendors/pocl.icd"
      present "$bare/etc/OpenCL/vendors/rusticl.icd"
      inside bash /gcdt/scripts/python.sh environment /root/python-env # what test.sh takes from PyPI
      inside /root/python-env/bin/python -c 'import matplotlib, nanobind, numpy, pyopencl, pytest, scipy, shapely, triangle'
      inside mpirun --version | head -1
      ;;
    demo)
      inside bash /gcdt/scripts/demo.sh
      present "$bare/gcdt/out/countries-50m.svg"
      present "$bare/gcdt/out/countries-50m.vtu"
      inside env -C /gcdt bash -e examples/triangulate.sh # README's commands
      present "$bare/gcdt/countries.svg"
      present "$bare/gcdt/countries.vtu"
      ;;
    test)
      inside bash /gcdt/scripts/test.sh "${quick[@]}"
      ;;
  esac
done
say "proved: $parts"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that a wheel needs no OpenCL: installs it with its extra cpu in a fresh minimal Debian that has Python and
# nothing of OpenCL nor of compilers, and triangulates there, with no variable set.
# Usage: scripts/prove-python.sh [--keep] WHEEL
#   WHEEL    one of scripts/python.sh wheel, for the root's Python (Debian 12: 3.11)
#   --keep   keep the root for a look at it, and say where it is
# Needs root, debootstrap, pip of the same version of Python (GCDT_PYTHON, default python3), which fetches the packages,
# and about 1 GB under TMPDIR (/var/tmp). GCDT_SUITE (default bookworm) and GCDT_MIRROR choose another root. Inside,
# there is no network.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
keep=""
[[ ${1-} != --keep ]] || { keep=yes; shift; }
[[ $# == 1 && -f $1 ]] || { sed -n '5,11s/^# //p' "$0"; [[ ${1-} == -h || ${1-} == --help ]] && exit 0; exit 2; }
wheel=$(realpath "$1")
[[ $(id -u) == 0 ]] || { echo "prove-python: needs root" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "prove-python: needs the package debootstrap" >&2; exit 2; }
# Mounts made below belong to a namespace of their own and end with it, and so does the lack of a network.
if [[ -z ${GCDT_PROVE_NAMESPACE-} ]]; then
  GCDT_PROVE_NAMESPACE=yes exec unshare --mount --propagation private bash "$0" ${keep:+--keep} "$wheel"
fi

suite=${GCDT_SUITE:-bookworm}
work=$(mktemp -d "${TMPDIR:-/var/tmp}/gcdt-python-XXXXXX")
bare=$work/root
clean_up() {
  umount -q "$bare/sys" "$bare/proc" || true
  if [[ $keep ]]; then echo "prove-python: kept $bare"; else rm -rf --one-file-system "$work"; fi
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

say() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

say "packages"
"${GCDT_PYTHON:-python3}" -m pip download --quiet --only-binary :all: --dest "$work/packages" "$wheel[cpu]" \
  matplotlib
ls "$work/packages"

say "a bare $suite with Python"
debootstrap --variant=minbase --include=python3,python3-venv "$suite" "$bare" ${GCDT_MIRROR:+"$GCDT_MIRROR"} \
  >"$work/debootstrap.log" || { tail -20 "$work/debootstrap.log" >&2; exit 1; }
mount -t proc proc "$bare/proc"
mount -t sysfs -o ro sysfs "$bare/sys"
found=$(find "$bare" -xdev \( -name '*OpenCL*' -o -name '*pocl*' -o -name 'libLLVM*' -o -name 'ld.bfd' -o -name 'cc1' \) |
  grep -v "^$bare/proc" || true)
[[ ! $found ]] || { echo "prove-python: the root is not bare: $found" >&2; exit 1; }
cp -r "$work/packages" "$bare/packages"
cp "$root/examples/triangulate.py" "$root/examples/map.py" "$bare/root/"
mkdir -p "$bare/data"
cp "$root/examples/data/countries-50m.poly" "$bare/data/"

# Runs a command in the root with a fresh environment and no network.
inside() {
  unshare --net chroot "$bare" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "$@"
}
inside python3 -m venv /root/env
python=/root/env/bin/python
say "the wheel alone: no device, and what to install is said"
inside $python -m pip install --quiet --no-index --find-links /packages --no-deps "/packages/$(basename "$wheel")"
inside $python -m pip install --quiet --no-index --find-links /packages numpy
inside $python -c 'import gcdt; assert gcdt.devices() == [], gcdt.devices()'
refused=$(inside $python -c 'import gcdt; gcdt.triangulate_pslg([(0, 0), (1, 0), (0, 1)])' 2>&1 || true)
[[ $refused == *NoDevice* && $refused == *"gcdt[cpu]"* ]] || { echo "prove-python: $refused" >&2; exit 1; }
say "with the extra cpu"
inside $python -m pip install --quiet --no-index --find-links /packages "gcdt[cpu]" matplotlib
inside $python -c 'import gcdt; print(*gcdt.devices(), sep="\n")'
inside $python /root/triangulate.py
inside $python /root/map.py /data/countries-50m.poly /root/map.png
[[ -s $bare/root/map.png ]] || { echo "prove-python: no picture" >&2; exit 1; }
inside $python -c '
import numpy as np, gcdt
mesh = gcdt.triangulate_pslg(np.random.default_rng(1).random((100_000, 2)))
assert mesh.verify(), mesh.verify()
print(mesh)'
say "proved: $(basename "$wheel") on $suite"

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
self=$root/scripts/prove-python.sh
keep=""
[[ ${1-} != --keep ]] || { keep=yes; shift; }
[[ $# == 1 && -f $1 ]] || { sed -n '5,11s/^# //p' "$0"; [[ ${1-} == -h || ${1-} == --help ]] && exit 0; exit 2; }
wheel=$(realpath "$1")
# shellcheck source=scripts/bare-root.sh
. "$root/scripts/bare-root.sh"
bare_begin "$self" ${keep:+--keep} "$wheel"

say "packages"
"${GCDT_PYTHON:-python3}" -m pip download --quiet --only-binary :all: --dest "$work/packages" "$wheel[cpu]" \
  matplotlib pyopencl
ls "$work/packages"

say "a bare $suite with Python"
bare_root --include=python3,python3-venv
found=$(find "$bare" -xdev \( -name '*OpenCL*' -o -name '*pocl*' -o -name 'libLLVM*' -o -name 'ld.bfd' -o -name 'cc1' \) |
  grep -v "^$bare/proc" || true)
[[ ! $found ]] || { echo "prove-python: the root is not bare: $found" >&2; exit 1; }
cp -r "$work/packages" "$bare/packages"
cp "$root/examples/triangulate.py" "$root/examples/map.py" "$bare/root/"
mkdir -p "$bare/data"
cp "$root/examples/data/countries-50m.poly" "$bare/data/"

offline() { unshare --net chroot "$bare" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "$@"; }
offline python3 -m venv /root/env
python=/root/env/bin/python
say "the wheel alone: no device, and what to install is said"
offline $python -m pip install --quiet --no-index --find-links /packages --no-deps "/packages/$(basename "$wheel")"
offline $python -m pip install --quiet --no-index --find-links /packages numpy
offline $python -c 'import gcdt; assert gcdt.devices() == [], gcdt.devices()'
refused=$(offline $python -c 'import gcdt; gcdt.triangulate_pslg([(0, 0), (1, 0), (0, 1)])' 2>&1 || true)
[[ $refused == *NoDevice* && $refused == *"gcdt[cpu]"* ]] || { echo "prove-python: $refused" >&2; exit 1; }
say "with the extra cpu"
offline $python -m pip install --quiet --no-index --find-links /packages "gcdt[cpu]" matplotlib
offline $python -c 'import gcdt; print(*gcdt.devices(), sep="\n")'
offline $python /root/triangulate.py
offline $python /root/map.py /data/countries-50m.poly /root/map.png
[[ -s $bare/root/map.png ]] || { echo "prove-python: no picture" >&2; exit 1; }
offline $python -c '
import numpy as np, gcdt
mesh = gcdt.triangulate_pslg(np.random.default_rng(1).random((100_000, 2)))
assert mesh.verify(), mesh.verify()
print(mesh)'
say "and PyOpenCL, with the same driver and a loader of its own"
offline $python -m pip install --quiet --no-index --find-links /packages pyopencl
offline $python -c '
import gcdt.opencl, numpy as np, pyopencl as cl, pyopencl.array
(platform,) = cl.get_platforms()
assert platform.name == gcdt.devices()[0].platform, platform
context = cl.Context(platform.get_devices())
queue = cl.CommandQueue(context)
points = np.random.default_rng(2).random((10_000, 2))
mesh = gcdt.opencl.triangulate(gcdt.opencl.solver(queue), cl.array.to_device(queue, points))
assert (mesh.copy("triangles", queue).get() == gcdt.triangulate_pslg(points).triangles).all()
print(mesh.shape("triangles"), "on", platform.name)'
say "proved: $(basename "$wheel") on $suite"

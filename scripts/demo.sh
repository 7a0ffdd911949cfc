#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From nothing to a picture: installs what is missing, builds, triangulates, verifies, draws.
# Usage: scripts/demo.sh [INPUT [OPTION]...]
#   INPUT    a .poly or .node file; without one, the borders of the world's countries
#   OPTION   passed on to "gcdt triangulate", such as --crossing drop
# Leaves NAME.svg, NAME.vtu and NAME.json (statistics) in out/. The variable GCDT_DEVICE chooses the device.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${1-} in
  -h | --help) sed -n '3,7s/^# //p' "$0"; exit 0 ;;
  -*) echo "demo.sh: the first argument is the input, not $1" >&2; exit 2 ;;
esac
input=$(realpath -m -- "${1:-$root/examples/data/countries-50m.poly}")
shift || true
[[ -r $input ]] || { echo "demo.sh: cannot read $input" >&2; exit 3; }

name=$(basename -- "${input%.*}")
out=$root/out

bash "$root/scripts/setup.sh"
cmake -S "$root" -B "$root/build" -DCMAKE_BUILD_TYPE=Release
cmake --build "$root/build" --parallel "$(nproc)"
gcdt=$root/build/tools/gcdt

mkdir -p "$out"
"$gcdt" devices
"$gcdt" triangulate "$input" --verify "$@" -o "$out/$name.svg" -o "$out/$name.vtu" --stats "$out/$name.json"
cat <<END

$name is triangulated and verified:
  $out/$name.svg    the picture: any browser
  $out/$name.vtu    the mesh: ParaView
  $out/$name.json   counts and times
END

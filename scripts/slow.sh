#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs inputs that take minutes or are not in the tree, and so are no part of the test suite. Prints the times of each.
# Usage: scripts/slow.sh lattice | star | maps FILE... | shake
#   lattice   2000 x 2000 lines from side to side, split where they cross: four million crossings
#   star      10,000 lines through one pixel: 50 million crossings
#   maps      .poly files, or .poly.gz: crossings split, mesh and domain proved. Any map does; the count of crossings is known
#             of Natural Earth's countries 1:10 million (472,391 vertices and 472,592 segments with six decimals, from
#             the npm package world-atlas 2, each border once)
#   shake     shake_test with 1000 shaken runs of its corpus on each way instead of 2 (GCDT_SHAKE_RUNS: another number)
# GCDT_TEST_DEVICE chooses the OpenCL device (default: PoCL). Needs about 8 GB of memory.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-test
usage() { sed -n '3,11s/^# //p' "$0"; }
case ${1-} in
  lattice | star | shake) [[ $# == 1 ]] || { usage >&2; exit 2; } ;;
  maps) [[ $# -ge 2 ]] || { usage >&2; exit 2; } ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
name=$1
shift

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for file in "$@"; do
  [[ -r $file ]] || { echo "slow: cannot read $file" >&2; exit 3; }
  case $file in
    *.poly) cp "$file" "$folder/" ;;
    *.poly.gz) gunzip -c "$file" >"$folder/$(basename "$file" .gz)" ;;
    *) echo "slow: $file is no .poly or .poly.gz" >&2; exit 2 ;;
  esac
done

cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_TESTS=ON -DGCDT_BENCH=ON -DGCDT_WERROR=ON >&2
if [[ $name == shake ]]; then
  cmake --build "$build" --parallel "$(nproc)" --target shake_test shake_layer >&2
  OPENCL_LAYERS=$build/tests/libshake_layer.so GCDT_SHAKE_RUNS=${GCDT_SHAKE_RUNS-1000} "$build/tests/shake_test" --duration=true
  exit
fi
cmake --build "$build" --parallel "$(nproc)" --target slow_cases >&2
GCDT_TEST_MAPS=$folder "$build/tests/slow_cases" --duration=true --test-case="$name: *"

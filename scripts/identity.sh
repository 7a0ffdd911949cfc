#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The part of scripts/slow.sh that compares hashes: those of tests/hashes.txt on PoCL and on Intel's CPU runtime, as they
# are and pretending to have less (tests/support/lesser_layer.cpp). A line for each; status 1 if a hash differs.
# Usage: scripts/identity.sh BUILD
#   BUILD   a folder where result_hash and lesser_layer are built. Intel's runtime goes into BUILD/intel
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
[[ $# == 1 && -x $1/tests/result_hash ]] || { sed -n '5,6s/^# //p' "$0" >&2; exit 2; }
build=$(cd "$1" && pwd)
intel=$build/intel
if [[ ! -e $intel/vendors/intel.icd ]]; then
  rm -rf "$intel"
  python3 -m venv "$intel"
  "$intel/bin/pip" install --quiet intel-opencl-rt intel-cmplr-lib-rt tbb
  rm -f "$intel"/lib/libOpenCL.so*  # a loader without layers
  mkdir "$intel/vendors"
  echo "$intel/lib/libintelocl.so" >"$intel/vendors/intel.icd"
fi

failed=0
rows=$(grep -c '^[a-z]' "$root/tests/hashes.txt")
# compare NAME DEVICE: the table, made by the device as each variant of it.
compare() {
  local less
  for less in "" "extensions" "group=64" "group=8" "group=1" "extensions local group=64"; do
    local start=$SECONDS
    if GCDT_LESSER=$less OPENCL_LAYERS=$build/tests/liblesser_layer.so \
      "$build/tests/result_hash" "$2" table "$root/tests/hashes.txt" | diff "$root/tests/hashes.txt" -; then
      echo "identity: $1, ${less:-as it is}: $rows hashes are the same ($((SECONDS - start)) s)"
    else
      echo "identity: $1, ${less:-as it is}: hashes differ" >&2
      failed=1
    fi
  done
}
compare PoCL "Portable Computing Language"
export OCL_ICD_VENDORS=$intel/vendors LD_LIBRARY_PATH=$intel/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
compare "Intel's CPU runtime" 0
exit "$failed"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Counts the bytes that each kernel moves, on a simulated GPU (bench/README.md, "Bytes moved"), and writes
# bench/results/traffic.json, which the benchmark's report holds kernels against.
# Usage: scripts/traffic.sh [VERTICES [WORKLOAD...]]
# Needs Oclgrind with its headers and LLVM's (Debian: oclgrind liboclgrind-dev llvm-14-dev), and PoCL for the inputs
# that are made from triangulations. Takes some ten minutes for the default, 20000 vertices.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${1-} in -h | --help) sed -n '3,/^set /s/^# //p' "$0"; exit 0 ;; esac
vertices=${1:-20000}
shift $(($# > 0 ? 1 : 0))
workloads=("$@")
[[ $# -gt 0 ]] || workloads=(uniform grid synthetic_cons_1 synthetic_cons_3 synthetic_cons_6)

build=$root/build-bench
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_BENCH=ON >&2
cmake --build "$build" --parallel "$(nproc)" --target gcdt_bench_generate gcdt_bench_traffic gcdt_bench_count_traffic >&2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Optimised kernels call a function of LLVM's that Oclgrind 21.10 lacks. Sectors are counted once a launch, so loads that
# an optimiser would spare make no difference. 132 compute units: an NVIDIA H200.
count() {
  "$build/bench/gcdt_bench_generate" "$1" "$vertices" "$scratch/$1" cpu >&2
  GCDT_CACHE_DIR=$scratch/cache GCDT_TRAFFIC=$scratch/$1.kernels oclgrind --build-options -cl-opt-disable \
    --compute-units 132 --global-mem-size 4000000000 --plugins "$build/bench/libgcdt_bench_count_traffic.so" \
    "$build/bench/gcdt_bench_traffic" "$scratch/$1" > "$scratch/$1.call"
}
for workload in "${workloads[@]}"; do count "$workload"; done

python3 - "$scratch" "$root/bench/results/traffic.json" "${workloads[@]}" << 'END'
import json, os, sys
scratch, path, workloads = sys.argv[1], sys.argv[2], sys.argv[3:]
found = json.load(open(path)) if os.path.exists(path) else {}
for name in workloads:
    with open(f"{scratch}/{name}.call") as call, open(f"{scratch}/{name}.kernels") as kernels:
        found[name] = json.load(call) | {"kernels": json.load(kernels)}
with open(path, "w") as file:
    file.write("{\n")
    for i, (name, counted) in enumerate(sorted(found.items())):
        kernels = counted.pop("kernels")
        file.write(f'"{name}": {json.dumps(counted)[:-1]}, "kernels": {{\n')
        file.write(",\n".join(f'  "{k}": {json.dumps(c)}' for k, c in sorted(kernels.items())))
        file.write("\n}}" + (",\n" if i + 1 < len(found) else "\n"))
    file.write("}\n")
print(path)
END

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Counts the bytes that each kernel moves, on a simulated GPU (bench/README.md, "Bytes moved"), and writes
# bench/results/traffic.json, which the benchmark's report holds kernels against.
# Usage: scripts/traffic.sh [WORKLOAD:VERTICES:OF...]
# counts with so many vertices what stands for a workload of OF (default: uniform:120000:10000000 and
# synthetic_cons_1:20000:1000000, which takes half an hour on one core: every instruction is interpreted).
# Needs Oclgrind with its headers and LLVM's (Debian: oclgrind liboclgrind-dev llvm-14-dev), and PoCL for the inputs
# that are made from triangulations.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${1-} in -h | --help) sed -n '3,/^set /s/^# //p' "$0" | head -n -1; exit 0 ;; esac
inputs=("$@")
[[ $# -gt 0 ]] || inputs=(uniform:120000:10000000 synthetic_cons_1:20000:1000000)

build=$root/build-bench
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_BENCH=ON >&2
cmake --build "$build" --parallel "$(nproc)" --target gcdt_bench_generate gcdt_bench_traffic gcdt_bench_count_traffic >&2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Optimised kernels call a function of LLVM's that Oclgrind 21.10 lacks. Sectors are counted once a launch, so loads that
# an optimiser would spare make no difference. What a launch does once for each of its work-items is in proportion if
# the simulated GPU is as much smaller than the real one (an NVIDIA H200 has 132 units) as the input.
count() { # WORKLOAD VERTICES OF
  local units=$((132 * $2 / $3))
  "$build/bench/gcdt_bench_generate" "$1" "$2" "$scratch/$1" cpu >&2
  GCDT_CACHE_DIR=$scratch/cache GCDT_TRAFFIC=$scratch/$1.kernels oclgrind --build-options -cl-opt-disable \
    --compute-units $((units > 0 ? units : 1)) --global-mem-size 4000000000 \
    --plugins "$build/bench/libgcdt_bench_count_traffic.so" "$build/bench/gcdt_bench_traffic" "$scratch/$1" \
    > "$scratch/$1.call"
}
for input in "${inputs[@]}"; do
  [[ $input =~ ^[a-z0-9_]+:[0-9]+:[0-9]+$ ]] || { echo "traffic.sh: not WORKLOAD:VERTICES:OF: $input" >&2; exit 2; }
  IFS=: read -r workload vertices of <<< "$input"
  count "$workload" "$vertices" "$of"
done

python3 - "$scratch" "$root/bench/results/traffic.json" "${inputs[@]}" << 'END'
import json, os, sys
scratch, path, inputs = sys.argv[1], sys.argv[2], sys.argv[3:]
found = {}
if os.path.exists(path):
    with open(path) as file:
        found = json.load(file)
for text in inputs:
    name, _, of = text.split(":")
    with open(f"{scratch}/{name}.call") as call, open(f"{scratch}/{name}.kernels") as kernels:
        found[name] = {"stands_for": int(of)} | json.load(call) | {"kernels": json.load(kernels)}
with open(path, "w") as file:
    blocks = []
    for name, counted in sorted(found.items()):
        kernels = counted.pop("kernels")
        lines = ",\n".join(f'  "{k}": {json.dumps(c)}' for k, c in sorted(kernels.items()))
        blocks.append(f'"{name}": {json.dumps(counted)[:-1]}, "kernels": {{\n{lines}\n}}}}')
    file.write("{\n" + ",\n".join(blocks) + "\n}\n")
print(path)
END

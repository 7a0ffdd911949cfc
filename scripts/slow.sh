#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs inputs that take minutes or are not in the tree, and so are no part of the test suite. Prints the times of each.
# Usage: scripts/slow.sh lattice | star | maps FILE... | tiles | shake | faults | races | files | load [BATCHES] | identity
#   lattice   2000 x 2000 lines from side to side, split where they cross: four million crossings
#   star      10,000 lines through one pixel: 50 million crossings
#   maps      .poly files, or .poly.gz: crossings split, mesh and domain proved. Any map does; the count of crossings is known
#             of Natural Earth's countries 1:10 million (472,391 vertices and 472,592 segments with six decimals, from
#             the npm package world-atlas 2, each border once)
#   tiles     10M uniform vertices on a device that is said to have 512 MB: the bytes of one call on all of it, and at most
#             100 bytes of the host's heap a vertex beside input and result, with tiles spilled to files 20; the same of
#             inputs with as many constraints, but where much is in the seam 100
#   shake     shake_test with 1000 shaken runs of its corpus on each way instead of 2 (GCDT_SHAKE_RUNS: another number;
#             GCDT_SHAKE_FIRST: the first seed)
#   faults    faults_test with each OpenCL call made to fail with each of its errors (GCDT_FAULT_STEP: every N-th call), shared
#             out to as many processes as there are cores (GCDT_FAULT_PROCESSES: another number)
#   races     every kind of device and every small call on Oclgrind, its reports held against
#             tests/device/allowed_races.txt
#   files     each call of the command that writes files fails, or the process is killed there, for all that write outputs;
#             the same of eight tiles that are spilled; the first rank of gcdt_mpi is killed at each;
#             1000 rounds of processes that fill a cache at once and are killed (GCDT_CACHE_ROUNDS: another number)
#   load      a million random batches, or so many, in one process; 8 threads, solvers made and released, calls cancelled
#   identity  the hashes of tests/hashes.txt on PoCL and on Intel's CPU runtime, with several sizes of work-groups, with
#             and without optional extensions. Intel's comes from PyPI (830 MB) into build-test/intel, once
# GCDT_TEST_DEVICE chooses the OpenCL device (default: PoCL). Needs about 8 GB of memory.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-test
usage() { sed -n '3,/^set /s/^# //p' "$0"; }
case ${1-} in
  lattice | star | tiles | shake | faults | races | files | identity) [[ $# == 1 ]] || { usage >&2; exit 2; } ;;
  load) [[ $# == 1 || ($# == 2 && $2 =~ ^[0-9]+$) ]] || { usage >&2; exit 2; } ;;
  maps) [[ $# -ge 2 ]] || { usage >&2; exit 2; } ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
name=$1
shift

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
files=()
[[ $name != maps ]] || files=("$@")
for file in "${files[@]}"; do
  [[ -r $file ]] || { echo "slow: cannot read $file" >&2; exit 3; }
  case $file in
    *.poly) cp "$file" "$folder/" ;;
    *.poly.gz) gunzip -c "$file" >"$folder/$(basename "$file" .gz)" ;;
    *) echo "slow: $file is no .poly or .poly.gz" >&2; exit 2 ;;
  esac
done

cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_TESTS=ON -DGCDT_BENCH=ON -DGCDT_WERROR=ON >&2
make_targets() { cmake --build "$build" --parallel "$(nproc)" --target "$@" >&2; }
case $name in
  shake)
    make_targets shake_test shake_layer
    OPENCL_LAYERS=$build/tests/libshake_layer.so GCDT_SHAKE_RUNS=${GCDT_SHAKE_RUNS-1000} "$build/tests/shake_test" --duration=true
    exit ;;
  tiles)
    make_targets gcdt_bench_tiles
    device=${GCDT_TEST_DEVICE-Portable}
    on_little() { "$build/bench/gcdt_bench_tiles" --device "$device" --tiles 0 --memory 512 --runs 1 "$@" uniform:10000000; }
    on_little --most-host-bytes 100
    on_little --most-host-bytes 20 --spill "$folder"
    # As many constraints as vertices.
    "$build/bench/gcdt_bench_tiles" --device "$device" --tiles 0 --memory 512 --runs 1 --most-host-bytes 20 --spill "$folder" coasts:4000000
    "$build/bench/gcdt_bench_tiles" --device "$device" --tiles 9,64 --runs 1 --most-host-bytes 100 letters:970000
    exit ;;
  faults)
    make_targets faults_test call_layer kept_layer
    export OPENCL_LAYERS=$build/tests/libkept_layer.so:$build/tests/libcall_layer.so
    # PoCL: so many threads a process. The first process has all kernels compiled.
    export POCL_MAX_PTHREAD_COUNT=${POCL_MAX_PTHREAD_COUNT-2} POCL_CPU_MAX_CU_COUNT=${POCL_CPU_MAX_CU_COUNT-2}
    GCDT_FAULT_STEP=1000000 "$build/tests/faults_test" --minimal
    bash "$root/scripts/shards.sh" "${GCDT_FAULT_PROCESSES-$(nproc)}" "$folder" "$build/tests/faults_test"
    exit ;;
  races)
    make_targets race_cases
    python3 "$root/tests/device/races_oracle.py" "$build/tests/race_cases" --all
    exit ;;
  files)
    make_targets command_faults_test cache_test spill_test file_faults gcdt_command gcdt_mpi
    GCDT_FILE_STEP=1 "$build/tests/command_faults_test" --duration=true
    GCDT_SPILL_TILES=8 "$build/tests/spill_test" --duration=true
    python3 "$root/tests/mpi/killed_ranks_oracle.py" "$(command -v mpiexec)" "$build/mpi/gcdt_mpi" \
      "$build/tests/libfile_faults.so" --all
    GCDT_CACHE_ROUNDS=${GCDT_CACHE_ROUNDS-1000} "$build/tests/cache_test" --duration=true
    exit ;;
  load)
    make_targets load call_layer
    "$build/tests/load" "${GCDT_TEST_DEVICE-Portable Computing Language}" "${1-1000000}"
    exit ;;
  identity)
    make_targets result_hash lesser_layer
    bash "$root/scripts/identity.sh" "$build"
    exit ;;
esac
cmake --build "$build" --parallel "$(nproc)" --target slow_cases >&2
GCDT_TEST_MAPS=$folder "$build/tests/slow_cases" --duration=true --test-case="$name: *"

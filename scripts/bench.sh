#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the benchmark of bench/README.md, as far as its rows are not there yet, and prints the table.
# Usage: scripts/bench.sh cpu|gpu [OPTION]...
#        scripts/bench.sh batches LABEL [ARGUMENT]...    gcdt_bench_batch, kept as LABEL-batches.jsonl
#        scripts/bench.sh refine LABEL [ARGUMENT]...     gcdt_bench_refine, kept as LABEL-refine.jsonl, and a plot of rounds
#        scripts/bench.sh ablation LABEL [ARGUMENT]...   gcdt_bench_ablation, kept as LABEL-ablation.md
#        scripts/bench.sh tiles LABEL [ARGUMENT]...      gcdt_bench_tiles, kept as LABEL-tiles.jsonl
#   --quick            small inputs and few runs: shows that everything works; the figures mean nothing
#   --only NAME[:N]    only these workloads (separated by commas), such as letters or uniform:1000000
#   --scaling          instead: 100k to 100M uniform vertices
#   --shapes           instead: shapes whose time might grow faster than n, 1k to 1M vertices
#   --force            measures rows again that are there already
#   --with-cgal        gpu: times CGAL on the host too, for minutes
# Variables: GCDT_DEVICE chooses the device (default: the first CPU or GPU). GCDT_BENCH_BIN is a folder of binaries
# built elsewhere (gcdt_bench, gcdt_bench_cgal). GCDT_BENCH_RESULTS is where results go (default bench/results).
# GCDT_BENCH_MAPS is a folder of further maps in .poly format. GCDT_BENCH_PYTHON is a Python 3 with matplotlib, and
# CuPy on a GPU, or the package triangle for refinement. GCDT_BENCH_SCRATCH is a folder for inputs handed to peers (default /dev/shm or /tmp).
# GCDT_BENCH_COMMIT names the version measured, where the tree is no git checkout.
# A LABEL names the devices in the file's name, such as nvidia-h200-x2.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
usage() { sed -n '3,/^set /s/^# //p' "$0"; }
command_line="scripts/bench.sh $*"
label=
case ${1-} in
  cpu | gpu) kind=$1; shift ;;
  batches | refine | ablation | tiles)
    [[ $# -ge 2 && $2 != -* ]] || { usage >&2; exit 2; }
    kind=$1; label=$2; shift 2 ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
list=$kind
options=()
quick=
scaling=
start=yes
cgal=
[[ $kind == gpu ]] || cgal=yes
while [[ -z $label && $# -gt 0 ]]; do
  case $1 in
    --quick) options+=(--quick); quick=-quick; shift ;;
    --force) options+=(--force); shift ;;
    --with-cgal) cgal=yes; shift ;;
    --scaling) list=scaling; scaling=-scaling; start=; shift ;;
    --shapes) list=shapes; scaling=-shapes; start=; shift ;;
    --only) [[ $# -ge 2 ]] || { usage >&2; exit 2; }; options+=(--only "$2"); start=; shift 2 ;;
    *) echo "bench.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
done

# The timer and CGAL: carried here, or built here.
binaries=${GCDT_BENCH_BIN:-}
if [[ -z $binaries ]]; then
  build=$root/build-bench
  cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_BENCH=ON -DGCDT_TOOLS=OFF -DGCDT_EXAMPLES=OFF >&2
  cmake --build "$build" --parallel "$(nproc)" >&2
  binaries=$build/bench
fi
[[ -x $binaries/gcdt_bench ]] || { echo "bench.sh: no gcdt_bench in $binaries" >&2; exit 2; }

results=${GCDT_BENCH_RESULTS:-$root/bench/results}
mkdir -p "$results"
commit=${GCDT_BENCH_COMMIT:-$(git -C "$root" describe --always --dirty 2>/dev/null || true)}

# Keeps what a program prints, below a line that says what was run; nothing is replaced if it fails.
keep() {
  local file=$1 head=$2
  shift 2
  { echo "$head"; "$@"; } | tee "$file.new"
  mv "$file.new" "$file"
  echo "written: $file" >&2
}
case $kind in
  batches | tiles)
    program=$binaries/gcdt_bench_tiles
    [[ $kind == tiles ]] || program=$binaries/gcdt_bench_batch
    keep "$results/$label-$kind.jsonl" \
      "{\"command\": \"$command_line\", \"commit\": \"$commit\", \"date\": \"$(date -u +%F)\", \"host_threads\": $(nproc)}" \
      "$program" "$@"
    exit ;;
  refine)
    maps=()
    for map in "$root"/examples/data/*.poly ${GCDT_BENCH_MAPS:+"$GCDT_BENCH_MAPS"/*.poly}; do
      [[ -e $map ]] && maps+=(--map "$map")
    done
    python=${GCDT_BENCH_PYTHON:-python3}
    peer=()
    if "$python" -c "import triangle" 2>/dev/null; then
      peer=(--peer "$python '$root/bench/peers/triangle_refine.py'")
    else
      echo "bench.sh: no package triangle: rows have no peer" >&2
    fi
    [[ ! -x $binaries/gcdt_bench_cgal_refine ]] || peer+=(--cgal "'$binaries/gcdt_bench_cgal_refine'")
    keep "$results/$label-refine.jsonl" \
      "{\"command\": \"$command_line\", \"commit\": \"$commit\", \"date\": \"$(date -u +%F)\", \"host_threads\": $(nproc)}" \
      "$binaries/gcdt_bench_refine" "${maps[@]}" "${peer[@]}" "$@"
    "$python" "$root/bench/refine_table.py" "$results/$label-refine.jsonl"
    "$python" "$root/bench/plots.py" "$results/$label-refine.jsonl"
    exit ;;
  ablation)
    keep "$results/$label-ablation.md" "\`$command_line\` at $commit, $(date -u +%F), $(nproc) host threads." \
      "$binaries/gcdt_bench_ablation" "$@"
    exit ;;
esac

python=${GCDT_BENCH_PYTHON:-}
if [[ -z $python ]]; then
  python=python3
  for candidate in python3 /usr/bin/python3; do
    if "$candidate" -c "import matplotlib" 2>/dev/null; then python=$candidate; break; fi
  done
fi

peers=()
if [[ -n $cgal ]]; then
  if [[ -x $binaries/gcdt_bench_cgal ]]; then
    peers+=(--peer "'$binaries/gcdt_bench_cgal'")
  else
    echo "bench.sh: no gcdt_bench_cgal: rows carry the peers' figures taken before" >&2
  fi
fi
if [[ $kind == gpu ]]; then
  if "$python" -c "import cupyx.scipy.spatial" 2>/dev/null; then
    peers+=(--peer "$python '$root/bench/peers/cupy_delaunay.py'")
  else
    echo "bench.sh: no CuPy: rows carry the peers' figures taken before" >&2
  fi
fi

maps=()
for map in "$root"/examples/data/*.poly ${GCDT_BENCH_MAPS:+"$GCDT_BENCH_MAPS"/*.poly}; do
  [[ -e $map ]] && maps+=(--map "$map")
done
scratch=${GCDT_BENCH_SCRATCH:-}
if [[ -z $scratch ]]; then
  scratch=/tmp
  # 100M vertices take 1.6 GB there
  if [[ -w /dev/shm && $(df --output=avail -k /dev/shm | tail -1) -gt 2000000 ]]; then scratch=/dev/shm; fi
fi
device=${GCDT_DEVICE:-$kind}

status=0
file=$("$binaries/gcdt_bench" --device "$device" --list "$list" --out "$results" --suffix "$scaling$quick" \
  --anchors "$root/bench/peers/anchors.json" --scratch "$scratch" --command "$command_line" --commit "$commit" \
  "${options[@]}" "${peers[@]}" "${maps[@]}") || status=$?
[[ -n $file ]] || exit "$status"
if [[ -n $start ]]; then "$python" "$root/bench/start.py" "$binaries/gcdt_bench" "$device" "$file"; fi
"$python" "$root/bench/report.py" "$file"
exit "$status"

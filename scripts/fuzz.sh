#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes the command's parsers, the C interface's arguments, and bytes -> graph -> mesh -> proof, with host code under the
# address and undefined-behaviour sanitizers, on PoCL. Ends with the executions of each target.
# Usage: scripts/fuzz.sh SECONDS [TARGET]...
#   SECONDS   for each target, besides the build
#   TARGET    parse-FORMAT (parse-poly, parse-wkb, ...), parse (all of these), arguments or pipeline; default: all
# A finding ends it with status 1 and leaves its bytes in build-fuzz/findings; what is new goes to build-fuzz/corpus, where
# the next run goes on from. tests/fuzz/corpus has the seeds and what was found before. Needs clang (setup.sh --fuzz).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-fuzz
usage() { sed -n '5,9s/^# //p' "$0"; }
[[ ${1-} =~ ^[0-9]+$ ]] || { usage >&2; exit 2; }
seconds=$1
shift
mapfile -t formats < <(cd "$root/tests/fuzz/corpus" && printf '%s\n' parse-*)
targets=()
for target in "${@:-all}"; do
  case $target in
    all) targets+=("${formats[@]}" arguments pipeline) ;;
    parse) targets+=("${formats[@]}") ;;
    arguments | pipeline) targets+=("$target") ;;
    *) [[ -d $root/tests/fuzz/corpus/$target ]] || { usage >&2; exit 2; }; targets+=("$target") ;;
  esac
done

bash "$root/scripts/setup.sh" --fuzz >&2
cmake --preset fuzz -S "$root" >&2
cmake --build "$build" --parallel "$(nproc)" --target fuzzers >&2

# OpenCL drivers keep memory until the process ends: leaks are looked for in parsers alone. These have files of 4 kB and
# bounded memory.
export UBSAN_OPTIONS=print_stacktrace=1
mkdir -p "$build/findings"
failed=0
summary=
for target in "${targets[@]}"; do
  program=${target%%-*}_fuzz
  export ASAN_OPTIONS=detect_leaks=0
  limits=(-rss_limit_mb=4096 -timeout=120 -entropic=0) # a quarter of the time goes into the weights of features
  [[ $target != parse-* ]] || limits=(-rss_limit_mb=2048 -malloc_limit_mb=64 -timeout=10) ASAN_OPTIONS=detect_leaks=1
  mkdir -p "$build/corpus/$target"
  log=$build/$target.log
  GCDT_FUZZ_FORMAT=${target#parse-} "$build/tests/fuzz/$program" "${limits[@]}" -max_total_time="$seconds" -max_len=4096 \
    -print_final_stats=1 -artifact_prefix="$build/findings/$target-" \
    "$build/corpus/$target" "$root/tests/fuzz/corpus/$target" >"$log" 2>&1 || {
    failed=1
    tail -n 60 "$log" >&2
  }
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  detail=$(sed -n 's/^pipeline_fuzz: \(.* problems solved.*\)/: \1/p' "$log")
  summary+=$(printf '%-16s %10s executions%s' "$target" "${executions:-0}" "$detail")$'\n'
done
printf '%s' "$summary"
exit "$failed"

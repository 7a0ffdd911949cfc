#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that tests notice faults: puts each mutant of tests/mutants/ into a copy of the tree and runs the tests it names.
# Usage: scripts/mutants.sh [--list] [NAME]...
#   --list   only says which mutants there are
#   NAME     the mutants tests/mutants/NAME.patch (default: all of them, which takes long)
# A mutant is killed if one of its tests fails, or takes longer than GCDT_MUTANT_SECONDS (default 600). It is an error,
# and the status 1, if one survives, no longer applies, does not build, or names tests that fail without it, too.
# The copy, its build folder and a log for each mutant are kept in build-mutants/, so that little is built again.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build-mutants
source=$work/source
build=$work/build
limit=${GCDT_MUTANT_SECONDS:-600}
cores=$(nproc)

list=
names=()
for argument in "$@"; do
  case $argument in
    --list) list=yes ;;
    -*) sed -n '3,9s/^# //p' "$0"; [[ $argument == -h || $argument == --help ]] && exit 0; exit 2 ;;
    *) names+=("$argument") ;;
  esac
done
if [[ ${#names[@]} == 0 ]]; then
  for patch in "$root"/tests/mutants/*.patch; do names+=("$(basename "$patch" .patch)"); done
fi

# The text of a line "KEY: text" at the head of a mutant.
head_line() { sed -n "1,2s/^$2: *//p" "$root/tests/mutants/$1.patch"; }

for name in "${names[@]}"; do
  [[ -r $root/tests/mutants/$name.patch ]] || { echo "mutants: there is no tests/mutants/$name.patch" >&2; exit 2; }
  for key in what tests; do
    [[ $(head_line "$name" $key) ]] || { echo "mutants: $name.patch does not begin with what: and tests:" >&2; exit 1; }
  done
  # Tests are separated by bars; a blank would match none.
  [[ $(head_line "$name" tests) != *" "* ]] || { echo "mutants: $name.patch has a blank in tests:" >&2; exit 1; }
  [[ -z $list ]] || printf '%-32s %s\n' "$name" "$(head_line "$name" what)"
done
[[ -z $list ]] || exit 0

# Makes the copy equal to the tree. Only what differs is written, so that only that is built again.
renew_copy() {
  mkdir -p "$source"
  (cd "$root" && git ls-files -z --cached --others --exclude-standard | sort -z | while IFS= read -r -d '' file; do
    [[ -e $file ]] || continue
    printf '%s\0' "$file"
    cmp -s "$file" "$source/$file" || { mkdir -p "$source/$(dirname "$file")"; cp "$file" "$source/$file"; }
  done) >"$work/files" &&
    (cd "$source" && find . -type f -printf '%P\0' | sort -z | comm -z -13 "$work/files" - | xargs -0 -r rm -f)
}

# A pattern of the tests of the mutants whose names are given: of names alone, since CTest's have few parentheses.
chosen() {
  local pattern
  for name in "$@"; do head_line "$name" tests; done | sort -u | while IFS= read -r pattern; do
    ctest --test-dir "$build" -N -R "^($pattern)\$" | sed -n 's/^ *Test *#[0-9]*: //p'
  done | sort -u | paste -sd '|' | sed 's/.*/^(&)$/'
}

# What a test needs to be built; most are executables of the test's name.
target_of() {
  case $1 in
    scripts | readme) ;;
    consumers) echo gcdt ;;
    forget_launches) printf '%s\n' kept_layer launch_layer ;;
    races) echo race_cases ;;
    abi | example_interop) echo gcdt_shared ;;
    bench_quick) echo gcdt_bench ;;
    bench_batch) echo gcdt_bench_batch ;;
    bench_*) echo "$1_test" ;;
    ranks_of_*) echo ranks_cases ;;
    gcdt_mpi_oracle) printf '%s\n' gcdt_mpi gcdt_command fault_layer ;;
    killed_ranks) printf '%s\n' gcdt_mpi file_faults ;;
    *) echo "$1" ;;
  esac
}

# Builds what the tests matching $1 need.
build_tests() {
  local tests targets=()
  tests=$(ctest --test-dir "$build" -N -R "$1" | sed -n 's/^ *Test *#[0-9]*: //p')
  [[ $tests ]] || { echo "no test matches $1"; return 1; }
  for test in $tests; do mapfile -t -O "${#targets[@]}" targets < <(target_of "$test"); done
  [[ ${#targets[@]} == 0 ]] || cmake --build "$build" --parallel "$cores" --target "${targets[@]}"
}

# Runs the tests matching $1. Those that failed are in CTest's own list of them.
run_tests() {
  rm -f "$build"/Testing/Temporary/LastTestsFailed*.log
  timeout --kill-after=10 "$((4 * limit))" \
    ctest --test-dir "$build" --output-on-failure --timeout "$limit" --parallel "$((cores < 4 ? cores : 4))" -R "$1" "${@:2}"
}
failed_tests() { find "$build/Testing/Temporary" -name 'LastTestsFailed*.log' -exec cut -d: -f2 {} + | sort -u; }

configure() { cmake -S "$source" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_TESTS=ON -DGCDT_BENCH=ON; }

rm -f "$work"/*.log
renew_copy
echo "mutants: the tests of ${#names[@]} mutants, without any"
{ configure && tests=$(chosen "${names[@]}") && build_tests "$tests"; } >"$work/unmutated.log" 2>&1 ||
  { tail -40 "$work/unmutated.log" >&2; echo "mutants: the tree itself does not build" >&2; exit 1; }
run_tests "$tests" >>"$work/unmutated.log" 2>&1 || echo "mutants: without a mutant fail: $(failed_tests | xargs)" >&2
broken=$(failed_tests)

# One mutant: prints what became of it; status 0 only if it was killed.
try() {
  local name=$1 tests test log=$work/$1.log
  tests=$(chosen "$name")
  for test in $broken; do
    if grep -qE "$tests" <<<"$test"; then echo "NOT TRIED: $test fails without it"; return 1; fi
  done
  renew_copy || return
  # The copy is no part of the repository around it.
  if ! (cd "$source" && GIT_CEILING_DIRECTORIES=$work git apply "$root/tests/mutants/$name.patch") >"$log" 2>&1; then
    echo "DOES NOT APPLY"
    return 1
  fi
  if ! { configure && build_tests "$tests"; } >>"$log" 2>&1; then
    echo "DOES NOT BUILD"
    return 1
  fi
  if run_tests "$tests" --stop-on-failure >>"$log" 2>&1; then
    echo "SURVIVED $(head_line "$name" tests)"
    return 1
  fi
  tests=$(failed_tests | xargs)
  echo "killed by ${tests:-the time limit}"
}

status=0
table=()
for name in "${names[@]}"; do
  begin=$SECONDS
  outcome=$(try "$name") || status=1
  table+=("$(printf '%-32s %-40s %5d s  %s' "$name" "$outcome" "$((SECONDS - begin))" "$(head_line "$name" what)")")
  echo "mutants: $name: $outcome"
done
renew_copy
echo
printf '%s\n' "${table[@]}"
if [[ $status != 0 ]]; then echo "mutants: not all were killed; logs are in build-mutants/" >&2; fi
exit $status

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The scripts fail where something is missing or what they run fails. What they call is played by small programs here.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# Usage: play FOLDER NAME TEXT: a program NAME, whose body is TEXT.
play() {
  mkdir -p "$1"
  printf '#!/bin/bash\n%s\n' "$3" >"$1/$2"
  chmod +x "$1/$2"
}

# Usage: expect STATUS WORD NAME COMMAND...: 0, or any other status for "fails"; WORD is somewhere in what is said.
expect() {
  local status=0 said
  said=$("${@:4}" 2>&1) || status=$?
  [[ $1 == fails && $status != 0 || $1 == "$status" ]] && [[ $said == *"$2"* ]] && return
  printf 'scripts_test: %s: status %s\n%s\n' "$3" "$status" "$said" >&2
  failures=1
}

# format.sh: clang-format missing, of another version, refusing a source, content.
mkdir "$work/without"
for program in bash dirname find sort sed; do ln -s "$(command -v $program)" "$work/without/"; done
expect fails "not installed" "no clang-format" env PATH="$work/without" "$root/scripts/format.sh"
cp -r "$work/without" "$work/format"
play "$work/format" clang-format 'echo "clang-format version 15.0.7"'
expect fails "not installed" "another clang-format" env PATH="$work/format" "$root/scripts/format.sh"
play "$work/format" clang-format-14 '[[ $1 == --version ]] && echo "clang-format version 14.0.6" || exit 1'
expect fails "" "a source that is not formatted" env PATH="$work/format" "$root/scripts/format.sh"
play "$work/format" clang-format-14 'echo "clang-format version 14.0.6"'
expect 0 "files" "all sources formatted" env PATH="$work/format" "$root/scripts/format.sh"

# consumers.sh: nothing is built; the consumers are programs that end with a status. One that fails, whichever it is,
# is an error.
consumers() { # FAILING: the name of the consumer that fails, or none
  local folder=$work/consumers-$1
  play "$folder" cmake '
    while [[ $# -gt 0 ]]; do
      case $1 in --build | -B) build=$2 ;; --prefix) prefix=$2 ;; --install) tree=$2 ;; esac
      shift
    done
    if [[ ${prefix-} && $tree != */subdirectory ]]; then mkdir -p "$prefix/lib" && touch "$prefix/lib/libgcdt.so"; fi
    [[ ! ${build-} ]] || { mkdir -p "$build" && program "$build/consumer" "$(basename "$build")"; }'
  play "$folder" cc 'program "$3" cc'
  play "$folder" c++ 'program "$4" c++'
  play "$folder" pkg-config 'echo -lgcdt'
  play "$folder" program "
    [[ \$2 == $1 ]] && status=1 || status=0
    printf '#!/bin/bash\\necho \"said by %s\"\\nexit %d\\n' \"\$2\" \$status >\"\$1\" && chmod +x \"\$1\""
  env PATH="$folder:$PATH" "$root/scripts/consumers.sh" "$work/out-$1"
}
expect 0 "FetchContent: said by subdirectory" "all consumers well" consumers none
for failing in find_package cc c++ subdirectory; do
  expect fails "said by $failing" "a consumer that fails: $failing" consumers $failing
done

# test.sh: the benchmark's tests are built, too; what does not build, or a test that fails, is an error.
tree=$work/suite
mkdir -p "$tree/scripts"
cp "$root/scripts/test.sh" "$tree/scripts/"
play "$tree/scripts" setup.sh 'exit 0'
play "$tree/scripts" format.sh '[[ ! -e $(dirname "$0")/../unformatted ]]'
play "$tree/programs" cmake 'echo "cmake $*"; [[ $1 != --build || ! -e $(dirname "$0")/../broken ]]'
play "$tree/programs" ctest 'echo "ctest $*"; [[ ! -e $(dirname "$0")/../failing ]]'
suite() { env PATH="$tree/programs:$PATH" "$tree/scripts/test.sh" "$@"; }
expect 0 "-DGCDT_TESTS=ON -DGCDT_BENCH=ON" "the suite" suite
expect 0 "-LE ^slow" "the quick suite" suite --quick
for fault in unformatted broken failing; do
  touch "$tree/$fault"
  expect fails "" "the suite with something $fault" suite
  rm "$tree/$fault"
done

# readme.sh: an example that README does not show as it is.
mkdir -p "$work/tree/scripts" "$work/tree/examples"
cp "$root/scripts/readme.sh" "$work/tree/scripts/"
cp "$root"/examples/triangulate.c* "$work/tree/examples/"
cp "$root/README.md" "$work/tree/"
expect 0 "its examples" "the README as it is" "$work/tree/scripts/readme.sh"
: >"$work/tree/README.md"
expect fails "no example in c" "a README without examples" "$work/tree/scripts/readme.sh"

# slow.sh and mutants.sh: what is not there.
expect fails "cannot read" "a map that is missing" "$root/scripts/slow.sh" maps "$work/none.poly"
expect fails "Usage" "no map" "$root/scripts/slow.sh" maps
expect fails "there is no" "a mutant that is missing" "$root/scripts/mutants.sh" no-such-mutant

[[ $failures == 0 ]] && echo "scripts_test: passed"
exit $failures

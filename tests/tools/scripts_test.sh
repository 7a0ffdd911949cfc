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

# layers.sh: a small tree of rooms, and one fault after the other in it.
rooms=$work/rooms
mkdir -p "$rooms"/{scripts,include/gcdt,lib/{device,mesh,batch,api,proof},kernels/{common,flip,insert,programs}}
cp "$root/scripts/layers.sh" "$rooms/scripts/"
include() { # FILE HEADER: FILE becomes one that includes HEADER, and nothing else
  printf '#include "%s"\n' "$2" >"$rooms/$1"
}
touch "$rooms"/{include/gcdt/gcdt.h,lib/device/runtime.hpp,lib/proof/verify.hpp,kernels/{common/shared.h,flip/flip.h}}
touch "$rooms/kernels/flip/flip.cl"
sound() {
  include lib/mesh/mesh.hpp device/runtime.hpp
  include lib/mesh/mesh.cpp flip/flip.h
  include lib/batch/pipeline.hpp mesh/mesh.hpp
  include lib/proof/verify.cpp common/shared.h
  include lib/api/verify.cpp proof/verify.hpp
  include kernels/insert/insert.cl flip/flip.h
  include kernels/programs/core.cl insert/insert.cl
}
layers() { "$rooms/scripts/layers.sh"; }
sound
expect 0 "layers: 7 includes" "rooms in order" layers
while read -r file header word; do
  include "$file" "$header"
  expect 1 "$file:1: #include \"$header\": $word" "$file that includes $header" layers
  rm "$rooms/$file"
  sound
done <<'END'
lib/device/runtime.cpp mesh/mesh.hpp lib/mesh comes after lib/device
lib/mesh/grid.cpp batch/pipeline.hpp lib/batch comes after lib/mesh
lib/mesh/grid.cpp flip/flip.cl the host includes headers
lib/mesh/grid.cpp mesh.hpp no room has this file
lib/proof/grid.cpp mesh/mesh.hpp the proof shares
lib/proof/grid.cpp flip/flip.h the proof shares
lib/batch/pool.cpp proof/verify.hpp the proof shares
kernels/flip/rounds.cl device/runtime.hpp kernels know nothing
kernels/common/mesh.h flip/flip.h kernels/flip comes after kernels/common
kernels/insert/grow.cl flip/flip.cl only kernels/programs
include/gcdt/types.hpp gcdt/gcdt.h a public header
END
for twin in kernels/insert/flip.cl kernels/insert/shared.h; do
  touch "$rooms/$twin"
  expect 1 "$twin: two kernel files of one base name" "a second $twin" layers
  rm "$rooms/$twin"
done
mkdir "$rooms/lib/attic"
touch "$rooms/lib/attic/old.cpp" "$rooms/lib/loose.hpp"
expect 1 "lib/attic/old.cpp: its folder is no room" "a folder that is not in the order" layers
expect 1 "lib/loose.hpp: its folder is no room" "a file beside the rooms" layers
rm -r "$rooms/lib/attic" "$rooms/lib/loose.hpp"
expect 0 "layers: 7 includes" "rooms in order again" layers

# consumers.sh: nothing is built; the consumers are programs that end with a status. One that fails, whichever it is,
# is an error.
consumers() { # FAILING: the name of the consumer that fails, or none
  local folder=$work/consumers-$1
  play "$folder" cmake '
    while [[ $# -gt 0 ]]; do
      case $1 in --build | -B) build=$2 ;; --prefix) prefix=$2 ;; esac
      shift
    done
    if [[ ${prefix-} && $prefix != */nothing ]]; then mkdir -p "$prefix/lib" && touch "$prefix/lib/libgcdt.so"; fi
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
play "$tree/scripts" python.sh '[[ ! -e $(dirname "$0")/../unreachable ]]'
play "$tree/scripts" layers.sh '[[ ! -e $(dirname "$0")/../disordered ]]'
play "$tree/programs" cmake 'echo "cmake $*"; [[ $1 != --build || ! -e $(dirname "$0")/../broken ]]'
play "$tree/programs" ctest 'echo "ctest $*"; [[ ! -e $(dirname "$0")/../failing ]]'
suite() { env PATH="$tree/programs:$PATH" "$tree/scripts/test.sh" "$@"; }
expect 0 "-DGCDT_TESTS=ON -DGCDT_BENCH=ON" "the suite" suite
expect 0 "-DGCDT_TEST_PYTHON=$tree/build-test/python-env/bin/python" "the suite's Python" suite
expect 0 "-LE ^slow" "the quick suite" suite --quick
for fault in unformatted disordered unreachable broken failing; do
  touch "$tree/$fault"
  expect fails "" "the suite with something $fault" suite
  rm "$tree/$fault"
done

# readme.sh: an example that a page does not show as it is, a long README, a link and a name that lead nowhere.
mkdir "$work/tree"
for entry in "$root"/*; do ln -s "$entry" "$work/tree/"; done
rm "$work/tree"/{scripts,docs,README.md}
cp -r "$root"/{scripts,docs,README.md} "$work/tree/"
readme() { "$work/tree/scripts/readme.sh"; }
again() { cp "$root/README.md" "$work/tree/" && cp "$root/docs/using.md" "$work/tree/docs/"; }
expect 0 "its examples" "the README as it is" readme
: >"$work/tree/README.md"
expect fails "no example in cpp in README.md" "a README without examples" readme
again
sed -i 's/gcdt_solver_release(solver);//' "$work/tree/docs/using.md"
expect fails "gcdt_solver_release" "a page that shows another example" readme
again
seq 150 >>"$work/tree/README.md"
expect fails "more than 150" "a long README" readme
again
echo '[a page](docs/none.md)' >>"$work/tree/README.md"
expect fails "README.md names ./docs/none.md" "a link that leads nowhere" readme
again
echo 'The text of `lib/mesh/none.cpp` is short.' >>"$work/tree/docs/using.md"
expect fails "docs/using.md names lib/mesh/none.cpp" "a file that is not there" readme

# pictures.sh, slow.sh, shards.sh and mutants.sh: what is not there.
expect fails "there is no" "no command that draws" "$root/scripts/pictures.sh" "$work/none"
expect fails "cannot read" "a map that is missing" "$root/scripts/slow.sh" maps "$work/none.poly"
expect fails "Usage" "no map" "$root/scripts/slow.sh" maps
expect fails "Usage" "faults without processes" "$root/scripts/shards.sh"
expect fails "process 1: 0 runs" "faults of processes that fail" "$root/scripts/shards.sh" 2 "$work" false
expect fails "there is no" "a mutant that is missing" "$root/scripts/mutants.sh" no-such-mutant

[[ $failures == 0 ]] && echo "scripts_test: passed"
exit $failures

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that the library can be installed and found: builds and runs small programs against it, shared and static,
# with find_package, pkg-config and FetchContent, each from an empty folder and a fresh prefix.
# Usage: scripts/consumers.sh [FOLDER [BUILD]]
#   FOLDER   where what is built goes (default: build-consumers); emptied first
#   BUILD    a build of the project, whose static library is installed (default: one is made)
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${1-} in -h | --help) sed -n '3,7s/^# //p' "$0"; exit 0 ;; esac
work=$(realpath -m "${1:-$root/build-consumers}")
static=${2-}
rm -rf "$work"
mkdir -p "$work"
sources=$root/tests/consumer

quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; echo "consumers: failed: $*" >&2; exit 1; }; }
# What is proved does not depend on optimisation, nor on how many files a compiler takes at a time.
build() {
  quietly cmake -S "$1" -B "$2" -DCMAKE_BUILD_TYPE=None -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=33 "${@:3}"
  quietly cmake --build "$2" --parallel 2
}
# Runs a consumer, which must succeed; a substitution within echo's argument would lose its status.
run() {
  local said
  said=$("${@:2}") || { echo "consumers: failed: $1: $said" >&2; exit 1; }
  echo "consumers: $1: $said"
}

# Nothing of the project but the library is built for another's project, and nothing installed unless that wants it.
subdirectory() { build "$sources/subdirectory" "$work/subdirectory" -DGCDT_SOURCE="$root" "$@"; }
subdirectory
run "FetchContent" "$work/subdirectory/consumer"
commands=$(find "$work/subdirectory" -type f -name 'gcdt' -perm -u+x)
[[ -z $commands ]] || { echo "consumers: the command was built" >&2; exit 1; }
mkdir "$work/nothing"
quietly cmake --install "$work/subdirectory" --prefix "$work/nothing"
installed=$(find "$work/nothing" -type f)
[[ -z $installed ]] || { echo "consumers: installed with another's project: $installed" >&2; exit 1; }

# Both kinds are linked of the same objects (lib/CMakeLists.txt), so the shared library is that project's, whose objects
# are there.
subdirectory -DBUILD_SHARED_LIBS=ON -DGCDT_INSTALL=ON
shared=$work/subdirectory
if [[ -z $static ]]; then
  static=$work/gcdt
  build "$root" "$static" -DGCDT_TOOLS=OFF -DGCDT_EXAMPLES=OFF
fi
for kind in shared static; do
  prefix=$work/$kind/prefix
  for component in library dev; do quietly cmake --install "${!kind}" --prefix "$prefix" --component $component; done
  library=$(find "$prefix" -name 'libgcdt.*' | sort)
  library=$(dirname "${library%%$'\n'*}")

  build "$sources/find_package" "$work/$kind/find_package" -DCMAKE_PREFIX_PATH="$prefix"
  run "$kind, find_package" "$work/$kind/find_package/consumer"

  # The prefix may be moved: the files in it say where things are from where they are.
  mv "$prefix" "$prefix-moved"
  library=${library/#$prefix/$prefix-moved}
  export PKG_CONFIG_PATH=$library/pkgconfig
  flags=$(pkg-config --cflags --libs gcdt)
  read -r -a flags <<<"$flags"
  quietly cc "$sources/main.c" -o "$work/$kind/c" "${flags[@]}" "-Wl,-rpath,$library"
  run "$kind, pkg-config, C" "$work/$kind/c"
  quietly c++ -std=c++17 "$sources/main.cpp" -o "$work/$kind/cpp" "${flags[@]}" "-Wl,-rpath,$library"
  run "$kind, pkg-config, C++" "$work/$kind/cpp"
done

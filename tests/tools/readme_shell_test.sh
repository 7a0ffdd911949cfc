#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# README's commands do what it says: examples/triangulate.sh with the real command, which a small program in cmake's place
# has built.
# Usage: readme_shell_test.sh GCDT
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "readme_shell_test: $1" >&2; exit 1; }

mkdir -p "$work/tree" "$work/programs"
ln -s "$root/examples" "$work/tree/examples"
printf '#!/bin/bash\necho "$*" >>asked\n[[ $1 != --build ]] || { mkdir -p "$2/tools" && ln -s "%s" "$2/tools/gcdt"; }\n' \
  "$(realpath "$1")" >"$work/programs/cmake"
chmod +x "$work/programs/cmake"
cd "$work/tree"
said=$(PATH=$work/programs:$PATH bash -e examples/triangulate.sh 2>&1) || fail "$said"
[[ $(cat asked) == $'-S . -B build\n--build build' ]] || fail "cmake was asked for: $(cat asked)"
grep -q '^0  *[^ ]' <<<"$said" || fail "no device is listed: $said"
grep -q '<svg' countries.svg || fail "countries.svg is no picture"
grep -q '<VTKFile' countries.vtu || fail "countries.vtu is no mesh"

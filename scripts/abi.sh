#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Compares the interface with the one in abi/: the shared library exports exactly the C functions of the public
# headers, and none of them, nor any type in them, has changed or gone (abidiff, package abigail-tools).
# Usage: scripts/abi.sh LIBRARY [--write]    --write takes the headers' interface as the new one
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
[[ $# -ge 1 && -e $1 ]] || { sed -n '3,5s/^# //p' "$0"; exit 2; }
command -v abidiff >/dev/null || { echo "abi: abidiff is not installed (package abigail-tools)" >&2; exit 1; }
kept=$root/abi/gcdt.abi
headers=("$root/include/gcdt/gcdt.h" "$root/include/gcdt/gcdt_pool.h" "$root/include/gcdt/gcdt_cl.h")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# One prototype a line.
prototypes=$(cat "${headers[@]}" | tr '\n' ' ' | grep -o 'GCDT_API [^;#]*gcdt_[a-z_]*([^;]*);' | sed 's/^GCDT_API //; s/  */ /g')
declared=$(grep -o 'gcdt_[a-z_]*(' <<<"$prototypes" | tr -d '(' | sort -u)
exported=$(nm -D --defined-only "$1" | awk '{ print $3 }' | sort -u)
if [[ $declared != "$exported" ]]; then
  echo "abi: declared (<) and exported (>) functions differ:" >&2
  diff <(echo "$declared") <(echo "$exported") >&2 || true
  exit 1
fi
symbols=$(readelf --wide --dyn-syms "$1")
if [[ $symbols == *" UNIQUE "* ]]; then
  echo "abi: a unique symbol would keep the library loaded for ever" >&2
  exit 1
fi

# The library's own debug information is full of C++; the same interface as C says only what matters.
{
  echo '#include <gcdt/gcdt_cl.h>'
  sed -E '/^void /s/;$/ {}/; /^void /!s/;$/ { return 0; }/' <<<"$prototypes"
} >"$work/interface.c"
soname=$(readelf -d "$1" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')
(cd "$work" && cc -I"$root/include" -g -O0 -w -fPIC -shared -Wl,-soname,"$soname" interface.c -o interface.so)
if [[ ${2-} == --write ]]; then
  mkdir -p "$root/abi"
  abidw --no-corpus-path --no-comp-dir-path --no-show-locs "$work/interface.so" >"$kept"
  echo "abi: wrote ${kept#"$root/"}"
  exit 0
fi
abidiff "$kept" "$work/interface.so"
echo "abi: as in ${kept#"$root/"}, $(wc -l <<<"$exported") functions"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails if a file of lib/ or kernels/ includes one of a room that comes later (docs/architecture.md), or if two kernel
# programs, or two kernel headers, have one base name: once they are embedded, nothing else tells them apart.
# Usage: scripts/layers.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# A room includes itself and those before it. lib/proof is not in the order: it includes itself, lib/exact and
# kernels/common, and only lib/api includes it.
declare -A order=(
  [lib]="exact device mesh phases query solve batch tiles api"
  [kernels]="common sort order flip insert constrain output check domain refine query tiles programs"
)
declare -A place=([lib/proof]=0)
for tree in "${!order[@]}"; do
  at=0
  for room in ${order[$tree]}; do place[$tree/$room]=$((++at)); done
done

faults=0
fault() { # WHERE WHAT
  echo "layers: $1: $2" >&2
  faults=$((faults + 1))
}

# Prints why FILE, of ROOM (such as lib/mesh), must not include HEADER, which stands in THERE; nothing if it may.
objection() { # ROOM HEADER THERE
  case $1,$3 in
    include,*) echo "a public header includes public headers only, in <>" ;;
    *,none) echo "no room has this file" ;;
    kernels/*,lib/*) echo "kernels know nothing of lib" ;;
    lib/proof,lib/proof | lib/proof,lib/exact | lib/proof,kernels/common | lib/api,lib/proof) ;;
    lib/proof,* | *,lib/proof) echo "the proof shares lib/exact and kernels/common with the rest, and is for lib/api alone" ;;
    lib/*,kernels/*) [[ $2 == *.h ]] || echo "the host includes headers of kernels, not programs" ;;
    *)
      if [[ $2 == *.cl && $1 != kernels/programs ]]; then
        echo "only kernels/programs makes programs of programs"
      elif ((place[$3] > place[$1])); then
        echo "$3 comes after $1"
      fi
      ;;
  esac
}

includes=0
while IFS=: read -r file line text; do
  room=${file%/*}
  [[ $file != include/* ]] || room=include
  [[ $room == include || ${place[$room]-} ]] || continue # named below, once for each file
  header=${text#*\"}
  header=${header%%\"*}
  there=none
  for tree in lib kernels; do
    if [[ -e $tree/$header && ${place[$tree/${header%/*}]-} ]]; then there=$tree/${header%/*}; fi
  done
  why=$(objection "$room" "$header" "$there")
  [[ ! $why ]] || fault "$file:$line" "#include \"$header\": $why"
  includes=$((includes + 1))
done < <(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' include lib kernels)

while read -r file; do
  [[ ${place[${file%/*}]-} ]] || fault "$file" "its folder is no room: add it to the order in scripts/layers.sh"
done < <(find lib kernels -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.cl' \) | sort)

while read -r name; do
  fault "$(find kernels -name "$name" | sort | paste -sd ' ')" "two kernel files of one base name"
done < <(find kernels -type f \( -name '*.h' -o -name '*.cl' \) -printf '%f\n' | sort | uniq -d)

((faults == 0)) || exit 1
echo "layers: $includes includes"

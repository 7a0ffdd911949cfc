#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Draws docs/countries.png, docs/regions.png, docs/refined.png and the page docs/map.html anew. Needs rsvg-convert (package librsvg2-bin).
# Usage: scripts/pictures.sh [GCDT]
#   GCDT   the command; without one, build/tools/gcdt, as scripts/demo.sh builds it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1-} in -*) sed -n '3,5s/^# //p' "scripts/pictures.sh"; exit 2 ;; esac
gcdt=${1:-build/tools/gcdt}
input=examples/data/countries-50m.poly
command -v "$gcdt" >/dev/null || { echo "pictures: there is no $gcdt" >&2; exit 3; }
command -v rsvg-convert >/dev/null || { echo "pictures: rsvg-convert is not installed (librsvg2-bin)" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The map is cut at the antimeridian, and borders end there (examples/data/README.md): Russia, Fiji and Antarctica are
# open to the sea, so no rule for domains keeps them. Each side's ends, from south to north, are joined two by two.
close_borders() {
  awk '
    NR == 1 { vertices = $1 }
    NR > 1 && NR <= vertices + 1 { side[$1] = $2 < 0 ? "west" : "east"; y[$1] = $3 }
    NR == vertices + 2 { segments = $1; marks = $2 }
    NR > vertices + 2 && NR <= vertices + 2 + segments { ++degree[$2]; ++degree[$3] }
    { line[NR] = $0 }
    END {
      for (v in degree) if (degree[v] == 1) print side[v], y[v], v | "sort -k1,1 -k2,2n >" ends
      close("sort -k1,1 -k2,2n >" ends)
      for (joints = 0; (getline first <ends) > 0 && (getline second <ends) > 0; ++joints) {
        split(first, a); split(second, b)
        joint[joints] = (segments + joints) " " a[3] " " b[3]
      }
      for (i = 1; i <= NR; ++i) {
        if (i == vertices + 2) print segments + joints, marks; else print line[i]
        if (i == vertices + 2 + segments) for (j = 0; j < joints; ++j) print joint[j]
      }
    }' ends="$work/ends" "$1"
}

# The same map with coordinates in steps of half a degree, so that a page of it is small.
coarse() {
  awk '
    function rounded(x) { return (x < 0 ? -int(0.5 - 2 * x) : int(0.5 + 2 * x)) / 2 }
    NR == 1 { vertices = $1 }
    NR > 1 && NR <= vertices + 1 { $2 = rounded($2); $3 = rounded($3) }
    { print }' "$1"
}
coarse "$input" >"$work/coarse.poly"
"$gcdt" triangulate "$work/coarse.poly" --triangle pcjQ # leaves out the vertices that have become one with others
"$gcdt" view "$work/coarse.1.poly" --title "Countries, to half a degree" --quiet -o docs/map.html

"$gcdt" triangulate "$input" --quiet -o "$work/countries.svg"
close_borders "$input" >"$work/closed.poly"
"$gcdt" triangulate "$work/closed.poly" --domain outer --verify --quiet -o "$work/regions.svg"
"$gcdt" triangulate examples/letter.poly --domain outer-holes --refine 30 --max-area 900 --colour angle --verify --quiet \
  -o "$work/refined.svg"
for picture in countries regions; do
  rsvg-convert -w 1000 "$work/$picture.svg" -o "docs/$picture.png"
done
rsvg-convert -w 480 "$work/refined.svg" -o docs/refined.png
echo "pictures: docs/map.html, docs/countries.png, docs/regions.png, docs/refined.png"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the command with GDAL in build-gdal/, and proves that Shapefile, GeoPackage, FlatGeobuf and DXF, written by
# ogr2ogr, give what the GeoJSON gives that they are made of.
# Usage: scripts/prove-gdal.sh
# Needs the packages libgdal-dev and gdal-bin, beside those of setup.sh.
set -euo pipefail
case ${1-} in "") ;; *) sed -n '3,6s/^# //p' "$0"; exit 2 ;; esac
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-gdal
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_GDAL=ON -DGCDT_EXAMPLES=OFF -DGCDT_WERROR=ON >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target gcdt_command
gcdt=$build/tools/gcdt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() { echo "prove-gdal: $1" >&2; exit 1; }

cat >in.geojson <<'END'
{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"n": 1}, "geometry": {"type": "Polygon", "coordinates":
[[[0, 0], [0, 8], [8, 8], [8, 0], [0, 0]], [[2, 2], [5, 2], [5, 6], [2, 2]]]}},
{"type": "Feature", "properties": {"n": 2}, "geometry": {"type": "Polygon", "coordinates":
[[[10, 0], [12, 0], [12, 2], [10, 0]]]}}]}
END
areas() { # FILE: the triangles inside, by their corners
  "$gcdt" triangulate "$1" --domain even-odd --quiet -o o.geojson
  grep -oE '\[\[\[.*\]\]\]' o.geojson | sort
}
expected=$(areas in.geojson)
[[ $(wc -l <<<"$expected") == 8 ]] || fail "the GeoJSON has other triangles than it should"
for kind in shp:"ESRI Shapefile" gpkg:GPKG fgb:FlatGeobuf; do
  file=map.${kind%%:*}
  ogr2ogr -f "${kind#*:}" -nlt POLYGON "$file" in.geojson 2>log || fail "$(cat log)"
  got=$(areas "$file")
  # Drivers may begin rings elsewhere, and so number vertices otherwise: the triangles are the same sets.
  [[ $(tr -d '[] \n' <<<"$got" | tr ',' '\n' | sort | uniq -c) == $(tr -d '[] \n' <<<"$expected" | tr ',' '\n' | sort | uniq -c) ]] ||
    fail "$file gives other triangles"
done
ogr2ogr -f DXF -nlt LINESTRING -select '' map.dxf in.geojson 2>log || fail "$(cat log)"
"$gcdt" triangulate map.dxf --domain even-odd --quiet --stats s.json
grep -q '"triangles": 8' s.json || fail "map.dxf gives other triangles"

for kind in shp gpkg fgb dxf; do
  : >"bad.$kind"
  head -c 700 "map.$kind" >"cut.$kind"
  mkdir "folder.$kind"
  for name in bad cut folder missing; do
    status=0
    said=$("$gcdt" triangulate "$name.$kind" 2>&1) || status=$?
    [[ $status == 3 && $said == "gcdt: $name.$kind: "* ]] || [[ $name == cut && $status == 0 ]] ||
      fail "$name.$kind: status $status: $said"
  done
done
echo "prove-gdal: Shapefile, GeoPackage, FlatGeobuf and DXF give the same triangles"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves in a headless Chromium that the page of `gcdt view` draws, picks and escapes what it should.
# Usage: scripts/prove-view.sh GCDT [SCREENSHOT.png]
#   SCREENSHOT.png   keeps the picture of examples/data/countries-50m.poly, for a look at it
# Needs the packages chromium, python3-pil and fonts-dejavu-core. WebGL is computed by the CPU.
set -euo pipefail
[[ $# -ge 1 && $1 != -* ]] || { sed -n '3,6s/^# //p' "$0"; exit 2; }
gcdt=$(realpath "$1")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "prove-view: $1" >&2; exit 1; }

browser() { # OPTION... URL
  timeout 300 chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
    --user-data-dir="$work/profile" --window-size=1000,600 --virtual-time-budget=60000 "$@" 2>/dev/null
}

# Two halves of a square, of which each is a region; the pointer is in the upper left one.
cat >"$work/square.poly" <<'END'
4 2 1 0
0 0 0 10
1 40 0 20
2 40 40 30
3 0 40 40
5 0
0 0 1
1 1 2
2 2 3
3 3 0
4 0 2
0
END
"$gcdt" view "$work/square.poly" --title '</title><img src=x onerror=document.title="broken">' -o "$work/square.html"
url="file://$work/square.html#x=20&y=20&scale=12&colour=region&pick=10,30"
browser --dump-dom "$url" >"$work/dom"
grep -q 'data-state="drawn"' "$work/dom" || fail "the page was not drawn: $(grep -o '<div class="panel" id="under">[^<]*' "$work/dom")"
printf '1 2 0 0\n0 10 30\n' >"$work/point.node"
triangle=$("$gcdt" locate "$work/square.poly" "$work/point.node" | awk '!/^#/ { print $2 }')
grep -q "data-picked=\"$triangle\"" "$work/dom" || fail "another triangle was picked than $triangle"
grep -q '<td>attribute 1</td><td>30</td>' "$work/dom" || fail "the attribute at the pointer is not 30"
grep -q '<td>constraint 4</td>' "$work/dom" || fail "the diagonal does not name its constraint"
[[ $(grep -c '<img' "$work/dom") == 0 ]] || fail "the title was read as HTML"
browser --screenshot="$work/square.png" "$url" >/dev/null
/usr/bin/python3 - "$work/square.png" <<'END'
import sys
from PIL import Image

image = Image.open(sys.argv[1]).convert("RGB")
at = lambda x, y: image.getpixel((round(500 + (x - 20) * 12), round(300 - (y - 20) * 12)))
assert image.size == (1000, 600)
upper, lower = at(12, 35), at(28, 5)
assert upper != lower and min(lower) > 150, (upper, lower)  # pale; the upper one is picked
assert upper[0] > upper[2] + 50, upper  # and so is orange
assert max(at(20, 20)) < 90, at(20, 20)  # a constraint
assert image.getpixel((500, 590)) == (255, 255, 255)  # outside
END

# Points alone are one region, which says nothing: they are coloured by angle, and the legend says so.
printf '0,0\n40,0\n40,40\n0,39\n11,7\n' >"$work/points.csv"
"$gcdt" view "$work/points.csv" -o "$work/points.html"
browser --dump-dom "file://$work/points.html" >"$work/dom"
grep -q '<div id="legend">.*<span id="most">60°</span>' "$work/dom" || fail "points are not coloured by angle"
browser --dump-dom "file://$work/points.html#colour=region" >"$work/dom"
grep -q '<div id="legend" hidden="">' "$work/dom" || fail "the address does not say the colour"

picture=${2:-$work/countries.png}
"$gcdt" view "$root/examples/data/countries-50m.poly" -o "$work/countries.html"
browser --screenshot="$(realpath -m "$picture")" "file://$work/countries.html" >/dev/null
/usr/bin/python3 - "$picture" <<'END'
import sys
from PIL import Image

colours = Image.open(sys.argv[1]).convert("RGB").getcolors(1 << 20)
assert len(colours) > 1000, len(colours)  # regions, edges and what lies between
END
# The page that README links.
browser --dump-dom "file://$root/docs/map.html" >"$work/dom"
grep -q 'data-state="drawn"' "$work/dom" || fail "docs/map.html was not drawn"
echo "prove-view: drawn, picked and escaped"

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a trace of gcdt (--trace) as a picture: trace.py TRACE.json PICTURE.svg

One row for each device and phase; the phase as the host saw it pale, what ran on the device in it dark."""
import json
import sys
from html import escape

COLOURS = ["#4477aa", "#228833", "#ccbb44", "#ee6677", "#66ccee", "#332288", "#aa3377", "#999933"]
ROW, GAP, LEFT, WIDTH = 18, 26, 90, 900


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1]) as file:
        events = json.load(file)["traceEvents"]
    spans = [e for e in events if e["ph"] == "X"]
    devices = {e["pid"]: e["args"]["name"] for e in events if e["name"] == "process_name"}
    rows = sorted({(e["pid"], e["tid"]): e["args"]["name"] for e in events if e["name"] == "thread_name"}.items())
    end = max(e["ts"] + e["dur"] for e in spans)
    scale = WIDTH / end
    place, y, out = {}, 0, []
    for (device, phase), name in rows:
        if (device, phase - 1) not in place:  # the first row of a device
            y += GAP
            out.append(f'<text x="4" y="{y - 6}" font-weight="bold">{escape(devices[device])}</text>')
        place[device, phase] = y
        out.append(f'<text x="12" y="{y + ROW - 5}">{escape(name)}</text>')
        y += ROW
    for e in sorted(spans, key=lambda e: e["cat"], reverse=True):  # phases below launches
        x, width = LEFT + e["ts"] * scale, max(e["dur"] * scale, 0.1)
        colour, opacity = COLOURS[e["tid"] % len(COLOURS)], 1 if e["cat"] == "launch" else 0.3
        out.append(f'<rect x="{x:.2f}" y="{place[e["pid"], e["tid"]] + 2}" width="{width:.2f}" height="{ROW - 4}" '
                   f'fill="{colour}" fill-opacity="{opacity}"/>')
    step = next(s for d in range(9) for s in (10**d, 2 * 10**d, 5 * 10**d) if end / s < 12)
    for i in range(int(end / step) + 1):
        x = LEFT + i * step * scale
        out.append(f'<path d="M{x:.1f} 4V{y + 4}" stroke="#ccc" stroke-width="0.5"/>')
        out.append(f'<text x="{x:.1f}" y="{y + 16}" text-anchor="middle">{i * step / 1000:g} ms</text>')
    with open(sys.argv[2], "w") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + WIDTH + 30} {y + 22}" '
                   f'font-family="sans-serif" font-size="11">\n' + "\n".join(out) + "\n</svg>\n")


main()

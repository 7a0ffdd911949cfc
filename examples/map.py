#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The world's countries with the Python package: regions, areas, a question to the mesh, and a picture.

Usage: map.py [MAP.POLY [PICTURE.PNG]]    default: examples/data/countries-50m.poly, map.png
Needs matplotlib. The steps are those of a notebook.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import gcdt

source = sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "data" / "countries-50m.poly"
picture = sys.argv[2] if len(sys.argv) > 2 else "map.png"

# 1. Read Triangle's .poly: a line with counts, then vertices, then segments.
with open(source, encoding="ascii") as file:
    rows = [line.split("#")[0].split() for line in file if line.split("#")[0].strip()]
n = int(rows[0][0])
first = int(rows[1][0])
points = np.array([row[1:3] for row in rows[1 : n + 1]], float)
m = int(rows[n + 1][0])
borders = np.array([row[1:3] for row in rows[n + 2 : n + 2 + m]], int) - first

# 2. Triangulate. Borders are constraints; regions are what they enclose.
mesh = gcdt.triangulate_pslg(points, borders, label_regions=True)
print(mesh, "on", mesh.statistics["device"], f"in {mesh.statistics['ms']['call']:.0f} ms")
print("proved:", bool(mesh.verify()))

# 3. Ask it: which region holds these cities?
cities = {"Nairobi": (36.82, -1.29), "Bern": (7.45, 46.95), "Quito": (-78.51, -0.22), "Canberra": (149.13, -35.28)}
where = mesh.locate(list(cities.values()))
areas = np.bincount(mesh.region, weights=mesh.areas)
for city, triangle in zip(cities, where):
    print(f"{city}: region {mesh.region[triangle]}, {areas[mesh.region[triangle]]:.1f} square degrees")

# 4. Draw it: each region in a colour, what is open to the outside left white. That is the sea, and Russia and
# Antarctica: the map is cut at the antimeridian, where their borders end.
land = mesh.depth > 0
colours = np.where(land, mesh.region * 7919 % 19 + 1.0, np.nan)
figure, (world, part) = plt.subplots(2, 1, figsize=(9, 9), height_ratios=(1, 1.25), layout="constrained")
mesh.plot(world, values=colours, cmap="tab20", rasterized=True)
world.collections[-1].set_linewidth(0.2)
world.set_title(f"{len(np.unique(mesh.region[land]))} regions, {len(mesh.triangles)} triangles")
mesh.plot(part, values=colours, cmap="tab20", alpha=0.5, rasterized=True)
part.triplot(*points.T, mesh.triangles, color="0.4", lw=0.3)
part.set(xlim=(5, 17), ylim=(43, 49), title="the Alps, with the mesh")
for name, (x, y) in cities.items():
    world.plot(x, y, "k.", ms=4)
    world.annotate(name, (x, y), fontsize=7, xytext=(3, 3), textcoords="offset points")
figure.savefig(picture, dpi=110)

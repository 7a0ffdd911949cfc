#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
import gcdt
import numpy as np

# A square with a slit in it: six vertices, five constraints.
points = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (1, 2), (3, 2)])
constraints = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)]
mesh = gcdt.triangulate_pslg(points, constraints)
print(mesh.triangles)
print(mesh.locate([(1, 1), (9, 9)]))  # which triangles hold these points; -1: none

# Polygons with holes, any number of them in one call: the ragged arrays of shapely.to_ragged_array and GeoArrow.
rings = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 1), (1, 2), (2, 1), (5, 0), (7, 0), (6, 3)]
filled = gcdt.triangulate_polygons(rings, ring_offsets=[0, 4, 7, 10], polygon_offsets=[0, 2, 3])
print(filled.triangles, filled.areas)

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Triangle 1.6 by the package `triangle` as a peer (bench/peer.hpp) of refinement: its switches are the argument. The
whole call, from arrays to arrays. Reading the file is not timed. The package is not part of this project, and its
licence not free: pip install triangle."""

import sys
import time
from importlib.metadata import version

import numpy
import triangle


def read(path):
    with open(path, "rb") as file:
        if file.read(8) != b"PSLGBIN1":
            raise ValueError("no such input")
        n, m = numpy.fromfile(file, "<i8", 2)
        given = {"vertices": numpy.fromfile(file, "<f8", 2 * n).reshape(-1, 2)}
        if m:
            given["segments"] = numpy.fromfile(file, "<i4", 2 * m).reshape(-1, 2)
        return given


def least_angle(made):
    corners = made["vertices"][made["triangles"]]
    u, v = (numpy.roll(corners, -k, axis=1) - corners for k in (1, 2))
    cross, dot = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0], (u * v).sum(axis=2)
    return f"{numpy.degrees(numpy.arctan2(cross, dot)).min():.4f}"


def main():
    print(f"triangle-{version('triangle')} constraints", flush=True)
    for line in sys.stdin:
        path, most, seconds = line.split()
        try:
            given = read(path)
            times, triangles, start = [], 0, time.perf_counter()
            while len(times) < int(most) and (len(times) < 3 or time.perf_counter() - start < float(seconds)):
                begin = time.perf_counter()
                made = triangle.triangulate(given, sys.argv[1])
                times.append(f"{1000 * (time.perf_counter() - begin):.4f}")
                triangles = len(made["triangles"])
            print("ok", triangles, *times, "mesh", len(made["vertices"]), least_angle(made), flush=True)
        except Exception as error:  # a peer that fails is a result, not a reason to stop
            print("error", str(error).replace("\n", " ")[:200], flush=True)


main()

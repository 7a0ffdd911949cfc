#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CuPy's Delaunay (a port of gDel2D) as a peer (bench/peer.hpp): the whole call, from points in device memory to
triangles in device memory. No constraints. Reading the file and copying it to the device are not timed."""

import sys
import time

import cupy
import numpy
from cupyx.scipy.spatial import Delaunay


def read(path):
    with open(path, "rb") as file:
        if file.read(8) != b"PSLGBIN1":
            raise ValueError("no such input")
        n, _ = numpy.fromfile(file, "<i8", 2)
        return cupy.asarray(numpy.fromfile(file, "<f8", 2 * n).reshape(-1, 2))


def run(points):
    cupy.cuda.Device().synchronize()
    start = time.perf_counter()
    mesh = Delaunay(points)
    cupy.cuda.Device().synchronize()
    return 1000 * (time.perf_counter() - start), len(mesh.simplices)


def main():
    cupy.zeros(1)  # fails here, before the greeting, where there is no GPU
    print(f"cupy-{cupy.__version__} points", flush=True)
    for line in sys.stdin:
        path, most, seconds = line.split()
        try:
            points = read(path)
            run(points)  # compiles and warms up
            times, triangles, start = [], 0, time.perf_counter()
            while len(times) < int(most) and (len(times) < 3 or time.perf_counter() - start < float(seconds)):
                ms, triangles = run(points)
                times.append(f"{ms:.4f}")
            print("ok", triangles, *times, flush=True)
        except Exception as error:  # a peer that fails is a result, not a reason to stop
            print("error", str(error).replace("\n", " ")[:200], flush=True)
        points = None
        cupy.get_default_memory_pool().free_all_blocks()


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times the Python package beside others on one CPU device, and prints Markdown tables.

Usage: compare.py [polygons] [find_simplex] [call] [--count N] [--repeat R] [--library LIBGCDT.SO]
  polygons      100,000 polygons in one call, against a loop over triangle, and over mapbox_earcut
  find_simplex  1,000,000 points located, against scipy's and matplotlib's
  call          1,000,000 vertices by the package, and by the C functions of LIBRARY through ctypes
Medians of R runs (default 5); all checks of results are made outside of the times.
"""

import argparse
import ctypes as c
import statistics
import time

import numpy as np

import gcdt


def measured(work, repeat):
    """Milliseconds of each run, on the clock and of all processors together."""
    times, busy = [], []
    for _ in range(repeat):
        start, cpu = time.perf_counter(), time.process_time()
        work()
        times.append(1e3 * (time.perf_counter() - start))
        busy.append(1e3 * (time.process_time() - cpu))
    return times, busy


def table(title, rows):
    print(f"\n{title}\n\n| | ms | least, most | processor time |\n|---|---|---|---|")
    for name, (times, busy) in rows:
        middle = statistics.median(times)
        print(
            f"| {name} | {middle:.0f} | {min(times):.0f}, {max(times):.0f} | {statistics.median(busy):.0f} |",
            flush=True,
        )


def buildings(count):
    """Outlines such as those of buildings: 4 to 24 corners, every fourth with a courtyard, as ragged arrays."""
    rng = np.random.default_rng(1)
    coords, rings, parts = [], [0], [0]
    for p in range(count):
        corners = int(rng.integers(4, 25))
        centre = rng.uniform(0, 10000, 2)
        angles = (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) * 2 * np.pi / corners
        directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        coords.append(centre + directions * rng.uniform(6, 12, corners)[:, None])
        rings.append(rings[-1] + corners)
        if p % 4 == 0:
            coords.append(centre + directions[::-1] * 2.0)
            rings.append(rings[-1] + corners)
        parts.append(len(rings) - 1)
    # Centimetres, as surveyors give them.
    return np.round(np.concatenate(coords), 2), np.array(rings), np.array(parts)


def with_triangle(coords, rings, parts):
    import triangle

    made = []
    for p in range(len(parts) - 1):
        first, last = rings[parts[p]], rings[parts[p + 1]]
        segments, holes = [], []
        for r in range(parts[p], parts[p + 1]):
            numbers = np.arange(rings[r], rings[r + 1]) - first
            segments.append(np.stack([numbers, np.roll(numbers, -1)], axis=1))
            if r > parts[p]:
                holes.append(coords[rings[r] : rings[r + 1]].mean(axis=0))
        given = {"vertices": coords[first:last], "segments": np.concatenate(segments)}
        if holes:
            given["holes"] = np.array(holes)
        made.append(triangle.triangulate(given, "p")["triangles"] + first)
    return np.concatenate(made)


def with_earcut(coords, rings, parts):
    import mapbox_earcut

    made = []
    for p in range(len(parts) - 1):
        first, last = rings[parts[p]], rings[parts[p + 1]]
        ends = (rings[parts[p] + 1 : parts[p + 1] + 1] - first).astype(np.uint32)
        made.append(mapbox_earcut.triangulate_float64(coords[first:last], ends) + first)
    return np.concatenate(made).reshape(-1, 3)


def area(coords, triangles):
    a, b, d = (coords[triangles[:, k]] for k in range(3))
    return 0.5 * np.abs((b[:, 0] - a[:, 0]) * (d[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (d[:, 0] - a[:, 0])).sum()


def polygons(count, repeat):
    coords, rings, parts = buildings(count)
    ways = [
        ("gcdt.triangulate_polygons, one call", lambda: gcdt.triangulate_polygons(coords, rings, parts).triangles),
        ("the same, check=False", lambda: gcdt.triangulate_polygons(coords, rings, parts, check=False).triangles),
        ("a loop over triangle, switch p", lambda: with_triangle(coords, rings, parts)),
        ("a loop over mapbox_earcut (no Delaunay)", lambda: with_earcut(coords, rings, parts)),
    ]
    areas = [area(coords, way()) for _, way in ways]
    assert np.allclose(areas, areas[0], rtol=1e-9), areas
    table(f"{count} polygons, {len(coords)} vertices", [(name, measured(way, repeat)) for name, way in ways])


def find_simplex(count, repeat):
    import matplotlib.tri
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(2)
    points, where = rng.random((100_000, 2)), rng.uniform(-0.05, 1.05, (count, 2))
    ours, theirs = gcdt.Delaunay(points), Delaunay(points)
    mesh = matplotlib.tri.Triangulation(*points.T, ours.simplices)
    made = measured(mesh.get_trifinder, 1)
    trifinder = mesh.get_trifinder()
    found = ours.find_simplex(where)
    assert (found == trifinder(*where.T)).mean() > 0.99999
    # scipy walks from where the last point was: points in any order take it minutes, so once is enough.
    answers = []
    once = measured(lambda: answers.append(theirs.find_simplex(where)), 1)
    assert ((found < 0) == (answers[0] < 0)).mean() > 0.99999
    near = where[np.lexsort((where[:, 1], (where[:, 0] * 300).astype(int)))]
    table(
        f"{count} points in a mesh of {len(points)} vertices",
        [
            ("gcdt.Delaunay.find_simplex", measured(lambda: ours.find_simplex(where), repeat)),
            ("the same, of points sorted into stripes", measured(lambda: ours.find_simplex(near), repeat)),
            ("scipy.spatial.Delaunay.find_simplex (once)", once),
            ("the same, of points sorted into stripes", measured(lambda: theirs.find_simplex(near), repeat)),
            ("matplotlib's trifinder", measured(lambda: trifinder(*where.T), repeat)),
            ("making matplotlib's trifinder (once)", made),
        ],
    )


class Input(c.Structure):  # gcdt_input
    _fields_ = [
        ("struct_size", c.c_size_t),
        ("coordinate_type", c.c_int32),
        ("vertices", c.c_void_p),
        ("vertex_count", c.c_uint64),
        ("constraints", c.c_void_p),
        ("constraint_count", c.c_uint64),
    ]


def call(count, repeat, library):
    """One mesh by C as `gcdt::Solver::triangulate` has it: solve, room for the arrays, one copy of all, release."""
    lib = c.CDLL(library)
    lib.gcdt_result_count.restype, lib.gcdt_result_count.argtypes = c.c_uint64, [c.c_void_p, c.c_int32]
    lib.gcdt_result_release.argtypes = [c.c_void_p]
    points = np.random.default_rng(3).random((count, 2))
    given = Input(c.sizeof(Input), 0, points.ctypes.data, count, None, 0)
    solver = c.c_void_p()
    assert lib.gcdt_solver_create(None, c.byref(solver)) == 0
    kinds = [(0, 12), (1, 12), (2, 1), (3, 4), (4, 8), (5, 4), (6, 4), (7, 4)]
    numbers = (c.c_int32 * len(kinds))(*(number for number, _ in kinds))

    def by_c():
        result = c.c_void_p()
        assert lib.gcdt_triangulate(solver, c.byref(given), None, c.byref(result)) == 0
        counts = [lib.gcdt_result_count(result, number) for number, _ in kinds]
        memory = [np.empty(n * size + 1, np.uint8) for n, (_, size) in zip(counts, kinds)]
        to = (c.c_void_p * len(kinds))(*(m.ctypes.data for m in memory))
        room = (c.c_uint64 * len(kinds))(*counts)
        assert lib.gcdt_result_copy_arrays(result, numbers, to, room, c.c_size_t(len(kinds))) == 0
        lib.gcdt_result_release(result)
        return memory

    mine = gcdt.Solver()
    ways = {"C functions": by_c, "gcdt.triangulate_pslg": lambda: gcdt.triangulate_pslg(points, solver=mine)}
    by_python = ways["gcdt.triangulate_pslg"]()
    assert (by_python.triangles.view(np.uint8).ravel() == by_c()[0][:-1]).all()
    times, busy = ({name: [] for name in ways} for _ in range(2))
    beside = []  # what a call in Python takes beside the call in C++ that it makes
    for _ in range(repeat):  # in turns: the machine may become slower or faster
        for name, way in ways.items():
            start, cpu = time.perf_counter(), time.process_time()
            made = way()
            times[name].append(1e3 * (time.perf_counter() - start))
            busy[name].append(1e3 * (time.process_time() - cpu))
            if name != "C functions":
                beside.append(times[name][-1] - made.statistics["ms"]["call"])
    table(f"{count} vertices", [(name, (times[name], busy[name])) for name in ways])
    print(f"\nPython beside its C++ call: {statistics.median(beside):.2f} ms")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("Usage: ")[1])
    parser.add_argument("what", nargs="*", default=["polygons", "find_simplex"])
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--library", default="libgcdt.so")
    args = parser.parse_args()
    print(gcdt.default_solver())
    for what in args.what:
        if what == "polygons":
            polygons(args.count or 100_000, args.repeat)
        elif what == "find_simplex":
            find_simplex(args.count or 1_000_000, args.repeat)
        elif what == "call":
            call(args.count or 1_000_000, args.repeat, args.library)
        else:
            parser.error(f"nothing is known of {what}")


if __name__ == "__main__":
    main()

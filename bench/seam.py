# SPDX-License-Identifier: Apache-2.0
"""The law of the seam (docs/scale.md): seam vertices = c * boundary * sqrt(n) for uniform vertices in a square, where the
boundary between the tiles is simulated, and c is measured. Prints rows of gcdt_bench_tiles against it, how the seam of other
inputs grows, and what many devices would need.

Usage: seam.py FILE.jsonl... [--predict DEVICES:VERTICES,...]
"""
import argparse
import collections
import json
import math

import numpy

SAMPLE = 1 << 16  # codes from which cuts are chosen, or 256 a tile (lib/tiles/cuts.cpp)
SLACK = 64  # of a tile's vertices a cut may have this part more on one side (lib/tiles/cuts.hpp)
BITS = 12  # the boundary is counted between cells of a square of 2^BITS by 2^BITS
SMALL = 0.1  # the law holds as long as the seam is this part of all vertices; beyond, seams of neighbouring cuts meet

# Measured constants (docs/scale.md, "Several machines"; include/gcdt/gcdt.h, gcdt_required_bytes).
EXCHANGE_BYTES = 20  # a vertex that goes to the rank of its tile
SEAM_BYTES = 210  # a vertex of the seam, to the first rank and back
HOST_BYTES = 90  # a vertex of a rank


def spread(numbers):
    """The bits of numbers below 2^16 at even places."""
    numbers = numbers.astype(numpy.uint64)
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        numbers = (numbers | numbers << numpy.uint64(shift)) & numpy.uint64(mask)
    return numbers


def roundest(codes, begin, slack):
    """The code that ends in most zeros of those within the slack."""
    low, high = int(codes[begin - slack]), int(codes[begin + slack])
    zeros = (low ^ high).bit_length() - 1
    return int(codes[begin]) if low >= int(codes[begin]) else high >> zeros << zeros


def boundary(tiles, seed=1):
    """The length of all boundaries between so many tiles of the unit square, cut as even_cuts() does."""
    random = numpy.random.default_rng(seed)
    count = max(SAMPLE, 256 * tiles)
    # Of 16 bits a coordinate, which are finer than the cells.
    x, y = (random.integers(0, 1 << 16, count) for _ in range(2))
    codes = numpy.sort(spread(x) | spread(y) << numpy.uint64(1))
    cuts = numpy.array([roundest(codes, count * t // tiles, count // tiles // SLACK) for t in range(1, tiles)])
    cuts = cuts.astype(numpy.uint64) >> numpy.uint64(2 * (16 - BITS))
    side = spread(numpy.arange(1 << BITS))
    tile = numpy.searchsorted(cuts, (side[:, None] | side[None, :] << numpy.uint64(1)).ravel(), "right")
    tile = tile.reshape(1 << BITS, 1 << BITS)
    edges = numpy.count_nonzero(tile[1:] != tile[:-1]) + numpy.count_nonzero(tile[:, 1:] != tile[:, :-1])
    return edges / (1 << BITS)


def mean_boundary(tiles):
    return sum(boundary(tiles, seed) for seed in range(1, 4)) / 3


def read(paths):
    for path in paths:
        with open(path) as file:
            yield from (row for row in map(json.loads, file) if "seam_vertices" in row and "fault" not in row)


def print_law(rows):
    """Returns the mean of c where the law holds."""
    print("| uniform, n | tiles | boundary | seam, vertices | part of all | c |\n|---|---|---|---|---|---|")
    constants = []
    for row in sorted(rows, key=lambda row: (row["n"], row["tiles"])):
        length = mean_boundary(row["tiles"])
        c = row["seam_vertices"] / (length * math.sqrt(row["n"]))
        if row["seam_fraction"] < SMALL:
            constants.append(c)
        print(f"| {row['n']:,} | {row['tiles']} | {length:.2f} | {row['seam_vertices']:,} | {row['seam_fraction']:.4f} "
              f"| {c:.2f} |")
    return sum(constants) / len(constants)


def print_others(rows):
    by_name = collections.defaultdict(dict)
    for row in rows:
        by_name[row["name"], row["n"]][row["tiles"]] = row
    tiles = sorted({k for some in by_name.values() for k in some})
    print("\n| input, vertices | " + " | ".join(f"{k} tiles" for k in tiles) + " |\n" + "|---" * (len(tiles) + 1) + "|")
    for (name, n), some in sorted(by_name.items()):
        print(f"| {name}, {n:,} | " + " | ".join(f"{some[k]['seam_fraction']:.3f}" if k in some else "" for k in tiles) + " |")


def print_needs(devices, n, c):
    seam = c * mean_boundary(devices) * math.sqrt(n)
    each = n / devices
    print(f"\n{devices:,} devices, {n:.2g} vertices: a device has {each / 1e6:.1f}M of them. The seam has {seam / 1e6:.2f}M vertices "
          f"({seam / n:.2%}). A rank sends {each * (1 - 1 / devices) * EXCHANGE_BYTES / 1e9:.2f} GB of vertices and "
          f"{seam / devices * SEAM_BYTES / 1e6:.1f} MB for the seam; the first one gets and gives "
          f"{seam * SEAM_BYTES / 1e9:.2f} GB; a rank's host needs {each * HOST_BYTES / 1e9:.1f} GB.")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+")
    parser.add_argument("--predict", default="8:1e9,64:1e10,1000:1e11,1000:1e12")
    arguments = parser.parse_args()
    rows = list(read(arguments.files))
    c = print_law([row for row in rows if row["name"] == "uniform"])
    print(f"\nc = {c:.2f}, the mean where the seam is less than {SMALL:.0%} of all")
    print_others([row for row in rows if row["name"] != "uniform"])
    for pair in arguments.predict.split(","):
        devices, n = pair.split(":")
        print_needs(int(devices), float(n), c)


main()

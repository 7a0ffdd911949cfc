# SPDX-License-Identifier: Apache-2.0
"""What several tests share. The oracles are other packages: scipy, triangle, shapely, matplotlib."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import gcdt


@pytest.fixture(scope="session")
def rng_points():
    return np.random.default_rng(20260101).random((2000, 2))


@pytest.fixture(autouse=True)
def a_device_is_there():
    assert gcdt.devices(), "the tests need an OpenCL device: pip install './python[cpu]'"


def as_set(triangles):
    """Triangles without their order and first corners."""
    return {frozenset(map(int, t)) for t in triangles}


def _circles(points, triangles):
    """Circumcircles: x, y, radius."""
    a, b, c = (np.asarray(points, float)[np.asarray(triangles)[:, k]] for k in range(3))
    b, c = b - a, c - a
    d = 2 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    x = (c[:, 1] * bb - b[:, 1] * cc) / d
    y = (b[:, 0] * cc - c[:, 0] * bb) / d
    return np.stack([a[:, 0] + x, a[:, 1] + y, np.hypot(x, y)], axis=1)


def same_circles(points, triangles, others):
    """Whether both have as many triangles, on the same circumcircles: all Delaunay triangulations of points have the
    same, whatever the diagonals of points on one circle are."""
    if len(triangles) == 0 or len(triangles) != len(others):
        return len(triangles) == len(others)
    ours, theirs = _circles(points, triangles), _circles(points, others)
    # Large circles are those of flat triangles, which double precision does not know as well.
    ours, theirs = (rows / np.maximum(1, rows[:, 2:]) for rows in (ours, theirs))
    far = [cKDTree(a).query(b)[0].max() for a, b in ((ours, theirs), (theirs, ours))]
    return max(far) < 1e-7

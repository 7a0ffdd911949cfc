# SPDX-License-Identifier: Apache-2.0
"""`Delaunay` beside scipy's: its documentation's expectations, and its own results."""

import numpy as np
import pytest
import scipy.spatial

import gcdt
from conftest import as_set, same_circles


def test_the_example_of_scipys_manual():
    # scipy.spatial.Delaunay, "Examples".
    points = np.array([[0, 0], [0, 1.1], [1, 0], [1, 1]])
    tri = gcdt.Delaunay(points)
    assert as_set(tri.simplices) == {frozenset((2, 3, 0)), frozenset((3, 1, 0))}
    assert points[tri.simplices].shape == (2, 3, 2)
    # Triangle 0 is the only neighbour of triangle 1, opposite to its vertex 1 (point 1).
    own = next(t for t in range(2) if 1 in tri.simplices[t])
    corner = tri.simplices[own].tolist().index(1)
    assert tri.neighbors[own].tolist().count(-1) == 2 and tri.neighbors[own, corner] == 1 - own
    # find_simplex, and barycentric coordinates by the transform.
    p = np.array([(0.1, 0.2), (1.5, 0.5), (0.5, 1.05)])
    theirs = scipy.spatial.Delaunay(points)
    found, expected = tri.find_simplex(p), theirs.find_simplex(p)
    assert found[1] == -1
    for mine, other in zip(found, expected):
        assert (mine == -1) == (other == -1)
        assert mine == -1 or set(tri.simplices[mine]) == set(theirs.simplices[other])
    t = found[0]
    b = tri.transform[t, :2].dot(p[0] - tri.transform[t, 2])
    weights = np.c_[b.reshape(1, 2), 1 - b.sum()][0]
    np.testing.assert_allclose(weights @ points[tri.simplices[t]], p[0])


@pytest.mark.parametrize("seed, n", [(0, 3), (1, 10), (2, 300), (3, 5000)])
def test_random_points(seed, n):
    points = np.random.default_rng(seed).normal(size=(n, 2))
    ours, theirs = gcdt.Delaunay(points), scipy.spatial.Delaunay(points)
    assert as_set(ours.simplices) == as_set(theirs.simplices)
    assert ours.simplices.dtype == theirs.simplices.dtype and ours.neighbors.dtype == theirs.neighbors.dtype
    assert as_set(ours.convex_hull) == as_set(theirs.convex_hull)
    assert len(ours.coplanar) == len(theirs.coplanar) == 0
    for name in ("ndim", "npoints", "nsimplex"):
        assert getattr(ours, name) == getattr(theirs, name)
    for name in ("min_bound", "max_bound", "points"):
        assert (getattr(ours, name) == getattr(theirs, name)).all()
    # Neighbours: across from corner k, as scipy's are.
    number = {frozenset(map(int, t)): i for i, t in enumerate(theirs.simplices)}
    to_theirs = np.array([number[frozenset(map(int, t))] for t in ours.simplices])
    for t in range(ours.nsimplex):
        for k in range(3):
            other = theirs.neighbors[to_theirs[t]][list(theirs.simplices[to_theirs[t]]).index(ours.simplices[t, k])]
            mine = ours.neighbors[t, k]
            assert (mine == -1 and other == -1) or to_theirs[mine] == other
    v = ours.vertex_to_simplex
    assert v.shape == (n,) and (ours.simplices[v] == np.arange(n)[:, None]).any(axis=1).all()
    (p, i), (q, j) = ours.vertex_neighbor_vertices, theirs.vertex_neighbor_vertices
    assert all(set(i[p[a] : p[a + 1]]) == set(j[q[a] : q[a + 1]]) for a in range(n))
    where = np.random.default_rng(seed + 100).normal(size=(7, 11, 2))
    mine, other = ours.find_simplex(where), theirs.find_simplex(where)
    assert mine.shape == other.shape
    assert ((mine == -1) == (other == -1)).all()
    assert (to_theirs[mine[mine >= 0]] == other[other >= 0]).all()
    np.testing.assert_allclose(
        ours.transform, [_scipys_transform(points, s) for s in ours.simplices], rtol=1e-6, atol=1e-9
    )


def _scipys_transform(points, simplex):
    """Its definition in scipy's manual."""
    last = points[simplex[2]]
    return np.vstack([np.linalg.inv((points[simplex[:2]] - last).T), last])


def test_points_on_circles_and_lines():
    x, y = np.meshgrid(np.arange(12.0), np.arange(9.0))
    grid = np.stack([x.ravel(), y.ravel()], axis=1)
    ours, theirs = gcdt.Delaunay(grid), scipy.spatial.Delaunay(grid)
    assert same_circles(grid, ours.simplices, theirs.simplices)
    assert as_set(ours.convex_hull) == as_set(theirs.convex_hull)


def test_equal_points_are_coplanar():
    points = np.array([[0, 0], [1, 0], [0, 1], [1, 1.5], [0, 0], [1, 0]])
    ours, theirs = gcdt.Delaunay(points), scipy.spatial.Delaunay(points)
    lost = {frozenset((int(a), int(c))) for a, _, c in ours.coplanar}
    assert lost == {frozenset((int(a), int(c))) for a, _, c in theirs.coplanar}
    for point, simplex, vertex in ours.coplanar:
        assert vertex in ours.simplices[simplex] and (points[point] == points[vertex]).all()


def test_segments_are_edges():
    points = np.random.default_rng(8).random((200, 2))
    points = points[np.argsort(points[:, 0])]
    path = np.stack([np.arange(199), np.arange(1, 200)], axis=1)
    tri = gcdt.Delaunay(points, path)
    edges = as_set(tri.mesh.edges)
    assert as_set(path) <= edges
    assert not as_set(path) <= as_set(gcdt.Delaunay(points).mesh.edges)


def test_points_of_crossings_follow():
    points = [(0, 0), (4, 4), (4, 0), (0, 4)]
    tri = gcdt.Delaunay(points, [(0, 1), (2, 3)], crossing="split")
    assert tri.npoints == 5 and tri.points[4].tolist() == [2, 2]
    assert (tri.simplices[tri.vertex_to_simplex] == np.arange(5)[:, None]).any(axis=1).all()


def test_flat_input_has_no_triangles():
    tri = gcdt.Delaunay([(0, 0), (1, 1), (2, 2)])
    assert tri.nsimplex == 0 and tri.convex_hull.shape == (0, 2) and tri.find_simplex((1, 1)) == -1
    assert tri.transform.shape == (0, 3, 2)


def test_what_is_scipys_alone_says_so():
    with pytest.raises(NotImplementedError):
        gcdt.Delaunay([(0, 0), (1, 0), (0, 1)], incremental=True)
    with pytest.raises(ValueError, match="vertex 1"):
        gcdt.Delaunay([(0, 0), (np.nan, 0), (0, 1)])

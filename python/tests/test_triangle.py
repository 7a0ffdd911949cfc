# SPDX-License-Identifier: Apache-2.0
"""`triangulate` beside the package `triangle`, on its own examples and on small cases of each rule."""

import numpy as np
import pytest
import triangle

import gcdt
from conftest import same_circles

# Those of its data files that hold an input; for others it needs refinement, or has none.
EXAMPLES = [
    "A",
    "box",
    "double_hex",
    "double_hex2",
    "double_hex3",
    "face",
    "la",
    "square_circle_hole",
    "dots",
    "diamond_02_00009",
    "spiral",
    "ell",
]
SWITCHES = ["", "p", "pc", "pe", "pn", "pA", "pj", "c", "e", "n", "pcen", "pAejB", "QzpY"]
INPUTS = ("vertices", "vertex_attributes", "vertex_markers", "segments", "segment_markers", "holes", "regions")


def _input(name):
    data = triangle.get_data(name)
    return {key: data[key] for key in INPUTS if key in data}


def _rows(made, kind, points):
    """Segments or edges by their coordinates, with their markers, if there are any."""
    ends = np.asarray(made[kind + "s"], int).reshape(-1, 2)
    markers = made.get(kind + "_markers", np.zeros(len(ends)))
    rows = [(tuple(sorted((tuple(points[a]), tuple(points[b])))), int(m)) for (a, b), m in zip(ends, np.ravel(markers))]
    return sorted(rows)


def same(given, switches):
    """Whether both packages say the same, but for order and diagonals of points on one circle."""
    theirs, ours = triangle.triangulate(given, switches), gcdt.triangulate(given, switches)
    for key, value in theirs.items():
        assert key in ours, key
        assert ours[key].dtype == np.asarray(value).dtype, key
        assert ours[key].shape == np.asarray(value).shape, key
    for key in set(ours) - set(theirs):
        assert len(ours[key]) == 0, key
    points = ours["vertices"]
    if len(points):  # without them triangle has no key
        np.testing.assert_array_equal(points, theirs["vertices"])
    assert ("vertex_markers" in ours) == ("B" not in switches)
    if len(points) and "B" not in switches:
        np.testing.assert_array_equal(ours["vertex_markers"], theirs["vertex_markers"])
    if "triangles" in theirs:
        assert same_circles(points, ours["triangles"], theirs["triangles"])
    if "segments" in theirs:
        assert _rows(ours, "segment", points) == _rows(theirs, "segment", points)
    if "edges" in theirs:
        mine, others = _rows(ours, "edge", points), _rows(theirs, "edge", points)
        assert [m for m in mine if m[1]] == [m for m in others if m[1]]
    if "triangle_attributes" in theirs:
        assert sorted(np.ravel(ours["triangle_attributes"])) == sorted(np.ravel(theirs["triangle_attributes"]))
    if "neighbors" in theirs:
        for made in (ours, theirs):
            corners, links = np.asarray(made["triangles"]), np.asarray(made["neighbors"])
            t, k = np.nonzero(links >= 0)
            assert not (corners[links[t, k]] == corners[t, k][:, None]).any(), "a neighbour is across from the corner"
    return ours, theirs


# Without segments p removes everything, in both.
CASES = [(n, s) for n in EXAMPLES for s in SWITCHES if "p" not in s or "segments" in _input(n)]


@pytest.mark.parametrize("name, switches", CASES)
def test_its_own_examples(name, switches):
    same(_input(name), switches)


def test_the_example_that_is_rounded():
    # Its longitudes are thirds of degrees: off every grid. Triangles that are flatter than a cell differ at the hull.
    given = _input("greenland")
    theirs, ours = (package.triangulate(given, "") for package in (triangle, gcdt))
    corners = [{frozenset(t) for t in made["triangles"].tolist()} for made in (theirs, ours)]
    assert len(corners[0] ^ corners[1]) < 20 and len(corners[0] & corners[1]) > 60000


FRAME = {
    "vertices": [[0, 0], [5, 0], [4, 4], [0, 4], [1, 1], [3, 1], [3, 3], [1, 3.5]],
    "segments": [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]],
}


@pytest.mark.parametrize("switches", ["p", "pe", "pen", "pc", "pA", "pB", "pAj", "pce"])
@pytest.mark.parametrize(
    "more",
    [
        {},
        {"holes": [[2, 2]]},
        {"segment_markers": [[1], [2], [3], [4], [5], [0], [0], [0]]},
        {"vertex_markers": [[0], [9], [0], [0], [0], [8], [0], [0]], "segment_markers": [[0]] * 4 + [[7]] * 4},
        {"regions": [[2, 2, 7, 0.1], [0.5, 0.5, 3, 0]]},
        {"regions": [[2, 2, 7, 0.1], [2.1, 2.2, 9, 0]], "holes": [[0.2, 0.3]]},
        {"vertex_attributes": [[float(v), -1.0] for v in range(8)]},
    ],
)
def test_markers_holes_and_regions(switches, more):
    ours, theirs = same({**FRAME, **more}, switches)
    if "vertex_attributes" in more:
        np.testing.assert_array_equal(ours["vertex_attributes"], theirs["vertex_attributes"])


@pytest.mark.parametrize("switches", ["", "j", "c", "e"])
def test_equal_vertices(switches):
    same({"vertices": [[0, 0], [4, 0], [5, 4], [0, 4], [2, 2], [2, 2], [0, 0]]}, switches)


@pytest.mark.parametrize("switches", ["p", "pc"])
def test_segments_that_cross(switches):
    crossed = {
        "vertices": [[0, 0], [8, 0], [8, 6], [0, 7], [2, 1], [6, 5], [6, 1], [2, 5]],
        "segments": [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [6, 7]],
        "segment_markers": [[1], [1], [1], [1], [2], [2]],
    }
    same(crossed, switches)


def test_the_input_is_left_alone():
    given = {key: np.array(value) for key, value in FRAME.items()}
    kept = {key: value.copy() for key, value in given.items()}
    gcdt.triangulate(given, "pe")
    assert all((given[key] == kept[key]).all() for key in kept) and set(given) == set(kept)


@pytest.mark.parametrize("switches", ["pq", "pq30", "pa0.1", "pD", "pqYa2.5", "r", "ps", "pu"])
def test_refinement_is_named(switches):
    with pytest.raises(NotImplementedError, match="refinement"):
        gcdt.triangulate(FRAME, switches)


def test_other_errors():
    with pytest.raises(ValueError, match="switch v"):
        gcdt.triangulate(FRAME, "v")
    with pytest.raises(ValueError, match="unknown key segment"):
        gcdt.triangulate({"vertices": [[0, 0]], "segment": []})
    with pytest.raises(ValueError, match="segment_markers must have 8 rows"):
        gcdt.triangulate({**FRAME, "segment_markers": [[1]]}, "p")
    with pytest.raises(IndexError, match="row 0 has vertex 8"):
        gcdt.triangulate({**FRAME, "segments": [[0, 8]]}, "p")

# SPDX-License-Identifier: Apache-2.0
"""What every call says of numbers that are not finite and of indices that do not exist: which row has them."""

import numpy as np
import pytest
import shapely

import gcdt

POINTS = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (1.0, 2.0), (3.0, 2.0)]
SEGMENTS = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)]
RINGS, POLYGONS = [0, 3, 6], [0, 1, 2]
TRIANGLES = [(0, 1, 5), (0, 5, 4)]


def kept(tmp_path, values):
    """A copy of an array in memory that ends the process if it is written to."""
    values = np.ascontiguousarray(values)
    (tmp_path / "array").write_bytes(values.tobytes())
    array = np.memmap(tmp_path / "array", values.dtype, "r", shape=values.shape)
    (tmp_path / "array").unlink()
    assert not array.flags.writeable and not np.shares_memory(array, values)
    return array


@pytest.fixture(scope="module")
def mesh():
    return gcdt.triangulate_pslg(POINTS, SEGMENTS)


# Each takes six points, of which one is bad.
CALLS_WITH_POINTS = {
    "triangulate_pslg": lambda m, p: gcdt.triangulate_pslg(p),
    "triangulate_pslg, constrained": lambda m, p: gcdt.triangulate_pslg(p, SEGMENTS, domain="even-odd"),
    "triangulate_pslg, on a grid": lambda m, p: gcdt.triangulate_pslg(p, grid=(0, 0, "0.001")),
    "holes": lambda m, p: gcdt.triangulate_pslg(POINTS, SEGMENTS, domain="holes", holes=p),
    "regions": lambda m, p: gcdt.triangulate_pslg(POINTS, SEGMENTS, regions=p),
    "Delaunay": lambda m, p: gcdt.Delaunay(p),
    "Delaunay.find_simplex": lambda m, p: gcdt.Delaunay(POINTS).find_simplex(p),
    "triangulate": lambda m, p: gcdt.triangulate({"vertices": p}, "Q"),
    "triangulate, holes": lambda m, p: gcdt.triangulate({"vertices": POINTS, "segments": SEGMENTS, "holes": p}, "p"),
    "triangulate, regions": lambda m, p: gcdt.triangulate(
        {"vertices": POINTS, "segments": SEGMENTS, "regions": np.ma.hstack([p, np.ones((6, 2))])}, "pA"
    ),
    "triangulate_polygons": lambda m, p: gcdt.triangulate_polygons(p, RINGS, POLYGONS),
    "triangulate_polygons, nonzero": lambda m, p: gcdt.triangulate_polygons(p, RINGS, POLYGONS, domain="nonzero"),
    "ring_constraints": lambda m, p: gcdt.ring_constraints(p, RINGS, POLYGONS),
    "adopt": lambda m, p: gcdt.adopt(p, TRIANGLES),
    "verify": lambda m, p: gcdt.verify(p, TRIANGLES),
    "Mesh.locate": lambda m, p: m.locate(p),
    "Mesh.interpolate": lambda m, p: m.interpolate(p, np.arange(6.0)),
}


@pytest.mark.parametrize("name", CALLS_WITH_POINTS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_point_that_is_not_finite_is_named(mesh, name, bad, dtype, tmp_path):
    points = np.array(POINTS, dtype)
    points[4, 1] = bad
    points = kept(tmp_path, points)
    with pytest.raises(ValueError, match=r"\b(row|vertex|point) 4\b") as caught:
        CALLS_WITH_POINTS[name](mesh, points)
    assert isinstance(caught.value, gcdt.CoordinateError) and caught.value.indices == (4, 1)


@pytest.mark.parametrize("name", CALLS_WITH_POINTS)
def test_a_point_that_is_masked_is_named(mesh, name):
    points = np.ma.array(POINTS)
    points[4, 1] = np.ma.masked
    with pytest.raises(ValueError, match=r"\brow 4 is masked"):
        CALLS_WITH_POINTS[name](mesh, points)
    assert len(gcdt.triangulate_pslg(np.ma.array(POINTS)).triangles) == 6, "nothing is masked"


def test_a_point_of_a_batch_that_is_not_finite_is_an_error_of_its_problem():
    points = np.array(POINTS * 3)
    points[10, 0] = np.nan
    batch = gcdt.Pool().triangulate(points, [0, 6, 12, 18])
    assert batch.failed.tolist() == [1]
    assert isinstance(batch[1].error, ValueError) and "vertex 4" in str(batch[1].error)


def test_a_geometry_that_is_not_finite_is_named():
    wrong = shapely.polygons([[(0, 0), (1, 0), (1, np.nan), (0, 0)]])
    with pytest.raises(ValueError, match=r"geometry 1: .*coords: row \d+ has y = nan"):
        gcdt.triangulate_geometries([shapely.box(0, 0, 1, 1), *wrong])


# Each takes five pairs of vertex numbers, of which one is bad; there are six vertices.
CALLS_WITH_PAIRS = {
    "triangulate_pslg": lambda s: gcdt.triangulate_pslg(POINTS, s),
    "Delaunay": lambda s: gcdt.Delaunay(POINTS, s),
    "triangulate": lambda s: gcdt.triangulate({"vertices": POINTS, "segments": s}, "p"),
    "adopt": lambda s: gcdt.adopt(POINTS, TRIANGLES, s),
    "verify": lambda s: gcdt.verify(POINTS, TRIANGLES, s),
}
BAD_NUMBERS = [(6, np.int64), (-1, np.int64), (-1, np.int32), (2**31 - 1, np.int32), (2**32 - 1, np.uint32)]
BAD_NUMBERS += [(2**40, np.int64), (2**63, np.uint64), (-(2**63), np.int64)]


@pytest.mark.parametrize("name", CALLS_WITH_PAIRS)
@pytest.mark.parametrize("number, dtype", BAD_NUMBERS)
def test_a_vertex_that_does_not_exist_is_named(name, number, dtype, tmp_path):
    pairs = np.array(SEGMENTS, dtype)
    pairs[3, 1] = number
    pairs = kept(tmp_path, pairs)
    argument = "segments" if name in ("Delaunay", "triangulate") else "constraints"
    with pytest.raises(IndexError, match=rf"^{argument}: row 3 has vertex {number}\b") as caught:
        CALLS_WITH_PAIRS[name](pairs)
    assert isinstance(caught.value, gcdt.IndexOutOfRange) and caught.value.indices == (3, 1)


@pytest.mark.parametrize("number, dtype", BAD_NUMBERS)
def test_a_corner_that_does_not_exist_is_named(number, dtype, tmp_path):
    triangles = np.array(TRIANGLES, dtype)
    triangles[1, 2] = number
    triangles = kept(tmp_path, triangles)
    with pytest.raises(IndexError, match=rf"triangles: row 1 has vertex {number}\b"):
        gcdt.adopt(POINTS, triangles)
    assert not gcdt.verify(POINTS, triangles)


@pytest.mark.parametrize("links", [[(0.5, -1, -1), (-1, -1, 0)], [(0, -1, -1)], [("a", 1, 2)] * 2])
def test_neighbours_that_are_no_numbers_are_refused(links):
    with pytest.raises(ValueError, match="neighbours"):
        gcdt.verify(POINTS, TRIANGLES, neighbours=links)


def test_a_neighbour_that_does_not_exist_is_a_fault():
    points, triangles = [(0, 0), (4, 0), (5, 4), (0, 3)], [(0, 1, 3), (1, 2, 3)]
    links = np.array([(1, -1, -1), (-1, 0, -1)])
    assert gcdt.verify(points, triangles, neighbours=links)
    for wrong in (2, -2, 2**40, -(2**40)):
        links[1, 1] = wrong
        assert not gcdt.verify(points, triangles, neighbours=links)


@pytest.mark.parametrize(
    "what",
    [
        {"values": [1, 2, 3]},
        {"values": ["a"] * 6},
        {"values": [1j] * 6},
        {"values": np.zeros((6, 2))},
        {"values": np.ma.masked_greater(np.arange(6.0), 3)},
    ],
)
def test_values_that_do_not_fit_are_refused(mesh, what):
    with pytest.raises(ValueError, match="values"):
        mesh.interpolate([(1, 1)], **what)


@pytest.mark.parametrize("sizes", [[1, np.nan, 1, 1, 1, 1], [1, -1, 1, 1, 1, 1], [1, 0, 1, 1, 1, 1]])
def test_sizes_that_make_no_sense_are_named(sizes):
    with pytest.raises(ValueError, match=r"sizes.*\b1\b"):
        gcdt.triangulate_pslg(POINTS, SEGMENTS, refine=gcdt.Refinement(20, sizes=sizes))


@pytest.mark.parametrize(
    "key, values", [("vertex_attributes", [1, 2]), ("vertex_markers", [1]), ("segment_markers", [1])]
)
def test_columns_of_another_length_are_named(key, values):
    with pytest.raises(ValueError, match=key):
        gcdt.triangulate({"vertices": POINTS, "segments": SEGMENTS, key: values}, "p")


@pytest.mark.parametrize("key, rows", [("holes", [(1, 2, 3)]), ("regions", [(1, 2)]), ("holes", [(1, "a")])])
def test_holes_and_regions_of_another_shape_are_named(key, rows):
    with pytest.raises(ValueError, match=key):
        gcdt.triangulate({"vertices": POINTS, "segments": SEGMENTS, key: rows}, "pA")


@pytest.mark.parametrize(
    "rings, polygons, said",
    [
        ([0, 4, 3, 6], [0, 1, 3], r"ring_offsets: element 2 is 3\b"),
        ([0, 3, 7], POLYGONS, r"ring_offsets must run from 0 to 6, but element 2 is 7\b"),
        (RINGS, [0, 2, 1], r"polygon_offsets: element 2 is 1\b"),
        (RINGS, [1, 2], r"polygon_offsets must run from 0 to 2, but element 0 is 1\b"),
    ],
)
def test_offsets_that_make_no_sense_are_named(rings, polygons, said, tmp_path):
    coords, rings = kept(tmp_path, np.array(POINTS)), kept(tmp_path, np.array(rings))
    polygons = kept(tmp_path, np.array(polygons))
    for call in (gcdt.triangulate_polygons, gcdt.ring_constraints):
        with pytest.raises(ValueError, match=said):
            call(coords, rings, polygons)


def test_the_dictionary_of_triangulate_stays_as_it_is(tmp_path):
    given = {"vertices": kept(tmp_path, np.array(POINTS)), "segments": kept(tmp_path, np.array(SEGMENTS))}
    before = dict(given)
    gcdt.triangulate(given, "pqa0.1")
    assert given.keys() == before.keys() and all(given[key] is before[key] for key in before)
    wrong = {"segments": [(0, 9)], "vertex_markers": np.arange(3), "holes": [(np.nan, 1)], "regions": [(1, 1)]}
    for key, values in wrong.items():
        made = given | {key: kept(tmp_path, np.array(values))}
        before = dict(made)
        with pytest.raises(gcdt.Error):
            gcdt.triangulate(made, "pA")
        assert made.keys() == before.keys() and all(made[k] is before[k] for k in before)


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: gcdt.triangulate_pslg(POINTS, crossing="cut"), "crossing is one of reject, drop, split, not cut"),
        (lambda: gcdt.triangulate_pslg(POINTS, domain="all"), "domain is one of hull, "),
        (lambda: gcdt.triangulate_pslg(POINTS, grid=(0, 0)), "a grid is"),
        (lambda: gcdt.triangulate_polygons(POINTS, RINGS, POLYGONS, errors="ignore"), "errors is"),
        (lambda: gcdt.triangulate_pslg(POINTS, solver="cpu"), "solver is a gcdt.Solver, not 'cpu'"),
        (lambda: gcdt.triangulate_pslg(POINTS, solver=gcdt.Solver(), device="cpu"), "a solver or a device, not both"),
        (lambda: gcdt.triangulate_polygons(POINTS, RINGS, POLYGONS, pool="cpu"), "pool is a gcdt.Pool, not 'cpu'"),
        (lambda: gcdt.triangulate_polygons(POINTS, RINGS, POLYGONS, pool=gcdt.Pool(), devices=0), "not both"),
        (lambda: gcdt.Delaunay(POINTS).find_simplex([1, 2, 3]), "xi must have the shape"),
        (lambda: gcdt.triangulate(POINTS), "not list"),
        (lambda: gcdt.triangulate({"vertcies": POINTS}), "unknown key vertcies"),
    ],
)
def test_arguments_that_make_no_sense_are_errors_of_gcdt(call, said):
    with pytest.raises(ValueError, match=said) as caught:
        call()
    assert isinstance(caught.value, gcdt.InputError)

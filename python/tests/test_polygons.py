# SPDX-License-Identifier: Apache-2.0
"""Polygons beside shapely: areas, and every triangle within its polygon."""

import importlib
import threading

import numpy as np
import pytest
import shapely
from shapely.geometry import MultiPolygon, Point, Polygon

import gcdt


def many(count, seed=0):
    """Star-shaped polygons, every second one with a hole, some multi-polygons."""
    rng = np.random.default_rng(seed)
    made = []
    for i in range(count):
        centre, corners = rng.uniform(0, 100, 2), int(rng.integers(3, 30))
        angles = np.sort(rng.uniform(0, 2 * np.pi, corners))
        angles[:3] = [0.1, 2.2, 4.3]  # so that the centre is inside
        angles.sort()
        ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * rng.uniform(1, 2, corners)[:, None]
        polygon = Polygon(centre + ring)
        if i % 2:
            polygon = polygon.difference(Point(centre).buffer(0.2))
        if i % 7 == 0:
            polygon = MultiPolygon([*shapely.get_parts(polygon), shapely.box(*(centre + 200), *(centre + 201))])
        made.append(polygon)
    assert all(p.is_valid for p in made)
    return np.array(made)


def test_areas_and_places_of_many_polygons():
    geometries = many(300)
    made, row = gcdt.triangulate_geometries(geometries)
    areas = np.bincount(row, weights=shapely.area(made.to_shapely()), minlength=len(geometries))
    np.testing.assert_allclose(areas, shapely.area(geometries), rtol=1e-9)
    centres = shapely.centroid(made.to_shapely())
    assert shapely.contains(geometries[row], centres).all()
    assert not made.errors and repr(made) == f"<gcdt.PolygonTriangles: {len(row)} triangles of 343 polygons>"


def test_the_arrays_of_shapely_go_straight_in():
    polygons = shapely.get_parts(many(50, seed=1))
    kind, coords, (rings, parts) = shapely.to_ragged_array(polygons)
    made = gcdt.triangulate_polygons(coords, rings, parts)
    np.testing.assert_allclose(made.areas, shapely.area(polygons), rtol=1e-9)
    assert made.offsets.tolist() == [0, *np.cumsum(np.bincount(made.polygon_of, minlength=len(polygons)))]
    assert np.shares_memory(made.points, coords)


def test_rings_may_be_open_and_run_either_way():
    ring = np.array([(0, 0), (4, 0), (4, 3), (0, 3)])
    hole = np.array([(1, 1), (2, 1), (2, 2), (1, 2)])
    for a in (ring, ring[::-1], np.vstack([ring, ring[:1]])):
        for b in (hole, hole[::-1], np.vstack([hole, hole[:1]])):
            coords, rings = np.vstack([a, b]), [0, len(a), len(a) + len(b)]
            for domain in ("even-odd", "nonzero"):
                made = gcdt.triangulate_polygons(coords, rings, [0, 2], domain=domain)
                assert made.areas.tolist() == [11.0]


@pytest.mark.whole
def test_geopandas_in_and_out():
    geopandas = importlib.import_module("geopandas")
    frame = geopandas.GeoDataFrame({"name": ["a", "b"]}, geometry=list(many(2, seed=2)), crs="EPSG:3857")
    made, row = gcdt.triangulate_geometries(frame.geometry)
    triangles = made.to_geopandas(crs=frame.crs)
    dissolved = triangles.assign(row=row).dissolve("row")
    np.testing.assert_allclose(dissolved.area, frame.area, rtol=1e-9)
    assert triangles.crs == frame.crs


def test_missing_and_empty_geometries_have_no_triangles():
    geometries = [None, Polygon(), shapely.box(0, 0, 1, 1), MultiPolygon()]
    made, row = gcdt.triangulate_geometries(geometries)
    assert row.tolist() == [2, 2]
    assert len(gcdt.triangulate_geometries([])[0].triangles) == 0
    with pytest.raises(TypeError, match="geometry 1 is no polygon but a Point"):
        gcdt.triangulate_geometries([shapely.box(0, 0, 1, 1), Point(1, 1)])
    with pytest.raises(ValueError, match="even-odd"):
        gcdt.triangulate_geometries(geometries, domain="round")


def test_one_bad_polygon_is_named_and_spoils_no_other():
    bow_tie = [(0, 0), (2, 2), (2, 0), (0, 2)]
    square = [(5, 5), (6, 5), (6, 6), (5, 6)]
    coords, rings, parts = np.array(square + bow_tie + square, float), [0, 4, 8, 12], [0, 1, 2, 3]
    with pytest.raises(gcdt.ConstraintsCross, match="polygon 1: ") as caught:
        gcdt.triangulate_polygons(coords, rings, parts)
    assert caught.value.pairs == [(0, 2)]
    made = gcdt.triangulate_polygons(coords, rings, parts, errors="return")
    assert list(made.errors) == [1] and made.areas.tolist() == [1.0, 0.0, 1.0]
    split = gcdt.triangulate_polygons(coords, rings, parts, crossing="split")
    valid = shapely.make_valid(Polygon(bow_tie))
    assert split.areas.tolist() == [1.0, valid.area, 1.0]
    assert split.points[12:].tolist() == [[1.0, 1.0]]
    coords[9, 0] = np.nan
    with pytest.raises(ValueError, match="polygon|not finite"):
        gcdt.triangulate_polygons(coords, rings, parts)


@pytest.mark.parametrize(
    "rings, parts, message",
    [
        ([0, 4, 3], [0, 2], "ring_offsets: element 2"),
        ([0, 4, 9], [0, 2], "ring_offsets must run from 0 to 8"),
        ([1, 4, 8], [0, 2], "ring_offsets must run from 0"),
        ([0, 4, 8], [0, 3], "polygon_offsets must run from 0 to 2"),
        ([0.0, 4.0, 8.0], [0, 2], "whole numbers"),
        ([-1, 4, 8], [0, 2], "element 0 is -1"),
    ],
)
def test_offsets_that_make_no_sense(rings, parts, message):
    with pytest.raises(ValueError, match=message):
        gcdt.triangulate_polygons(np.zeros((8, 2)), rings, parts)


def test_batches_of_problems():
    rng = np.random.default_rng(9)
    sizes = rng.integers(0, 60, 100)
    bounds = np.concatenate([[0], np.cumsum(sizes)])
    points = rng.random((bounds[-1], 2))
    pool = gcdt.Pool("auto")
    batch = pool.triangulate(points, bounds)
    assert len(batch) == 100 and len(batch.failed) == 0
    triangles, offsets = batch.all_of("triangles")
    for p in range(100):
        alone = gcdt.triangulate_pslg(points[bounds[p] : bounds[p + 1]])
        assert (batch[p].triangles == alone.triangles).all()
        assert (batch[p].neighbours == alone.neighbours).all()
        assert (triangles[offsets[p] : offsets[p + 1]] == alone.triangles).all()
    assert sum(d["problems"] for d in pool.devices) == 100
    with pytest.raises(IndexError):
        batch[100]
    assert len(batch[-2:]) == 2 and batch[0].statistics["grid"]["kind"]
    assert repr(batch) == f"<gcdt.Batch of 100 problems, {len(triangles)} triangles, 0 failed>"


def test_problems_have_their_own_errors():
    points = [(0, 0), (2, 2), (2, 0), (0, 2)] * 3
    constraints = [(0, 1), (0, 1), (2, 3), (0, 9)]
    batch = gcdt.Pool().triangulate(points, [0, 4, 8, 12], constraints, [0, 1, 3, 4])
    assert batch.failed.tolist() == [1, 2] and batch[0].error is None
    assert isinstance(batch[1].error, gcdt.ConstraintsCross) and isinstance(batch[2].error, IndexError)
    assert batch[2].error.indices == (0, 1) and len(batch[1].triangles) == 0
    assert repr(batch[0]) == "<gcdt.Problem 0: 2 triangles>" and str(batch[2].error) in repr(batch[2])
    with pytest.raises(IndexError, match="row 3"):
        gcdt.Pool().triangulate(points, [0, 4, 8, 12], [*constraints[:3], (0, -1)], [0, 1, 3, 4])
    with pytest.raises(ValueError, match="constraint_offsets"):
        gcdt.Pool().triangulate(points, [0, 4, 8, 12], constraints, [0, 4])


def test_threads_take_turns_at_a_pool():
    coords, rings, parts = np.tile([(0, 0), (4, 0), (0, 4)], (500, 1)), np.arange(0, 1501, 3), np.arange(501)
    pool, areas, looked = gcdt.Pool(), [], []

    def work():
        for _ in range(3):
            areas.append(gcdt.triangulate_polygons(coords, rings, parts, pool=pool).areas.sum())
            looked.append(len(pool.devices))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert areas == [500 * 8.0] * 12 and set(looked) == {1}

    def again(phase, done):
        with pytest.raises(gcdt.Error) as caught:
            _ = pool.devices
        said.append(caught.value.status)
        with pytest.raises(gcdt.Error) as caught:
            gcdt.triangulate_polygons(coords, rings, parts, pool=pool)
        said.append(caught.value.status)

    said = []
    gcdt.triangulate_polygons(coords, rings, parts, pool=pool, progress=again)
    assert set(said) == {"in_use"}

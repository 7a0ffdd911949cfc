# SPDX-License-Identifier: Apache-2.0
"""Quality refinement: of a call, of a mesh that is there, in batches; proofs; the package `triangle` beside it."""

import numpy as np
import pytest
import triangle

import gcdt
from gcdt import Refinement

SQUARE = np.array([(0, 0), (8, 0), (8, 8), (0, 8), (3, 0), (3, 8)], float)
WALLS = np.array([(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0), (4, 5)])
ARRAYS = ("triangles", "neighbours", "constrained", "representative", "pieces", "source_offsets", "sources", "added")
ARRAYS += ("added_on_grid", "added_origin", "region", "depth", "winding", "region_seed", "excuse")


def same(a, b, but=()):
    for name in set(ARRAYS) - set(but):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), name)


def test_angles_and_areas_are_as_wanted():
    mesh = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(30, most_area=0.25))
    assert mesh.quality()["least_angle"] >= 30 and mesh.areas.max() <= 0.25
    assert mesh.areas.sum() == pytest.approx(64)
    assert len(mesh.points) == len(mesh.representative) == len(SQUARE) + len(mesh.added)
    np.testing.assert_array_equal(mesh.points[: len(SQUARE)], SQUARE)
    assert mesh.statistics["refine"]["complete"] and mesh.statistics["refine"]["added"] == len(mesh.added)
    assert mesh.added_origin.shape == (len(mesh.added), 4)
    on = mesh.added_origin[:, 3]
    wall = mesh.added[on == 6]
    assert len(wall) and (wall[:, 0] == 3).all()
    assert mesh.verify()


def test_points_beside_triangle(rng_points):
    ours = gcdt.triangulate_pslg(rng_points, refine=20)
    theirs = triangle.triangulate({"vertices": rng_points}, "q20")
    added = len(theirs["vertices"]) - len(rng_points)
    assert len(ours.added) <= 1.1 * added
    assert ours.quality()["least_angle"] >= 20


@pytest.mark.parametrize("domain", ["hull", "outer", "even-odd"])
def test_a_mesh_is_refined_to_the_bytes_of_one_call(domain, rng_points):
    plain = gcdt.triangulate_pslg(SQUARE, WALLS, domain=domain)
    before = plain.triangles.copy()
    for wanted in (25, Refinement(28, most_area=0.3, conforming=True), Refinement(0, most_area=1)):
        refined = plain.refine(wanted)
        same(refined, gcdt.triangulate_pslg(SQUARE, WALLS, domain=domain, refine=wanted))
        assert refined.verify()
    np.testing.assert_array_equal(plain.triangles, before)
    assert plain.verify()
    assert len(plain.refine(Refinement(20, most_area=0.1, most_added=7)).added) == 7
    # On its own: the mesh that it was made of may go.
    refined = plain.refine(Refinement(most_area=0.3))
    plain.release()
    assert (refined.locate([(1, 1), (9, 9)]) >= 0).tolist() == [True, False]
    with pytest.raises(ValueError, match="released"):
        plain.refine(20)


def test_why_triangles_are_left():
    needle = np.array([(0, 0), (10, 0), (10, 1)], float)
    mesh = gcdt.triangulate_pslg(needle, [(0, 1), (1, 2), (2, 0)], refine=Refinement(20, most_area=0.2))
    left = [gcdt.EXCUSES[excuse] for excuse in mesh.excuse[mesh.excuse > 0]]
    assert left.count("input angle") == mesh.statistics["refine"]["left_input_angle"] == 1
    assert left.count("beside angle") == mesh.statistics["refine"]["left_beside_angle"] == len(left) - 1
    assert 0 in mesh.triangles[gcdt.EXCUSES.index("input angle") == mesh.excuse] and mesh.verify()
    part = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(20, most_area=0.1, most_added=9))
    assert "limit" in {gcdt.EXCUSES[excuse] for excuse in part.excuse}
    assert len(gcdt.triangulate_pslg(SQUARE, WALLS).excuse) == 0


def test_a_refined_mesh_is_refined_further():
    once = gcdt.triangulate_pslg(SQUARE, WALLS, domain="outer", refine=Refinement(20, most_area=4))
    before = once.triangles.copy()
    twice = once.refine(Refinement(28, most_area=0.5))
    count = len(once.added)
    assert 0 < count < len(twice.added) == twice.statistics["refine"]["added"] + count
    np.testing.assert_array_equal(twice.points[: len(SQUARE)], SQUARE)
    np.testing.assert_array_equal(twice.added[:count], once.added)
    np.testing.assert_array_equal(twice.added_origin[:count], once.added_origin)
    assert twice.quality()["least_angle"] >= 28 and twice.areas.max() <= 0.5
    assert once.verify() and twice.verify()
    same(twice.refine(Refinement(28, most_area=0.5)), twice)
    np.testing.assert_array_equal(once.triangles, before)


def test_an_adopted_mesh_is_refined():
    own = gcdt.triangulate_pslg(SQUARE, WALLS, domain="outer")
    adopted = gcdt.adopt(SQUARE, own.triangles[::-1], WALLS)
    labels = ("region", "depth", "winding", "region_seed")  # adopted meshes have none
    same(adopted.refine(25), own.refine(25), labels)
    same(adopted.refine(20).refine(30), own.refine(20).refine(30), labels)
    # What it covers is its domain, constraints or not.
    half = gcdt.adopt(SQUARE, own.triangles[own.points[own.triangles].mean(axis=1)[:, 0] < 3])
    refined = half.refine(Refinement(20, most_area=0.5))
    assert refined.areas.sum() == pytest.approx(24) and refined.areas.max() <= 0.5
    assert not refined.constrained.any()


def test_what_cannot_be_refined():
    plain = gcdt.triangulate_pslg(SQUARE, WALLS)
    for mesh in (plain, plain.refine(20), gcdt.adopt(SQUARE, plain.triangles, WALLS)):
        with pytest.raises(ValueError, match="no regions"):
            mesh.refine(Refinement(region_areas=[1.0]))
    for bad, why in [
        (60, "least_angle"),
        (Refinement(most_area=-1), "most_area"),
        (Refinement(sizes=[1.0]), "1 lengths for 6 vertices"),
        (Refinement(splits="some"), "splits is one of all, inner, none"),
        (Refinement(most_added=-1), "most_added"),
        (Refinement(most_added=1.5), "most_added"),
        (Refinement(most_added=True), "most_added"),
        ("20", "a gcdt.Refinement or a least angle"),
        (True, "a gcdt.Refinement or a least angle"),
    ]:
        with pytest.raises(ValueError, match=why):
            plain.refine(bad)
        with pytest.raises(ValueError, match=why):
            gcdt.triangulate_pslg(SQUARE, WALLS, refine=bad)
    with pytest.raises(ValueError, match="a gcdt.Refinement or a least angle, not None"):
        plain.refine(None)
    with pytest.raises(gcdt.Cancelled):
        plain.refine(Refinement(most_area=1e-3), progress=lambda phase, done: False)
    assert len(plain.refine(Refinement(most_area=1, most_added=2**70)).added)


def test_regions_and_lengths():
    regions = [(1, 1), (7, 7)]
    wanted = Refinement(region_areas=[0.1, np.inf])
    mesh = gcdt.triangulate_pslg(SQUARE, WALLS, regions=regions, refine=wanted)
    assert mesh.areas[mesh.region_seed == 0].max() <= 0.1 < mesh.areas[mesh.region_seed == 1].max()
    same(gcdt.triangulate_pslg(SQUARE, WALLS, regions=regions).refine(wanted), mesh)
    graded = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(sizes=0.1 + SQUARE[:, 1] / 4))
    low, high = (np.abs(graded.points[graded.triangles].mean(axis=1)[:, 1] - y) < 1 for y in (0, 8))
    assert graded.areas[low].mean() < graded.areas[high].mean() / 20
    assert graded.verify()


def test_values_at_added_vertices():
    mesh = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(most_area=0.3))
    value = 3 * SQUARE[:, 0] - SQUARE[:, 1] + 2
    np.testing.assert_allclose(mesh.added_values(value), 3 * mesh.added[:, 0] - mesh.added[:, 1] + 2)
    assert mesh.interpolate([(2.5, 4)], value)[0] == pytest.approx(5.5)


def test_proofs_notice_what_is_wrong():
    mesh = gcdt.triangulate_pslg(SQUARE, WALLS, refine=25)
    assert mesh.verify()
    moved = mesh.added_on_grid.copy()
    moved[0] += 1000
    mesh.added_on_grid = moved
    assert not mesh.verify()
    limited = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(30, most_area=0.5, most_added=5))
    assert not limited.statistics["refine"]["complete"] and limited.verify()
    # Proved by other bounds than those that it was made for: not as wanted, and without an excuse.
    coarse = gcdt.triangulate_pslg(SQUARE, WALLS, refine=Refinement(most_area=2))
    coarse._options = coarse._options.refined(Refinement(most_area=0.1)._native())
    assert "area" in coarse.verify().reason


def test_batches_and_scipy_s_names(rng_points):
    offsets = [0, 6, 106, 206]
    points = np.concatenate([SQUARE, rng_points[:100], [(0, 0), (1, np.nan)], rng_points[100:198]])
    made = gcdt.Pool().triangulate(points, offsets, refine=Refinement(25, most_added=200))
    assert list(made.failed) == [2]
    for p in (0, 1):
        alone = gcdt.triangulate_pslg(points[offsets[p] : offsets[p + 1]], refine=Refinement(25, most_added=200))
        np.testing.assert_array_equal(made[p].triangles, alone.triangles)
        np.testing.assert_array_equal(made[p].added_origin, alone.added_origin)
        assert made[p].statistics["refine"]["added"] == len(alone.added)
    found = gcdt.Delaunay(SQUARE, WALLS, refine=Refinement(most_area=1))
    assert found.npoints == len(found.mesh.points) > len(SQUARE)
    assert found.find_simplex([(1, 1)])[0] >= 0 and (found.vertex_to_simplex >= 0).all()

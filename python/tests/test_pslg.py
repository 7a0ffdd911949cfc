# SPDX-License-Identifier: Apache-2.0
"""The native call: arrays in and out, errors, questions, threads, interrupts."""

import gc
import signal
import subprocess
import sys
import threading
import time

import matplotlib.tri
import numpy as np
import pytest
import shapely
from scipy.spatial import ConvexHull, Delaunay

import gcdt
from conftest import as_set
from gcdt import _errors

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 2), (3, 2)]
BORDER = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)]


def test_triangles_are_those_of_scipy(rng_points):
    mesh = gcdt.triangulate_pslg(rng_points)
    assert as_set(mesh.triangles) == as_set(Delaunay(rng_points).simplices)
    assert mesh.areas.sum() == pytest.approx(ConvexHull(rng_points).volume, rel=1e-12)
    assert (mesh.areas > 0).all()
    assert mesh.verify()


def test_constraints_are_edges_and_know_their_sources():
    mesh = gcdt.triangulate_pslg(SQUARE + [(2, 2)], BORDER)
    edges = {tuple(e) for e in mesh.edges.tolist()}
    assert {(4, 6), (5, 6)} <= edges  # vertex 6 splits constraint 4
    sources = {
        tuple(sorted(piece)): mesh.sources[a:b].tolist()
        for piece, a, b in zip(mesh.pieces.tolist(), mesh.source_offsets[:-1], mesh.source_offsets[1:])
    }
    assert sources[(4, 6)] == sources[(5, 6)] == [4]
    assert sources[(0, 3)] == [3]
    at = mesh.edge_pieces
    assert ((at >= 0) == mesh.constrained_edges).all()
    for t, k in zip(*np.nonzero(at >= 0)):
        ends = {int(mesh.triangles[t, (k + j) % 3]) for j in (1, 2)}
        assert ends == set(mesh.pieces[at[t, k]].tolist())


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int32, np.int64, np.uint8, np.float16])
def test_types_of_numbers_do_not_matter(dtype):
    expected = gcdt.triangulate_pslg(SQUARE, BORDER)
    points = np.array(SQUARE, dtype)
    before = points.copy()
    for index in (np.int32, np.uint32, np.int64, np.uint64, np.int8):
        mesh = gcdt.triangulate_pslg(points, np.array(BORDER, index))
        assert (mesh.triangles == expected.triangles).all()
    assert (points == before).all() and points.dtype == dtype


def test_memory_is_shared_where_it_can_be():
    points = np.random.default_rng(1).random((1000, 2))
    mesh = gcdt.triangulate_pslg(points)
    assert np.shares_memory(mesh.points, points)
    assert not mesh.triangles.flags.owndata, "the library's memory, not a copy"
    triangles = mesh.triangles
    copy = triangles.copy()
    del mesh
    gc.collect()
    gcdt.triangulate_pslg(points[::-1])
    assert (triangles == copy).all()


def test_strided_and_read_only_arrays():
    wide = np.random.default_rng(2).random((500, 6))
    expected = gcdt.triangulate_pslg(np.ascontiguousarray(wide[:, 1:4:2]))
    frozen = np.asfortranarray(wide[:, 1:4:2])
    frozen.flags.writeable = False
    for points in (wide[:, 1:4:2], frozen):
        assert (gcdt.triangulate_pslg(points).triangles == expected.triangles).all()
    big = wide[:, 1:4:2].astype(">f8")
    assert (gcdt.triangulate_pslg(big).triangles == expected.triangles).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_numbers_that_are_not_finite_are_named(bad, dtype):
    points = np.zeros((10, 2), dtype)
    points[7, 1] = bad
    with pytest.raises(ValueError, match="vertex 7") as caught:
        gcdt.triangulate_pslg(points)
    assert isinstance(caught.value, gcdt.CoordinateError) and caught.value.indices == (7, 1)
    mesh = gcdt.triangulate_pslg(SQUARE)
    with pytest.raises(ValueError, match="7"):
        mesh.locate(points)
    with pytest.raises(ValueError, match="holes: row 7"):
        gcdt.triangulate_pslg(SQUARE, holes=points, domain="holes")


@pytest.mark.parametrize(
    "index, dtype", [(6, np.int64), (-1, np.int64), (-1, np.int32), (6, np.uint32), (2**40, np.int64), (6, np.uint8)]
)
def test_indices_that_do_not_exist_are_named(index, dtype):
    constraints = np.array(BORDER).astype(dtype)
    constraints[3, 1] = index
    with pytest.raises(IndexError, match=rf"row 3 has vertex {index}\b") as caught:
        gcdt.triangulate_pslg(SQUARE, constraints)
    assert isinstance(caught.value, gcdt.IndexOutOfRange) and caught.value.indices == (3, 1)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: gcdt.triangulate_pslg([1, 2, 3]), "shape"),
        (lambda: gcdt.triangulate_pslg([[1, 2, 3]]), "shape"),
        (lambda: gcdt.triangulate_pslg([["a", "b"]]), "numbers"),
        (lambda: gcdt.triangulate_pslg([[1 + 2j, 2]]), "numbers"),
        (lambda: gcdt.triangulate_pslg(SQUARE, [[0, 1, 2]]), "shape"),
        (lambda: gcdt.triangulate_pslg(SQUARE, [[0.0, 1.0]]), "whole numbers"),
        (lambda: gcdt.triangulate_pslg(SQUARE, crossing="often"), "crossing"),
        (lambda: gcdt.triangulate_pslg(SQUARE, domain="of discourse"), "domain"),
        (lambda: gcdt.triangulate_pslg(SQUARE, grid=(0, 0)), "grid"),
        (lambda: gcdt.triangulate_pslg(SQUARE, grid=(0, 0, "nothing")), "cell"),
        (lambda: gcdt.triangulate_pslg(SQUARE, grid=(1, 0, "1")), "vertex 0"),
        (lambda: gcdt.triangulate_pslg([[2**60, 0], [1, 1]]), "vertex 0"),
        (lambda: gcdt.triangulate_pslg(SQUARE).interpolate([[1, 1]], [1, 2, 3]), "one number for each of 6"),
    ],
)
def test_arguments_that_make_no_sense_are_value_errors(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_crossings_are_refused_dropped_or_split():
    points, cross = [(0, 0), (4, 4), (4, 0), (0, 4)], [(0, 1), (2, 3)]
    with pytest.raises(gcdt.ConstraintsCross) as caught:
        gcdt.triangulate_pslg(points, cross)
    assert caught.value.pairs == [(0, 1)] and caught.value.pair_count == 1
    assert gcdt.triangulate_pslg(points, cross, crossing="drop").dropped.tolist() == [1]
    split = gcdt.triangulate_pslg(points, cross, crossing="split")
    crossing = shapely.LineString(points[:2]).intersection(shapely.LineString(points[2:]))
    assert split.added.tolist() == [list(crossing.coords[0])]
    assert split.points.shape == (5, 2) and split.added_crossing.tolist() == [[0, 1]]
    assert split.verify()
    values = [0.0, 4.0, 10.0, 20.0]
    assert split.added_values(values).tolist() == [(2 + 15) / 2]
    assert split.interpolate([(2, 2)], values).tolist() == [8.5]


def test_domains_have_the_areas_of_shapely():
    outer = [(0, 0), (10, 0), (10, 10), (0, 10)]
    hole = [(2, 2), (5, 2), (5, 5), (2, 5)]
    polygon = shapely.Polygon(outer, [hole])
    constraints = gcdt.ring_constraints(outer + hole, [0, 4, 8])
    for how in ({"domain": "even-odd"}, {"domain": "outer-holes", "holes": [(3, 3)]}):
        mesh = gcdt.triangulate_pslg(outer + hole, constraints, **how)
        assert mesh.areas.sum() == polygon.area
        assert mesh.verify()
    whole = gcdt.triangulate_pslg(outer + hole, constraints, regions=[(3, 3), (1, 1)])
    centres = shapely.points(np.asarray(whole.points, float)[whole.triangles].mean(axis=1))
    assert (whole.region_seed == np.where(shapely.contains(polygon, centres), 1, 0)).all()


@pytest.mark.parametrize("points", [[], [(1, 1)], [(1, 1)] * 5, [(0, 0), (1, 1), (2, 2)], np.empty((0, 2))])
def test_no_triangles_are_no_error(points):
    mesh = gcdt.triangulate_pslg(points)
    assert mesh.triangles.shape == (0, 3) and mesh.neighbours.shape == (0, 3)
    assert mesh.locate([(0, 0)]).tolist() == [-1]
    assert mesh.edges.shape == (0, 2) and len(mesh.hull) == 0
    assert len(mesh.notes) == 1


def test_points_are_located_where_matplotlib_finds_them(rng_points):
    mesh = gcdt.triangulate_pslg(rng_points)
    where = np.random.default_rng(3).uniform(-0.1, 1.1, (5000, 2))
    finder = matplotlib.tri.Triangulation(*rng_points.T, mesh.triangles).get_trifinder()
    found, weights = mesh.locate(where, weights=True)
    assert (found == finder(*where.T)).all()
    inside = found >= 0
    assert 0.6 < inside.mean() < 0.9
    corners = rng_points[mesh.triangles[found[inside]]]
    # The points are rounded to the grid, whose cells have an edge of 2^-31.
    assert np.abs((weights[inside, :, None] * corners).sum(axis=1) - where[inside]).max() < 1e-8
    assert (weights[~inside] == 0).all()


def test_interpolation_is_that_of_scipy(rng_points):
    from scipy.interpolate import LinearNDInterpolator

    values = np.sin(5 * rng_points[:, 0]) + rng_points[:, 1]
    where = np.random.default_rng(4).uniform(-0.1, 1.1, (3000, 2))
    ours = gcdt.triangulate_pslg(rng_points).interpolate(where, values)
    scipys = LinearNDInterpolator(Delaunay(rng_points), values)(where)
    np.testing.assert_allclose(ours, scipys, atol=1e-7)
    assert np.isnan(ours).any() and not np.isnan(ours).all()


def test_hull_and_vertex_triangles(rng_points):
    mesh = gcdt.triangulate_pslg(rng_points)
    assert set(mesh.hull.tolist()) == set(ConvexHull(rng_points).vertices.tolist())
    assert (mesh.triangles[mesh.vertex_triangles] == np.arange(len(rng_points))[:, None]).any(axis=1).all()


def test_a_mesh_of_another_program_is_adopted(rng_points):
    theirs = Delaunay(rng_points).simplices
    mesh = gcdt.adopt(rng_points, theirs)
    assert as_set(mesh.triangles) == as_set(theirs)
    where = np.random.default_rng(5).random((200, 2))
    assert (mesh.locate(where) == Delaunay(rng_points).find_simplex(where)).all()
    overlapping = [(0, 1, 2), (0, 1, 5)]
    with pytest.raises(gcdt.CheckFailed):
        gcdt.adopt(SQUARE, overlapping)
    with pytest.raises(IndexError, match="row 1 has vertex 9"):
        gcdt.adopt(SQUARE, [(0, 1, 2), (0, 2, 9)])


def test_verify_judges_meshes_of_other_programs(rng_points):
    simplices = Delaunay(rng_points).simplices
    assert gcdt.verify(rng_points, simplices)
    verdict = gcdt.verify(rng_points, simplices[1:])
    assert not verdict and verdict.reason
    wrong = simplices.copy()
    wrong[17, 1] = 10**9
    assert not gcdt.verify(rng_points, wrong)
    wrong[17, 1] = -1
    assert not gcdt.verify(rng_points, wrong)


def test_released_meshes_say_so():
    with gcdt.triangulate_pslg(SQUARE) as mesh:
        assert len(mesh.hull) == 4
    with pytest.raises(ValueError, match="released"):
        mesh.locate([(1, 1)])
    assert mesh.triangles.shape == (6, 3)


def test_progress_is_told_and_can_cancel(rng_points):
    told = []
    gcdt.triangulate_pslg(rng_points, progress=lambda phase, done: told.append((phase, done)))
    assert told and all(0 <= done <= 1 for _, done in told)
    assert [done for _, done in told] == sorted(done for _, done in told)
    with pytest.raises(gcdt.Cancelled):
        gcdt.triangulate_pslg(rng_points, progress=lambda *_: False)

    class Own(Exception):
        pass

    def fails(phase, done):
        raise Own

    with pytest.raises(Own):
        gcdt.triangulate_pslg(rng_points, progress=fails)
    assert gcdt.triangulate_pslg(rng_points).verify()


def test_a_call_from_a_callback_is_refused(rng_points):
    caught = []

    def again(phase, done):
        try:
            gcdt.triangulate_pslg(SQUARE)
        except gcdt.Error as error:
            caught.append(error.status)

    gcdt.triangulate_pslg(rng_points, progress=again)
    assert set(caught) == {"in_use"}


def test_threads_take_turns_and_others_go_on(rng_points):
    expected = gcdt.triangulate_pslg(rng_points).triangles
    results = [None] * 8

    def work(i):
        for _ in range(3):
            mesh = gcdt.triangulate_pslg(rng_points)
            mesh.locate(rng_points[:10])
            results[i] = mesh.triangles

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert all((r == expected).all() for r in results)


def test_the_interpreter_runs_during_a_call():
    points = np.random.default_rng(6).random((400_000, 2))
    gcdt.triangulate_pslg(points[:1000])
    longest, stop = [0.0], threading.Event()

    def tick():
        last = time.perf_counter()
        while not stop.is_set():
            time.sleep(0.005)
            now = time.perf_counter()
            longest[0] = max(longest[0], now - last)
            last = now

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.perf_counter()
    gcdt.triangulate_pslg(points)
    took = time.perf_counter() - start
    stop.set()
    thread.join()
    assert longest[0] < took / 2, f"another thread stood still for {longest[0]:.3f} of {took:.3f} s"


def test_ctrl_c_ends_a_call():
    program = """
import os, signal, threading, time, numpy as np, gcdt
points = np.random.default_rng(7).random((3_000_000, 2))
gcdt.triangulate_pslg(points[:1000])
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.perf_counter()
try:
    gcdt.triangulate_pslg(points)
except KeyboardInterrupt:
    print("interrupted", time.perf_counter() - start)
print(gcdt.triangulate_pslg(points[:1000]).verify().valid)
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    first, second = ran.stdout.split("\n")[:2]
    assert first.startswith("interrupted"), ran.stdout + ran.stderr
    assert second == "True"


def test_ctrl_c_goes_before_an_error_of_the_library(monkeypatch):
    """A signal during a call of a driver may make it fail: its handler runs when the error is made."""
    make = _errors.make

    def make_and_interrupt(*arguments):
        signal.raise_signal(signal.SIGINT)
        return make(*arguments)

    monkeypatch.setattr(_errors, "make", make_and_interrupt)
    with pytest.raises(KeyboardInterrupt):
        gcdt.triangulate_pslg([(0, 0), (1, 0), (0, float("nan"))])
    monkeypatch.undo()
    with pytest.raises(gcdt.CoordinateError):
        gcdt.triangulate_pslg([(0, 0), (1, 0), (0, float("nan"))])


def test_statistics_have_the_names_of_the_file(rng_points):
    statistics = gcdt.triangulate_pslg(rng_points).statistics
    assert statistics["n"] == len(rng_points) and statistics["triangles"] == len(Delaunay(rng_points).simplices)
    assert statistics["ms"]["call"] >= statistics["ms"]["core"] > 0
    assert statistics["grid"]["kind"] == "rounded" and 0 < statistics["grid"]["largest_move"] < 1e-9
    assert statistics["device"] == gcdt.default_solver().device.name


def test_devices_are_chosen():
    first = gcdt.devices()[0]
    assert gcdt.Solver(0).device == first
    with pytest.raises(gcdt.NoDevice, match="no such device"):
        gcdt.Solver("no such device")
    with pytest.raises(ValueError, match="not both"):
        gcdt.triangulate_pslg(SQUARE, solver=gcdt.default_solver(), device=0)
    assert gcdt.required_bytes(1_000_000, 0) > 10_000_000
    said = []
    gcdt.triangulate_pslg(SQUARE, solver=gcdt.Solver(0, log=lambda level, text: said.append(text)))
    assert said

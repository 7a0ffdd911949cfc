# SPDX-License-Identifier: Apache-2.0
"""PyOpenCL's arrays in and out."""

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest

import gcdt
import gcdt.opencl


@pytest.fixture(scope="module")
def queue():
    chosen = gcdt.default_solver().device
    for platform in cl.get_platforms():
        for device in platform.get_devices():
            if device.name == chosen.name and device.driver_version == chosen.driver:
                return cl.CommandQueue(cl.Context([device]))
    pytest.fail(f"PyOpenCL does not see {chosen.name}")


@pytest.fixture(scope="module")
def solver(queue):
    return gcdt.opencl.solver(queue)


def test_the_bytes_are_those_of_host_arrays(queue, solver, rng_points):
    constraints = np.stack([np.arange(0, 1900, 100), np.arange(100, 2000, 100)], axis=1).astype(np.uint32)
    expected = gcdt.triangulate_pslg(rng_points, constraints, crossing="drop")
    given = cl_array.to_device(queue, rng_points), cl_array.to_device(queue, constraints)
    mesh = gcdt.opencl.triangulate(solver, *given, crossing="drop")
    for name in ("triangles", "neighbours", "constrained", "representative", "pieces", "sources", "dropped"):
        copied = mesh.copy(name, queue)
        assert copied.get().dtype == getattr(expected, name).dtype
        assert (copied.get() == getattr(expected, name)).all(), name
    assert (mesh.copy("hull", queue).get() == expected.hull).all()
    assert mesh.statistics["triangles"] == len(expected.triangles)
    # The same without a copy, in a kernel.
    program = cl.Program(
        queue.context,
        """
        kernel void add(global const uint* a, global uint* sum) { atomic_add(sum, a[get_global_id(0)]); }""",
    ).build()
    total = cl_array.zeros(queue, 1, np.uint32)
    buffer = mesh.buffer("triangles")
    program.add(queue, (expected.triangles.size,), None, buffer, total.data)
    assert total.get()[0] == expected.triangles.sum() % 2**32
    del buffer


def test_arrays_may_begin_inside_their_buffers(queue, solver, rng_points):
    given = cl_array.to_device(queue, rng_points)
    mesh = gcdt.opencl.triangulate(solver, given[500:1500])
    assert (mesh.copy("triangles", queue).get() == gcdt.triangulate_pslg(rng_points[500:1500]).triangles).all()


def test_points_are_located_on_the_device(queue, solver, rng_points):
    mesh = gcdt.opencl.triangulate(solver, cl_array.to_device(queue, rng_points))
    where = np.random.default_rng(1).uniform(-0.1, 1.1, (3000, 2))
    found, weights = mesh.locate(cl_array.to_device(queue, where), weights=True)
    expected, shares = gcdt.triangulate_pslg(rng_points).locate(where, weights=True)
    assert (found.get() == expected).all()
    np.testing.assert_allclose(weights.get(), shares, atol=1e-6)


def test_wrong_arrays_are_named(queue, solver):
    with pytest.raises(ValueError, match="vertices must be float64"):
        gcdt.opencl.triangulate(solver, cl_array.zeros(queue, (4, 2), np.int16))
    with pytest.raises(ValueError, match="shape"):
        gcdt.opencl.triangulate(solver, cl_array.zeros(queue, (4, 3), np.float64))
    points = cl_array.to_device(queue, np.array([[0.0, 0], [1, 0], [0, np.nan]]))
    with pytest.raises(ValueError, match="vertex 2"):
        gcdt.opencl.triangulate(solver, points)
    points = cl_array.to_device(queue, np.array([[0.0, 0], [1, 0], [0, 1]]))
    with pytest.raises(IndexError):
        gcdt.opencl.triangulate(solver, points, cl_array.to_device(queue, np.array([[0, 3]], np.uint32)))
    with pytest.raises(ValueError, match="no array triangle"):
        gcdt.opencl.triangulate(solver, points).copy("triangle", queue)
    mesh = gcdt.opencl.triangulate(solver, points)
    assert mesh.copy("triangles", queue).get().tolist() == [[0, 1, 2]]
    assert repr(mesh) == "<gcdt.opencl.DeviceMesh of 1 triangles>"
    # Of the host's memory.
    host = points.get()
    for call, name in (
        (lambda: gcdt.opencl.triangulate(solver, host), "vertices"),
        (lambda: gcdt.opencl.triangulate(solver, points, [(0, 1)]), "constraints"),
        (lambda: mesh.locate(host), "points"),
    ):
        with pytest.raises(
            ValueError, match=rf"{name} must be a pyopencl\.array\.Array, not (numpy\.ndarray|builtins\.list)"
        ):
            call()

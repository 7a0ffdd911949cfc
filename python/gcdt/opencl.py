# SPDX-License-Identifier: Apache-2.0
"""Meshes from and to PyOpenCL's device memory, without a copy through the host. Needs the package pyopencl.

    solver = gcdt.opencl.solver(queue)
    mesh = gcdt.opencl.triangulate(solver, vertices, constraints)      # pyopencl.array.Arrays
    triangles = mesh.copy("triangles", queue)                          # a pyopencl.array.Array

The solver works on the context and device of the queue. Importing this module, before PyOpenCL is first asked for its
platforms, lets it find the drivers that pip has installed, too. Offsets and counts are in elements: pairs of numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _drivers, _gcdt, _views
from ._errors import make
from ._options import options
from ._solver import Log, Progress, Solver

if TYPE_CHECKING:
    import pyopencl as cl
    import pyopencl.array as cl_array
else:
    cl = _views.imported("pyopencl", "opencl")
    cl_array = _views.imported("pyopencl.array", "opencl")

# PyOpenCL of PyPI has a loader of its own, which like any other reads the names of drivers when it is first called.
with _drivers.with_installed() as _told:
    if _told:
        cl.get_platforms()

_TYPES = {np.dtype(np.float64): 0, np.dtype(np.float32): 1, np.dtype(np.int32): 2, np.dtype(np.int64): 3}
_NUMBERS = {"std::uint32_t": np.uint32, "std::int32_t": np.int32, "std::uint8_t": np.uint8}


def solver(queue: cl.CommandQueue, *, log: Log | None = None) -> Solver:
    """A solver on the context and device of a queue, which it keeps."""
    return Solver._of(_gcdt.solver_on_queue(queue.int_ptr, log))


def _check_on_device(array: Any, name: str) -> None:
    if not isinstance(array, cl_array.Array):
        kind = f"{type(array).__module__}.{type(array).__qualname__}"
        raise make("invalid_argument", f"{name} must be a pyopencl.array.Array, not {kind}")


def _range(array: cl_array.Array, name: str) -> Any:
    """The k x 2 numbers of an array."""
    if array.ndim != 2 or array.shape[1] != 2 or not array.flags.c_contiguous:
        raise make("invalid_argument", f"{name} must be contiguous and have the shape (k, 2), not {array.shape}")
    pair = 2 * array.dtype.itemsize
    if array.offset % pair:
        raise make("invalid_argument", f"{name} begins at byte {array.offset}, which is no multiple of {pair}")
    return _gcdt.BufferRange(array.base_data.int_ptr, array.offset // pair, array.shape[0])


def _coordinate_type(array: cl_array.Array, name: str) -> int:
    if array.dtype not in _TYPES:
        raise make("invalid_argument", f"{name} must be float64, float32, int32 or int64, not {array.dtype}")
    return _TYPES[array.dtype]


def _waits(arrays: Sequence[cl_array.Array | None], wait_for: Sequence[cl.Event]) -> tuple[list[int], list[cl.Event]]:
    """The events to be waited for, as numbers, and themselves, to be kept until the call is over."""
    events = [*wait_for]
    for array in arrays:
        if array is not None:
            events.extend(array.events)
    return [event.int_ptr for event in events], events


class DeviceMesh:
    """A mesh in device memory. Arrays are named as those of `gcdt.Mesh`."""

    def __init__(self, native: Any, given: Sequence[Any]) -> None:
        """Not for callers: see `triangulate`."""
        self._result = native
        self._given = given  # read while the result is asked

    def __repr__(self) -> str:
        return f"<gcdt.opencl.DeviceMesh of {self.shape('triangles')[0]} triangles>"

    def shape(self, name: str) -> tuple[int, ...]:
        """The shape of an array."""
        number, width, _ = _array(name)
        count = self._result.count(number)
        return (count,) if width == 1 else (count, width)

    def buffer(self, name: str) -> cl.MemoryObject:
        """The device memory of an array, without a copy, to be read only: shape(name) numbers from its start.

        Commands that read it must be complete before the mesh is released or collected.
        """
        number, _, _ = _array(name)
        return cl.MemoryObject.from_int_ptr(_gcdt.result_buffer(self._result, number), retain=True)

    def copy(self, name: str, queue: cl.CommandQueue, wait_for: Sequence[cl.Event] = ()) -> cl_array.Array:
        """A copy of an array within the device, enqueued in the queue: a pyopencl.array.Array with its event."""
        number, _, dtype = _array(name)
        copied = cl_array.empty(queue, self.shape(name), dtype)
        if copied.size == 0:
            return copied
        to = _gcdt.BufferRange(copied.base_data.int_ptr, 0, copied.shape[0])
        waits, _ = _waits([], wait_for)
        event = cl.Event.from_int_ptr(_gcdt.enqueue_copy(self._result, number, queue.int_ptr, to, waits), retain=False)
        copied.add_event(event)
        return copied

    def locate(self, points: cl_array.Array, *, weights: bool = False, wait_for: Sequence[cl.Event] = ()) -> Any:
        """As `gcdt.Mesh.locate`, from device memory to device memory; weights are float32."""
        _check_on_device(points, "points")
        queue = points.queue
        count = points.shape[0]
        found = cl_array.empty(queue, count, np.int32)
        shares = cl_array.empty(queue, (count, 3), np.float32) if weights else None
        if count:
            waits, _kept = _waits([points], wait_for)
            _gcdt.locate_buffers(
                self._result,
                _coordinate_type(points, "points"),
                _range(points, "points"),
                found.base_data.int_ptr,
                shares.base_data.int_ptr if shares is not None else 0,
                waits,
            )
        return (found, shares) if weights else found

    @property
    def statistics(self) -> dict[str, Any]:
        """As `gcdt.Mesh.statistics`."""
        return _gcdt.result_statistics(self._result)

    def release(self) -> None:
        """Gives the device memory back to the solver."""
        self._result.release()


def _array(name: str) -> tuple[int, int, Any]:
    if name not in _gcdt.arrays:
        raise make("invalid_argument", f"a mesh has no array {name}")
    number, width, dtype = _gcdt.arrays[name]
    return number, width, np.dtype(_NUMBERS[dtype])


def triangulate(
    solver: Solver,
    vertices: cl_array.Array,
    constraints: cl_array.Array | None = None,
    *,
    crossing: str = "reject",
    domain: str = "hull",
    label_regions: bool = False,
    check: bool = True,
    canonical: bool = True,
    progress: Progress | None = None,
    wait_for: Sequence[cl.Event] = (),
) -> DeviceMesh:
    """As `gcdt.triangulate_pslg`, of arrays on the device of `solver(queue)`, after their events and `wait_for`.

    `vertices`: (n, 2) float64, float32 or int64; int32 are grid points as they are, none negative. `constraints`:
    (m, 2) uint32. Both are read in place, or copied within the device if they do not begin with their buffers.
    """
    _check_on_device(vertices, "vertices")
    if constraints is not None:
        _check_on_device(constraints, "constraints")
    if constraints is not None and constraints.dtype != np.uint32:
        raise make("invalid_argument", f"constraints must be uint32, not {constraints.dtype}")
    none = _gcdt.BufferRange(0, 0, 0)
    waits, _kept = _waits([vertices, constraints], wait_for)
    native = _gcdt.triangulate_buffers(
        solver._native,
        _coordinate_type(vertices, "vertices"),
        _range(vertices, "vertices") if math.prod(vertices.shape) else none,
        _range(constraints, "constraints") if constraints is not None and constraints.size else none,
        options(
            crossing=crossing,
            domain=domain,
            label_regions=label_regions,
            check=check,
            canonical=canonical,
            progress=progress,
        ),
        waits,
    )
    return DeviceMesh(native, (vertices, constraints))

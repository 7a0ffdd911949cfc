# SPDX-License-Identifier: Apache-2.0
"""What is raised. Each error is also the built-in exception that fits it."""

from __future__ import annotations

from collections.abc import Sequence


class Error(Exception):
    """What the library has to say of a failed call.

    `status`: its name, such as "constraints_cross". `indices`: the numbers of the vertices, constraints or triangles
    that it is about, as a tuple (its shape depends on the status; docs/python.md). `polygon`: which of several polygons
    it is about, or None. `opencl_code`: of the OpenCL call that failed, 0 if it was none.
    """

    status = "error"
    indices: tuple[int, ...] = ()
    pair_count = 0
    polygon: int | None = None
    opencl_code = 0


class InputError(Error, ValueError):
    """An argument or the input makes no sense."""


class CoordinateError(InputError):
    """A coordinate is NaN or infinite, or outside a grid. `indices`: the row, and the axis (0: x, 1: y)."""


class IndexOutOfRange(Error, IndexError):
    """A vertex that does not exist. `indices`: the row of the array, and the column."""


class ConstraintsCross(InputError):
    """Constraints cross each other. `pairs`: their numbers, two and two; `pair_count`: how many pairs there are."""

    @property
    def pairs(self) -> list[tuple[int, int]]:
        return list(zip(self.indices[::2], self.indices[1::2]))


class NoDevice(Error, RuntimeError):
    """There is no OpenCL device that fits the choice."""


class DeviceError(Error, RuntimeError):
    """An OpenCL call failed, or the device computes wrongly."""


class OutOfMemory(Error, MemoryError):
    """The device's memory or its largest buffer is too small."""


class CheckFailed(Error, RuntimeError):
    """A mesh is not what it should be: the library's own, which is withheld, or a given one."""


class Cancelled(Error, RuntimeError):
    """The progress function returned False."""


_CLASSES: dict[str, type[Error]] = {
    "invalid_argument": InputError,
    "coordinate_not_finite": CoordinateError,
    "coordinate_outside_grid": CoordinateError,
    "index_out_of_range": IndexOutOfRange,
    "too_many_vertices": InputError,
    "constraints_cross": ConstraintsCross,
    "vertices_coincide": InputError,
    "no_device": NoDevice,
    "out_of_memory": OutOfMemory,
    "workspace_too_small": OutOfMemory,
    "check_failed": CheckFailed,
    "cancelled": Cancelled,
}


def make(status: str, message: str, indices: Sequence[int] = (), pair_count: int = 0, opencl_code: int = 0) -> Error:
    """The exception for a status of the library."""
    if status == "no_device" and message.startswith("no OpenCL device found"):
        message += "; or, for the CPU: pip install 'gcdt[cpu]'"
    error = _CLASSES.get(status, DeviceError)(message)
    error.status, error.indices = status, tuple(indices)
    error.pair_count, error.opencl_code = pair_count, opencl_code
    return error

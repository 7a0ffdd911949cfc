# SPDX-License-Identifier: Apache-2.0
"""Devices, and solvers on them."""

from __future__ import annotations

import atexit
import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from . import _drivers, _gcdt
from ._errors import make

Log = Callable[[int, str], None]
Progress = Callable[[str, float], "bool | None"]


@dataclass(frozen=True)
class DeviceInfo:
    """What an OpenCL device is and has; sizes in bytes."""

    name: str
    vendor: str
    platform: str
    driver: str
    version: str
    is_gpu: bool
    is_cpu: bool
    memory_bytes: int
    largest_buffer_bytes: int
    local_bytes: int
    compute_units: int
    largest_work_group: int
    atomics64: bool
    fp64: bool
    subgroups: bool


def devices() -> list[DeviceInfo]:
    """All OpenCL devices that the library can use, in the order that selects them by number."""
    _drivers.prepare()
    return [DeviceInfo(**device) for device in _gcdt.devices()]


class Solver:
    """A device with its programs and memory, which it keeps between calls.

    `device`: "auto" (a GPU if there is one, else a CPU), "cpu", "gpu", a number of `gcdt.devices()`, or a part of a
    name; None: the variable GCDT_DEVICE, else "auto". `log(level, message)` is called with what it does (level 1:
    warnings, 2: information). Raises `NoDevice`, which says what to install.

    Threads take turns at one solver; for calls at once give each thread its own. A process that was forked cannot use
    the solvers of its parent (an OpenCL driver's limit): start processes by "spawn".
    """

    def __init__(self, device: str | int | None = None, *, log: Log | None = None) -> None:
        _drivers.prepare()
        self._native: Any = _gcdt.Solver.create("" if device is None else str(device), log)

    @classmethod
    def _of(cls, native: Any) -> Solver:
        solver = cls.__new__(cls)
        solver._native = native
        return solver

    @property
    def device(self) -> DeviceInfo:
        """The device that it runs on."""
        return DeviceInfo(**self._native.device())

    def trim(self) -> None:
        """Gives back the device memory that is kept for the next call."""
        self._native.trim()

    def __repr__(self) -> str:
        return f"<gcdt.Solver on {self.device.name}>"


@functools.cache
def _shared(device: str | None) -> Solver:
    return Solver(device)


def default_solver(device: str | int | None = None) -> Solver:
    """The solver that functions take if they are given none: one for each choice of a device, made when first used."""
    return _shared(None if device is None else str(device))


def solver_for(solver: Solver | None, device: str | int | None) -> Solver:
    """The solver of a call's arguments."""
    if solver is not None and device is not None:
        raise make("invalid_argument", "give a solver or a device, not both")
    if solver is not None and not isinstance(solver, Solver):
        raise make("invalid_argument", f"solver is a gcdt.Solver, not {solver!r}")
    return solver if solver is not None else default_solver(device)


# Drivers may be unloaded before modules are.
atexit.register(_shared.cache_clear)

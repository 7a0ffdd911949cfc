# SPDX-License-Identifier: Apache-2.0
"""Pools of devices, and batches of problems."""

from __future__ import annotations

import atexit
import functools
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _drivers, _gcdt
from ._errors import Error, make
from ._options import options
from ._refinement import Refinement
from ._solver import DeviceInfo, Log, Progress


class Problem:
    """One problem of a batch. Its arrays, named as those of `Mesh`, are views into the batch; empty with an error."""

    def __init__(self, batch: Batch, number: int) -> None:
        self._batch, self.number = batch, number

    def __repr__(self) -> str:
        return f"<gcdt.Problem {self.number}: {self.error or f'{len(self.triangles)} triangles'}>"

    @property
    def error(self) -> Error | None:
        """What is wrong with it, in its own numbers; None if it was triangulated."""
        return self._batch._native.error(self.number)

    @property
    def statistics(self) -> dict[str, Any]:
        """Its grid, and what splitting and refinement have done."""
        return self._batch._native.problem_statistics(self.number)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in _ARRAYS:
            raise AttributeError(f"a problem has no {name}")
        return getattr(self._batch._native, name)(self.number)

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *_ARRAYS]


_ARRAYS = tuple(name for name in _gcdt.arrays if name not in ("vertex_triangles", "hull", "edge_pieces"))


class Batch(Sequence[Problem]):
    """The results of a batch, in host memory: a sequence of `Problem`s.

    `failed`: (f,) uint64, the numbers of problems with errors. `statistics`: a dictionary of the whole batch.
    """

    def __init__(self, native: Any) -> None:
        self._native = native
        self.statistics: dict[str, Any] = native.statistics()

    def __repr__(self) -> str:
        triangles, failed = self.statistics["triangles"], len(self.failed)
        return f"<gcdt.Batch of {len(self)} problems, {triangles} triangles, {failed} failed>"

    def __len__(self) -> int:
        return len(self._native)

    def __getitem__(self, problem: Any) -> Any:
        if isinstance(problem, slice):
            return [self[p] for p in range(*problem.indices(len(self)))]
        number = int(problem) + (len(self) if problem < 0 else 0)
        if not 0 <= number < len(self):
            raise IndexError(f"problem {problem} of {len(self)}")
        return Problem(self, number)

    def __iter__(self) -> Iterator[Problem]:
        return (Problem(self, p) for p in range(len(self)))

    @functools.cached_property
    def failed(self) -> NDArray[np.uint64]:
        return self._native.failed()

    def all_of(self, name: str) -> tuple[NDArray[Any], NDArray[np.uint64]]:
        """An array (named as those of `Mesh`) of all problems, one after the other, and where each one's begins.

        Numbers of vertices, triangles and constraints count from 0 in each problem.
        """
        return self._native.all_of(name)


class Pool:
    """Triangulates batches of problems on any set of devices.

    `devices`: separated by commas: "all", "gpu" (all GPUs), "cpu", "auto" (all GPUs if there are any, else a CPU),
    numbers, or parts of names; None: the variable GCDT_DEVICE, else "auto". Threads take turns at one pool.
    """

    def __init__(self, devices: str | int | None = None, *, log: Log | None = None) -> None:
        _drivers.prepare()
        self._native: Any = _gcdt.Pool.create("" if devices is None else str(devices), log)

    @property
    def devices(self) -> list[dict[str, Any]]:
        """The devices that it was made with: "info", why one was "lost" (or None), and its part in the last batch."""
        keys = DeviceInfo.__dataclass_fields__
        return [
            {"info": DeviceInfo(**{k: d[k] for k in keys}), **{k: v for k, v in d.items() if k not in keys}}
            for d in self._native.devices()
        ]

    def triangulate(
        self,
        vertices: ArrayLike,
        vertex_offsets: ArrayLike,
        constraints: ArrayLike | None = None,
        constraint_offsets: ArrayLike | None = None,
        *,
        crossing: str = "reject",
        domain: str = "hull",
        label_regions: bool = False,
        grid: tuple[float, float, str] | None = None,
        check: bool = True,
        distinct: bool = False,
        refine: Refinement | float | None = None,
        progress: Progress | None = None,
    ) -> Batch:
        """Triangulates many problems in one call, each with the bytes that it would have alone.

        `vertices`: (N, 2), all problems' one after the other; `vertex_offsets`: (P + 1,): problem p has rows
        [p] to [p + 1]; `constraints`: (M, 2) vertex numbers that count from 0 in each problem; `constraint_offsets`:
        (P + 1,). Options as for `gcdt.triangulate_pslg`; with `refine`, `most_added` counts for each problem, `sizes`
        are (N,), and there are no `region_areas`. A problem that is invalid has an `error` and spoils no other.
        """
        points = _arrays.coordinates(vertices)
        bounds = _arrays.offsets(vertex_offsets, len(points), "vertex_offsets")
        # Ends are counted within each problem, whose error names them; here only that they are numbers of 32 bits.
        lines = _arrays.numbers(constraints, 2, 1 << 32, "constraints")
        if constraint_offsets is None:
            if len(lines):
                raise make("invalid_argument", "constraints need constraint_offsets")
            constraint_offsets = np.zeros(len(bounds), np.uint64)
        line_bounds = _arrays.offsets(constraint_offsets, len(lines), "constraint_offsets")
        if len(line_bounds) != len(bounds):
            raise make(
                "invalid_argument",
                f"vertex_offsets has {len(bounds)} elements, constraint_offsets {len(line_bounds)}",
            )
        wanted = options(
            crossing=crossing,
            domain=domain,
            label_regions=label_regions,
            grid=grid,
            check=check,
            distinct=distinct,
            progress=progress,
            refine=refine,
        )
        return Batch(self._native.triangulate(points, bounds, lines, line_bounds, wanted))


@functools.cache
def _shared(devices: str | None) -> Pool:
    return Pool(devices)


def default_pool(devices: str | int | None = None) -> Pool:
    """The pool that functions take if they are given none."""
    return _shared(None if devices is None else str(devices))


def pool_for(pool: Pool | None, devices: str | int | None) -> Pool:
    """The pool of a call's arguments."""
    if pool is not None and devices is not None:
        raise make("invalid_argument", "give a pool or devices, not both")
    if pool is not None and not isinstance(pool, Pool):
        raise make("invalid_argument", f"pool is a gcdt.Pool, not {pool!r}")
    return pool if pool is not None else default_pool(devices)


atexit.register(_shared.cache_clear)

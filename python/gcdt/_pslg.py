# SPDX-License-Identifier: Apache-2.0
"""Vertices and constraints to a mesh: the library's own call."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _gcdt
from ._mesh import Mesh
from ._options import options
from ._refinement import Refinement
from ._solver import Progress, Solver, solver_for


def triangulate_pslg(
    vertices: ArrayLike,
    constraints: ArrayLike | None = None,
    *,
    crossing: str = "reject",
    domain: str = "hull",
    holes: ArrayLike | None = None,
    regions: ArrayLike | None = None,
    label_regions: bool = False,
    grid: tuple[float, float, str] | None = None,
    check: bool = True,
    canonical: bool = True,
    distinct: bool = False,
    refine: Refinement | float | None = None,
    progress: Progress | None = None,
    solver: Solver | None = None,
    device: str | int | None = None,
) -> Mesh:
    """The exact constrained Delaunay triangulation of a planar straight-line graph.

    `vertices`: (n, 2) float64, float32, int32 or int64 (up to 2^53 in magnitude), finite. Read in place if contiguous.
    `constraints`: (m, 2) vertex numbers, or None.

    `crossing`: what happens to constraints that cross: "reject" raises `ConstraintsCross`, "drop" leaves out those
    that cross an earlier one that was kept, "split" makes the crossings vertices.
    `domain`: which triangles are returned: "hull" (all), "even-odd", "nonzero", "holes" (all but the regions with a
    point of `holes`), "outer" (all that is closed off from the outside by constraints) or "outer-holes" (neither).
    `holes`: (h, 2) points. `regions`: (r, 2) points, whose rows `mesh.region_seed` names.
    `label_regions`: region, depth and winding number of each triangle also for the domain "hull".
    `grid`: (x, y, cell): a grid of the caller's, such as (0, 0, "0.001"), that coordinates must be within; None: the
    finest that holds them.
    `check`: the device proves the mesh before it is returned. `canonical`: triangles in canonical order; without it
    in any order, which costs less. `distinct`: refuses vertices that differ but would be one on the grid.
    `refine`: a `gcdt.Refinement`, or a least angle in degrees: vertices are added until the triangles are as wanted.
    `progress(phase, done)`: called with the share done; if it returns False the call raises `Cancelled`.
    `solver`, or `device` for a shared one: see `Solver`.

    Fewer than three distinct vertices, or all on one line, give no triangles and a note. Raises `CoordinateError`,
    `IndexOutOfRange` and other `gcdt.Error`s, which name the row.
    """
    points = _arrays.coordinates(vertices)
    pairs = _arrays.numbers(constraints, 2, len(points), "constraints")
    wanted = options(
        crossing=crossing,
        domain=domain,
        holes=holes,
        regions=regions,
        label_regions=label_regions,
        grid=grid,
        check=check,
        canonical=canonical,
        distinct=distinct,
        progress=progress,
        refine=refine,
    )
    used = solver_for(solver, device)
    return Mesh(used._native.triangulate(points, pairs, wanted), points, pairs, wanted, used)


def adopt(
    vertices: ArrayLike,
    triangles: ArrayLike,
    constraints: ArrayLike | None = None,
    *,
    grid: tuple[float, float, str] | None = None,
    check: bool = True,
    progress: Progress | None = None,
    solver: Solver | None = None,
    device: str | int | None = None,
) -> Mesh:
    """A mesh that is there already, of any program, to be asked what a `Mesh` is asked.

    `vertices`: (n, 2); `triangles`: (t, 3) vertex numbers, counter-clockwise, which keep their numbers; `constraints`:
    (m, 2), along edges. The triangles need not be Delaunay, nor cover the convex hull. Raises `CheckFailed` if they
    overlap, or if a vertex is inside one.
    """
    points = _arrays.coordinates(vertices)
    corners = _arrays.numbers(triangles, 3, len(points), "triangles")
    pairs = _arrays.numbers(constraints, 2, len(points), "constraints")
    wanted = options(grid=grid, check=check, progress=progress)
    used = solver_for(solver, device)
    return Mesh(used._native.adopt(points, corners, pairs, wanted), points, pairs, wanted, used)


@dataclass(frozen=True)
class Verification:
    """Whether a mesh is valid, and what its first fault is, if not. True or false as `valid` is."""

    valid: bool
    reason: str

    def __bool__(self) -> bool:
        return self.valid


def verify(
    vertices: ArrayLike,
    triangles: ArrayLike,
    constraints: ArrayLike | None = None,
    *,
    neighbours: ArrayLike | None = None,
    crossing: str = "reject",
    domain: str = "hull",
    holes: ArrayLike | None = None,
    grid: tuple[float, float, str] | None = None,
) -> Verification:
    """Proves that triangles, of any program, are the constrained Delaunay triangulation on the grid.

    `vertices`: (n, 2); `triangles`: (t, 3) in any order; `constraints`: (m, 2); `neighbours`: (t, 3), or None. By exact
    arithmetic on the host; needs no device. A mesh with a wrong index is invalid, not an error. Where four vertices
    lie on one circle the diagonal must be that of docs/contract.md, 4.
    """
    points = _arrays.coordinates(vertices)
    pairs = _arrays.numbers(constraints, 2, len(points), "constraints")
    corners = _arrays.indices_to_judge(triangles, (-1, 3), "triangles", np.uint32, 0xFFFFFFFF)
    links: Any = None
    if neighbours is not None:
        links = _arrays.indices_to_judge(neighbours, corners.shape, "neighbours", np.int32, -(2**31))
    wanted = options(crossing=crossing, domain=domain, holes=holes, grid=grid)
    mesh = _gcdt.GivenMesh(corners, links, None, np.empty((0, 2), np.int32), None)
    on = _gcdt.choose_grid(points, wanted)
    return Verification(*_gcdt.verify(points, pairs, mesh, None, None, None, on, wanted))

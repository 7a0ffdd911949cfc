# SPDX-License-Identifier: Apache-2.0
"""`Delaunay`, with the names of scipy.spatial.Delaunay."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _views
from ._errors import make
from ._mesh import Mesh
from ._pslg import triangulate_pslg
from ._solver import Solver


class Delaunay:
    """The Delaunay triangulation of points in the plane, with the attributes of `scipy.spatial.Delaunay`.

    `points`: (n, 2) floats. `segments`: (m, 2) point numbers, edges that must be there (constraints), which scipy does
    not have; `options` are those of `gcdt.triangulate_pslg`, such as crossing="split", domain="even-odd" or refine=25.

    `points`: (n, 2) float64, followed by points that splitting and refinement have added. `simplices`: (T, 3) int32,
    counter-clockwise. `neighbors`: (T, 3) int32: [t, k] is the triangle opposite corner k of t, or -1. `mesh`: the
    `gcdt.Mesh`.

    Other than with scipy: points that are equal, or on one line, are no error (there may be no triangles); no point is
    left out for being close to an edge; and of points on one circle the diagonal follows a rule, so that the result is
    the same everywhere. `furthest_site`, `incremental` and options of Qhull are not supported.
    """

    def __init__(
        self,
        points: ArrayLike,
        segments: ArrayLike | None = None,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        solver: Solver | None = None,
        device: str | int | None = None,
        **options: Any,
    ) -> None:
        if furthest_site or incremental or qhull_options is not None:
            raise NotImplementedError("furthest_site, incremental and qhull_options are scipy's alone")
        given = np.ascontiguousarray(_arrays.coordinates(points, "points"), dtype=np.float64)
        pairs = _arrays.numbers(segments, 2, len(given), "segments")
        self.mesh: Mesh = triangulate_pslg(given, pairs, solver=solver, device=device, **options)
        self.points: NDArray[np.float64] = self.mesh.points
        self.simplices: NDArray[np.int32] = self.mesh.triangles.view(np.int32)
        self.neighbors: NDArray[np.int32] = self.mesh.neighbours
        self.ndim = 2
        self.npoints = len(self.points)
        self.nsimplex = len(self.simplices)
        self.furthest_site = False

    @property
    def min_bound(self) -> NDArray[np.float64]:
        """(2,): the least x and y."""
        return self.points.min(axis=0)

    @property
    def max_bound(self) -> NDArray[np.float64]:
        """(2,): the largest x and y."""
        return self.points.max(axis=0)

    @cached_property
    def vertex_to_simplex(self) -> NDArray[np.int32]:
        """(n,): a triangle at each point, or -1; points that are equal share one."""
        found = self.mesh.vertex_triangles
        missing = self.npoints - len(found)
        if missing == 0:
            return found
        # Of added points, which are corners of triangles unless the domain leaves them out.
        whole = np.concatenate([found, np.full(missing, -1, np.int32)])
        at = np.full(self.npoints, -1, np.int32)
        at[self.simplices.ravel()[::-1]] = np.repeat(np.arange(self.nsimplex, dtype=np.int32), 3)[::-1]
        whole[len(found) :] = at[len(found) :]
        return whole

    @cached_property
    def convex_hull(self) -> NDArray[np.int32]:
        """(h, 2): the edges with a triangle on one side only; the convex hull, unless a domain was chosen."""
        triangle, corner = np.nonzero(self.neighbors == -1)
        ends = [self.simplices[triangle, (corner + k) % 3] for k in (1, 2)]
        return np.stack(ends, axis=1)

    @cached_property
    def coplanar(self) -> NDArray[np.int32]:
        """(c, 3): points that are no corner since another one is in their place; a triangle there, and that point."""
        alone = np.arange(len(self.mesh.representative), dtype=np.int32)
        stand_in = self.mesh.representative.view(np.int32)
        lost = np.flatnonzero(stand_in != alone).astype(np.int32)
        return np.stack([lost, self.vertex_to_simplex[lost], stand_in[lost]], axis=1)

    @cached_property
    def transform(self) -> NDArray[np.float64]:
        """(T, 3, 2): affine transforms to barycentric coordinates: c = transform[t, :2] @ (x - transform[t, 2])."""
        a, b, c = (self.points[self.simplices[:, k]] for k in range(3))
        edges = np.stack([a - c, b - c], axis=2)
        made = np.empty((self.nsimplex, 3, 2))
        determinant = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = (
                np.stack([edges[:, 1, 1], -edges[:, 0, 1], -edges[:, 1, 0], edges[:, 0, 0]], axis=1)
                / determinant[:, None]
            )
        made[:, :2] = inverse.reshape(-1, 2, 2)
        made[:, 2] = c
        made[determinant == 0] = np.nan
        return made

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """(indptr, indices): the neighbours of point v are indices[indptr[v]:indptr[v + 1]], ascending."""
        pairs = _views.edges(self.simplices).astype(np.int32)
        both = np.concatenate([pairs, pairs[:, ::-1]])
        both = both[np.lexsort((both[:, 1], both[:, 0]))]
        starts = np.searchsorted(both[:, 0], np.arange(self.npoints + 1))
        return starts.astype(np.int32), np.ascontiguousarray(both[:, 1])

    def find_simplex(self, xi: ArrayLike, bruteforce: bool = False, tol: float | None = None) -> Any:
        """The triangle that holds each of the points `xi`, (..., 2); -1 outside. (...) int32.

        On an edge or corner it is the least triangle there. Points are rounded to the grid and located exactly there,
        so `bruteforce` and `tol` have no effect.
        """
        where = _arrays.floats(xi, "xi")
        if where.shape[-1:] != (2,):
            raise make("invalid_argument", f"xi must have the shape (..., 2), not {where.shape}")
        found = self.mesh.locate(where.reshape(-1, 2))
        return found.reshape(where.shape[:-1])

# SPDX-License-Identifier: Apache-2.0
"""A mesh: its arrays in host memory, and the same on the device for questions."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _gcdt, _views

if TYPE_CHECKING:
    from ._pslg import Verification
    from ._refinement import Refinement
    from ._solver import Progress


class Mesh:
    """A constrained Delaunay triangulation with T triangles, of n vertices and A that splitting and refinement added.

    Arrays, all in host memory (docs/contract.md has their order):

    ================  ==================  ===========================================================================
    `points`          (n + A, 2)          the vertices as they were given, then the added ones
    `triangles`       (T, 3) uint32       corners, counter-clockwise
    `neighbours`      (T, 3) int32        [t, k] is the triangle across the edge opposite corner k of t, or -1
    `constrained`     (T,) uint8          bit k: the edge opposite corner k is (part of) a constraint
    `representative`  (n + A,) uint32     the vertex that stands for each, where several are on one grid point
    `pieces`          (P, 2) uint32       the constraints after cleaning, as edges
    `source_offsets`  (P + 1,) uint32     sources[source_offsets[i]:source_offsets[i + 1]] are the constraints of the
    `sources`         (S,) uint32         input that run along pieces[i]
    `dropped`         (D,) uint32         constraints dropped under crossing="drop"
    `added`           (A, 2) float64      vertices added under crossing="split", then by refinement
    `added_on_grid`   (A, 2) int32        the same on the grid
    `added_crossing`  (A, 2) uint32       the pair of constraints that crosses there; of refinement 2^32 - 1 twice
    `added_origin`    (A, 4) uint32       with refine (else empty): what the vertex was put on: three corners, or two
                                          ends and 2^32 - 1; then the constraint along it, or 2^32 - 1
    `region`          (T,) uint32         with a domain or label_regions (else empty): the number of the region,
    `depth`           (T,) uint32         the least number of constrained edges between it and the outside,
    `winding`         (T,) int32          how often constraints wind around it counter-clockwise,
    `region_seed`     (T,) int32          and the row of `regions` that is in it, or -1
    `excuse`          (T,) uint8          with refine (else empty): 0, or why the triangle is worse than wanted:
                                          `gcdt.EXCUSES[excuse]`
    ================  ==================  ===========================================================================

    `statistics` is a dictionary with counts, times in milliseconds and the grid (docs/statistics.md).

    The mesh also stays in device memory, for `locate` and other questions, until it is released or collected.
    """

    triangles: NDArray[np.uint32]
    neighbours: NDArray[np.int32]
    constrained: NDArray[np.uint8]
    representative: NDArray[np.uint32]
    pieces: NDArray[np.uint32]
    source_offsets: NDArray[np.uint32]
    sources: NDArray[np.uint32]
    dropped: NDArray[np.uint32]
    added: NDArray[np.float64]
    added_on_grid: NDArray[np.int32]
    added_crossing: NDArray[np.uint32]
    added_origin: NDArray[np.uint32]
    region: NDArray[np.uint32]
    depth: NDArray[np.uint32]
    winding: NDArray[np.int32]
    region_seed: NDArray[np.int32]
    excuse: NDArray[np.uint8]
    statistics: dict[str, Any]

    def __init__(
        self,
        made: tuple[Any, dict[str, Any], dict[str, Any]],
        vertices: NDArray[Any],
        constraints: NDArray[np.uint32],
        options: Any,
        solver: Any,
    ) -> None:
        """Not for callers: see `gcdt.triangulate_pslg` and `gcdt.adopt`."""
        self._result, arrays, self.statistics = made
        self.__dict__.update(arrays)
        self.vertices = vertices
        self.constraints = constraints
        self._options, self._solver = options, solver

    def __repr__(self) -> str:
        return f"<gcdt.Mesh of {len(self.triangles)} triangles, {len(self.representative)} vertices>"

    @cached_property
    def points(self) -> NDArray[Any]:
        """(n + A, 2): the vertices as they were given, not copied unless some were added."""
        if len(self.added) == 0:
            return self.vertices
        return np.concatenate([np.asarray(self.vertices, np.float64), self.added])

    @property
    def notes(self) -> list[str]:
        """Remarks such as that all vertices lie on one line."""
        return list(self.statistics["notes"])

    @property
    def grid(self) -> dict[str, Any]:
        """The grid on which the mesh is exact: kind, origin, cell, largest_move (docs/contract.md, 1)."""
        return dict(self.statistics["grid"])

    @property
    def constrained_edges(self) -> NDArray[np.bool_]:
        """(T, 3): whether the edge opposite corner k is (part of) a constraint."""
        return (self.constrained[:, None] >> np.arange(3, dtype=np.uint8)) & 1 == 1

    @cached_property
    def edges(self) -> NDArray[np.uint32]:
        """(E, 2): every edge of the mesh once, the lesser vertex first, in ascending order."""
        return _views.edges(self.triangles)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """(T,): areas in units of the coordinates squared, in double precision."""
        return _views.areas(self.points, self.triangles)

    # ---- Questions to the device ------------------------------------------------------------------------------

    def locate(self, points: ArrayLike, weights: bool = False) -> Any:
        """Where points are.

        `points`: (k, 2). Returns (k,) int32: the least triangle that holds each, its border included, or -1. With
        `weights` also (k, 3) float64: barycentric weights in the order of the corners, 0 outside. Exact on the grid.
        """
        return self._result.locate(_arrays.coordinates(points, "points"), weights)

    def interpolate(self, points: ArrayLike, values: ArrayLike, outside: float = np.nan) -> NDArray[np.float64]:
        """Values at points, linear in each triangle.

        `points`: (k, 2); `values`: (n + A,), one for each vertex, or (n,), from which those of added vertices are
        interpolated along their constraints; `outside`: the value where no triangle is. Returns (k,) float64.
        """
        where = _arrays.coordinates(points, "points")
        count, given = len(self.representative), _arrays.floats(values, "values")
        if given.shape == (len(self.vertices),) and len(self.added):
            given = np.concatenate([given, self.added_values(given)])
        return self._result.interpolate(where, _arrays.values_of(given, count, "values", "vertices"), float(outside))

    def added_values(self, values: ArrayLike) -> NDArray[np.float64]:
        """(A,) values at added vertices, of (n,) at those of the input.

        At a crossing the mean of what the two constraints have there, linear between their ends; of refinement what
        is linear on the triangle or edge that the vertex was put on.
        """
        known = _arrays.values_of(values, len(self.vertices), "values", "vertices")
        return _gcdt.added_values(
            self.vertices, self.constraints, self.added, self.added_crossing, self.added_origin, known
        )

    def refine(
        self,
        refine: Refinement | float = 20.0,
        *,
        check: bool = True,
        canonical: bool = True,
        progress: Progress | None = None,
    ) -> Mesh:
        """The mesh that the call which made this would have made with `refine`, without its input being gone through.

        This mesh stays as it is, and may be refined again, to other bounds. One that is refined is refined further:
        its vertices keep their numbers. Of one that was adopted the domain is what its triangles cover, and edges that
        are no constraints are made Delaunay. `refine`: a `gcdt.Refinement`, or the least angle in degrees.
        """
        from ._errors import make
        from ._options import options
        from ._refinement import refinement

        if refine is None:
            raise make("invalid_argument", "refine is a gcdt.Refinement or a least angle, not None")
        wanted = options(refine=refine, check=check, canonical=canonical, progress=progress)
        made = self._result.refine(wanted)
        own = self._options.refined(refinement(refine))
        return Mesh(made, self.vertices, self.constraints, own, self._solver)

    @cached_property
    def hull(self) -> NDArray[np.uint32]:
        """(h,): the vertices on the convex hull, counter-clockwise, those inside its edges too."""
        return self._result.hull()

    @cached_property
    def vertex_triangles(self) -> NDArray[np.int32]:
        """(n,): the least triangle at each vertex of the input, or -1 without one."""
        return self._result.vertex_triangles()

    @cached_property
    def edge_pieces(self) -> NDArray[np.int32]:
        """(T, 3): the row of `pieces` along the edge opposite corner k, or -1."""
        return self._result.edge_pieces()

    def quality(self) -> dict[str, Any]:
        """The least and the largest angle (degrees) and area (units squared), measured in integers on the device."""
        return self._result.quality()

    def release(self) -> None:
        """Gives the device memory back at once. The arrays stay, what asks the device raises `InputError`."""
        self._result.release()

    def __enter__(self) -> Mesh:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    # ---- Proofs -----------------------------------------------------------------------------------------------

    def verify(self) -> Verification:
        """Proves on the host, by exact arithmetic and other code, that the mesh is what `triangulate_pslg` promises.

        Of a refined mesh that its triangles are those of the domain, constraints chains within their bounds, and
        angles, areas and lengths as wanted, or excused; not under crossing="split" (docs/refinement.md).
        """
        from ._pslg import Verification

        labelled = len(self.region) > 0
        return Verification(
            *_gcdt.verify(
                self.vertices,
                self.constraints,
                self._given(),
                self.region if labelled else None,
                self.depth if labelled else None,
                self.winding if labelled else None,
                self.statistics["grid"],
                self._options,
            )
        )

    def assess(self) -> dict[str, Any]:
        """Whether a mesh of the hull is also valid at the coordinates as they were given, before rounding."""
        return _gcdt.assess(self.vertices, self._given(), self.statistics["grid"])

    def _given(self) -> Any:
        return _gcdt.GivenMesh(self.triangles, self.neighbours, self.constrained, self.added_on_grid, self.added_origin)

    # ---- For other packages -----------------------------------------------------------------------------------

    def plot(self, ax: Any = None, *, values: Sequence[float] | NDArray[Any] | None = None, **style: Any) -> Any:
        """Draws the mesh with matplotlib, constraints thicker, and returns the axes.

        `values`: one number for each triangle, such as `mesh.region`, by which they are coloured. `style` goes to
        `tripcolor` with values, else to `triplot`.
        """
        return _views.plot(self, ax, values, style)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData with z = 0; regions, depths and windings as cell data, if there are any."""
        return _views.to_pyvista(self)

    def to_meshio(self) -> Any:
        """A meshio.Mesh with triangles and, as lines, the constrained edges; regions as cell data."""
        return _views.to_meshio(self)

    def to_shapely(self) -> NDArray[Any]:
        """(T,) shapely polygons."""
        return _views.to_shapely(self.points, self.triangles)

    def to_geopandas(self, crs: Any = None) -> Any:
        """A geopandas.GeoDataFrame with one row for each triangle."""
        return _views.to_geopandas(self, crs)

# SPDX-License-Identifier: Apache-2.0
"""Polygons with holes, by the hundred thousand: the ragged arrays of GeoArrow and shapely, one batch in one call."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _gcdt, _views
from ._errors import CoordinateError, Error, make
from ._options import options
from ._pool import Batch, Pool, pool_for
from ._solver import Progress


@dataclass(frozen=True, repr=False)
class PolygonTriangles:
    """The triangles of P polygons.

    `triangles`: (T, 3) uint32, rows of `points`, counter-clockwise; those of polygon p are rows offsets[p] to
    offsets[p + 1]. `offsets`: (P + 1,) uint64. `points`: the coordinates as they were given, then vertices that
    splitting has added. `errors`: the polygons that could not be triangulated, which have no triangles.
    `batch`: what else there is to know of each polygon.
    """

    triangles: NDArray[np.uint32]
    offsets: NDArray[np.uint64]
    points: NDArray[Any]
    batch: Batch
    errors: dict[int, Error]

    def __repr__(self) -> str:
        return f"<gcdt.PolygonTriangles: {len(self.triangles)} triangles of {len(self.offsets) - 1} polygons>"

    @cached_property
    def polygon_of(self) -> NDArray[np.int64]:
        """(T,): the polygon of each triangle."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets.astype(np.int64)))

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """(P,): the area of each polygon, summed over its triangles."""
        sums = np.concatenate([[0.0], np.cumsum(_views.areas(self.points, self.triangles))])
        bounds = self.offsets.astype(np.int64)
        return sums[bounds[1:]] - sums[bounds[:-1]]

    def to_shapely(self) -> NDArray[Any]:
        """(T,) shapely polygons."""
        return _views.to_shapely(self.points, self.triangles)

    def to_geopandas(self, crs: Any = None) -> Any:
        """A geopandas.GeoDataFrame with one row for each triangle, and its polygon in the column "polygon"."""
        geopandas = _views.imported("geopandas", "geo")
        return geopandas.GeoDataFrame({"polygon": self.polygon_of}, geometry=self.to_shapely(), crs=crs)


def _named(error: Error, polygon: int, points: NDArray[Any], first: int) -> Error:
    """The error of a polygon, whose coordinates begin with row `first`: says which, and which row of all a point is."""
    said = str(error)
    if isinstance(error, CoordinateError):
        row, axis = first + error.indices[0], error.indices[1]
        error.indices = (row, axis)
        said = f"coords: row {row} has {'xy'[axis]} = {points[row, axis]}"
    error.polygon = polygon
    error.args = (f"polygon {polygon}: {said}",)
    return error


def triangulate_polygons(
    coords: ArrayLike,
    ring_offsets: ArrayLike,
    polygon_offsets: ArrayLike,
    *,
    domain: str = "even-odd",
    crossing: str = "reject",
    errors: str = "raise",
    check: bool = True,
    progress: Progress | None = None,
    pool: Pool | None = None,
    devices: str | int | None = None,
) -> PolygonTriangles:
    """Triangulates polygons with holes, all in one call.

    `coords`: (N, 2); `ring_offsets`: (R + 1,): ring r is coords[ring_offsets[r]:ring_offsets[r + 1]], closed by its
    first point once more or not; `polygon_offsets`: (P + 1,): the rings of each polygon, its outer ring first. These
    are the arrays of GeoArrow, and of `shapely.to_ragged_array`. Rings may run in either direction and touch.

    `domain`: "even-odd", or "nonzero": the union of overlapping rings. `crossing`: as for `triangulate_pslg`; "split"
    accepts polygons that cross themselves. `errors`: "raise" raises the error of the first polygon that is invalid,
    which is named; "return" leaves such polygons without triangles and returns their errors.
    `pool`, or `devices` for a shared one: see `Pool`.
    """
    if errors not in ("raise", "return"):
        raise make("invalid_argument", f'errors is "raise" or "return", not {errors!r}')
    points = _arrays.coordinates(coords, "coords")
    rings = _arrays.offsets(ring_offsets, len(points), "ring_offsets")
    polygons = _arrays.offsets(polygon_offsets, len(rings) - 1, "polygon_offsets")
    wanted = options(crossing=crossing, domain=domain, check=check, progress=progress)
    used = pool_for(pool, devices)
    native, triangles, offsets, added = used._native.triangulate_polygons(points, rings, polygons, wanted)
    batch = Batch(native)
    found = {int(p): _named(batch[int(p)].error, int(p), points, int(rings[polygons[p]])) for p in batch.failed}
    if found and errors == "raise":
        raise next(iter(found.values()))
    if len(added):
        points = np.concatenate([np.asarray(points, np.float64), added])
    return PolygonTriangles(triangles, offsets, points, batch, found)


def ring_constraints(
    coords: ArrayLike, ring_offsets: ArrayLike, polygon_offsets: ArrayLike | None = None
) -> NDArray[np.uint32]:
    """(N, 2): constraints of rings for `triangulate_pslg`, one from each point to the next of its ring.

    With `polygon_offsets` the first ring of each polygon is directed counter-clockwise and its others clockwise, so
    that the domain "nonzero" is the union of all polygons.
    """
    points = _arrays.coordinates(coords, "coords")
    rings = _arrays.offsets(ring_offsets, len(points), "ring_offsets")
    if polygon_offsets is None:
        polygons = np.empty(0, np.uint64)
    else:
        polygons = _arrays.offsets(polygon_offsets, len(rings) - 1, "polygon_offsets")
    return _gcdt.ring_constraints(points, rings, polygons)


def from_shapely(
    geometries: Any,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Ragged arrays of shapely polygons and multi-polygons (an array, a list, a GeoSeries), z left out.

    Returns coords, ring_offsets and polygon_offsets for `triangulate_polygons`, and for each polygon the row of
    `geometries` that it is a part of. Missing and empty geometries have no polygons. Raises `TypeError` for others.
    """
    shapely = _views.imported("shapely", "geo")
    objects = np.atleast_1d(np.asarray(geometries, dtype=object))
    kinds = shapely.get_type_id(objects)
    wrong = np.flatnonzero((kinds != 3) & (kinds != 6) & (kinds != -1))
    if wrong.size:
        raise TypeError(f"geometry {wrong[0]} is no polygon but a {objects[wrong[0]].geom_type}")
    parts, rows = shapely.get_parts(objects, return_index=True)
    kept = ~shapely.is_empty(parts)
    parts, rows = parts[kept], rows[kept]
    if len(parts) == 0:
        return np.empty((0, 2)), np.zeros(1, np.int64), np.zeros(1, np.int64), rows
    _, coords, (ring_offsets, polygon_offsets) = shapely.to_ragged_array(parts, include_z=False)
    return coords, ring_offsets, polygon_offsets, rows


def triangulate_geometries(geometries: Any, **how: Any) -> tuple[PolygonTriangles, NDArray[np.int64]]:
    """`triangulate_polygons` of shapely objects or a geopandas series; how: its options.

    Returns the triangles, and for each of them the row of `geometries` that it is in.
    """
    coords, ring_offsets, polygon_offsets, rows = from_shapely(geometries)
    try:
        made = triangulate_polygons(coords, ring_offsets, polygon_offsets, **how)
    except Error as error:
        if error.polygon is not None:
            error.args = (f"geometry {rows[error.polygon]}: {error}",)
        raise
    return made, rows[made.polygon_of]

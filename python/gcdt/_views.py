# SPDX-License-Identifier: Apache-2.0
"""Meshes for other packages, which are imported when they are asked for."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import make

if TYPE_CHECKING:
    from ._mesh import Mesh


def imported(module: str, extra: str) -> Any:
    """A package that only some calls need; where it is missing the error says what brings it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"{error}: pip install 'gcdt[{extra}]' brings it", name=error.name) from None


def edges(triangles: NDArray[Any]) -> NDArray[np.uint32]:
    """Every edge once, the lesser vertex first, ascending."""
    pairs = np.sort(triangles[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2), axis=1).astype(np.uint64)
    keys = np.unique(pairs[:, 0] << np.uint64(32) | pairs[:, 1])
    return np.stack([keys >> np.uint64(32), keys & np.uint64(0xFFFFFFFF)], axis=1).astype(np.uint32)


def areas(points: NDArray[Any], triangles: NDArray[Any]) -> NDArray[np.float64]:
    """Signed areas, positive counter-clockwise."""
    a, b, c = (np.asarray(points[triangles[:, k]], np.float64) for k in range(3))
    return 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


def _cell_data(mesh: Mesh) -> dict[str, NDArray[Any]]:
    names = ("region", "depth", "winding", "region_seed")
    return {name: getattr(mesh, name) for name in names if len(getattr(mesh, name))}


def _constrained_ends(mesh: Mesh) -> NDArray[Any]:
    """The ends of constrained edges of the mesh, each edge once."""
    triangle, corner = np.nonzero(mesh.constrained_edges)
    ends = np.stack([mesh.triangles[triangle, (corner + k) % 3] for k in (1, 2)], axis=1)
    return np.unique(np.sort(ends, axis=1), axis=0)


def plot(mesh: Mesh, ax: Any, values: Any, style: dict[str, Any]) -> Any:
    if ax is None:
        ax = imported("matplotlib.pyplot", "plot").gca()
    lines = imported("matplotlib.collections", "plot")
    points = np.asarray(mesh.points, np.float64)
    if len(mesh.triangles):
        if values is None:
            ax.triplot(*points.T, mesh.triangles, **{"lw": 0.5, "color": "0.6", **style})
        else:
            values = np.asarray(values)
            if values.shape != (len(mesh.triangles),):
                raise make(
                    "invalid_argument", f"values must have one number for each of {len(mesh.triangles)} triangles"
                )
            ax.tripcolor(*points.T, mesh.triangles, facecolors=values, **style)
    ax.add_collection(lines.LineCollection(points[_constrained_ends(mesh)], colors="black", linewidths=1.2))
    ax.set_aspect("equal")
    ax.autoscale_view()
    return ax


def to_pyvista(mesh: Mesh) -> Any:
    pyvista = imported("pyvista", "mesh")
    points = np.zeros((len(mesh.points), 3))
    points[:, :2] = mesh.points
    count = len(mesh.triangles)
    faces = np.full((count, 4), 3, np.int64)
    faces[:, 1:] = mesh.triangles
    made = pyvista.PolyData(points, faces.ravel()) if count else pyvista.PolyData(points)
    for name, values in _cell_data(mesh).items():
        made.cell_data[name] = values
    return made


def to_meshio(mesh: Mesh) -> Any:
    meshio = imported("meshio", "mesh")
    lines = _constrained_ends(mesh)
    cells = [("triangle", mesh.triangles.astype(np.int64))]
    if len(lines):
        cells.append(("line", lines.astype(np.int64)))
    data = {
        name: [values] + ([np.zeros(len(lines), values.dtype)] if len(lines) else [])
        for name, values in _cell_data(mesh).items()
    }
    return meshio.Mesh(np.asarray(mesh.points, np.float64), cells, cell_data=data)


def to_shapely(points: NDArray[Any], triangles: NDArray[Any]) -> NDArray[Any]:
    shapely = imported("shapely", "geo")
    if len(triangles) == 0:
        return np.empty(0, object)
    return shapely.polygons(np.asarray(points, np.float64)[triangles])


def to_geopandas(mesh: Mesh, crs: Any) -> Any:
    geopandas = imported("geopandas", "geo")
    return geopandas.GeoDataFrame(_cell_data(mesh), geometry=to_shapely(mesh.points, mesh.triangles), crs=crs)

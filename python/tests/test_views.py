# SPDX-License-Identifier: Apache-2.0
"""Meshes for matplotlib, meshio and pyvista."""

import importlib
import sys

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import gcdt
import gcdt.opencl


@pytest.fixture
def mesh():
    points = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 1), (3, 1), (2, 3)]
    return gcdt.triangulate_pslg(points, [(0, 1), (4, 5), (5, 6), (6, 4)], label_regions=True)


def test_plot_draws_edges_and_constraints(mesh):
    figure, ax = plt.subplots()
    assert mesh.plot(ax) is ax
    assert len(ax.collections[-1].get_segments()) == len(mesh.pieces)
    figure.canvas.draw()
    inked = (np.asarray(figure.canvas.buffer_rgba())[..., :3] < 100).any(axis=2).sum()
    assert inked > 500
    figure, ax = plt.subplots()
    mesh.plot(ax, values=mesh.region, cmap="viridis")
    figure.canvas.draw()
    with pytest.raises(ValueError, match="one number for each"):
        mesh.plot(ax, values=[1, 2])
    gcdt.triangulate_pslg([]).plot(ax)


def test_meshio_writes_what_it_reads(mesh, tmp_path):
    meshio = importlib.import_module("meshio")
    mesh.to_meshio().write(tmp_path / "mesh.vtu")
    read = meshio.read(tmp_path / "mesh.vtu")
    assert (read.cells_dict["triangle"] == mesh.triangles).all()
    assert len(read.cells_dict["line"]) == len(mesh.pieces)
    assert (read.cell_data_dict["region"]["triangle"] == mesh.region).all()
    assert (read.points[:, :2] == np.asarray(mesh.points)).all()


@pytest.mark.parametrize(
    "call, package, extra",
    [
        (lambda m: m.plot(), "matplotlib.pyplot", "plot"),
        (lambda m: m.to_meshio(), "meshio", "mesh"),
        (lambda m: m.to_pyvista(), "pyvista", "mesh"),
        (lambda m: m.to_shapely(), "shapely", "geo"),
        (lambda m: m.to_geopandas(), "geopandas", "geo"),
        (lambda m: gcdt.from_shapely([]), "shapely", "geo"),
        (lambda m: importlib.reload(gcdt.opencl), "pyopencl", "opencl"),
    ],
)
def test_what_brings_a_missing_package_is_said(mesh, monkeypatch, call, package, extra):
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not installed
    with pytest.raises(ModuleNotFoundError, match=rf"{package}.*pip install 'gcdt\[{extra}\]'"):
        call(mesh)


@pytest.mark.whole
def test_pyvista_has_the_area(mesh):
    pyvista = importlib.import_module("pyvista")
    surface = mesh.to_pyvista()
    assert isinstance(surface, pyvista.PolyData)
    assert surface.area == pytest.approx(mesh.areas.sum())
    assert (surface.cell_data["region"] == mesh.region).all()

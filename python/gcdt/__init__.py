# SPDX-License-Identifier: Apache-2.0
"""Exact constrained Delaunay triangulation (CDT) on OpenCL devices, GPU or CPU.

    import gcdt
    mesh = gcdt.triangulate_pslg([(0, 0), (4, 0), (4, 4), (0, 4), (1, 2), (3, 2)], [(4, 5)])
    mesh.triangles

All arrays are numpy's; they are read where they are if they are contiguous and of a type that the library reads.
Distances are in the units of the coordinates, angles in degrees, times in milliseconds. Vertices, constraints and
triangles are numbered from 0. Calls may come from any thread, release the interpreter's lock, and end at Ctrl-C.
"""

from ._delaunay import Delaunay
from ._errors import (
    Cancelled,
    CheckFailed,
    ConstraintsCross,
    CoordinateError,
    DeviceError,
    Error,
    IndexOutOfRange,
    InputError,
    NoDevice,
    OutOfMemory,
)
from ._gcdt import required_bytes
from ._gcdt import version as _version
from ._mesh import Mesh
from ._polygons import PolygonTriangles, from_shapely, ring_constraints, triangulate_geometries, triangulate_polygons
from ._pool import Batch, Pool, Problem
from ._pslg import Verification, adopt, triangulate_pslg, verify
from ._refinement import EXCUSES, Refinement
from ._solver import DeviceInfo, Solver, default_solver, devices
from ._triangle import triangulate

__version__ = _version()

__all__ = [
    "Batch",
    "Cancelled",
    "CheckFailed",
    "ConstraintsCross",
    "CoordinateError",
    "Delaunay",
    "DeviceError",
    "DeviceInfo",
    "EXCUSES",
    "Error",
    "IndexOutOfRange",
    "InputError",
    "Mesh",
    "NoDevice",
    "OutOfMemory",
    "PolygonTriangles",
    "Pool",
    "Problem",
    "Refinement",
    "Solver",
    "Verification",
    "adopt",
    "default_solver",
    "devices",
    "from_shapely",
    "required_bytes",
    "ring_constraints",
    "triangulate",
    "triangulate_geometries",
    "triangulate_polygons",
    "triangulate_pslg",
    "verify",
]

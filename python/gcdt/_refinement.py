# SPDX-License-Identifier: Apache-2.0
"""What quality refinement is to reach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _gcdt
from ._errors import make

#: Why a triangle of a refined mesh is worse than wanted, by `Mesh.excuse`
#: (docs/refinement.md, "Why triangles are left").
EXCUSES = ("none", "input angle", "beside angle", "short side", "limit", "target", "fixed", "refused")


@dataclass(frozen=True)
class Refinement:
    """What the triangles of the domain are refined to, by adding vertices (docs/refinement.md: what is promised).

    `least_angle`: degrees, 1 to 34; 0: angles do not matter. Most inputs end by themselves, but from 30 on a limit
    of vertices is needed for some.
    `most_area`: of a triangle, in units of the coordinates squared; None: any.
    `region_areas`: (r,), the same for the region of each row of `regions`; infinity: any. None: any.
    `sizes`: (n,), a length wanted at each vertex, linear in between: the longest side of a triangle is at most sqrt(2)
    times the mean of those at its corners. None: any. Not with crossing="split".
    `conforming`: edges beside constraints are Delaunay, too.
    `splits`: what may be split: "all", "inner" (not the border of the domain), "none".
    `least_length`: triangles with a shorter side are left as they are; 0: 8 cells of the grid, which is the least.
    `most_added`: a limit of vertices; reaching it is no error, but `statistics["refine"]["complete"]` is False then.
    """

    least_angle: float = 20.0
    most_area: float | None = None
    region_areas: ArrayLike | None = None
    sizes: ArrayLike | None = None
    conforming: bool = False
    splits: str = "all"
    least_length: float = 0.0
    most_added: int | None = None

    def _native(self) -> Any:
        def row(values: ArrayLike | None, name: str) -> Any:
            if values is None:
                return np.empty(0)
            given = _arrays.array_of(values, name)
            return _arrays.values_of(given, given.size, name, "rows")

        most = self.most_added
        if most is not None and (isinstance(most, bool) or not isinstance(most, (int, np.integer)) or most < 0):
            raise make("invalid_argument", f"refine.most_added must be a whole number, 0 or more, not {most!r}")
        return _gcdt.Refinement(
            float(self.least_angle),
            np.inf if self.most_area is None else float(self.most_area),
            row(self.region_areas, "refine.region_areas"),
            row(self.sizes, "refine.sizes"),
            bool(self.conforming),
            str(self.splits),
            float(self.least_length),
            None if most is None else min(int(most), 2**64 - 1),
        )


def refinement(given: Refinement | float | None) -> Any:
    """The extension's, of what a call is given: a number is the least angle."""
    if given is None:
        return None
    if isinstance(given, Refinement):
        return given._native()
    if isinstance(given, (int, float, np.number)) and not isinstance(given, bool):
        return Refinement(float(given))._native()
    raise make("invalid_argument", f"refine is a gcdt.Refinement or a least angle, not {given!r}")

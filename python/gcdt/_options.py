# SPDX-License-Identifier: Apache-2.0
"""The options of a call."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _gcdt
from ._errors import make
from ._refinement import Refinement, refinement
from ._solver import Progress


def _grid(grid: Any) -> tuple[tuple[float, float], str] | None:
    if grid is None:
        return None
    try:
        x, y, cell = grid
        return (float(x), float(y)), cell if isinstance(cell, str) else repr(float(cell))
    except (TypeError, ValueError):
        raise make("invalid_argument", f'a grid is (x, y, cell), such as (0, 0, "0.001"), not {grid!r}') from None


def options(
    *,
    crossing: str = "reject",
    domain: str = "hull",
    holes: ArrayLike | None = None,
    regions: ArrayLike | None = None,
    label_regions: bool = False,
    grid: Any = None,
    check: bool = True,
    canonical: bool = True,
    distinct: bool = False,
    progress: Progress | None = None,
    refine: Refinement | float | None = None,
) -> Any:
    """The extension's options; see `gcdt.triangulate_pslg`."""
    none = np.empty((0, 2))
    return _gcdt.Options(
        str(crossing),
        str(domain),
        none if holes is None else _arrays.doubles(holes, "holes"),
        none if regions is None else _arrays.doubles(regions, "regions"),
        bool(label_regions) or regions is not None,
        _grid(grid),
        bool(check),
        bool(canonical),
        bool(distinct),
        progress,
        refinement(refine),
    )

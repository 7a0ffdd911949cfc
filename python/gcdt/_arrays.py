# SPDX-License-Identifier: Apache-2.0
"""Arrays of the caller's as the extension takes them: contiguous, of a type that the library reads.

What is so already is not copied. What is not is checked before it is converted, so that no number changes its value.
What a mask hides is no number: numpy would give what lies below it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import make

_COORDINATES = (np.dtype(np.float64), np.dtype(np.float32), np.dtype(np.int32), np.dtype(np.int64))


def array_of(values: ArrayLike, name: str) -> NDArray[Any]:
    """As numpy makes it."""
    if np.ma.is_masked(values):
        at = tuple(int(i) for i in np.argwhere(np.ma.getmaskarray(values))[0])
        where = f"row {at[0]}" if at else "it"
        raise make("invalid_argument", f"{name}: {where} is masked; leave out what is, or fill it", at)
    try:
        return np.asarray(values)
    except ValueError as error:  # rows of several lengths
        raise make("invalid_argument", f"{name} is no array: {error}") from None


def floats(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Numbers of any kind and shape as float64."""
    array = array_of(values, name)
    if array.dtype.kind not in "fiubO":
        raise make("invalid_argument", f"{name} must be numbers, not {array.dtype}")
    try:
        return array.astype(np.float64, copy=False)
    except (TypeError, ValueError) as error:
        raise make("invalid_argument", f"{name} must be numbers: {error}") from None


def coordinates(values: ArrayLike, name: str = "vertices") -> NDArray[Any]:
    """n x 2 coordinates: float64, float32, int32 or int64 as they are, anything else as float64."""
    array = array_of(values, name)
    if array.size == 0 and array.ndim < 2:
        return np.empty((0, 2))
    if array.ndim != 2 or array.shape[1] != 2:
        raise make("invalid_argument", f"{name} must have the shape (n, 2), not {array.shape}")
    return np.ascontiguousarray(array if array.dtype in _COORDINATES else floats(array, name))


def doubles(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """The same as float64, without NaN and infinities."""
    array = np.ascontiguousarray(coordinates(values, name), dtype=np.float64)
    bad = ~np.isfinite(array)
    if bad.any():
        row, axis = (int(i) for i in np.argwhere(bad)[0])
        raise make("coordinate_not_finite", f"{name}: row {row} has {'xy'[axis]} = {array[row, axis]}", (row, axis))
    return array


def numbers(values: ArrayLike | None, width: int, count: int, name: str, what: str = "vertex") -> NDArray[np.uint32]:
    """k x `width` numbers below `count`, as uint32; arrays of int32 and uint32 are not copied."""
    if values is None:
        return np.empty((0, width), np.uint32)
    array = array_of(values, name)
    if array.size == 0:
        return np.empty((0, width), np.uint32)
    if array.ndim != 2 or array.shape[1] != width:
        raise make("invalid_argument", f"{name} must have the shape (k, {width}), not {array.shape}")
    if not np.issubdtype(array.dtype, np.integer):
        raise make("invalid_argument", f"{name} must be whole numbers, not {array.dtype}")
    if array.dtype == np.int32 and array.dtype.isnative:
        checked = np.ascontiguousarray(array).view(np.uint32)  # negative ones become too large
    elif array.dtype == np.uint32 and array.dtype.isnative:
        checked = np.ascontiguousarray(array)
    else:
        checked = array
    if checked.max() >= count or checked.min() < 0:
        row, column = (int(i) for i in np.argwhere((array < 0) | (array >= count))[0])
        raise make(
            "index_out_of_range",
            f"{name}: row {row} has {what} {array[row, column]}, but there are {count}",
            (row, column),
        )
    return np.ascontiguousarray(checked, dtype=np.uint32)


def offsets(values: ArrayLike, last: int, name: str) -> NDArray[np.uint64]:
    """Ascending offsets from 0 to `last`, as uint64."""
    array = array_of(values, name)
    if array.ndim != 1 or not (np.issubdtype(array.dtype, np.integer) or array.size == 0):
        raise make("invalid_argument", f"{name} must be whole numbers in one dimension")
    if array.size == 0:
        array = np.zeros(1, np.uint64)
    falls = np.flatnonzero(array[1:] < array[:-1])
    if falls.size:
        at = int(falls[0]) + 1
        raise make("invalid_argument", f"{name}: element {at} is {array[at]}, less than the one before", (at,))
    if array[0] != 0 or array[-1] != last:
        at = 0 if array[0] != 0 else len(array) - 1
        raise make("invalid_argument", f"{name} must run from 0 to {last}, but element {at} is {array[at]}", (at,))
    return np.ascontiguousarray(array).astype(np.uint64, copy=False)


def values_of(values: ArrayLike, count: int, name: str, what: str) -> NDArray[np.float64]:
    """One float64 for each of `count` things."""
    array = np.ascontiguousarray(floats(values, name))
    if array.shape != (count,):
        raise make(
            "invalid_argument", f"{name} must have one number for each of {count} {what}, not the shape {array.shape}"
        )
    return array


def indices_to_judge(values: ArrayLike, shape: tuple[int, int], name: str, dtype: Any, wrong: int) -> NDArray[Any]:
    """Whole numbers of a shape (-1: any length); those that do not fit the type become `wrong`."""
    array = array_of(values, name)
    if array.size == 0 and shape[0] <= 0:
        return np.empty((0, shape[1]), dtype)
    if array.ndim != 2 or array.shape[1] != shape[1] or shape[0] not in (-1, array.shape[0]):
        wanted = f"({'t' if shape[0] == -1 else shape[0]}, {shape[1]})"
        raise make("invalid_argument", f"{name} must have the shape {wanted}, not {array.shape}")
    if not np.issubdtype(array.dtype, np.integer):
        raise make("invalid_argument", f"{name} must be whole numbers, not {array.dtype}")
    fits = np.iinfo(dtype)
    judged = np.ascontiguousarray(array).astype(dtype)
    judged[(array < fits.min) | (array > fits.max)] = wrong  # from NumPy 2 on, no `where` takes both types
    return judged

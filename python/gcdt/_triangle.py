# SPDX-License-Identifier: Apache-2.0
"""`triangulate`, with the dictionaries and switches of the package `triangle`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._errors import make
from ._mesh import Mesh
from ._pslg import triangulate_pslg
from ._refinement import Refinement
from ._solver import Solver

# Switches that change neither triangles nor keys here: how Triangle computes, what it prints or writes to files.
_WITHOUT_EFFECT = frozenset("QzVCXiFlIOgPNE")
_NOT_DONE = {
    "r": "refines a mesh that is given; gcdt.Mesh.refine refines one of gcdt's",
    "u": "asks a test of the caller's own",
    "s": "splits segments instead of having them as edges",
}
_KNOWN_KEYS = frozenset(
    ("vertices", "vertex_attributes", "vertex_markers", "segments", "segment_markers", "holes", "regions")
)
# Of a mesh that the caller has from an earlier call. Triangle reads the first three under r alone, the others never.
_PASSED_OVER = frozenset(
    ("triangles", "triangle_attributes", "triangle_max_area", "neighbors", "edges", "edge_markers")
)


@dataclass
class _Switches:
    """What the letters say, with the numbers behind q, a and S."""

    letters: list[str]
    angle: float | None = None
    area: float | None = None
    most: int | None = None
    region_areas: bool = False

    def __contains__(self, letter: str) -> bool:
        return letter in self.letters

    @classmethod
    def of(cls, opts: str) -> _Switches:
        made = cls([])
        for letter, number in re.findall(r"(.)([0-9.]*)", re.sub(r"^[0-9.]+", "", re.sub(r"[- ]", "", opts))):
            made._take(letter, number, opts)
        return made

    def _take(self, letter: str, number: str, opts: str) -> None:
        if letter in _NOT_DONE:
            raise make("invalid_argument", f"switch {letter} of {opts!r} {_NOT_DONE[letter]}: it is not supported")
        if letter not in _WITHOUT_EFFECT and letter not in "pcAenjBqaDYS":
            raise make("invalid_argument", f"switch {letter} of {opts!r} is not known, or not supported")
        self.letters.append(letter)
        if letter not in "qaS":
            return
        try:
            value = float(number) if number else None
        except ValueError:
            raise make("invalid_argument", f"{number!r} behind switch {letter} of {opts!r} is no number") from None
        if letter == "q":
            self.angle = 20.0 if value is None else value
        elif letter == "S":
            self.most = 0 if value is None else int(value)
        elif value is None:
            self.region_areas = True
        else:
            self.area = value

    def refinement(self, areas: NDArray[Any] | None) -> Refinement | None:
        """Y and S limit refinement, but do not ask for it."""
        if not {"q", "a", "D"} & set(self.letters):
            return None
        fixed = self.letters.count("Y")
        return Refinement(
            least_angle=self.angle if self.angle is not None else 0.0,
            most_area=self.area,
            region_areas=areas if self.region_areas else None,
            conforming="D" in self,
            splits="all" if fixed == 0 else "inner" if fixed == 1 else "none",
            most_added=self.most,
        )


def _column(values: Any, count: int, name: str, dtype: Any) -> NDArray[Any]:
    """One number for each of `count` rows, given as (count,) or (count, 1)."""
    array = _arrays.floats(values, name)
    if array.size != count:
        raise make("invalid_argument", f"{name} must have {count} rows, not the shape {array.shape}")
    return array.reshape(count).astype(dtype)


def _regions(given: Mapping[str, Any]) -> NDArray[np.float64]:
    """(r, 4): x, y, attribute and largest area (0: none, which may be left out)."""
    rows = _arrays.floats(given["regions"], "regions")
    if rows.ndim != 2 or rows.shape[1] not in (3, 4):
        raise make("invalid_argument", f"regions must have the shape (r, 4), not {rows.shape}")
    _arrays.doubles(rows[:, :2], "regions")
    return rows if rows.shape[1] == 4 else np.hstack([rows, np.zeros((len(rows), 1))])


@dataclass
class _Marks:
    """Markers of vertices and edges, by Triangle's rules.

    A segment has the marker it was given. A vertex without one takes that of the first segment at it that has one.
    What is still without one, and on the boundary, gets 1; so do vertices of segments on the convex hull that a hole
    has eaten.
    """

    vertices: NDArray[np.int32]
    pieces: NDArray[np.int32]

    @classmethod
    def of(
        cls,
        mesh: Mesh,
        given: Mapping[str, Any],
        switches: _Switches,
        boundary: NDArray[Any],
        pieces_on_it: NDArray[np.bool_],
        pieces_on_hull: NDArray[np.bool_],
    ) -> _Marks:
        count = len(mesh.representative)
        vertices = np.zeros(count, np.int32)
        if "vertex_markers" in given:
            own = _column(given["vertex_markers"], len(mesh.vertices), "vertex_markers", np.int32)
            vertices[: len(own)] = own
        pieces = np.zeros(len(mesh.pieces), np.int32)
        first = mesh.sources[mesh.source_offsets[:-1]] if len(pieces) else np.empty(0, np.int64)
        if "segment_markers" in given and "p" in switches:
            marks = _column(given["segment_markers"], len(mesh.constraints), "segment_markers", np.int32)
            pieces = marks[first]
        # By falling number of the segment, so that the first one is written last.
        order = np.argsort(first, kind="stable")[::-1]
        order = order[pieces[order] != 0]
        inherited = np.zeros(count, np.int32)
        ends = mesh.pieces[order]
        inherited[ends.ravel()] = np.repeat(pieces[order], 2)
        vertices = np.where(vertices == 0, inherited, vertices)
        pieces = np.where((pieces == 0) & pieces_on_it, 1, pieces)
        on = np.zeros(count, bool)
        on[boundary.ravel()] = True
        on[mesh.pieces[pieces_on_hull].ravel()] = True
        vertices = np.where((vertices == 0) & on, 1, vertices)
        return cls(vertices.astype(np.int32), pieces.astype(np.int32))


def _keys(ends: NDArray[Any]) -> NDArray[np.uint64]:
    """A number for each pair, whatever its direction."""
    pairs = np.sort(ends.astype(np.uint64), axis=1)
    return pairs[:, 0] << np.uint64(32) | pairs[:, 1]


def _boundary(mesh: Mesh) -> NDArray[np.uint32]:
    triangle, corner = np.nonzero(mesh.neighbours == -1)
    return np.stack([mesh.triangles[triangle, (corner + k) % 3] for k in (1, 2)], axis=1)


def _attributes(mesh: Mesh, given: Mapping[str, Any]) -> NDArray[np.float64]:
    """Of vertices; those of added ones are interpolated along their segments, and in their triangles."""
    own = _arrays.floats(given["vertex_attributes"], "vertex_attributes")
    count = len(mesh.vertices)
    if own.shape[:1] != (count,) or own.ndim > 2:
        raise make("invalid_argument", f"vertex_attributes must have the shape ({count}, a), not {own.shape}")
    own = own.reshape(count, -1)
    columns = [np.concatenate([own[:, k], mesh.added_values(own[:, k])]) for k in range(own.shape[1])]
    return np.stack(columns, axis=1)


def _mesh(given: Mapping[str, Any], switches: _Switches, how: dict[str, Any]) -> Mesh:
    if "p" not in switches:
        refine = switches.refinement(None)
        return triangulate_pslg(_arrays.floats(given["vertices"], "vertices"), refine=refine, **how)
    vertices = _arrays.coordinates(_arrays.floats(given["vertices"], "vertices"))
    regions, areas = None, None
    if ("A" in switches or switches.region_areas) and len(given.get("regions", ())):
        # The last of several points in a region counts, so that the least number is to be the last.
        rows = _regions(given)[::-1]
        regions, areas = rows[:, :2], rows[:, 3]
    if areas is not None:
        areas = np.where(areas > 0, areas, np.inf)  # Triangle has -1 and 0 for none
    holes = given.get("holes")
    return triangulate_pslg(
        vertices,
        _arrays.numbers(given.get("segments"), 2, len(vertices), "segments"),
        crossing="split",
        domain="holes" if "c" in switches else "outer-holes",
        holes=holes if holes is not None and len(holes) else None,
        regions=regions,
        refine=switches.refinement(areas),
        **how,
    )


def triangulate(
    tri: Mapping[str, Any], opts: str = "", *, solver: Solver | None = None, device: str | int | None = None
) -> dict[str, Any]:
    """What `triangle.triangulate` does.

    `tri`: a dictionary with `vertices`, (n, 2), and if there are any `vertex_attributes`, (n, a), `vertex_markers`,
    (n, 1), `segments`, (m, 2), `segment_markers`, (m, 1), `holes`, (h, 2), and `regions`, (r, 4): x, y, attribute and
    largest area. Other keys of a dictionary that was returned are passed over.
    `opts`: switches: p (segments, holes and regions are read; triangles outside the segments are removed), c (the
    convex hull is enclosed with segments, and nothing outside is removed), A (regions' attributes), e (edges), n
    (neighbors), j (vertices that are no corner are left out), B (no markers). Refinement: q or q30 (no angle below 20,
    or 30 degrees, at most 34), a0.5 (no triangle larger), a (none larger than its region says), D (conforming
    Delaunay), Y (no vertices on the boundary), YY (on no segment), S100 (at most so many vertices are added). Q, z and
    others that make no difference here are accepted; r, s and u are not.

    Returns a dictionary with `vertices`, `vertex_markers`, `triangles` and, as the switches say, `vertex_attributes`,
    `triangle_attributes`, `neighbors`, `segments`, `segment_markers`, `edges`, `edge_markers`, `holes`, `regions`.
    Their order is that of `gcdt.Mesh`. What there is none of is an empty array, where `triangle` has no key.
    """
    switches = _Switches.of(opts)
    if not isinstance(tri, Mapping):
        raise make("invalid_argument", f"the input is a dictionary with `vertices` and more, not {type(tri).__name__}")
    unknown = set(tri) - _KNOWN_KEYS - _PASSED_OVER
    if "vertices" not in tri or unknown:
        raise make("invalid_argument", f"unknown key {sorted(unknown)[0]}" if unknown else "there are no vertices")
    mesh = _mesh(tri, switches, {"solver": solver, "device": device})
    try:
        return _dictionary(mesh, tri, switches)
    finally:
        mesh.release()


def _dictionary(mesh: Mesh, tri: Mapping[str, Any], switches: _Switches) -> dict[str, Any]:
    boundary = _boundary(mesh)
    outline = _keys(boundary)
    # Segments between triangles that are all removed go with them.
    piece_keys = _keys(mesh.pieces)
    edge_keys = _keys(mesh.edges)
    around = mesh.hull
    hull = _keys(np.stack([around, np.roll(around, -1)], axis=1))
    on_outline, on_hull = np.isin(piece_keys, outline), np.isin(piece_keys, hull)
    marks = _Marks.of(mesh, tri, switches, boundary, on_outline, on_hull)
    made: dict[str, Any] = {
        "vertices": np.ascontiguousarray(mesh.points, np.float64),
        "vertex_markers": marks.vertices[:, None],
        "triangles": mesh.triangles.view(np.int32),
    }
    if "vertex_attributes" in tri:
        made["vertex_attributes"] = _attributes(mesh, tri)
    if "A" in switches and "p" in switches and "regions" in tri:
        attributes = np.append(_regions(tri)[::-1, 2], 0.0)
        made["triangle_attributes"] = attributes[mesh.region_seed][:, None]
    if "n" in switches:
        made["neighbors"] = mesh.neighbours
    if "p" in switches or "c" in switches:
        kept = np.isin(piece_keys, edge_keys)
        segments, segment_marks = mesh.pieces[kept], marks.pieces[kept]
        if "c" in switches:
            more = ~np.isin(outline, piece_keys)
            segments = np.concatenate([segments, boundary[more]])
            segment_marks = np.concatenate([segment_marks, np.ones(int(more.sum()), np.int32)])
        made["segments"] = segments.astype(np.int32)
        made["segment_markers"] = segment_marks[:, None]
    for key in ("holes", "regions"):
        if "p" in switches and key in tri:
            made[key] = np.asarray(tri[key], np.float64)
    if "e" in switches:
        made["edges"] = mesh.edges.astype(np.int32)
        edge_marks = np.isin(edge_keys, outline).astype(np.int32)
        order = np.argsort(piece_keys)
        if len(order):
            at = np.minimum(np.searchsorted(piece_keys[order], edge_keys), len(order) - 1)
            is_piece = piece_keys[order][at] == edge_keys
            edge_marks[is_piece] = marks.pieces[order[at[is_piece]]]
        made["edge_markers"] = edge_marks[:, None]
    if "B" in switches:
        made = {key: value for key, value in made.items() if not key.endswith("_markers")}
    return _jettisoned(made) if "j" in switches else made


def _jettisoned(made: dict[str, Any]) -> dict[str, Any]:
    """Without the vertices that are no corner; the others keep their order."""
    used = np.zeros(len(made["vertices"]), bool)
    used[made["triangles"].ravel()] = True
    numbers = (np.cumsum(used) - 1).astype(np.int32)
    for key in ("vertices", "vertex_markers", "vertex_attributes"):
        if key in made:
            made[key] = made[key][used]
    for key in ("triangles", "segments", "edges"):
        if key in made:
            made[key] = numbers[made[key]]
    return made

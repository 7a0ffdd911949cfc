# SPDX-License-Identifier: Apache-2.0
"""The command's formats against NumPy, shapely, meshio and poppler: what these write is read, and the other way round.

Usage: formats_oracle.py GCDT
"""
import json
import os
import re
import struct
import subprocess
import sys
import tempfile

import meshio
import numpy
import shapely.geometry
import shapely.wkb
import shapely.wkt

GCDT = os.path.abspath(sys.argv[1])


def gcdt(*arguments, status=0):
    done = subprocess.run([GCDT, *arguments], capture_output=True, text=True, timeout=300)
    assert done.returncode == status, (arguments, done.returncode, done.stderr)
    return done.stderr


def triangles_of(name):
    """The rows of an .ele file."""
    rows = [line.split() for line in open(name) if not line.startswith("#")]
    return numpy.array([row[1:4] for row in rows[1:]], dtype=int).reshape(-1, 3)


def vertices_of(name):
    rows = [line.split() for line in open(name) if not line.startswith("#")]
    return numpy.array([row[1:3] for row in rows[1 : 1 + int(rows[0][0])]], dtype=float).reshape(-1, 2)


RANDOM = numpy.random.default_rng(5)
POINTS = RANDOM.integers(-1000, 1000, (300, 2)).astype(float) / 8
RING = numpy.array([[-200, -200], [200, -200], [200, 200], [-200, 200]], dtype=float)
VERTICES = numpy.concatenate([POINTS, RING])
SEGMENTS = numpy.array([[300, 301], [301, 302], [302, 303], [303, 300]])


def write_poly(name):
    with open(name, "w") as out:
        out.write(f"{len(VERTICES)} 2 0 0\n")
        for i, (x, y) in enumerate(VERTICES):
            out.write(f"{i} {float(x)!r} {float(y)!r}\n")
        out.write(f"{len(SEGMENTS)} 0\n")
        for i, (a, b) in enumerate(SEGMENTS):
            out.write(f"{i} {a} {b}\n")
        out.write("0\n")


def arrays_are_read(expected):
    for dtype in ("<f8", ">f8", "<f4", ">i2"):
        scaled = VERTICES * 8 if dtype == ">i2" else VERTICES
        for order in ("C", "F"):
            arrays = {
                "vertices": numpy.array(scaled, dtype=dtype, order=order),
                "segments": SEGMENTS.astype("<i8" if order == "C" else ">u2"),
                "segment_markers": numpy.arange(4).reshape(4, 1),
                "holes": numpy.zeros((0, 2)),
                "unknown": numpy.array(["a", "b"]),
            }
            for save in (numpy.savez, numpy.savez_compressed):
                save("in.npz", **arrays)
                gcdt("triangulate", "in.npz", "-o", "o.ele")
                assert (triangles_of("o.ele") == expected).all(), (dtype, order)
    numpy.save("in.npy", VERTICES)
    gcdt("triangulate", "in.npy", "-o", "o.node")
    assert (vertices_of("o.node") == VERTICES).all()


def archives_that_are_wrong_are_refused():
    good = {"vertices": VERTICES, "segments": SEGMENTS}
    for change, said in (
        ({"vertices": None}, 'there is no array "vertices" in it'),
        ({"vertices": VERTICES[:, :1]}, "vertices.npy: vertices have 2 columns, and more for attributes; these have 1"),
        ({"vertices": numpy.array(["a"])}, "vertices.npy: the array holds '<U1'"),
        ({"segments": SEGMENTS + 1}, "segments.npy: row 2 has 304; it must be from 0 to 303"),
        ({"segments": -SEGMENTS}, "segments.npy: row 0 has -300; it must be from 0 to 303"),
        ({"segments": SEGMENTS / 2}, "segments.npy: the array holds floating-point numbers where integers are due"),
        ({"segment_markers": numpy.arange(3)}, "segment_markers.npy: 4 rows are due, not 3"),
        ({"vertex_markers": numpy.full(304, 2**40)}, "row 0 has 1099511627776; it must be from -2147483648"),
        ({"vertices": numpy.where(VERTICES == VERTICES[7], numpy.nan, VERTICES)}, "of vertex 7, nan, is not finite"),
    ):
        arrays = {name: array for name, array in {**good, **change}.items() if array is not None}
        for save in (numpy.savez, numpy.savez_compressed):
            save("bad.npz", **arrays)
            assert said in gcdt("triangulate", "bad.npz", status=3), said
    for save in (numpy.savez, numpy.savez_compressed):
        save("whole.npz", **good)
        whole = open("whole.npz", "rb").read()
        for size in list(range(0, len(whole), len(whole) // 12)) + [len(whole) - 1]:
            open("bad.npz", "wb").write(whole[:size])
            assert "bad.npz" in gcdt("triangulate", "bad.npz", status=3)
        middle = len(whole) // 4
        open("bad.npz", "wb").write(whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :])
        assert "bad.npz: vertices.npy: " in gcdt("triangulate", "bad.npz", status=3)


def geometries_are_read(expected):
    polygon = shapely.geometry.Polygon(RING)
    points = shapely.geometry.MultiPoint(POINTS)
    both = shapely.geometry.GeometryCollection([points, polygon])
    texts = {
        "in.wkt": shapely.wkt.dumps(both),
        "in.json": json.dumps(shapely.geometry.mapping(both)),
    }
    for name, text in texts.items():
        open(name, "w").write(text)
    binaries = {
        "little.wkb": shapely.wkb.dumps(both, big_endian=False),
        "big.wkb": shapely.wkb.dumps(both, big_endian=True),
        "postgis.wkb": shapely.wkb.dumps(both, srid=4326),
        "digits.wkb": shapely.wkb.dumps(both, hex=True).encode(),
    }
    for name, data in binaries.items():
        open(name, "wb").write(data)
    for name in (*texts, *binaries):
        gcdt("triangulate", name, "-o", "o.ele")
        assert (triangles_of("o.ele") == expected).all(), name


def results_are_read_by_others():
    names = [f"o.{kind}" for kind in ("ele", "neigh", "npz", "npy", "ply", "obj", "off", "msh", "geojson", "pslg", "vtu")]
    outputs = [word for name in names for word in ("-o", name)]
    gcdt("triangulate", "in.poly", "--domain", "even-odd", *outputs)
    expected = triangles_of("o.ele")
    assert (numpy.load("o.npy") == expected).all()
    with numpy.load("o.npz") as npz:
        assert (npz["triangles"] == expected).all()
        assert (npz["neighbors"] == triangles_of("o.neigh")).all()
        assert (npz["vertices"] == VERTICES).all()
        assert (npz["region"] == 0).all() and (npz["depth"] == 1).all()
        assert {tuple(sorted(s)) for s in npz["segments"].tolist()} == {tuple(sorted(s)) for s in SEGMENTS.tolist()}
        corners = [(t[(k + 1) % 3], t[(k + 2) % 3]) for t, bits in zip(npz["triangles"].tolist(), npz["constrained"])
                   for k in range(3) if bits >> k & 1]
        assert {tuple(sorted(s)) for s in corners} == {tuple(sorted(s)) for s in SEGMENTS.tolist()}
    for name in ("o.ply", "o.obj", "o.off", "o.msh", "o.vtu"):
        mesh = meshio.read(name)
        assert (mesh.points[:, :2] == VERTICES).all(), name
        assert (mesh.cells_dict["triangle"] == expected).all(), name
        if name == "o.msh":
            lines = {tuple(sorted(s)) for s in mesh.cells_dict["line"].tolist()}
            assert lines == {tuple(sorted(s)) for s in SEGMENTS.tolist()}, name
    lines = {tuple(sorted(int(v) - 1 for v in line.split()[1:])) for line in open("o.obj") if line.startswith("l ")}
    assert lines == {tuple(sorted(s)) for s in SEGMENTS.tolist()}
    features = json.load(open("o.geojson"))["features"]
    corners = [[VERTICES.tolist()[v] for v in (*t, t[0])] for t in expected]
    assert [feature["geometry"]["coordinates"] for feature in features] == [[ring] for ring in corners]
    magic, vertices, segments = struct.unpack("<8sqq", open("o.pslg", "rb").read(24))
    assert (magic, vertices, segments) == (b"PSLGBIN1", len(VERTICES), 4)
    assert (numpy.fromfile("o.pslg", "<f8", 2 * vertices, offset=24).reshape(-1, 2) == VERTICES).all()


def results_are_read_again():
    """Of each format that is written and read; edges of triangles are constraints where the format has faces."""
    expected = triangles_of("o.ele")
    for name in ("o.pslg", "o.npz", "o.ply", "o.obj", "o.off"):
        gcdt("triangulate", name, "--domain", "hull", "-o", "again.ele")
        assert (triangles_of("again.ele") - triangles_of("again.ele").min() == expected - expected.min()).all(), name
    open("middle.node", "w").write("2 2 0 0\n0 0.01 0.02\n1 500 0\n")
    gcdt("locate", "o.npz", "middle.node", "-o", "from_npz.txt")
    gcdt("locate", "o.vtu", "middle.node", "-o", "from_vtu.txt")
    assert open("from_npz.txt").read() == open("from_vtu.txt").read()


def bytes_are_the_same_in_each_run():
    kinds = ("npz", "npy", "ply", "obj", "off", "msh", "geojson", "pslg")
    for run in ("one", "two"):
        gcdt("triangulate", "in.poly", *[word for kind in kinds for word in ("-o", f"{run}.{kind}")])
    for kind in kinds:
        assert open(f"one.{kind}", "rb").read() == open(f"two.{kind}", "rb").read(), kind


def pictures_show_what_they_should():
    """A square whose halves are two regions: a page of cairo's is drawn by poppler."""
    open("p.poly", "w").write("4 2 0 0\n0 0 0\n1 40 0\n2 40 40\n3 0 40\n5 0\n0 0 1\n1 1 2\n2 2 3\n3 3 0\n4 0 2\n0\n")
    for run in ("one", "two"):
        gcdt("triangulate", "p.poly", "--regions", "-o", f"{run}.pdf", "-o", f"{run}.png")
    for kind in ("pdf", "png"):
        assert open(f"one.{kind}", "rb").read() == open(f"two.{kind}", "rb").read(), kind
    told = subprocess.run(["pdfinfo", "-rawdates", "one.pdf"], capture_output=True, text=True, check=True).stdout
    assert re.search(r"^CreationDate: +(D:)?19700101000000", told, re.MULTILINE), told
    assert "ModDate" not in told, told
    page = subprocess.run(["pdftoppm", "-r", "72", "-aa", "no", "one.pdf"], capture_output=True, check=True).stdout
    kind, size, depth, pixels = page.split(b"\n", 3)
    width, height = map(int, size.split())
    assert kind == b"P6" and depth == b"255" and width < height  # the scale is below
    image = numpy.frombuffer(pixels, numpy.uint8).reshape(height, width, 3)
    scale, margin = 720 / 40, 0.02 * 720

    def at(x, y):
        return tuple(image[round(margin + (40 - y) * scale), round(margin + x * scale)].tolist())

    assert at(30, 10) != at(10, 30) and min(at(30, 10) + at(10, 30)) > 170  # pale, and not the same
    assert max(at(20, 20)) < 60 and max(at(0, 10)) < 60  # constraints
    below = image[round(2 * margin + 720) :]
    assert below.min() < 60 and tuple(image[2, 2].tolist()) == (255, 255, 255)


def surfaces_of_others_are_read():
    """A square of two triangles with heights, as meshio writes it: its diagonal stays."""
    points = numpy.array([[0, 0, 1], [4, 0, 2], [5, 4, 3], [0, 4, 4]], dtype=float)
    mesh = meshio.Mesh(points, [("triangle", numpy.array([[0, 1, 3], [1, 2, 3]]))])
    for name, keywords in (("m.ply", {"binary": True}), ("m.ply", {"binary": False}), ("m.obj", {}), ("m.off", {})):
        meshio.write(name, mesh, **keywords)
        gcdt("triangulate", name, "-o", "m.ele", "-o", "m.node")
        rows = triangles_of("m.ele")
        assert {frozenset(row) for row in (rows - rows.min()).tolist()} == {frozenset({0, 1, 3}), frozenset({1, 2, 3})}
        heights = [line.split()[3] for line in open("m.node") if not line.startswith("#")][1:]
        assert [float(height) for height in heights] == [1, 2, 3, 4], (name, heights)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write_poly("in.poly")
    gcdt("triangulate", "in.poly", "-o", "expected.ele")
    reference = triangles_of("expected.ele")
    arrays_are_read(reference)
    archives_that_are_wrong_are_refused()
    geometries_are_read(reference)
    results_are_read_by_others()
    results_are_read_again()
    bytes_are_the_same_in_each_run()
    surfaces_of_others_are_read()
    pictures_show_what_they_should()
print("formats: NumPy, shapely and meshio agree")

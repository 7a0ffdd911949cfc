# SPDX-License-Identifier: Apache-2.0
"""The pages that `gcdt view` writes: whole, escaped, without outside references, and with the mesh's own numbers.

Usage: view_oracle.py GCDT
"""
import base64
import html.parser
import json
import os
import re
import subprocess
import sys
import tempfile
import zlib

import numpy

GCDT = os.path.abspath(sys.argv[1])
HOSTILE = "</title></script><script>alert(1)</script> & \"'\u00e4<!--"


def gcdt(*arguments, status=0):
    done = subprocess.run([GCDT, *arguments], capture_output=True, text=True, timeout=300)
    assert done.returncode == status, (arguments, done.returncode, done.stderr)
    return done.stderr


class Page(html.parser.HTMLParser):
    """Elements and attributes of a page, and the texts of scripts by id."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.attributes, self.texts, self.open, self.title = [], [], {}, None, ""
        self.text = open(path, encoding="utf-8").read()
        self.feed(self.text)
        self.meta = json.loads(self.texts["meta"])

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attributes]
        self.open = dict(attributes).get("id", "code") if tag == "script" else tag

    def handle_endtag(self, tag):
        self.open = None

    def handle_data(self, data):
        if self.open == "title":
            self.title += data
        elif self.open:
            self.texts[self.open] = self.texts.get(self.open, "") + data

    def array(self, name, dtype, columns=1):
        data = numpy.frombuffer(zlib.decompress(base64.b64decode(self.texts["data-" + name])), dtype)
        return data.reshape(-1, columns) if columns > 1 else data


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    # Two squares, one in the other; vertices have two attributes.
    places = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 3), (6, 3), (6, 6), (3, 6)]
    open("in.poly", "w").write(
        "8 2 2 0\n" + "".join(f"{i + 1} {x} {y} {x + y} {i}\n" for i, (x, y) in enumerate(places))
        + "8 0\n" + "".join(f"{i + 1} {i + 1} {i // 4 * 4 + (i + 1) % 4 + 1}\n" for i in range(8)) + "0\n")
    gcdt("triangulate", "in.poly", "--regions", "-o", "o.npz", "-o", "o.vtu")
    gcdt("view", "in.poly", "--title", HOSTILE, "-o", "page.html")
    page = Page("page.html")
    assert page.title == page.meta["title"] == HOSTILE, page.title
    assert page.tags.count("script") == 13, page.tags  # meta, eleven arrays, the code
    assert not {"src", "href", "action", "onload"} & set(page.attributes)
    assert not re.search(r"https?:|//[a-z]|url\(|import\s*\(|fetch\(|XMLHttp|WebSocket", page.texts["code"].replace("// ", ""))
    assert "default-src 'none'" in page.text
    with numpy.load("o.npz") as npz:
        assert (page.array("places", "<f8", 2) == npz["vertices"]).all()
        assert (page.array("triangles", "<u4", 3) == npz["triangles"]).all()
        for name, dtype in (("constrained", "u1"), ("region", "<u4"), ("depth", "<u4"), ("winding", "<i4")):
            assert (page.array(name, dtype) == npz[name]).all(), name
        assert (page.array("pieces", "<u4", 2) == npz["segments"]).all()
        for k in range(2):
            assert (page.array(f"attribute{k}", "<f8") == npz["vertex_attributes"][:, k]).all()
    assert page.meta["triangles"] == len(page.array("triangles", "<u4", 3)) and page.meta["first"] == 1
    offsets, sources = page.array("offsets", "<u4"), page.array("sources", "<u4")
    for i, piece in enumerate(page.array("pieces", "<u4", 2).tolist()):
        (source,) = sources[offsets[i] : offsets[i + 1]].tolist()
        assert sorted(piece) == sorted([source, source // 4 * 4 + (source + 1) % 4])
    # A mesh is shown as its file has it, without a device.
    os.environ["GCDT_DEVICE"] = "no such device"
    for name in ("o.npz", "o.vtu"):
        gcdt("view", name, "-o", "mesh.html")
        again = Page("mesh.html")
        assert again.title == name
        for array, dtype in (("places", "<f8"), ("triangles", "<u4"), ("constrained", "u1"), ("region", "<u4")):
            assert (again.array(array, dtype) == page.array(array, dtype)).all(), (name, array)
    gcdt("view", "o.npz", "--domain", "even-odd", "-o", "mesh.html", status=2)
    gcdt("view", "o.npz", "-o", "mesh.txt", status=2)
    gcdt("view", "o.npz", "-o", "no-such-folder/mesh.html", status=6)
    gcdt("view", "no.npz", "-o", "mesh.html", status=3)
    gcdt("view", "in.poly", "-o", "page.html", status=4)
    one = open("mesh.html", "rb").read()
    gcdt("view", "o.vtu", "-o", "mesh.html")
    assert open("mesh.html", "rb").read() == one
print("view: the page has the mesh, and nothing else")

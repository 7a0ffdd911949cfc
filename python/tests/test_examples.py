# SPDX-License-Identifier: Apache-2.0
"""The examples run, and say what is true."""

import re
import subprocess
import sys
from pathlib import Path

import matplotlib.image

EXAMPLES = Path(__file__).parents[2] / "examples"


def _run(*command):
    ran = subprocess.run([sys.executable, *map(str, command)], capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_first_code():
    said = _run(EXAMPLES / "triangulate.py")
    assert said.endswith("[15.5  3. ]\n") and "-1]" in said


def test_the_map(tmp_path):
    said = _run(EXAMPLES / "map.py", EXAMPLES / "data" / "countries-50m.poly", tmp_path / "map.png")
    assert "proved: True" in said
    # Areas of countries in square degrees, from their square kilometres: Kenya 580,000, Switzerland 41,300.
    for city, degrees in (("Nairobi", 580e3 / 111.2**2), ("Bern", 41.3e3 / 111.2**2 / 0.684)):
        found = float(re.search(rf"{city}: region \d+, ([0-9.]+)", said)[1])
        assert abs(found / degrees - 1) < 0.05, (city, found, degrees)
    picture = matplotlib.image.imread(tmp_path / "map.png")
    coloured = (picture[..., :3].max(axis=2) - picture[..., :3].min(axis=2) > 0.2).mean()
    assert 0.2 < coloured < 0.7, "land is coloured, the sea is white"

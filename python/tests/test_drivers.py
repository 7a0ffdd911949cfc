# SPDX-License-Identifier: Apache-2.0
"""What the OpenCL loader is told of drivers that pip has installed. scripts/prove-python.sh shows it with real ones."""

import os
from pathlib import Path

import pytest

from gcdt import _drivers


@pytest.fixture
def told(tmp_path, monkeypatch):
    """Packages with drivers, a folder of the system, and a list of what the loader finds when it is first called."""
    for package, file in (("intel_opencl_rt", "libintelocl.so"), ("pocl_binary_distribution", "libpocl-1.so")):
        made = tmp_path / f"{package}-1.dist-info"
        made.mkdir()
        (made / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1\n")
        # As Intel's: a name that begins like the driver's stands before it.
        (made / "RECORD").write_text(f"lib/{file}-gdb.py,,\nlib/{file},,\n")
        (tmp_path / "lib").mkdir(exist_ok=True)
        (tmp_path / "lib" / f"{file}-gdb.py").touch()
        (tmp_path / "lib" / file).touch()
    system = tmp_path / "vendors"
    system.mkdir()
    (system / "vendor.icd").write_text("libvendor.so\n")
    calls = []

    class Loader:
        @staticmethod
        def devices():
            folder = Path(os.environ["OCL_ICD_VENDORS"])
            calls.append((folder, sorted(f.read_text().strip() for f in folder.glob("*.icd"))))

    for variable in _drivers._CHOSEN:
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(_drivers, "_ready", False)
    monkeypatch.setattr(_drivers, "_SYSTEM", system)
    monkeypatch.setattr(_drivers, "_gcdt", Loader)
    return calls


def test_drivers_of_packages_stand_beside_those_of_the_system(told, tmp_path):
    before = dict(os.environ)
    _drivers.prepare()
    _drivers.prepare()
    ((folder, drivers),) = told
    assert drivers == sorted(["libvendor.so", *(str(tmp_path / "lib" / f) for f in ("libintelocl.so", "libpocl-1.so"))])
    assert not folder.exists() and dict(os.environ) == before


def test_another_loader_is_told_of_them_too(told, tmp_path):
    before = dict(os.environ)
    with _drivers.with_installed() as more:
        folder = Path(os.environ["OCL_ICD_VENDORS"])
        assert more and len(list(folder.glob("*.icd"))) == 3
    with pytest.raises(ZeroDivisionError), _drivers.with_installed():
        raise ZeroDivisionError
    assert not folder.exists() and dict(os.environ) == before


@pytest.mark.parametrize("variable", _drivers._CHOSEN)
def test_who_chooses_drivers_himself_has_those(told, monkeypatch, variable):
    monkeypatch.setenv(variable, "/somewhere")
    _drivers.prepare()
    assert told == []


def test_pocl_is_left_out_where_it_would_end_the_process(told, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.warns(UserWarning, match="binutils"):
        _drivers.prepare()
    assert told[0][1] == sorted(["libvendor.so", str(tmp_path / "lib" / "libintelocl.so")])

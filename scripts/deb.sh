#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes Debian packages of the library, its headers, the command and Python, in build-deb/.
# Usage: scripts/deb.sh [--no-python] [WHEEL]
#   --no-python   without python3-gcdt
#   WHEEL         of the distribution's own Python; default: scripts/python.sh makes it of /usr/bin/python3
# Needs what scripts/setup.sh installs, and dpkg-dev; for the wheel python3-dev and python3-venv.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-deb
python=yes wheel=
for argument in "$@"; do
  case $argument in
    --no-python) python= ;;
    *.whl) wheel=$(realpath "$argument") ;;
    *) sed -n '4,7s/^# //p' "$0"; [[ $argument == -h || $argument == --help ]] && exit 0; exit 2 ;;
  esac
done
options=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON -DGCDT_EXAMPLES=OFF)
if [[ $python ]]; then
  if [[ ! $wheel ]]; then
    bash "$root/scripts/python.sh" wheel /usr/bin/python3
    wheel=$(find "$root/build-python/wheels" -name 'gcdt-*.whl' -newer "$root/build-python/build/pyvenv.cfg" | sort | tail -1)
  fi
  rm -rf "$build/python"
  mkdir -p "$build/python"
  /usr/bin/python3 -m zipfile -e "$wheel" "$build/python"
fi
cmake -S "$root" -B "$build" "${options[@]}" -DGCDT_PYTHON_TREE="${python:+$build/python}"
cmake --build "$build" --parallel "$(nproc)"
rm -f "$build"/*.deb
(cd "$build" && cpack -G DEB)
ls -l "$build"/*.deb

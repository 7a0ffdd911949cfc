#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds with warnings as errors, and runs all tests, the benchmark's included.
# Usage: scripts/test.sh [--quick] [CTEST OPTION]...
#   --quick        leaves out the tests labelled "slow"
#   CTEST OPTION   passed on, such as -R predicates
# Many files are compiled at a time; with GCDT_UNITY=OFF each alone (CONTRIBUTING.md).
# Ends with CTest's own summary and status. A missing oracle or OpenCL driver fails a test, never skips it.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-test
selection=()
case ${1-} in
  -h | --help) sed -n '3,7s/^# //p' "$0"; exit 0 ;;
  --quick) selection=(-LE '^slow$'); shift ;;
esac

cores=$(nproc)
# A CPU driver uses every core for each test: a few tests at once hide the serial parts, more only fill the memory.
tests_at_once=$((cores < 4 ? cores + 1 : 4))

bash "$root/scripts/setup.sh" --tests
bash "$root/scripts/format.sh"
bash "$root/scripts/layers.sh"
bash "$root/scripts/python.sh" environment "$build/python-env"
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DGCDT_TESTS=ON -DGCDT_BENCH=ON -DGCDT_WERROR=ON \
  -DGCDT_UNITY="${GCDT_UNITY:-ON}" -DGCDT_TEST_PYTHON="$build/python-env/bin/python"
cmake --build "$build" --parallel "$cores"
ctest --test-dir "$build" --output-on-failure --no-tests=error --parallel "$tests_at_once" "${selection[@]}" "$@"

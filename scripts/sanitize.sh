#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the tests, but for the slow ones, with host code under the address and undefined-behaviour sanitizers.
# Usage: scripts/sanitize.sh [CTEST OPTION]...
# Leaks are not looked for: OpenCL drivers keep memory until the process ends. Kernels are not instrumented, and
# the example in Python is left out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cores=$(nproc)
bash scripts/setup.sh --tests
cmake --preset sanitize
cmake --build --preset sanitize --parallel "$cores"
ctest --preset sanitize --parallel $((cores < 4 ? cores : 4)) "$@"

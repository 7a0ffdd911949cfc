#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails if a source is not as clang-format 14 would write it, or that version is missing: another one decides nothing.
# Usage: scripts/format.sh [--fix]
#   --fix   rewrites them
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1-} in
  "") mode=(--dry-run -Werror) ;;
  --fix) mode=(-i) ;;
  *) sed -n '3,5s/^# //p' "scripts/format.sh"; exit 2 ;;
esac
tool=$(command -v clang-format-14 || command -v clang-format || true)
if [[ -z $tool || $("$tool" --version) != *"version 14."* ]]; then
  echo "format: clang-format 14 is not installed (package clang-format-14)" >&2
  exit 1
fi
sources=$(find include kernels lib mpi tools tests examples bench python -name build -prune -o -type f \
  \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.cl' \) -print | sort)
mapfile -t sources <<<"$sources"
"$tool" "${mode[@]}" "${sources[@]}"
echo "format: ${#sources[@]} files"

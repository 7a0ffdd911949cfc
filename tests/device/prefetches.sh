#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# After all other tests: what PoCL compiled of each of these kernels for threads asks for cache lines before they are
# needed (GCDT_PREFETCH in kernels/common/prefetch.h). Results are the same without, and calls take longer.
# Usage: tests/device/prefetches.sh SINCE
#   SINCE   a file: what was used since it was made is looked at
set -euo pipefail

since=${1:?"usage: $0 SINCE"}
# shellcheck source=tests/device/compiled.sh
. "$(dirname "$0")/compiled.sh"
wanted=(check_edges gather_triangles refine_aim refine_insert refine_judge_stars refine_tail refine_wait)
objects=$(mktemp)
trap 'rm -f "$objects"' EXIT
compiled_since "$since" | tr '\0' '\n' >"$objects"
status=0
for kernel in "${wanted[@]}"; do
  found=$(grep "/$kernel\.so$" "$objects" | xargs -r -d '\n' objdump -d --no-show-raw-insn | grep -cE '\s(prefetch|prfm)' || true)
  echo "$kernel: $found prefetches"
  [[ $found -gt 0 ]] || status=1
done
exit "$status"

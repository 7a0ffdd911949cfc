#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# After all other tests: no kernel that PoCL compiled for them shares local memory between work-groups. PoCL makes a
# local variable an argument of the kernel that it finds it in, one copy a work-group; one that it does not find stays a
# static variable of the shared object, which threads then race for (GCDT_GIVEN_LOCAL in kernels/common/shared.h).
# Usage: tests/device/local_memory.sh SINCE
#   SINCE   a file: what was used since it was made is looked at
set -euo pipefail

since=${1:?"usage: $0 SINCE"}
cache=${POCL_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/pocl/kcache}
looked_at=0 shared=0
while IFS= read -r used; do
  while IFS= read -r object; do
    looked_at=$((looked_at + 1))
    # Variables with a dot in their names: "kernel.variable".
    if variables=$(nm "$object" | grep -E ' [bBdD] [a-z]\w*\.\w+$'); then
      shared=$((shared + 1))
      echo "$object:"$'\n'"$variables"
    fi
  done < <(find "$(dirname "$used")" -name '*.so')
done < <(find "$cache" -name last_accessed -newer "$since")
echo "$looked_at compiled kernels, of which $shared share local memory between work-groups"
((looked_at > 0 && shared == 0))

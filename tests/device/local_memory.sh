#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# After all other tests: no kernel that PoCL compiled for them shares local memory between work-groups. PoCL makes a
# local variable an argument of the kernel that it finds it in, one copy a work-group; one that it does not find stays a
# static variable of the shared object, which threads then race for (GCDT_GIVEN_LOCAL in kernels/common/shared.h).
# Usage: tests/device/local_memory.sh SINCE
#   SINCE   a file: what was used since it was made is looked at
set -euo pipefail

since=${1:?"usage: $0 SINCE"}
# shellcheck source=tests/device/compiled.sh
. "$(dirname "$0")/compiled.sh"
objects=$(mktemp)
trap 'rm -f "$objects"' EXIT
compiled_since "$since" >"$objects"
looked_at=$(tr -cd '\0' <"$objects" | wc -c)
# Variables with a dot in their names: "kernel.variable".
shared=$(xargs -0 -r nm -A <"$objects" | grep -E ' [bBdD] [a-z]\w*\.\w+$' || true)
[[ ! $shared ]] || echo "shared by work-groups:"$'\n'"$shared"
echo "$looked_at compiled kernels looked at"
[[ $looked_at -gt 0 && ! $shared ]]

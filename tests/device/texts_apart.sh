#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# After all other tests: each function that is to stand apart from its kernels (GCDT_APART in kernels/common/shared.h)
# does so in what PoCL compiled for them. One that asks for ids, has a barrier or is not called by a kernel that a thread
# runs is found here: PoCL makes it part of the kernel, whose text it compiles three times over.
# Usage: tests/device/texts_apart.sh SINCE
#   SINCE   a file: what was used since it was made is looked at
set -euo pipefail

since=${1:?"usage: $0 SINCE"}
kernels=$(dirname "$0")/../../kernels
# shellcheck source=tests/device/compiled.sh
. "$(dirname "$0")/compiled.sh"
wanted=$(grep -rhoE '^GCDT_APART \w+ \w+\(' "$kernels" | sed -E 's/.* (\w+)\($/\1/' | sort -u)
found=$(compiled_since "$since" | xargs -0 -r nm --defined-only -j | sort -u)
part_of_kernels=$(comm -23 <(echo "$wanted") <(echo "$found"))
[[ ! $part_of_kernels ]] || echo "part of kernels:"$'\n'"$part_of_kernels"
echo "$(wc -w <<<"$wanted") functions looked for"
[[ $wanted && ! $part_of_kernels ]]

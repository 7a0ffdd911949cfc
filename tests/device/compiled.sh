# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Not run, but sourced by the scripts that look at what PoCL has compiled.

# Usage: compiled_since FILE
# Prints the shared objects of the programs that were used since the file was made, each with a NUL behind it.
compiled_since() {
  local cache=${POCL_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/pocl/kcache}
  find "$cache" -name last_accessed -newer "$1" -printf '%h\0' | xargs -0 -r -I{} find {} -name '*.so' -print0
}

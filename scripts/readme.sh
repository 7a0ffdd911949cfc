#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails unless the examples in README are, word for word, the files that are built and run.
# Usage: scripts/readme.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

for language in c cpp; do
  shown=$(sed -n "/^\`\`\`$language\$/,/^\`\`\`\$/p" README.md | sed '1d;$d')
  built=$(tail -n +3 "examples/triangulate.$language")
  [[ $shown && $built ]] || { echo "readme: no example in $language" >&2; exit 1; }
  diff <(echo "$shown") <(echo "$built")
done
echo "readme: its examples are examples/triangulate.c and .cpp"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails unless the examples in README are, word for word, the files that are built and run.
# Usage: scripts/readme.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

for language in c cpp; do
  diff <(sed -n "/^\`\`\`$language\$/,/^\`\`\`\$/p" README.md | sed '1d;$d') <(tail -n +3 "examples/triangulate.$language")
done
echo "readme: its examples are examples/triangulate.c and .cpp"

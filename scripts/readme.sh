#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails unless the examples in README and docs/using.md are, word for word, the files that are built and run, README has
# at most 150 lines, and every file that the documents link to or name is there.
# Usage: scripts/readme.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

shows() { # PAGE LANGUAGE
  local shown built
  shown=$(awk -v fence="\`\`\`$2" '$0 == fence { block = ""; inside = 1; next } /^```$/ { inside = 0 }
                                   inside { block = block $0 "\n" } END { printf "%s", block }' "$1") # the last such block
  built=$(tail -n +3 "examples/triangulate.$2")
  [[ $shown && $built ]] || { echo "readme: no example in $2 in $1" >&2; exit 1; }
  diff <(echo "$shown") <(echo "$built")
}
shows README.md cpp
shows README.md sh
shows README.md c
shows docs/using.md c
shows README.md py
shows docs/python.md py

lines=$(wc -l <README.md)
((lines <= 150)) || { echo "readme: README has $lines lines, more than 150" >&2; exit 1; }

missing=0
named() { # PAGE FILE: the file is there
  [[ -e $2 ]] || { echo "readme: $1 names $2, which is missing" >&2; missing=1; }
}
pages=(README.md CONTRIBUTING.md docs/*.md kernels/README.md bench/README.md bench/RESULTS.md bench/NOTES.md)
for page in "${pages[@]}"; do
  while read -r link; do
    [[ $link == http* || $link == '#'* ]] || named "$page" "$(dirname "$page")/${link%%#*}"
  done < <(grep -oE '\]\([^)]+\)' "$page" | sed 's/^](//; s/)$//')
  [[ $page != bench/NOTES.md ]] || continue # it names files of the commits that it is about
  while read -r path; do
    named "$page" "$path"
  done < <(grep -oE '`(abi|bench|docs|examples|include|kernels|lib|scripts|tests|tools)/[A-Za-z0-9_./-]*[` ]' "$page" |
    tr -d '` ' | sort -u)
done
((missing == 0)) || exit 1
echo "readme: its examples are examples/triangulate.c, .cpp, .py and .sh, and what ${#pages[@]} pages name is there"

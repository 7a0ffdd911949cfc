#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the documentation as a site, of docs/ and of the headers, in build-site/html; any warning is an error.
# Usage: scripts/site.sh
# Needs the packages doxygen, python3-sphinx, python3-breathe and python3-myst-parser.
set -euo pipefail
[[ $# == 0 ]] || { sed -n '4,5s/^# //p' "$0"; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build-site
rm -rf "$work"
mkdir -p "$work/source/docs" "$work/source/kernels" "$work/source/bench" "$work/source/python" "$work/source/tests"
cp "$root"/docs/site/{conf.py,index.md,c.rst,cpp.rst} "$root"/{CONTRIBUTING,CHANGELOG,SECURITY}.md "$work/source/"
cp "$root"/docs/*.{md,png,html} "$work/source/docs/"
cp "$root/kernels/README.md" "$work/source/kernels/"
cp "$root"/bench/*.md "$work/source/bench/"
cp -r "$root/bench/results" "$work/source/bench/"
for page in "$root"/bench/results/*.md; do # a page of a site has a title
  copy=$work/source/bench/results/$(basename "$page")
  { grep -q '^# ' "$page" || printf '# %s\n\n' "$(basename "$page" .md)"; cat "$page"; } >"$copy"
done

# The C headers have plain comments, so that they read as C: here those before and behind declarations are marked.
# shellcheck disable=SC2016
filter='sed -E "s#^( *)/\* (----.*)#\1/* \2#; t; s#^( *)/\* #\1/** #; s#([;,{)] +|[a-z0-9_] +)/\* #\1/**< #"'
printf '%s\n' '#!/bin/sh' 'case $1 in *.h) '"$filter"' "$1" ;; *) cat "$1" ;; esac' >"$work/filter"
chmod +x "$work/filter"
{
  cat "$root/docs/site/Doxyfile"
  echo "INPUT = $root/include/gcdt"
  echo "INPUT_FILTER = $work/filter"
  echo "OUTPUT_DIRECTORY = $work"
  echo "STRIP_FROM_PATH = $root/include"
  echo "INCLUDE_PATH = $root/include"
} >"$work/Doxyfile"
doxygen "$work/Doxyfile" >"$work/doxygen.log" 2>&1 || { cat "$work/doxygen.log" >&2; exit 1; }
[[ ! -s $work/doxygen.log ]] || { cat "$work/doxygen.log" >&2; echo "site: doxygen warns" >&2; exit 1; }
# Enums that have no name: Doxygen 1.9.4 numbers them, 1.9.8 leaves the name empty, which breathe takes for a fault.
for page in "$work"/xml/*_8h.xml; do
  awk '{ while (sub(/<name><\/name>/, "<name>@" count + 0 "</name>")) ++count } 1' "$page" >"$work/numbered"
  mv "$work/numbered" "$page"
done
python=/usr/bin/python3
[[ -x $python ]] || python=python3
"$python" -m sphinx -q -W --keep-going -b html "$work/source" "$work/html"
echo "site: $work/html/index.html"

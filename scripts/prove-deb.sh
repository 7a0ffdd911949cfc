#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that the packages of scripts/deb.sh can be installed in a bare Debian, and work there.
# Usage: scripts/prove-deb.sh [FOLDER]   where the .deb files are (default: build-deb)
# Needs root, debootstrap, and about 2 GB under TMPDIR (/var/tmp). GCDT_SUITE and GCDT_MIRROR as for prove-setup.sh.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
self=$root/scripts/prove-deb.sh
case ${1-} in -*) sed -n '4,5s/^# //p' "$self"; exit 2 ;; esac
folder=$(realpath "${1:-$root/build-deb}")
# shellcheck source=scripts/bare-root.sh
. "$root/scripts/bare-root.sh"
bare_begin "$self" "$folder"

say "a bare $suite"
bare_root
mkdir "$bare/debs"
cp "$folder"/*.deb "$bare/debs/"
cp "$root"/examples/triangulate.{c,cpp,py} "$root/examples/data/countries-50m.poly" "$bare/root/"
cp -r "$root/tests/consumer/find_package" "$bare/root/"
cp "$root"/tests/consumer/main.* "$bare/root/"
inside apt-get -q update >"$work/apt.log" 2>&1 || { tail "$work/apt.log"; exit 1; }

say "the command alone: no device, and what to install is said"
add $(cd "$bare" && printf '/%s ' debs/gcdt_*.deb debs/libgcdt0_*.deb)
inside gcdt --version
status=0
said=$(inside gcdt triangulate /root/countries-50m.poly 2>&1) || status=$?
[[ $status == 4 && $said == *pocl-opencl-icd* ]] || { echo "prove-deb: status $status: $said" >&2; exit 1; }
for file in man/man1/gcdt.1 bash-completion/completions/gcdt zsh/site-functions/_gcdt fish/vendor_completions.d/gcdt.fish; do
  [[ -s $bare/usr/share/$file || -s $bare/usr/share/$file.gz ]] || { echo "prove-deb: no $file" >&2; exit 1; }
done

say "with a device"
add pocl-opencl-icd
inside gcdt triangulate /root/countries-50m.poly --verify -o /root/o.ele -o /root/o.npz -o /root/o.png -o /root/o.pdf -o /root/o.vtu
inside gcdt verify /root/countries-50m.poly /root/o.ele
inside gcdt view /root/o.npz -o /root/o.html

say "programs against the library"
add $(cd "$bare" && printf '/%s ' debs/libgcdt-dev_*.deb) gcc g++ cmake make pkg-config
inside sh -ec 'cd /root; cc triangulate.c -o c $(pkg-config --cflags --libs gcdt) && ./c
  c++ -std=c++17 triangulate.cpp -o cpp $(pkg-config --cflags --libs gcdt) && ./cpp
  cmake -S find_package -B build >log && cmake --build build >>log && build/consumer'

if compgen -G "$bare/debs/python3-gcdt_*.deb" >/dev/null; then
  say "Python"
  add $(cd "$bare" && printf '/%s ' debs/python3-gcdt_*.deb)
  inside python3 /root/triangulate.py
  # Another Python must not get what it cannot import.
  version=$(inside python3 -c 'import sys; print(f"3.{sys.version_info.minor}")')
  # shellcheck disable=SC2016
  wanted=$(inside dpkg-query -W -f '${Depends}' python3-gcdt)
  [[ $wanted == *"python3 (>= $version), python3 (<< 3.$((${version#3.} + 1)))"* || $wanted == *"python3 (>= 3.12),"* ]] ||
    { echo "prove-deb: python3-gcdt depends on $wanted" >&2; exit 1; }
fi
say "and away again"
# shellcheck disable=SC2016
mapfile -t ours < <(inside dpkg-query -W -f '${Package}\n' '*gcdt*')
inside apt-get -q -y purge "${ours[@]}" >"$work/apt.log" 2>&1 || { tail "$work/apt.log"; exit 1; }
left=$(find "$bare/usr" -name '*gcdt*')
[[ ! $left ]] || { echo "prove-deb: left behind: $left" >&2; exit 1; }
say "proved: $(cd "$folder" && echo *.deb)"

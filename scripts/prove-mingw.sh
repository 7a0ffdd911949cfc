#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the library for Windows by MinGW-w64, warnings as errors: libgcdt.dll, and the examples in C and C++ linked with it.
# Usage: scripts/prove-mingw.sh
# Needs Debian's g++-mingw-w64-x86-64 and OpenCL's headers. Nothing is run: there is no Windows here. OpenCL.dll, which
# drivers bring, is stood for by an import library with the functions that cl.h declares.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build-mingw
machine=x86_64-w64-mingw32
for program in $machine-gcc-posix $machine-g++-posix $machine-dlltool $machine-windres $machine-objdump; do
  command -v "$program" >/dev/null || { echo "prove-mingw: $program is missing (package g++-mingw-w64-x86-64)" >&2; exit 1; }
done
headers=$(dirname "$(find /usr/include/CL -name opencl.hpp | head -n 1)")
[[ $headers == */CL ]] || { echo "prove-mingw: CL/opencl.hpp is missing (package opencl-clhpp-headers)" >&2; exit 1; }

# In a folder of their own: beside them are the headers of this machine's C library.
mkdir -p "$build/opencl/include"
cp -rL "$headers" "$build/opencl/include/"
{
  echo "LIBRARY OpenCL.dll"
  echo "EXPORTS"
  grep -ohE '\bcl[A-Z][A-Za-z0-9]+ *\(' "$headers/cl.h" | tr -d ' (' | sort -u
} >"$build/opencl/OpenCL.def"
$machine-dlltool -d "$build/opencl/OpenCL.def" -l "$build/opencl/libOpenCL.a"

cmake -S "$root" -B "$build" -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=ON \
  -DCMAKE_C_COMPILER=$machine-gcc-posix -DCMAKE_CXX_COMPILER=$machine-g++-posix -DCMAKE_RC_COMPILER=$machine-windres \
  -DOpenCL_INCLUDE_DIR="$build/opencl/include" -DOpenCL_LIBRARY="$build/opencl/libOpenCL.a" \
  -DGCDT_TOOLS=OFF -DGCDT_EXAMPLES=OFF -DGCDT_INSTALL=OFF -DGCDT_WERROR=ON
cmake --build "$build" --parallel "$(nproc)" --target gcdt

dll=$build/lib/libgcdt.dll
flags=(-I"$root/include" -DGCDT_SHARED)
$machine-gcc-posix -std=c99 "${flags[@]}" "$root/examples/triangulate.c" "$dll.a" -o "$build/triangulate_c.exe"
$machine-g++-posix -std=c++17 "${flags[@]}" "$root/examples/triangulate.cpp" "$dll.a" -o "$build/triangulate.exe"

# Every function of the headers, and nothing else.
declared=$(grep -ohE '^GCDT_API .*\bgcdt_[a-z0-9_]+\(' "$root"/include/gcdt/*.h | grep -oE 'gcdt_[a-z0-9_]+\($' | tr -d '(' | sort -u)
exported=$($machine-objdump -p "$dll" | sed -n '/Ordinal\/Name Pointer/,$s/^\t\[ *[0-9]*\] //p' | sort -u)
diff <(echo "$declared") <(echo "$exported") || { echo "prove-mingw: the DLL exports other functions than the headers declare" >&2; exit 1; }
echo "prove-mingw: $(wc -l <<<"$exported") functions in $(basename "$dll"), and two programs linked with it"

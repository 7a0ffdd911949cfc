// SPDX-License-Identifier: Apache-2.0
// One triangulation of a file of gcdt_bench_generate on the only device, and nothing else: for simulators.
//   gcdt_bench_traffic FILE
#include <cstdio>
#include <exception>

#include <gcdt/gcdt.hpp>

#include "inputs.hpp"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::fprintf(stderr, "usage: gcdt_bench_traffic FILE   (a PSLGBIN1 file: bench/inputs.hpp)\n");
    return 2;
  }
  const gcdt::bench::Workload work = gcdt::bench::read_pslg(arguments[1]);
  const gcdt::Triangulation made = gcdt::triangulate(work.points, work.constraints);
  const gcdt::Statistics& s = made.statistics;
  std::printf("{\"n\": %zu, \"m\": %zu, \"triangles\": %zu, \"flips\": %llu, \"crossed_pairs\": %llu}\n",
              work.points.size(), work.constraints.size(), made.triangles.size(),
              static_cast<unsigned long long>(s.flips), static_cast<unsigned long long>(s.crossed_pairs));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench_traffic: %s\n", error.what());
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
// Writes one input of the benchmark to a file, for other programs.
//   gcdt_bench_generate NAME SIZE FILE [DEVICE]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <gcdt/gcdt.hpp>

#include "inputs.hpp"

int main(int count, char** arguments) try {
  if (count < 4 || count > 5) {
    std::fprintf(stderr, "usage: gcdt_bench_generate NAME SIZE FILE [DEVICE]   (a PSLGBIN1 file: bench/inputs.hpp)\n");
    return 2;
  }
  const gcdt::bench::Input input{arguments[1], std::strtoull(arguments[2], nullptr, 10), {}};
  const gcdt::bench::Workload work = gcdt::bench::make(input, [&](const std::vector<gcdt::bench::Point>& points) {
    return gcdt::triangulate(points, {}, {}, count == 5 ? arguments[4] : "").triangles;
  });
  gcdt::bench::write_pslg(work, arguments[3]);
  std::printf("%s: %zu vertices, %zu constraints\n", arguments[1], work.points.size(), work.constraints.size());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench_generate: %s\n", error.what());
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
// What CGAL's programs have in common as peers (bench/peer.hpp): inputs, the clock, and answers to requests.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include "inputs.hpp"

namespace gcdt::bench {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct PeerInput {
  std::vector<Kernel::Point_2> points;
  std::vector<std::pair<std::size_t, std::size_t>> constraints;
};

inline PeerInput read(const std::string& path) {
  const Workload given = read_pslg(path);
  PeerInput input;
  for (const auto& point : given.points) input.points.emplace_back(point[0], point[1]);
  for (const auto& ends : given.constraints) input.constraints.emplace_back(ends[0], ends[1]);
  return input;
}

/// In milliseconds.
inline double now() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// One run.
struct Answer {
  double ms = 0;
  std::size_t triangles = 0;
  std::string more = {};  ///< what is said behind the times
};

/// Names itself, and answers requests until there are none: run(input) is timed as often as they want.
template <class Run>
void serve(const std::string& name, Run&& run) {
  std::cout << name << '-' << CGAL_STR(CGAL_VERSION) << " constraints" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string path;
    int most = 3;
    double seconds = 0;
    words >> path >> most >> seconds;
    try {
      const PeerInput input = read(path);
      Answer answer;
      std::ostringstream times;
      const double start = now();
      for (int i = 0; i < most && (i < 3 || now() - start < 1000 * seconds); ++i) {
        answer = run(input);
        times << ' ' << answer.ms;
      }
      std::cout << "ok " << answer.triangles << times.str() << answer.more << std::endl;
    } catch (const std::exception& error) {
      std::string what = error.what();
      std::replace(what.begin(), what.end(), '\n', ' ');
      std::cout << "error " << what << std::endl;
    }
  }
}

}  // namespace gcdt::bench

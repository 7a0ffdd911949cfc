// SPDX-License-Identifier: Apache-2.0
// Batches in which constraints of some problems cross, on pools that count their launches.
#pragma once

#include <map>

#include "pool_cases.hpp"

namespace gcdt::test {

inline constexpr std::array<Crossing, 3> crossing_policies = {Crossing::reject, Crossing::drop, Crossing::split};

inline Options with_policy(Crossing policy) {
  Options options;
  options.crossing = policy;
  return options;
}

/// Problem p of `count`: random constraints that cross if `crosses(p)`, else such that do not. Of 4 to 90 vertices on
/// grids of 6 to 1000 places a side, so that there are vertices on constraints, overlaps and repeats.
template <class Crosses>
std::vector<Workload> random_problems(std::size_t count, std::uint64_t seed, const Crosses& crosses) {
  std::vector<Workload> problems;
  for (std::size_t p = 0; p < count; ++p) {
    const std::size_t n = 4 + (p * 37 + seed * 11) % 87;
    const std::uint32_t side = p % 3 == 0 ? 6 : p % 3 == 1 ? 40 : 1000;
    if (!crosses(p)) {
      problems.push_back(random_pslg(n, side, n / 2, seed * 1000 + p));
      continue;
    }
    problems.push_back(random_crossing(n, side, n / 2, seed * 1000 + p));
    // Two that cross for sure, around all others, and a third that is crossed by none.
    const auto corner = static_cast<std::uint32_t>(n);
    for (const double x : {-1.0, side + 1.0})
      for (const double y : {-2.0, side + 1.0}) problems.back().points.push_back({x, y});
    const std::vector<Constraint> more = {{corner, corner + 3}, {corner + 2, corner + 1}, {corner, corner + 1}};
    auto& all = problems.back().constraints;
    all.insert(p % 2 == 0 ? all.begin() : all.end(), more.begin(), more.end());
  }
  return problems;
}

/// A pool of one device whose launches are counted by kernel.
class CountingPool {
 public:
  explicit CountingPool(runtime::CallHook hook) {
    hook.before = [this](const char* call, const char* detail) {
      if (std::string(call) == "clEnqueueNDRangeKernel") {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++launched_[detail];
      }
      return CL_SUCCESS;
    };
    pool_ = std::make_unique<DevicePool>(std::vector<DevicePool::Member>{{cl::Context(), app_device(), hook}},
                                         runtime::Log(), Trace());
  }
  DevicePool& pool() { return *pool_; }
  /// How often each kernel is launched for the problems.
  std::map<std::string, std::uint64_t> launches(const std::vector<Workload>& problems, const Options& options) {
    const RaggedBatch batch(problems);
    launched_.clear();
    pool_->triangulate(batch.view(), options);
    return launched_;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::uint64_t> launched_;
  std::unique_ptr<DevicePool> pool_;
};

inline std::uint64_t sum_of(const std::map<std::string, std::uint64_t>& launches) {
  std::uint64_t sum = 0;
  for (const auto& [kernel, count] : launches) sum += count;
  return sum;
}

/// Every problem's bytes, or its error with all that it says, are what it has alone.
inline void check_as_alone(DevicePool& pool, const std::vector<Workload>& problems, const Options& options) {
  const RaggedBatch batch(problems);
  const PoolResult result = pool.triangulate(batch.view(), options);
  Singles(problems, options).check(result);
  for (const auto& [p, error] : result.errors) {
    CAPTURE(p);
    try {
      solver().triangulate(problems[p].points, problems[p].constraints, options);
      FAIL("alone it has no error");
    } catch (const Error& alone) {
      CHECK(error.status() == alone.status());
      CHECK(error.indices() == alone.indices());
      CHECK(error.pair_count() == alone.pair_count());
    }
  }
}

/// Crossings in 200 of 600 problems cost at most `most` launches more than none, one crossing about as many, and no
/// kernel of `insertion` is launched more often: problems that cross do not have the others inserted again.
inline void check_launches(CountingPool& counting, Crossing policy, std::uint64_t most, const std::string& insertion) {
  const Options options = with_policy(policy);
  const auto crossing_in = [&](std::size_t some) {
    return counting.launches(random_problems(600, 1, [&](std::size_t p) { return p % 3 == 1 && p < 3 * some; }),
                             options);
  };
  auto none = crossing_in(0), one = crossing_in(1), many = crossing_in(200);
  REQUIRE(none[insertion] > 0);
  CHECK(many[insertion] == none[insertion]);
  CHECK(sum_of(one) <= sum_of(none) + most);
  CHECK(sum_of(many) <= sum_of(none) + most);
  CHECK(sum_of(many) <= sum_of(one) + 12);  // passes of sorts
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// gcdt bench: how fast each device is, and which one `auto` is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "command.hpp"
#include "progress.hpp"

namespace gcdt::command {

namespace {

/// Numbers that look random, the same everywhere (splitmix64).
class Numbers {
 public:
  double next() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
    x = (x ^ x >> 27) * 0x94d049bb133111eb;
    return static_cast<double>((x ^ x >> 31) >> 34) / (1 << 30);
  }

 private:
  std::uint64_t state_ = 1;
};

/// Vertices all over a square, and short constraints that do not cross: a segment in each of as many cells.
struct Workload {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;

  explicit Workload(std::uint32_t count) {
    const auto side = static_cast<std::uint32_t>(std::max(1.0, std::sqrt(count / 2.0)));
    Numbers numbers;
    for (std::uint32_t row = 0; row < side; ++row)
      for (std::uint32_t column = 0; column < side; ++column) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (int end = 0; end < 2; ++end) {
          const double x = numbers.next(), y = numbers.next();
          vertices.push_back({(column + x) / side, (row + y) / side});
        }
        constraints.push_back({first, first + 1});
      }
  }
};

struct Measured {
  std::uint64_t calls = 0, triangles = 0;
  double median = 0, least = 0;  ///< milliseconds a call
};

/// Calls for so long, and at least three times; the first, which builds programs, is not counted.
Measured measured(Solver& solver, const Workload& workload, double seconds) {
  Options options;
  options.progress = [](const char*, double) { return !interrupted(); };
  std::vector<double> times;
  Measured found;
  const Stopwatch all;
  for (bool first = true; first || times.size() < 3 || all.milliseconds() < 1000 * seconds; first = false) {
    const Stopwatch call;
    const Result result = solver.solve(workload.vertices, workload.constraints, options);
    const double time = call.milliseconds();
    found.triangles = result.statistics().triangles;
    if (!first) times.push_back(time);
  }
  std::sort(times.begin(), times.end());
  found.calls = times.size();
  found.median = times[times.size() / 2];
  found.least = times.front();
  return found;
}

}  // namespace

void bench(const BenchArguments& arguments) {
  if (!(arguments.seconds >= 0)) throw io::Failure(io::Exit::usage, "--seconds: no time");
  const std::vector<DeviceInfo> all = devices();
  const std::size_t automatic = select_device("auto");  // throws, and says what to install, where there is none
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (arguments.device.empty() || i == select_device(arguments.device)) chosen.push_back(i);
  const Workload workload(arguments.vertices);
  print(fmt::format("{} vertices in a square, {} short constraints; {} s on each device\n", workload.vertices.size(),
                    workload.constraints.size(), arguments.seconds));
  std::optional<std::size_t> fastest;
  double best = 0;
  for (const std::size_t i : chosen) {
    try {
      Solver solver(std::to_string(i));
      const Measured found = measured(solver, workload, arguments.seconds);
      const double rate = static_cast<double>(workload.vertices.size()) / found.median / 1000;
      print(fmt::format(
          "device {}: {} ({}): median {:.1f} ms, least {:.1f}, of {} calls: {:.2f} million vertices a second\n", i,
          all[i].name, all[i].platform, found.median, found.least, found.calls, rate));
      if (rate > best) best = rate, fastest = i;
    } catch (const Error& error) {
      stop_if_interrupted();
      print(fmt::format("device {}: {} ({}): {}\n", i, all[i].name, all[i].platform, error.what()));
    }
  }
  print(fmt::format("auto picks device {}: {}\n", automatic, all[automatic].name));
  if (!fastest) throw io::Failure(io::Exit::device, "no device could be measured");
  if (chosen.size() > 1 && *fastest != automatic)
    print(fmt::format("device {} is the fastest for this: --device {}, or GCDT_DEVICE={} for all calls\n", *fastest,
                      *fastest, *fastest));
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
#include "opencl_app.hpp"

namespace gcdt::test {

cl::Device app_device() { return runtime::all_devices().at(select_device(test_device())); }

cl_command_queue_properties supported(cl_command_queue_properties wanted) {
  return wanted & app_device().getInfo<CL_DEVICE_QUEUE_PROPERTIES>();
}

Integers integer_input(std::size_t points, std::uint64_t seed) {
  const Workload work = random_pslg(points, 400, 3 * points, seed);
  Integers input;
  for (const Point& p : work.points)
    input.points.push_back({static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1])});
  input.constraints.assign(work.constraints.begin(), work.constraints.end());
  return input;
}

bool same_bytes(const Triangulation& a, const Triangulation& b) {
#define GCDT_ARRAY(number, name, ...) \
  if (a.name != b.name) return false;
#include <gcdt/arrays.def>
  return true;
}

Triangulation from_host(const Integers& input, Options options) {
  options.grid = FixedGrid{};
  return solver().triangulate(input.points, input.constraints, options);
}

DevicePoints device_points(const App& app, const Integers& input) {
  return {Points::Type::int32, app.buffer(input.points), input.points.size(), 0};
}

DeviceConstraints device_constraints(const App& app, const Integers& input) {
  return {app.buffer(input.constraints), input.constraints.size(), 0};
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// The public entry (include/gcdt/gcdt.hpp).
#include "pipeline.hpp"

namespace gcdt {

struct Solver::State {
  explicit State(const cl::Device& device) : runtime(device), primitives(runtime) {}
  runtime::Runtime runtime;
  Primitives primitives;
};

Solver::Solver(const std::string& device) {
  const std::size_t number = select_device(device);
  const std::vector<cl::Device> all = runtime::all_devices();
  if (number >= all.size()) throw Error(Status::no_device, "the chosen OpenCL device is gone");
  state_ = std::make_unique<State>(all[number]);
}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

const DeviceInfo& Solver::device() const { return state_->runtime.info(); }

Triangulation Solver::triangulate(Points points, Constraints constraints, const Options& options) {
  return Pipeline(state_->runtime, state_->primitives, points, constraints, options).run();
}

Triangulation triangulate(Points points, Constraints constraints, const Options& options, const std::string& device) {
  return Solver(device).triangulate(points, constraints, options);
}

const char* version() { return GCDT_VERSION; }

}  // namespace gcdt

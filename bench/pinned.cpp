// SPDX-License-Identifier: Apache-2.0
#include "pinned.hpp"

#include <chrono>
#include <cstring>
#include <stdexcept>

#include <gcdt/gcdt_cl.hpp>

#include "rates.hpp"

namespace gcdt::bench {

/// Host memory of a mapped buffer, as long as the object lives.
class PinnedCaller::Memory {
 public:
  Memory(const cl::Context& context, const cl::CommandQueue& queue, std::size_t bytes)
      : queue_(queue), buffer_(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes > 0 ? bytes : 1) {
    cl_int code = CL_SUCCESS;
    data_ = queue_.enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes > 0 ? bytes : 1, nullptr,
                                    nullptr, &code);
    if (code != CL_SUCCESS) throw std::runtime_error("mapping a buffer: OpenCL error " + std::to_string(code));
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  ~Memory() {
    queue_.enqueueUnmapMemObject(buffer_, data_);
    queue_.finish();
  }
  void* data() const { return data_; }

 private:
  cl::CommandQueue queue_;
  cl::Buffer buffer_;
  void* data_ = nullptr;
};

struct PinnedCaller::State {
  explicit State(const cl::Device& device) : context(device), queue(context, device), solver(make_solver(queue)) {}
  cl::Context context;
  cl::CommandQueue queue;
  Solver solver;
};

PinnedCaller::PinnedCaller(const DeviceInfo& device) {
  cl_device_id found = opencl_device(device);
  if (!found) throw std::runtime_error(device.name + " was not found again");
  state_ = std::make_unique<State>(cl::Device(found, true));
}

PinnedCaller::~PinnedCaller() = default;

std::vector<double> PinnedCaller::time(Points points, Constraints constraints, const Options& options, int runs) {
  const auto pin = [&](std::size_t bytes) { return std::make_unique<Memory>(state_->context, state_->queue, bytes); };
  constexpr std::size_t vertex_bytes = 16;
  if (points.type() != Points::Type::float64) throw std::runtime_error("pinned calls are timed with doubles");
  const auto vertices = pin(vertex_bytes * points.size()), pairs = pin(8 * constraints.size());
  std::memcpy(vertices->data(), points.data(), vertex_bytes * points.size());
  if (constraints.size() > 0) std::memcpy(pairs->data(), constraints.data(), 8 * constraints.size());
  const Points pinned_points = Points::pairs(static_cast<const double*>(vertices->data()), points.size());
  const Constraints pinned_pairs = {static_cast<const Constraint*>(pairs->data()), constraints.size()};
  const std::pair<std::int32_t, std::size_t> arrays[] = {
      {GCDT_TRIANGLES, 12}, {GCDT_NEIGHBOURS, 12}, {GCDT_CONSTRAINED, 1}, {GCDT_REPRESENTATIVES, 4}};
  std::unique_ptr<Memory> results[4];
  std::vector<double> times;
  for (int run = 0; run <= runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    const Result result = state_->solver.solve(pinned_points, pinned_pairs, options);
    for (int i = 0; i < 4; ++i) {
      const std::uint64_t count = gcdt_result_count(result.handle(), arrays[i].first);
      if (run == 0) results[i] = pin(count * arrays[i].second);
      detail::check(gcdt_result_copy(result.handle(), arrays[i].first, results[i]->data(), count));
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (run > 0) times.push_back(took.count() - result.statistics().ms.build);
  }
  return times;
}

}  // namespace gcdt::bench

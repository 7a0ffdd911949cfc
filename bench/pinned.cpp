// SPDX-License-Identifier: Apache-2.0
#include "pinned.hpp"

#include <chrono>
#include <cstring>
#include <stdexcept>

#include <gcdt/gcdt_cl.hpp>

#include "rates.hpp"

namespace gcdt::bench {

namespace {

constexpr std::int32_t copied[] = {GCDT_TRIANGLES, GCDT_NEIGHBOURS,     GCDT_CONSTRAINED, GCDT_REPRESENTATIVES,
                                   GCDT_PIECES,    GCDT_SOURCE_OFFSETS, GCDT_SOURCES};
constexpr std::size_t array_count_of_mesh = 4, array_count = sizeof copied / sizeof *copied;

}  // namespace

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
  std::unique_ptr<Memory> pin(std::size_t bytes) const { return std::make_unique<Memory>(context, queue, bytes); }

  cl::Context context;
  cl::CommandQueue queue;
  Solver solver;
  std::unique_ptr<Memory> vertices, pairs, results[array_count];
  std::size_t n = 0, m = 0;
};

PinnedCaller::PinnedCaller(const DeviceInfo& device) {
  cl_device_id found = opencl_device(device);
  if (!found) throw std::runtime_error(device.name + " was not found again");
  state_ = std::make_unique<State>(cl::Device(found, true));
}

PinnedCaller::~PinnedCaller() = default;

void PinnedCaller::take(Points points, Constraints constraints) {
  constexpr std::size_t vertex_bytes = 16;
  if (points.type() != Points::Type::float64) throw std::runtime_error("pinned calls are timed with doubles");
  State& s = *state_;
  s.n = points.size(), s.m = constraints.size();
  s.vertices = s.pin(vertex_bytes * s.n), s.pairs = s.pin(sizeof(Constraint) * s.m);
  std::memcpy(s.vertices->data(), points.data(), vertex_bytes * s.n);
  if (s.m > 0) std::memcpy(s.pairs->data(), constraints.data(), sizeof(Constraint) * s.m);
  for (std::unique_ptr<Memory>& memory : s.results) memory.reset();
}

Points PinnedCaller::points() const {
  return Points::pairs(static_cast<const double*>(state_->vertices->data()), state_->n);
}

Constraints PinnedCaller::constraints() const {
  return {static_cast<const Constraint*>(state_->pairs->data()), state_->m};
}

double PinnedCaller::call(const Options& options, bool all) {
  const auto start = std::chrono::steady_clock::now();
  const Result result = state_->solver.solve(points(), constraints(), options);
  const std::size_t wanted = all ? array_count : array_count_of_mesh;
  void* to[array_count];
  std::uint64_t counts[array_count];
  for (std::size_t i = 0; i < wanted; ++i) {
    std::unique_ptr<Memory>& memory = state_->results[i];
    counts[i] = gcdt_result_count(result.handle(), copied[i]);
    if (!memory) memory = state_->pin(counts[i] * gcdt_element_bytes(copied[i]));
    to[i] = memory->data();
  }
  detail::check(gcdt_result_copy_arrays(result.handle(), copied, to, counts, wanted));
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  return took.count() - result.statistics().ms.build;
}

std::vector<double> PinnedCaller::time(Points points, Constraints constraints, const Options& options, int runs) {
  take(points, constraints);
  std::vector<double> times;
  for (int run = 0; run <= runs; ++run) {
    const double ms = call(options);
    if (run > 0) times.push_back(ms);
  }
  return times;
}

}  // namespace gcdt::bench

// SPDX-License-Identifier: Apache-2.0
#include "device_caller.hpp"

#include <chrono>
#include <stdexcept>

#include <gcdt/gcdt_cl.hpp>

#include "rates.hpp"

namespace gcdt::bench {

struct DeviceCaller::State {
  explicit State(const cl::Device& device) : context(device), queue(context, device), solver(make_solver(queue)) {}

  cl::Buffer upload(const void* from, std::size_t bytes) const {
    cl::Buffer buffer = room(bytes);
    if (queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, from) != CL_SUCCESS)
      throw std::runtime_error("queries could not be brought to the device");
    return buffer;
  }
  cl::Buffer room(std::size_t bytes) const {
    cl_int code = CL_SUCCESS;
    cl::Buffer buffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &code);
    if (code != CL_SUCCESS)
      throw std::runtime_error("no device memory for queries: OpenCL error " + std::to_string(code));
    return buffer;
  }

  cl::Context context;
  cl::CommandQueue queue;
  Solver solver;
};

DeviceCaller::DeviceCaller(const DeviceInfo& device) {
  cl_device_id found = opencl_device(device);
  if (!found) throw std::runtime_error(device.name + " was not found again");
  state_ = std::make_unique<State>(cl::Device(found, true));
}

DeviceCaller::~DeviceCaller() = default;

std::vector<double> DeviceCaller::time_locate(Points points, Constraints constraints, const Options& options,
                                              Points queries, int runs) {
  if (queries.type() != Points::Type::float64) throw std::runtime_error("locating is timed with doubles");
  const Result result = state_->solver.solve(points, constraints, options);
  DevicePoints there;
  there.type = Points::Type::float64;
  there.buffer = state_->upload(queries.data(), 16 * queries.size());
  there.count = queries.size();
  const cl::Buffer triangles = state_->room(4 * queries.size()), weights = state_->room(12 * queries.size());
  std::vector<double> times;
  for (int run = 0; run <= runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    locate(result, there, triangles, weights);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (run > 0) times.push_back(took.count());
  }
  return times;
}

}  // namespace gcdt::bench

// SPDX-License-Identifier: Apache-2.0
// An application with an OpenCL context of its own, as the tests of the device interface need it.
#pragma once

#include <doctest/doctest.h>

#include <gcdt/gcdt_cl.hpp>

#include "device/runtime.hpp"
#include "solver_fixture.hpp"
#include "workloads.hpp"

namespace gcdt::test {

/// The device that test_device() names. Fails the test if there is none.
cl::Device app_device();

/// What the device has of these properties of queues; PoCL has all.
cl_command_queue_properties supported(cl_command_queue_properties wanted);

struct App {
  cl::Context context;
  cl::CommandQueue queue;

  explicit App(cl_command_queue_properties properties = 0)
      : context(app_device()), queue(context, app_device(), supported(properties)) {}
  App(cl::Context theirs, const cl::Device& device) : context(std::move(theirs)), queue(context, device) {}

  template <class T>
  cl::Buffer buffer(const std::vector<T>& values, cl_mem_flags flags = CL_MEM_READ_WRITE) const {
    return cl::Buffer(context, flags | CL_MEM_COPY_HOST_PTR, std::max<std::size_t>(values.size(), 1) * sizeof(T),
                      values.empty() ? const_cast<T*>(std::vector<T>(1).data()) : const_cast<T*>(values.data()));
  }
  cl::Buffer buffer(std::size_t bytes, cl_mem_flags flags = CL_MEM_READ_WRITE) const {
    return cl::Buffer(context, flags, bytes);
  }
  template <class T>
  std::vector<T> read(const cl::Buffer& from, std::size_t count, std::size_t first = 0) const {
    std::vector<T> values(count);
    if (count == 0) return values;
    REQUIRE(queue.enqueueReadBuffer(from, CL_TRUE, first * sizeof(T), count * sizeof(T), values.data()) == CL_SUCCESS);
    return values;
  }
};

using Int2 = std::array<std::int32_t, 2>;

/// A constrained input on the grid 0, 0, 1.
struct Integers {
  std::vector<Int2> points;
  std::vector<Constraint> constraints;
};

Integers integer_input(std::size_t points = 300, std::uint64_t seed = 1);

bool same_bytes(const Triangulation& a, const Triangulation& b);

/// What host arrays give on the grid 0, 0, 1.
Triangulation from_host(const Integers& input, Options options = {});

DevicePoints device_points(const App& app, const Integers& input);
DeviceConstraints device_constraints(const App& app, const Integers& input);

/// The error that `f` throws; fails the test if it throws none.
template <class F>
Error error_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error;
  }
  FAIL_CHECK("nothing was thrown");
  return Error(Status::ok, "nothing was thrown");
}

}  // namespace gcdt::test

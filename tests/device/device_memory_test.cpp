// SPDX-License-Identifier: Apache-2.0
// Who allocates what and when: repeated calls allocate nothing, workspaces and hooks are used alone, reference
// counts come back, arguments that are wrong are named and nothing is touched.
#include "opencl_app.hpp"

#include <algorithm>

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Counts what a solver allocates.
struct Meter {
  int allocated = 0, released = 0;
  std::size_t bytes = 0;
  bool refuse = false;

  void watch(Solver& solver) {
    gcdt_cl_allocator hooks = {};
    hooks.struct_size = sizeof hooks;
    hooks.user = this;
    hooks.allocate = [](void* user, cl_context context, cl_mem_flags flags, std::size_t size, cl_int* code) -> cl_mem {
      Meter& meter = *static_cast<Meter*>(user);
      if (meter.refuse) {
        *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return nullptr;
      }
      ++meter.allocated;
      meter.bytes += size;
      return clCreateBuffer(context, flags, size, nullptr, code);
    };
    hooks.release = [](void* user, cl_mem buffer) {
      ++static_cast<Meter*>(user)->released;
      CHECK(clReleaseMemObject(buffer) == CL_SUCCESS);
    };
    detail::check(gcdt_cl_set_allocator(solver.handle(), &hooks));
  }
};

cl_uint references(const App& app) { return app.context.getInfo<CL_CONTEXT_REFERENCE_COUNT>(); }
cl_uint references(const cl::Buffer& buffer) { return buffer.getInfo<CL_MEM_REFERENCE_COUNT>(); }
cl_uint references(const cl::CommandQueue& queue) { return queue.getInfo<CL_QUEUE_REFERENCE_COUNT>(); }

}  // namespace

TEST_CASE("a second identical call allocates nothing, and no call needs more than required_bytes") {
  Meter meter;
  {
    Solver solver(test_device());
    meter.watch(solver);
    for (const std::string& name : workload_names()) {
      const Workload work = workload(name, name == "random_pslg" ? 60 : 20000);
      CAPTURE(name);
      const Triangulation first = solver.triangulate(work.points, work.constraints);
      const int before = meter.allocated;
      const Triangulation second = solver.triangulate(work.points, work.constraints);
      CHECK(meter.allocated == before);
      CHECK(same_bytes(first, second));
      CHECK(first.statistics.peak_device_bytes <= first.statistics.held_device_bytes);
      solver.trim();
      CHECK(meter.allocated == meter.released);
      const Statistics fresh = solver.triangulate(work.points, work.constraints).statistics;
      // Constraints count once for each piece between the vertices on them.
      const std::uint64_t parts = std::max(fresh.m, fresh.constraints_pieces + fresh.constraints_overlapping);
      CHECK(fresh.peak_device_bytes <= required_bytes(fresh.n, parts));
      CHECK(fresh.held_device_bytes <= required_bytes(fresh.n, parts) * 3 / 2);
      solver.trim();
    }
  }
  CHECK(meter.allocated > 0);
  CHECK(meter.allocated == meter.released);
}

TEST_CASE("buffers of sizes that are not asked for again do not pile up") {
  Meter meter;
  Solver solver(test_device());
  meter.watch(solver);
  std::uint64_t held = 0;
  Statistics last;
  for (std::size_t n = 30000; n < 120000; n += n / 10) {
    last = solver.triangulate(uniform(n).points).statistics;
    held = std::max(held, last.held_device_bytes);
  }
  CHECK(held <= 3 * last.peak_device_bytes);
  CHECK(meter.released > 0);
}

TEST_CASE("memory that the hook refuses is an error with OpenCL's code, and the solver works on") {
  Meter meter;
  Solver solver(test_device());
  meter.watch(solver);
  meter.refuse = true;
  const Workload work = uniform(1000);
  const Error error = error_of([&] { solver.triangulate(work.points); });
  CHECK(error.status() == Status::out_of_memory);
  CHECK(error.opencl_code() == CL_MEM_OBJECT_ALLOCATION_FAILURE);
  meter.refuse = false;
  CHECK(same_bytes(solver.triangulate(work.points), test::solver().triangulate(work.points)));
}

TEST_CASE("a result may be released after its solver, and results live side by side") {
  const Integers a = integer_input(), b = integer_input(250, 2);
  std::unique_ptr<Result> kept;
  Triangulation second;
  {
    Solver solver(test_device());
    Options options;
    options.grid = FixedGrid{};
    kept = std::make_unique<Result>(solver.solve(a.points, a.constraints, options));
    second = solver.triangulate(b.points, b.constraints, options);
  }
  CHECK(same_bytes(kept->download(), from_host(a)));
  CHECK(same_bytes(second, from_host(b)));
}

TEST_CASE("a workspace of required_bytes is used alone; one too small is told the size that does") {
  const App app;
  const Integers input = integer_input();
  const Triangulation expected = from_host(input);
  Solver solver = make_solver(app.queue);
  Meter meter;
  meter.watch(solver);
  const DevicePoints points = device_points(app, input);
  const DeviceConstraints constraints = device_constraints(app, input);
  std::uint64_t bytes = 1 << 16;
  int attempts = 0;
  for (; attempts < 10; ++attempts) {
    const cl::Buffer workspace = app.buffer(bytes);
    set_workspace(solver, {workspace});
    try {
      const Result result = solve(solver, points, constraints);
      CHECK(same_bytes(result.download(), expected));
      CHECK(error_of([&] { set_workspace(solver, {}); }).status() == Status::in_use);
      const Error overlap = error_of([&] { enqueue_copy(result, GCDT_TRIANGLES, app.queue, workspace, 10000); });
      CHECK(overlap.status() == Status::buffers_overlap);
      break;
    } catch (const Error& error) {
      REQUIRE(error.status() == Status::workspace_too_small);
      REQUIRE(error.indices().size() == 1);
      REQUIRE(error.indices()[0] > bytes);
      bytes = error.indices()[0];
    }
  }
  CHECK(attempts >= 1);
  CHECK(attempts <= 2);  // what is missing before the first walk, and after it
  CHECK(bytes <= required_bytes(input.points.size(), input.constraints.size()));
  CHECK(meter.allocated == 0);
  const cl::Buffer half = app.buffer(bytes);
  set_workspace(solver, {half});
  CHECK(references(half) == 2);
  CHECK(error_of([&] { solve(solver, {Points::Type::int32, half, 10, 0}); }).status() == Status::buffers_overlap);
  CHECK(error_of([&] { set_workspace(solver, {half, half}); }).status() == Status::buffers_overlap);
  set_workspace(solver, {});
  CHECK(references(half) == 1);
}

TEST_CASE("reference counts of the application's objects are what they were") {
  const App app;
  const Integers input = integer_input();
  const DevicePoints points = device_points(app, input);
  const DeviceConstraints constraints = device_constraints(app, input);
  const cl::Buffer to = app.buffer(1 << 16);
  const auto cycle = [&] {
    Solver solver = make_solver(app.queue);
    CHECK(references(app.queue) >= 2);
    const Result result = solve(solver, points, constraints);
    enqueue_copy(result, GCDT_TRIANGLES, app.queue, to, result.triangle_count()).wait();
    CHECK(error_of([&] {
            solve(solver, {Points::Type::int32, points.buffer, points.count + 1, 0});
          }).status() == Status::buffer_too_small);
  };
  // PoCL's queues keep their last event, which keeps queue and context, in a race with its threads: one reference
  // more or less. So many cycles, of which each would leave one.
  constexpr int cycles = 20;
  constexpr cl_uint race = 2;
  cycle();
  const cl_uint context = references(app), queue = references(app.queue);
  for (int i = 0; i < cycles; ++i) cycle();
  app.queue.finish();
  MESSAGE("context " << context << " then " << references(app) << ", queue " << queue << " then "
                     << references(app.queue));
  CHECK(references(app) <= context + race);
  CHECK(references(app.queue) <= queue + race);
  CHECK(references(points.buffer) == 1);
  CHECK(references(constraints.buffer) == 1);
  CHECK(references(to) == 1);
}

TEST_CASE("what is wrong with what device buffers hold is named, by vertex, end, or pair") {
  const App app;
  const Integers input = integer_input();
  Solver solver = make_solver(app.queue);
  Integers negative = input;
  negative.points[17][1] = -1;
  const Error outside = error_of([&] { solve(solver, device_points(app, negative)); });
  CHECK(outside.status() == Status::coordinate_outside_grid);
  CHECK(outside.indices() == std::vector<std::uint64_t>{17, 1});
  Integers broken = input;
  broken.constraints[5][1] = static_cast<std::uint32_t>(input.points.size());
  const Error index = error_of([&] { solve(solver, device_points(app, broken), device_constraints(app, broken)); });
  CHECK(index.status() == Status::index_out_of_range);
  CHECK(index.indices() == std::vector<std::uint64_t>{5, 1});
  const Integers crossing{{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 2}, {1, 3}}};
  // Constraints that the host may not read are named all the same.
  const DeviceConstraints hidden = {app.buffer(crossing.constraints, CL_MEM_READ_ONLY | CL_MEM_HOST_NO_ACCESS), 2, 0};
  const Error cross = error_of([&] { solve(solver, device_points(app, crossing), hidden); });
  CHECK(cross.status() == Status::constraints_cross);
  CHECK(cross.indices() == std::vector<std::uint64_t>{0, 1});
  CHECK(cross.pair_count() == 1);
}

TEST_CASE("wrong device arguments are named, and nothing of the caller's is touched") {
  const App app, foreign;
  const Integers input = integer_input();
  Solver solver = make_solver(app.queue);
  const DevicePoints points = device_points(app, input);
  const DeviceConstraints constraints = device_constraints(app, input);
  const auto status_of = [&](const DevicePoints& p, const DeviceConstraints& c) {
    return error_of([&] { solve(solver, p, c); }).status();
  };
  CHECK(status_of(device_points(foreign, input), constraints) == Status::wrong_context);
  CHECK(status_of(points, device_constraints(foreign, input)) == Status::wrong_context);
  CHECK(status_of({Points::Type::int32, cl::Buffer(), 3, 0}, {}) == Status::invalid_argument);
  const cl::Buffer write_only = app.buffer(1 << 12, CL_MEM_WRITE_ONLY);
  CHECK(status_of({Points::Type::int32, write_only, 3, 0}, {}) == Status::buffer_access);
  CHECK(status_of({Points::Type::int32, points.buffer, 10, 0}, {points.buffer, 4, 8}) == Status::buffers_overlap);
  const Error beyond = error_of([&] { solve(solver, {Points::Type::int32, points.buffer, 2, points.count - 1}); });
  CHECK(beyond.status() == Status::buffer_too_small);
  CHECK(beyond.indices() == std::vector<std::uint64_t>{points.count + 1, points.count});
  CHECK(status_of({Points::Type::int32, points.buffer, 1, ~std::uint64_t(0)}, {}) == Status::buffer_too_small);
  CHECK(status_of({Points::Type::float64, points.buffer, points.count, 0}, {}) == Status::buffer_too_small);

  const Result result = solve(solver, points, constraints);
  const std::size_t count = result.triangle_count();
  const std::vector<unsigned char> pattern(12 * count, 0x5A);
  const cl::Buffer to = app.buffer(pattern);
  const auto copy_status = [&](const App& of, const cl::Buffer& where, std::uint64_t capacity, std::uint64_t offset) {
    return error_of([&] { enqueue_copy(result, GCDT_TRIANGLES, of.queue, where, capacity, offset); }).status();
  };
  CHECK(copy_status(app, to, count - 1, 0) == Status::buffer_too_small);
  CHECK(copy_status(app, to, count, 1) == Status::buffer_too_small);
  CHECK(copy_status(app, to, ~std::uint64_t(0), 1) == Status::buffer_too_small);
  CHECK(copy_status(app, app.buffer(12 * count, CL_MEM_READ_ONLY), count, 0) == Status::buffer_access);
  CHECK(copy_status(app, foreign.buffer(12 * count), count, 0) == Status::wrong_context);
  CHECK(copy_status(foreign, to, count, 0) == Status::wrong_context);
  CHECK(copy_status(app, buffer_of(result, GCDT_NEIGHBOURS), count, 0) == Status::buffers_overlap);
  std::vector<std::array<std::uint32_t, 3>> host(count - 1, {7, 7, 7});
  CHECK(gcdt_result_copy(result.handle(), GCDT_TRIANGLES, host.data(), host.size()) == GCDT_ERROR_BUFFER_TOO_SMALL);
  CHECK(host == std::vector<std::array<std::uint32_t, 3>>(count - 1, {7, 7, 7}));
  CHECK(app.read<unsigned char>(to, pattern.size()) == pattern);
  CHECK(app.read<Int2>(points.buffer, input.points.size()) == input.points);
  CHECK(app.read<Constraint>(constraints.buffer, input.constraints.size()) == input.constraints);
  CHECK(same_bytes(solve(solver, points, constraints).download(), from_host(input)));
}

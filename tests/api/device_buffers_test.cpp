// SPDX-License-Identifier: Apache-2.0
// Device memory in, device memory out: the same bytes as host arrays, whatever the queue; order is honoured.
#include "opencl_app.hpp"

#include <chrono>
#include <thread>

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Every array of a result through a copy into the application's memory, at an offset, with guards around it.
template <class T>
Array<T> copied(const App& app, const Result& result, std::int32_t array) {
  const std::size_t count = result.count(array), offset = 3;
  REQUIRE(gcdt_element_bytes(array) == sizeof(T));
  std::vector<unsigned char> guard((count + 2 * offset) * sizeof(T), 0xA5);
  const cl::Buffer to = app.buffer(guard);
  enqueue_copy(result, array, app.queue, to, count, offset).wait();
  const auto all = app.read<unsigned char>(to, guard.size());
  for (std::size_t i = 0; i < offset * sizeof(T); ++i)
    if (all[i] != 0xA5 || all[all.size() - 1 - i] != 0xA5) FAIL("memory around the copy was written");
  const std::vector<T> read = app.read<T>(to, count, offset);
  return {read.begin(), read.end()};
}

Triangulation copied(const App& app, const Result& result) {
  Triangulation all;
#define GCDT_ARRAY(number, name, type, width, ...) \
  all.name = copied<gcdt::detail::Element<type, width>>(app, result, number);
#include <gcdt/arrays.def>
  return all;
}

void check_agrees(const App& app) {
  const Integers input = integer_input();
  const Triangulation expected = from_host(input);
  Solver solver = make_solver(app.queue);
  const Result result = solve(solver, device_points(app, input), device_constraints(app, input));
  CHECK(same_bytes(copied(app, result), expected));
  CHECK(same_bytes(result.download(), expected));
  CHECK(result.statistics().grid.kind == Grid::Kind::fixed);
}

}  // namespace

TEST_CASE("host arrays and device buffers give the same bytes, copied to the host, into buffers and used in place") {
  const App app;
  check_agrees(app);
  Integers crossing{{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 2}, {1, 3}}};
  Options drop;
  drop.crossing = Crossing::drop;
  Solver solver = make_solver(app.queue);
  const Result dropped = solve(solver, device_points(app, crossing), device_constraints(app, crossing), drop);
  CHECK(same_bytes(copied(app, dropped), from_host(crossing, drop)));
  CHECK(dropped.dropped() == std::vector<std::uint32_t>{1});
  const auto in_place = app.read<std::array<std::uint32_t, 3>>(buffer_of(dropped, GCDT_TRIANGLES), 2);
  CHECK(in_place == dropped.triangles());
}

TEST_CASE("nothing, few vertices and a line are no errors in device memory either") {
  const App app;
  Solver solver = make_solver(app.queue);
  const Result none = solve(solver, {});
  CHECK(none.triangle_count() == 0);
  CHECK(same_bytes(copied(app, none), from_host({})));
  const Integers line{{{0, 0}, {5, 5}, {9, 9}}, {{0, 2}}};
  const Result flat = solve(solver, device_points(app, line), device_constraints(app, line));
  CHECK(flat.triangle_count() == 0);
  CHECK(flat.statistics().notes.size() == 1);
  CHECK(same_bytes(copied(app, flat), from_host(line)));
}

TEST_CASE("real coordinates in device memory get the grid that host arrays get") {
  const App app;
  Solver solver = make_solver(app.queue);
  const Workload work = uniform(500);
  std::vector<std::array<float, 2>> floats;
  for (const Point& p : work.points) floats.push_back({static_cast<float>(p[0]), static_cast<float>(p[1])});
  const Result wide = solve(solver, {Points::Type::float64, app.buffer(work.points), work.points.size(), 0});
  const Triangulation expected = test::solver().triangulate(work.points);
  CHECK(same_bytes(wide.download(), expected));
  CHECK(wide.statistics().grid.largest_move == expected.statistics.grid.largest_move);
  const Result narrow = solve(solver, {Points::Type::float32, app.buffer(floats), floats.size(), 0});
  CHECK(same_bytes(narrow.download(), test::solver().triangulate(floats)));
  std::vector<std::array<std::int64_t, 2>> longs;  // as far from 0 as they may be
  for (const Point& p : work.points)
    longs.push_back({(std::int64_t{1} << 53) - static_cast<std::int64_t>(p[0] * 1e6),
                     static_cast<std::int64_t>(p[1] * 1e6) - (std::int64_t{1} << 53)});
  const Result whole = solve(solver, {Points::Type::int64, app.buffer(longs), longs.size(), 0});
  CHECK(same_bytes(whole.download(), test::solver().triangulate(longs)));
  CHECK(whole.statistics().grid.kind == Grid::Kind::binary);
}

TEST_CASE("crossings are split in device memory as in host memory") {
  const App app;
  Solver solver = make_solver(app.queue);
  const Integers crossing{{{0, 0}, {9, 8}, {8, 9}, {0, 8}, {3, 0}, {3, 9}}, {{0, 2}, {1, 3}, {4, 5}}};
  Options options;
  options.crossing = Crossing::split;
  const Result split = solve(solver, device_points(app, crossing), device_constraints(app, crossing), options);
  const Triangulation expected = from_host(crossing, options);
  REQUIRE(expected.added.size() == 3);
  CHECK(same_bytes(copied(app, split), expected));
  CHECK(app.read<std::array<std::int32_t, 2>>(buffer_of(split, GCDT_ADDED), 3) == expected.added_on_grid);
  CHECK(app.read<Constraint>(buffer_of(split, GCDT_ADDED_CROSSINGS), 3) == expected.added_crossing);
}

TEST_CASE("offsets and sub-buffers are honoured") {
  const App app;
  const Integers input = integer_input();
  const Triangulation expected = from_host(input);
  Solver solver = make_solver(app.queue);
  // Elements before and after that would be errors or change the mesh.
  std::vector<Int2> points(7, Int2{-1, -1});
  points.insert(points.end(), input.points.begin(), input.points.end());
  points.insert(points.end(), 5, Int2{-1, -1});
  std::vector<Constraint> constraints(11, Constraint{~0u, ~0u});
  constraints.insert(constraints.end(), input.constraints.begin(), input.constraints.end());
  constraints.push_back({~0u, ~0u});
  const cl::Buffer all_points = app.buffer(points), all_constraints = app.buffer(constraints);
  CHECK(same_bytes(copied(app, solve(solver, {Points::Type::int32, all_points, input.points.size(), 7},
                                     {all_constraints, input.constraints.size(), 11})),
                   expected));
  const auto align = app_device().getInfo<CL_DEVICE_MEM_BASE_ADDR_ALIGN>() / 8;
  std::vector<Int2> aligned(align / sizeof(Int2), Int2{-1, -1});
  aligned.insert(aligned.end(), points.begin(), points.end());
  cl::Buffer whole = app.buffer(aligned);
  const cl_buffer_region region = {align, points.size() * sizeof(Int2)};
  cl_int code = CL_SUCCESS;
  const cl::Buffer part = whole.createSubBuffer(CL_MEM_READ_ONLY, CL_BUFFER_CREATE_TYPE_REGION, &region, &code);
  REQUIRE(code == CL_SUCCESS);
  CHECK(same_bytes(copied(app, solve(solver, {Points::Type::int32, part, input.points.size(), 7},
                                     {all_constraints, input.constraints.size(), 11})),
                   expected));
  // In place, without an offset.
  const cl_buffer_region exact = {align, input.points.size() * sizeof(Int2)};
  std::vector<Int2> behind(align / sizeof(Int2), Int2{-1, -1});
  behind.insert(behind.end(), input.points.begin(), input.points.end());
  cl::Buffer holder = app.buffer(behind);
  const cl::Buffer tail = holder.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &exact, &code);
  REQUIRE(code == CL_SUCCESS);
  CHECK(same_bytes(
      solve(solver, {Points::Type::int32, tail, input.points.size(), 0}, device_constraints(app, input)).download(),
      expected));
  CHECK(app.read<Int2>(all_points, points.size()) == points);
  CHECK(app.read<Constraint>(all_constraints, constraints.size()) == constraints);
}

namespace {

/// The vertices as numbers of one type behind `offset` others that would be errors or change the mesh, and before some.
template <class Number>
void check_offsets(Points::Type type, Number bad, Number scale) {
  using Pair = std::array<Number, 2>;
  const App app;
  const Integers input = integer_input();
  std::vector<Pair> given;
  for (const Int2& p : input.points)
    given.push_back({static_cast<Number>(p[0]) * scale, static_cast<Number>(p[1]) * scale});
  const Triangulation expected = test::solver().triangulate(given, input.constraints);
  Solver solver = make_solver(app.queue);
  const Result whole = solve(solver, {type, app.buffer(given), given.size(), 0}, device_constraints(app, input));
  CHECK(same_bytes(whole.download(), expected));
  for (const std::size_t offset : {1, 2, 7}) {  // odd ones are not aligned as vectors of four are
    CAPTURE(offset);
    std::vector<Pair> more(offset, Pair{bad, bad});
    more.insert(more.end(), given.begin(), given.end());
    more.insert(more.end(), 5, Pair{bad, bad});
    std::vector<Constraint> pairs(offset + 1, Constraint{~0u, ~0u});
    pairs.insert(pairs.end(), input.constraints.begin(), input.constraints.end());
    const cl::Buffer vertices = app.buffer(more), constraints = app.buffer(pairs);
    const Result result =
        solve(solver, {type, vertices, given.size(), offset}, {constraints, input.constraints.size(), offset + 1});
    CHECK(same_bytes(result.download(), expected));
    CHECK(app.read<Pair>(vertices, more.size()).back() == more.back());
    // Located with the same offset: the vertices themselves, and the bad ones are not looked at.
    const cl::Buffer to = app.buffer(4 * given.size());
    locate(result, {type, vertices, given.size(), offset}, to);
    CHECK(app.read<std::int32_t>(to, given.size()) == result.locate(given));
  }
}

}  // namespace

TEST_CASE("offsets are counted in pairs of the coordinates' own type") {
  // Finite, since not a number differs from itself; far away, so that one of them would change the grid.
  check_offsets<double>(Points::Type::float64, 1e300, 0.1);
  check_offsets<float>(Points::Type::float32, 1e30f, 0.1f);
  check_offsets<std::int64_t>(Points::Type::int64, std::int64_t{1} << 53, std::int64_t{1} << 40);
}

TEST_CASE("in-order, out-of-order and profiling queues do, and keep their properties") {
  for (const cl_command_queue_properties properties :
       {cl_command_queue_properties(0), cl_command_queue_properties(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE),
        cl_command_queue_properties(CL_QUEUE_PROFILING_ENABLE),
        cl_command_queue_properties(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE | CL_QUEUE_PROFILING_ENABLE)}) {
    const App app(properties);
    check_agrees(app);
    CHECK(app.queue.getInfo<CL_QUEUE_PROPERTIES>() == supported(properties));
  }
}

TEST_CASE("a wait list is waited for, though another thread sets its event late") {
  const Integers input = integer_input(), other = integer_input(200, 2);
  const Triangulation expected = from_host(input);
  for (const cl_command_queue_properties properties : {0, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE}) {
    const App app(static_cast<cl_command_queue_properties>(properties));
    Solver solver = make_solver(app.queue);
    // The vertices arrive by a command that the user event holds back.
    const cl::Buffer points = app.buffer(std::vector<Int2>(input.points.size(), Int2{-1, -1}));
    cl::UserEvent gate(app.context);
    cl::Event written;
    const std::vector<cl::Event> gates = {gate};
    REQUIRE(app.queue.enqueueWriteBuffer(points, CL_FALSE, 0, input.points.size() * sizeof(Int2), input.points.data(),
                                         &gates, &written) == CL_SUCCESS);
    app.queue.flush();
    std::thread late([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      gate.setStatus(CL_COMPLETE);
    });
    const Result result = solve(solver, {Points::Type::int32, points, input.points.size(), 0},
                                device_constraints(app, input), {}, {written});
    late.join();
    CHECK(same_bytes(result.download(), expected));
  }
}

TEST_CASE("a copy waits for its list, its event tells its end, and the result may be gone before") {
  const App app(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE);
  const Integers input = integer_input(), other = integer_input(300, 2);
  Solver solver = make_solver(app.queue);
  const Triangulation expected = from_host(input);
  const cl::Buffer to = app.buffer(expected.triangles.size() * 12);
  cl::UserEvent gate(app.context);
  cl::Event copy;
  {
    const Result result = solve(solver, device_points(app, input), device_constraints(app, input));
    copy = enqueue_copy(result, GCDT_TRIANGLES, app.queue, to, expected.triangles.size(), 0, {gate});
    app.queue.flush();
  }
  CHECK(copy.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() != CL_COMPLETE);
  std::thread late([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    gate.setStatus(CL_COMPLETE);
  });
  // The next call would write over the result: it waits for the copy.
  CHECK(same_bytes(solve(solver, device_points(app, other), device_constraints(app, other)).download(),
                   from_host(other)));
  late.join();
  CHECK(copy.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() == CL_COMPLETE);
  CHECK(app.read<std::array<std::uint32_t, 3>>(to, expected.triangles.size()) == expected.triangles);
}

TEST_CASE("an event of the wait list that fails is an error, and the solver works on") {
  const App app;
  const Integers input = integer_input();
  Solver solver = make_solver(app.queue);
  const DevicePoints points = device_points(app, input);
  cl::UserEvent gate(app.context);
  gate.setStatus(CL_OUT_OF_RESOURCES);
  const Error error = error_of([&] { solve(solver, points, {}, {}, {gate}); });
  CHECK(error.opencl_code() == CL_OUT_OF_RESOURCES);
  CHECK(solve(solver, points).triangle_count() > 0);
}

TEST_CASE("a context with two devices does, on either") {
  // Two of one platform, else the halves of one.
  cl::Device whole = app_device();
  std::vector<cl::Device> parts;
  cl::Platform(whole.getInfo<CL_DEVICE_PLATFORM>()).getDevices(CL_DEVICE_TYPE_ALL, &parts);
  if (parts.size() < 2) {
    const cl_device_partition_property halves[] = {CL_DEVICE_PARTITION_EQUALLY, 1, 0};
    REQUIRE_MESSAGE(whole.createSubDevices(halves, &parts) == CL_SUCCESS, "needs a CPU with two cores, or two GPUs");
  }
  REQUIRE(parts.size() >= 2);
  parts.resize(2);
  const cl::Context both(parts);
  const App first(both, parts[0]), second(both, parts[1]);
  check_agrees(first);
  check_agrees(second);
  // Input made by the queue of one device, triangulated on the other, read by the first again.
  const Integers input = integer_input();
  Solver solver = make_solver(second.queue);
  const Result result = solve(solver, device_points(first, input), device_constraints(first, input));
  CHECK(same_bytes(copied(first, result), from_host(input)));
}

TEST_CASE("any order gives the same mesh as the canonical one") {
  const App app;
  Solver solver = make_solver(app.queue);
  const Integers input = integer_input();
  Options any;
  any.canonical = false;
  Triangulation mesh = solve(solver, device_points(app, input), device_constraints(app, input), any).download();
  CHECK(fault(input.points, input.constraints, mesh) == "");
  const auto sorted = [](Array<std::array<std::uint32_t, 3>> triangles) {
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  };
  CHECK(sorted(mesh.triangles) == sorted(from_host(input).triangles));
}

TEST_CASE("points in device memory are located as host arrays are, with offsets, and domains come out as buffers") {
  const App app;
  const Integers input = integer_input();
  Options options;
  options.domain = Domain::even_odd;
  Solver solver = make_solver(app.queue);
  const Result result = solve(solver, device_points(app, input), device_constraints(app, input), options);
  const Triangulation expected = from_host(input, options);
  CHECK(same_bytes(result.download(), expected));
  CHECK(copied<std::uint32_t>(app, result, GCDT_REGIONS) == expected.region);
  CHECK(copied<std::uint32_t>(app, result, GCDT_DEPTHS) == expected.depth);
  CHECK(copied<std::int32_t>(app, result, GCDT_WINDINGS) == expected.winding);
  CHECK(copied<std::uint32_t>(app, result, GCDT_HULL) == result.hull());
  CHECK(copied<std::int32_t>(app, result, GCDT_VERTEX_TRIANGLES) == result.vertex_triangles());

  std::vector<Int2> queries{{-7, 3}, {100000, 5}};
  Random random(1);
  for (int i = 0; i < 2000; ++i)
    queries.push_back({static_cast<std::int32_t>(random.below(400)), static_cast<std::int32_t>(random.below(400))});
  std::vector<std::array<double, 3>> weights;
  const Array<std::int32_t> triangles = result.locate(queries, &weights);
  const std::size_t skipped = 1, count = queries.size() - skipped;
  const cl::Buffer to = app.buffer(4 * count), shares = app.buffer(12 * count);
  locate(result, {Points::Type::int32, app.buffer(queries), count, skipped}, to, shares);
  CHECK(app.read<std::int32_t>(to, count) == std::vector<std::int32_t>(triangles.begin() + skipped, triangles.end()));
  const auto single = app.read<std::array<float, 3>>(shares, count);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)  // sums and quotients of single precision
      CHECK(std::abs(single[i][k] - weights[i + skipped][k]) <= 0x1p-21);
  const Error small = error_of([&] {
    locate(result, {Points::Type::int32, app.buffer(queries), count, skipped}, app.buffer(4), shares);
  });
  CHECK(small.status() == Status::buffer_too_small);
  CHECK(error_of([&] {
          locate(result, {Points::Type::int32, app.buffer(queries), 1, 0}, buffer_of(result, GCDT_REGIONS));
        }).status() == Status::buffers_overlap);
}

TEST_CASE("vertices in device memory that rounding makes one are counted and refused as those of host arrays are") {
  const App app;
  std::vector<std::array<double, 2>> points = {{7, 7}};
  for (int i = 0; i < 3000; ++i) points.push_back({i % 60 / 3.0, i / 60 / 7.0 + (i % 11 == 0 ? 1e-12 : 0)});
  for (int i = 0; i < 500; ++i) points.push_back({points[5 * i][0], points[5 * i][1] + (i % 2 ? 1e-11 : 0)});
  const Triangulation expected = solver().triangulate(points, {});
  CHECK(expected.statistics.vertices_rounded_together > 100);
  Solver here = make_solver(app.queue);
  const DevicePoints there = {Points::Type::float64, app.buffer(points), points.size(), 0};
  const Statistics found = solve(here, there, {}).statistics();
  CHECK(found.vertices_rounded_together == expected.statistics.vertices_rounded_together);
  CHECK(found.rounded_pair == expected.statistics.rounded_pair);
  Options options;
  options.distinct = true;
  CHECK(error_of([&] { solve(here, there, {}, options); }).status() == Status::vertices_coincide);
}

// SPDX-License-Identifier: Apache-2.0
// Every status comes out of every interface that can meet it: C, C++, the application's buffers, batches, the command.
// What a driver does wrong is a layer's doing (fault_layer.c), so that all else is what users have.
#include <sys/wait.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "cache_folder.hpp"
#include "failure_cases.hpp"
#include "opencl_app.hpp"
#include "scratch_folder.hpp"

#include <gcdt/gcdt_pool.hpp>

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before the loader is first called.
const bool layered = (set_variable("OPENCL_LAYERS", GCDT_FAULT_LAYER), true);

/// Drivers have the faults for the object's life.
class Faults {
 public:
  explicit Faults(Variables variables) : variables_(std::move(variables)) {
    for (const auto& [name, value] : variables_) set_variable(name.c_str(), value);
  }
  ~Faults() {
    for (const auto& [name, value] : variables_) set_variable(name.c_str(), "");
  }
  Faults(const Faults&) = delete;

 private:
  Variables variables_;
};

/// How a call went: the C interface's code, the C++ interface's status, and what was said.
struct Seen {
  std::int32_t code = GCDT_OK;
  Status status = Status::ok;
  std::string said;
};

template <class F>
Seen in_cpp(F&& f) {
  try {
    f();
    return {};
  } catch (const Error& error) {
    return {error.opencl_code(), error.status(), error.what()};
  }
}

template <class F>
Seen in_c(F&& f) {
  Seen seen;
  seen.code = f();
  gcdt_error error = GCDT_ERROR_INIT;
  REQUIRE(gcdt_last_error(nullptr, &error) == GCDT_OK);
  if (seen.code != GCDT_OK) CHECK(error.status == seen.code);
  seen.said = error.message;
  seen.status = gcdt::detail::status_of(seen.code);
  return seen;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void expect_c(const Failure& failure, const Seen& seen) {
  CHECK(seen.code == failure.code);
  CHECK_MESSAGE(contains(seen.said, failure.said), seen.said);
  CHECK(std::string(gcdt_strerror(seen.code)) != gcdt_strerror(1));
}

void expect_cpp(const Failure& failure, const Seen& seen) {
  CHECK(seen.status == failure.status);
  CHECK(seen.code == (failure.code > -20000 ? failure.code : 0));
  CHECK_MESSAGE(contains(seen.said, failure.said), seen.said);
}

struct CBatch {
  std::vector<std::uint64_t> vertices, constraints;
  gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;

  explicit CBatch(const Workload& work) : vertices{0, work.points.size()}, constraints{0, work.constraints.size()} {
    input.problem_count = 1;
    input.vertices = work.points.data(), input.vertex_offsets = vertices.data();
    input.constraints = work.constraints.front().data(), input.constraint_offsets = constraints.data();
  }
};

/// What the command says of the input; "" and 0 if nothing.
std::pair<int, std::string> command(const gcdt::testing::ScratchFolder& folder, const std::string& arguments) {
  const std::string line =
      "'" GCDT_COMMAND "' " + arguments + " >'" + folder / "out" + "' 2>'" + folder / "err" + "' </dev/null";
  const int status = std::system(line.c_str());
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), folder.read("err")};
}

std::string poly(const Workload& work) {
  std::ostringstream text;
  text.precision(17);
  text << work.points.size() << " 2 0 0\n";
  for (std::size_t i = 0; i < work.points.size(); ++i)
    text << i << ' ' << work.points[i][0] << ' ' << work.points[i][1] << '\n';
  text << work.constraints.size() << " 0\n";
  for (std::size_t i = 0; i < work.constraints.size(); ++i)
    text << i << ' ' << work.constraints[i][0] << ' ' << work.constraints[i][1] << '\n';
  text << "0\n";
  return text.str();
}

}  // namespace

TEST_CASE("the layer is there, and does nothing unless it is told to") {
  REQUIRE(layered);
  Solver solver(test_device());
  CHECK(solver.triangulate(uniform(30000).points).triangles.size() > 0);
  const Faults faults(Variables{{"GCDT_FAULT_MEMORY", "12345"}});
  CHECK(Solver(test_device()).device().memory_bytes == 12345);
}

TEST_CASE("what goes wrong has one status in the C interface, in C++ and with the application's buffers") {
  for (const Failure& failure : failures()) {
    CAPTURE(failure.name);
    const gcdt::testing::ScratchFolder folder;
    Variables faults = failure.faults;
    faults.emplace_back("GCDT_FAULT_MATCHED", folder / "matched");
    const Faults scope(faults);
    Solver own(test_device());
    const App app;
    Solver theirs = make_solver(app.queue);
    const Workload& work = failure.work;
    const auto none = reinterpret_cast<gcdt_result*>(&own);
    gcdt_result* result = none;
    gcdt::detail::ProgressCall progress{&failure.options.progress, nullptr};
    const gcdt_options options = gcdt::detail::options(failure.options, progress);
    const gcdt_input input = gcdt::detail::input(work.points, work.constraints);
    expect_c(failure, in_c([&] { return gcdt_triangulate(own.handle(), &input, &options, &result); }));
    gcdt_error error = GCDT_ERROR_INIT;
    REQUIRE(gcdt_last_error(own.handle(), &error) == GCDT_OK);
    CHECK(error.status == failure.code);
    const cl::Buffer points = app.buffer(work.points), constraints = app.buffer(work.constraints);
    gcdt_cl_input buffers = GCDT_CL_INPUT_INIT;
    buffers.coordinate_type = GCDT_FLOAT64;
    buffers.vertices = points(), buffers.vertex_count = work.points.size();
    buffers.constraints = constraints(), buffers.constraint_count = work.constraints.size();
    expect_c(failure,
             in_c([&] { return gcdt_cl_triangulate(theirs.handle(), &buffers, &options, 0, nullptr, &result); }));
    CHECK(result == none);
    expect_cpp(failure, in_cpp([&] { own.triangulate(work.points, work.constraints, failure.options); }));
    expect_cpp(failure, in_cpp([&] {
                 solve(theirs, {Points::Type::float64, points, work.points.size(), 0},
                       {constraints, work.constraints.size(), 0}, failure.options);
               }));
    if (failure.faults.size() > 1) CHECK(folder.read("matched") != "");
  }
}

TEST_CASE("what goes wrong with a problem or its device has the same status in a batch") {
  for (Failure failure : failures()) {
    CAPTURE(failure.name);
    if (failure.status == Status::out_of_memory)  // other devices were asked as well: not the call's code
      failure.code = GCDT_ERROR_OUT_OF_MEMORY, failure.said = "memory";
    const Faults scope(failure.faults);
    const CBatch input(failure.work);
    gcdt::detail::ProgressCall progress{&failure.options.progress, nullptr};
    const gcdt_options options = gcdt::detail::options(failure.options, progress);
    const std::string device = test_device();
    gcdt_pool_options pool_options = GCDT_POOL_OPTIONS_INIT;
    pool_options.devices = device.c_str();
    gcdt_pool* pool = nullptr;
    REQUIRE(gcdt_pool_create(&pool_options, &pool) == GCDT_OK);
    gcdt_batch* batch = nullptr;
    const Seen seen = in_c([&] { return gcdt_pool_triangulate(pool, &input.input, &options, &batch); });
    if (failure.of_device) {
      expect_c(failure, seen);
      CHECK(batch == nullptr);
    } else {
      CHECK(seen.code == GCDT_OK);
      gcdt_problem problem = {};
      problem.struct_size = sizeof problem;
      REQUIRE(gcdt_batch_problem(batch, 0, &problem) == GCDT_OK);
      expect_c(failure, {problem.status, Status::ok, problem.message});
    }
    gcdt_batch_release(batch);
    gcdt_pool_release(pool);
    Pool own(test_device());
    Batch problems;
    problems.add(failure.work.points, failure.work.constraints);
    expect_cpp(failure, in_cpp([&] {
                 const BatchResult result = own.triangulate(problems, failure.options);
                 if (const auto error = result.error(0)) throw *error;
               }));
  }
}

TEST_CASE("what goes wrong has one exit status of the command, for an input and for a folder of them") {
  for (const Failure& failure : failures()) {
    CAPTURE(failure.name);
    if (failure.exit == 0) continue;
    const gcdt::testing::ScratchFolder folder;
    Variables faults = failure.faults;
    faults.emplace_back("GCDT_FAULT_MATCHED", folder / "matched");
    faults.emplace_back("GCDT_DEVICE", test_device());
    const Faults scope(faults);
    const std::string in = folder.write("in.poly", poly(failure.work));
    const auto [exit, said] = command(folder, "triangulate '" + in + "' " + failure.arguments);
    CHECK_MESSAGE(exit == failure.exit, said);
    if (failure.status != Status::index_out_of_range && failure.status != Status::coordinate_not_finite)
      CHECK_MESSAGE(contains(said, failure.said), said);
    CHECK(command(folder, "batch -o '" + folder / "made" + "' '" + in + "' " + failure.arguments).first ==
          failure.exit);
    if (failure.faults.size() > 1) CHECK(folder.read("matched").size() >= 2);
  }
  const gcdt::testing::ScratchFolder folder;
  const std::string in = folder.write("in.poly", poly(uniform(10)));
  CHECK(command(folder, "triangulate '" + in + "'").first == 0);
  CHECK(command(folder, "triangulate '" + in + "' --device none-such").first == 4);
}

TEST_CASE("statuses of arguments alone: sizes, counts, devices, the host's memory and what callbacks throw") {
  const std::vector<Point> points = uniform(100).points;
  const gcdt_input input = gcdt::detail::input(points, {});
  gcdt_result* result = nullptr;
  gcdt_options options = GCDT_OPTIONS_INIT;
  gcdt_input many = input;
  many.vertex_count = std::uint64_t{max_vertices} + 1;
  CHECK(gcdt_triangulate(solver().handle(), &many, &options, &result) == GCDT_ERROR_TOO_MANY_VERTICES);
  CHECK(in_cpp([&] { solver().triangulate(Points::pairs(points.data()->data(), many.vertex_count)); }).status ==
        Status::too_many_vertices);
  options.struct_size = 1;
  CHECK(gcdt_triangulate(solver().handle(), &input, &options, &result) == GCDT_ERROR_STRUCT_SIZE);
  options = GCDT_OPTIONS_INIT;
  options.crossing = 99;
  CHECK(gcdt_triangulate(solver().handle(), &input, &options, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  options = GCDT_OPTIONS_INIT;
  options.progress = [](void*, const char*, double) -> std::int32_t { throw std::runtime_error("mine"); };
  CHECK(gcdt_triangulate(solver().handle(), &input, &options, &result) == GCDT_ERROR_INTERNAL);
  options.progress = [](void*, const char*, double) -> std::int32_t { throw std::bad_alloc(); };
  CHECK(gcdt_triangulate(solver().handle(), &input, &options, &result) == GCDT_ERROR_HOST_MEMORY);
  CHECK_THROWS_AS(gcdt::detail::check(GCDT_ERROR_HOST_MEMORY), std::bad_alloc);
  gcdt_solver_options wanted = GCDT_SOLVER_OPTIONS_INIT;
  wanted.device = "none such";
  gcdt_solver* made = nullptr;
  CHECK(gcdt_solver_create(&wanted, &made) == GCDT_ERROR_NO_DEVICE);
  CHECK(in_cpp([] { Solver of_none("none such"); }).status == Status::no_device);
  CHECK(in_cpp([] { Pool of_none("none such"); }).status == Status::no_device);
  CHECK(result == nullptr);
  CHECK(made == nullptr);
}

TEST_CASE("statuses of the application's buffers") {
  const App app, foreign;
  const Integers work = integer_input();
  Solver solver = make_solver(app.queue);
  const cl::Buffer points = app.buffer(work.points), constraints = app.buffer(work.constraints);
  gcdt_cl_input input = GCDT_CL_INPUT_INIT;
  input.coordinate_type = GCDT_INT32;
  input.vertices = points(), input.vertex_count = work.points.size();
  input.constraints = constraints(), input.constraint_count = work.constraints.size();
  gcdt_result* result = nullptr;
  const auto code = [&](const gcdt_cl_input& of) {
    return gcdt_cl_triangulate(solver.handle(), &of, nullptr, 0, nullptr, &result);
  };
  const auto changed = [&](auto&& change) {
    gcdt_cl_input other = input;
    change(other);
    return code(other);
  };
  const cl::Buffer elsewhere = foreign.buffer(work.points), hidden = app.buffer(work.points, CL_MEM_WRITE_ONLY);
  CHECK(changed([&](gcdt_cl_input& of) { of.vertices = elsewhere(); }) == GCDT_ERROR_WRONG_CONTEXT);
  CHECK(changed([&](gcdt_cl_input& of) { of.vertices = hidden(); }) == GCDT_ERROR_BUFFER_ACCESS);
  CHECK(changed([&](gcdt_cl_input& of) {
          of.constraints = of.vertices;
          of.constraint_count = 10;
        }) == GCDT_ERROR_BUFFERS_OVERLAP);
  CHECK(changed([&](gcdt_cl_input& of) { ++of.vertex_count; }) == GCDT_ERROR_BUFFER_TOO_SMALL);
  const cl::Buffer small = app.buffer(std::size_t{1} << 16);
  const cl_mem handle = small();
  REQUIRE(gcdt_cl_set_workspace(solver.handle(), 1, &handle) == GCDT_OK);
  CHECK(code(input) == GCDT_ERROR_WORKSPACE_TOO_SMALL);
  REQUIRE(gcdt_cl_set_workspace(solver.handle(), 0, nullptr) == GCDT_OK);
  CHECK(result == nullptr);
  REQUIRE(code(input) == GCDT_OK);
  CHECK(gcdt_cl_set_workspace(solver.handle(), 1, &handle) == GCDT_ERROR_IN_USE);
  std::uint32_t corner[3];
  CHECK(gcdt_result_copy(result, GCDT_TRIANGLES, corner, 1) == GCDT_ERROR_BUFFER_TOO_SMALL);
  gcdt_result_release(result);
}

// SPDX-License-Identifier: Apache-2.0
// Each OpenCL call of small runs of every entry point fails, with each error that the specification documents for it
// (tests/support/opencl_calls.def), as tests/support/fault_campaign.hpp says: here some of them, by `scripts/slow.sh
// faults` all.
#include <doctest/doctest.h>

#include "cache_folder.hpp"
#include "fault_campaign.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "result_hash.hpp"

using namespace gcdt;
using namespace gcdt::test;

Calls& gcdt::test::calls() {
  const char* file = std::getenv("GCDT_CALL_LAYER");
  static Calls& of_layer = (solver(), calls_of(file ? file : GCDT_CALL_LAYER));
  return of_layer;
}

namespace {

const Workload& small_graph() {
  static const Workload work = random_pslg(14, 100, 12, 3);
  return work;
}

/// With few vertices, too, all is asked of the device.
runtime::CallHook launching() {
  runtime::CallHook hook = healthy();
  hook.tuning.works_here = false;
  return hook;
}

/// A run of solvers like this one, of one call.
template <class Call>
Open on_solver(const runtime::CallHook& hook, Call call) {
  return [=] {
    const auto made = std::make_shared<Solver>(hooked_solver(hook));
    return Opened{[=] { return call(*made); }};
  };
}

std::uint64_t solved(Solver& on, const Options& options, const Workload& work = small_graph()) {
  return result_hash(on.triangulate(work.points, work.constraints, options));
}

runtime::CallHook as_gpu() {
  runtime::CallHook hook;
  hook.tuning.kind = DeviceKind::gpu;
  hook.tuning.prepares_host_memory = true;
  hook.tuning.least_chunked = 64;
  hook.tuning.transfer_chunk = 256;
  return hook;
}

}  // namespace

TEST_CASE("the layer is there: it counts objects, and makes the call fail that it is told to") {
  const Held before = calls().held();
  {
    const App app;
    const cl::Buffer buffer = app.buffer(100);
    CHECK(calls().held().of(Kind::context) == before.of(Kind::context) + 1);
    CHECK(calls().held().of(Kind::queue) == before.of(Kind::queue) + 1);
    CHECK(calls().held().bytes == before.bytes + 100);
    const cl::Buffer same = buffer;
    calls().begin({"clFinish", 1, 1});
    CHECK(app.queue.flush() == CL_SUCCESS);
    CHECK(app.queue.finish() == CL_OUT_OF_RESOURCES);
    CHECK(app.queue.finish() == CL_SUCCESS);
    CHECK(calls().end().size() == 3);
    CHECK(std::string(calls().failed().first) == "clFinish");
  }
  CHECK(calls().held() == before);
}

// Of devices that are not the one, or do not say their names; and the log of a build that went well. A buffer that
// cannot be had is asked for again when those that nobody uses any more have been given back.
const Rules of_a_new_solver = {
    {"clGetDeviceIDs", "clGetDeviceInfo", "clGetPlatformInfo", "clGetProgramBuildInfo", "clCreateBuffer"}};

TEST_CASE("making a solver, and its first call") {
  campaign(
      40,
      [] {
        return Opened{[] {
          Solver made(test_device());
          return solved(made, {});
        }};
      },
      of_a_new_solver);
}

TEST_CASE("the same where the device is asked for all of it") {
  campaign(
      40,
      [device = app_device()] {
        return Opened{[=] {
          runtime::CallHook compiling = launching();
          compiling.keep_programs = false;
          Solver made = hooked_solver(compiling, {}, device);
          return solved(made, {});
        }};
      },
      of_a_new_solver);
}

TEST_CASE("a call of a solver: constraints, domain, regions") {
  Options options;
  options.domain = Domain::even_odd;
  options.regions = true;
  campaign(20, on_solver(launching(), [=](Solver& on) { return solved(on, options); }));
}

TEST_CASE("a call that splits crossings") {
  Options options;
  options.crossing = Crossing::split;
  campaign(40, on_solver(launching(), [=](Solver& on) {
             return solved(on, options, problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}, {1, 2}}, {{0, 1}, {2, 3}}));
           }));
}

TEST_CASE("a call that refines") {
  Options options;
  options.refine = Refinement{};
  options.refine->most_added = 6;
  campaign(40, on_solver(launching(), [=](Solver& on) { return solved(on, options); }));
}

TEST_CASE("a call of a device treated as a GPU, with pinned memory") {
  campaign(50, on_solver(as_gpu(), [](Solver& on) { return solved(on, {}); }),
           {{"clCreateBuffer", "clEnqueueMapBuffer", "clEnqueueUnmapMemObject"}});
}

TEST_CASE("what is asked of a result: points, values, quality, what is made on demand, refinement") {
  campaign(30, [] {
    const auto made = std::make_shared<Solver>(hooked_solver(launching()));
    const auto result = std::make_shared<Result>(made->solve(small_graph().points, small_graph().constraints));
    return Opened{[=] {
      Hash hash;
      std::vector<std::array<double, 3>> weights;
      const std::vector<Point> points = uniform(20, 5).points;
      hash.add(result->locate(points, &weights));
      hash.add(weights);
      const std::vector<double> values(small_graph().points.size(), 1.5);
      hash.add(result->interpolate(points, values, -1.0));
      hash.add(result->quality().least_angle);
      hash.add(result->hull());
      hash.add(result->vertex_triangles());
      hash.add(result->edge_pieces());
      Refinement wanted;
      wanted.most_added = 4;
      hash.add(result_hash(result->refine(wanted).download()));
      return hash.value();
    }};
  });
}

TEST_CASE("a mesh of another program is adopted") {
  campaign(40, [] {
    const auto made = std::make_shared<Solver>(hooked_solver(launching()));
    const Triangulation mesh = made->triangulate(small_graph().points, small_graph().constraints);
    return Opened{[=] {
      return result_hash(made->adopt(small_graph().points, mesh.triangles, small_graph().constraints).download());
    }};
  });
}

TEST_CASE("the application's buffers and queue, and copies that it waits for") {
  const Rules over_by_then = {{"clWaitForEvents"}};  // the copy, whatever the wait for it says
  const Open open = [] {
    const auto app = std::make_shared<App>();
    const auto made = std::make_shared<Solver>(hooked_solver(launching(), app->queue));
    const Integers work = integer_input(20);
    const auto points = std::make_shared<DevicePoints>(device_points(*app, work));
    const auto constraints = std::make_shared<DeviceConstraints>(device_constraints(*app, work));
    const cl::Buffer to = app->buffer(4096);
    return Opened{[=] {
      Options options;
      options.grid = FixedGrid{};
      const Result result = solve(*made, *points, *constraints, options);
      const cl::Event copied = enqueue_copy(result, GCDT_TRIANGLES, app->queue, to, result.triangle_count());
      Hash hash;
      std::vector<std::uint32_t> corners(3 * result.triangle_count());
      const cl_int code = app->queue.enqueueReadBuffer(to, CL_TRUE, 0, corners.size() * 4, corners.data());
      if (code != CL_SUCCESS) throw Error(Status::device_failed, "the application's own call failed");
      hash.add(corners);
      hash.add(result_hash(result.download()));
      return hash.value();
    }};
  };
  campaign(40, open, over_by_then);
}

namespace {

/// A pool of devices that all may fail. Those that are lost are replaced.
Open on_pool(const std::vector<runtime::CallHook>& hooks, const Options& options) {
  return [=] {
    const auto pool = std::make_shared<Pool>(hooked_pool(hooks).release());
    const Run run = [=] {
      const std::vector<Workload> problems = {small_graph(), uniform(12), problem({{0, 0}, {4, 0}, {0, 4}})};
      const BatchResult result = pool->triangulate(batch_of(problems), options);
      Hash hash;
      for (std::size_t p = 0; p < problems.size(); ++p) {
        if (const auto error = result.error(p)) throw *error;
        hash.add(result_hash(gcdt::detail::triangulation(result, p)));
      }
      return hash.value();
    };
    return Opened{run, [=] {
                    const std::vector<PoolDevice> devices = pool->devices();
                    return std::any_of(devices.begin(), devices.end(), [](const PoolDevice& d) { return d.lost; });
                  }};
  };
}

/// Of one worker, so that its calls are the same each time.
runtime::CallHook by_one_worker() {
  runtime::CallHook hook;
  hook.tuning.workers = 1;
  return hook;
}

const Rules of_pools = {{"all"}, true, true};
const Rules of_one_worker = {{"all"}, false, true};

Options refines_and_splits() {
  Options options;
  options.refine = Refinement{};
  options.refine->most_added = 6;
  options.crossing = Crossing::split;
  return options;
}

Options in_tiles() {
  Options options;
  options.tiles = 3;
  return options;
}

}  // namespace

TEST_CASE("a batch on a pool of one device, by one worker and by two, and of two devices") {
  campaign(40, on_pool({by_one_worker()}, {}), of_one_worker);
  campaign(40, on_pool({{}}, {}), of_pools);
  campaign(40, on_pool({{}, {}}, {}), of_pools);
}

TEST_CASE("a batch on a pool of a device treated as a GPU, whose workers share a context") {
  runtime::CallHook hook = as_gpu();
  hook.tuning.workers = 2;
  hook.tuning.shares_context = true;
  campaign(40, on_pool({hook}, {}), of_pools);
}

TEST_CASE("batches that refine and that split, by one worker") {
  campaign(80, on_pool({by_one_worker()}, refines_and_splits()), of_one_worker);
}

TEST_CASE("batches that refine and that split, on two devices") {
  campaign(80, on_pool({{}, {}}, refines_and_splits()), of_pools);
}

// With many cores which of its buffers is free again in time differs.
TEST_CASE("tiles by one worker") { campaign(50, on_pool({by_one_worker()}, in_tiles()), of_pools); }

TEST_CASE("tiles on two devices") { campaign(50, on_pool({{}, {}}, in_tiles()), of_pools); }

TEST_CASE("making a solver whose programs are in the cache, and its first call") {
  const CacheFolder cache;  // its own: other processes that share the work go through theirs
  // What is in the cache but cannot be taken from there, or put there, is built from its source.
  Rules built = of_a_new_solver;
  built.worked_around.insert({"clCreateProgramWithBinary", "clBuildProgram", "clGetProgramInfo"});
  campaign(
      40,
      [device = app_device()] {
        return Opened{[=] {
          Solver made = hooked_solver(launching(), {}, device);
          return solved(made, {});
        }};
      },
      built);
}

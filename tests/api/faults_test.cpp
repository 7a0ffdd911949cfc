// SPDX-License-Identifier: Apache-2.0
// Each OpenCL call of small runs of every entry point fails, with each error that the specification documents for it
// (tests/support/opencl_calls.def): the call is an Error that says so, or was worked around; nothing leaks; and the
// same object gives the right bytes afterwards. GCDT_FAULT_STEP says which calls: 1, each with each of its errors, as
// `scripts/slow.sh faults` does; N, every N-th, with one of its errors, another each time. GCDT_FAULT_FIRST: from which
// one on.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <set>

#include "call_layer.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "result_hash.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Calls& calls() {
  static Calls& of_layer = (solver(), calls_of(GCDT_CALL_LAYER));
  return of_layer;
}

std::uint64_t from_environment(const char* variable, std::uint64_t usual) {
  const char* given = std::getenv(variable);
  return given ? std::strtoull(given, nullptr, 10) : usual;
}

/// Makes an object, and returns what calls it and returns a hash of all that came out. The object lives as long.
using Run = std::function<std::uint64_t()>;
using Open = std::function<Run()>;

/// What an entry point may do when a call fails.
struct Rules {
  std::set<std::string> worked_around;  ///< functions; "all": other devices do the work
  bool threads = false;                 ///< numbers of calls are not the same each time
  bool lost = false;                    ///< the object may be of no use afterwards, and says so
};

const Workload& small_graph() {
  static const Workload work = random_pslg(14, 100, 12, 3);
  return work;
}

/// How a run went while calls failed.
struct Went {
  std::optional<std::uint64_t> hash;
  std::optional<Error> error;
};

Went go(const Run& run) {
  try {
    return {run(), {}};
  } catch (const Error& error) {
    return {{}, error};
  }
}

bool is_clear(const Error& error) {
  const bool status = error.status() == Status::device_failed || error.status() == Status::out_of_memory ||
                      error.status() == Status::no_device;
  return status && std::string(error.what()).size() > 20;
}

/// Goes through the calls of one entry point.
class Campaign {
 public:
  Campaign(Open open, Rules rules) : open_(std::move(open)), rules_(std::move(rules)), before_(calls().held()) {
    run_ = open_();
    expected_ = run_();
    REQUIRE(run_() == expected_);
    calls().begin();
    REQUIRE(run_() == expected_);
    all_ = calls().end();
    held_ = calls().held();
    REQUIRE(all_.size() > 0);
  }

  void run(std::uint64_t step) {
    for (std::uint64_t k = from_environment("GCDT_FAULT_FIRST", 1); k <= all_.size(); k += step) {
      const std::uint32_t errors = step == 1 ? all_[k - 1].errors : 1;
      for (std::uint32_t e = 0; e < errors; ++e, ++tried_) fail(k, step == 1 ? e : tried_, tried_ % 5 == 4);
    }
    run_ = {};
    CHECK_MESSAGE(calls().held() == before_, calls().held().text());
    MESSAGE(all_.size() << " calls, " << tried_ << " made to fail, " << errors_ << " errors, " << around_
                        << " worked around");
    CHECK(errors_ + around_ > 0);
  }

 private:
  void fail(std::uint64_t k, std::uint32_t error, bool lasting) {
    calls().begin(k, error, lasting);
    const Went went = go(run_);
    calls().end();
    const auto [function, code] = calls().failed();
    CAPTURE(k);
    CAPTURE(std::string(function ? function : "no call"));
    CAPTURE(code);
    CAPTURE(lasting);
    CAPTURE(std::string(went.error ? went.error->what() : ""));
    if (!rules_.threads) CHECK(function != nullptr);
    if (went.hash) {
      ++around_;
      CHECK(*went.hash == expected_);
      const auto& may = rules_.worked_around;
      CHECK((!function || may.count("all") > 0 || may.count(function) > 0));
    } else {
      ++errors_;
      CHECK(is_clear(*went.error));
    }
    const Went again = go(run_);
    if (again.hash) return check_after(*again.hash);
    CAPTURE(std::string(again.error->what()));
    CHECK(rules_.lost);
    run_ = {};
    CHECK_MESSAGE(calls().held() == before_, calls().held().text());
    run_ = open_();
    CHECK(run_() == expected_);
  }

  /// Buffers are kept by size, and what a call did not reach it does not keep: they are counted when all is gone. So
  /// are those of pools, each of whose workers makes what its problems need.
  void check_after(std::uint64_t hash) {
    CHECK(hash == expected_);
    const Held held = calls().held();
    if (rules_.threads) return;
    for (const Kind kind : {Kind::context, Kind::queue, Kind::program, Kind::kernel, Kind::event})
      CHECK_MESSAGE(held.of(kind) <= held_.of(kind), std::string(kind_names[static_cast<std::size_t>(kind)]));
    CHECK(held.of(Kind::memory) <= held_.of(Kind::memory) + 8);
  }

  Open open_;
  Rules rules_;
  Held before_, held_;
  Run run_;
  std::uint64_t expected_ = 0, errors_ = 0, around_ = 0;
  std::uint32_t tried_ = 0;
  std::vector<Called> all_;
};

void campaign(std::uint64_t usual_step, const Open& open, Rules rules = {}) {
  for (const char* release : {"clReleaseContext", "clReleaseCommandQueue", "clReleaseMemObject", "clReleaseProgram",
                              "clReleaseKernel", "clReleaseEvent"})
    rules.worked_around.insert(release);
  Campaign(open, rules).run(from_environment("GCDT_FAULT_STEP", usual_step));
}

/// A run of solvers like this one, of one call.
template <class Call>
Open on_solver(const runtime::CallHook& hook, Call call) {
  return [=] {
    const auto made = std::make_shared<Solver>(hooked_solver(hook));
    return Run([=] { return call(*made); });
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
    calls().begin(2, 1);
    CHECK(app.queue.flush() == CL_SUCCESS);
    CHECK(app.queue.finish() == CL_OUT_OF_RESOURCES);
    CHECK(app.queue.finish() == CL_SUCCESS);
    CHECK(calls().end().size() == 3);
    CHECK(std::string(calls().failed().first) == "clFinish");
  }
  CHECK(calls().held() == before);
}

TEST_CASE("making a solver, and its first call") {
  // Of devices that are not the one, or do not say their names; and the log of a build that went well.
  const Rules passed_over = {{"clGetDeviceIDs", "clGetDeviceInfo", "clGetPlatformInfo", "clGetProgramBuildInfo"}};
  campaign(
      110,
      [] {
        return Run([] {
          Solver made(test_device());
          return solved(made, {});
        });
      },
      passed_over);
}

TEST_CASE("a call of a solver: constraints, domain, regions") {
  Options options;
  options.domain = Domain::even_odd;
  options.regions = true;
  campaign(30, on_solver(healthy(), [=](Solver& on) { return solved(on, options); }));
}

TEST_CASE("a call that splits crossings") {
  Options options;
  options.crossing = Crossing::split;
  campaign(90, on_solver(healthy(), [=](Solver& on) {
             return solved(on, options, problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}, {1, 2}}, {{0, 1}, {2, 3}}));
           }));
}

TEST_CASE("a call that refines") {
  Options options;
  options.refine = Refinement{};
  options.refine->most_added = 6;
  campaign(90, on_solver(healthy(), [=](Solver& on) { return solved(on, options); }));
}

TEST_CASE("a call of a device treated as a GPU, with pinned memory") {
  campaign(150, on_solver(as_gpu(), [](Solver& on) { return solved(on, {}); }),
           {{"clCreateBuffer", "clEnqueueMapBuffer", "clEnqueueUnmapMemObject"}});
}

TEST_CASE("what is asked of a result: points, values, quality, what is made on demand, refinement") {
  campaign(60, [] {
    const auto made = std::make_shared<Solver>(hooked_solver(healthy()));
    const auto result = std::make_shared<Result>(made->solve(small_graph().points, small_graph().constraints));
    return Run([=] {
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
    });
  });
}

TEST_CASE("a mesh of another program is adopted") {
  campaign(40, [] {
    const auto made = std::make_shared<Solver>(hooked_solver(healthy()));
    const Triangulation mesh = made->triangulate(small_graph().points, small_graph().constraints);
    return Run([=] {
      return result_hash(made->adopt(small_graph().points, mesh.triangles, small_graph().constraints).download());
    });
  });
}

TEST_CASE("the application's buffers and queue, and copies that it waits for") {
  const Rules over_by_then = {{"clWaitForEvents"}};  // the copy, whatever the wait for it says
  const Open open = [] {
    const auto app = std::make_shared<App>();
    const auto made = std::make_shared<Solver>(hooked_solver(healthy(), app->queue));
    const Integers work = integer_input(20);
    const auto points = std::make_shared<DevicePoints>(device_points(*app, work));
    const auto constraints = std::make_shared<DeviceConstraints>(device_constraints(*app, work));
    const cl::Buffer to = app->buffer(4096);
    return Run([=] {
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
    });
  };
  campaign(40, open, over_by_then);
}

namespace {

/// A pool of two devices, which both may fail.
Open on_pool(const std::vector<runtime::CallHook>& hooks, const Options& options) {
  return [=] {
    const auto pool = std::make_shared<Pool>(hooked_pool(hooks).release());
    return Run([=] {
      const std::vector<Workload> problems = {small_graph(), uniform(12), problem({{0, 0}, {4, 0}, {0, 4}})};
      const BatchResult result = pool->triangulate(batch_of(problems), options);
      Hash hash;
      for (std::size_t p = 0; p < problems.size(); ++p) {
        if (const auto error = result.error(p)) throw *error;
        hash.add(result_hash(gcdt::detail::triangulation(result, p)));
      }
      return hash.value();
    });
  };
}
const Rules of_pools = {{"all"}, true, true};

}  // namespace

TEST_CASE("a batch on a pool of one device, and of two") {
  campaign(60, on_pool({healthy()}, {}), of_pools);
  campaign(60, on_pool({healthy(), healthy()}, {}), of_pools);
}

TEST_CASE("a batch on a pool of a device treated as a GPU, whose workers share a context") {
  runtime::CallHook hook = as_gpu();
  hook.tuning.workers = 2;
  hook.tuning.shares_context = true;
  campaign(200, on_pool({hook}, {}), of_pools);
}

TEST_CASE("batches that refine and that split") {
  Options options;
  options.refine = Refinement{};
  options.refine->most_added = 6;
  options.crossing = Crossing::split;
  campaign(300, on_pool({healthy(), healthy()}, options), of_pools);
}

TEST_CASE("tiles") {
  Options options;
  options.tiles = 3;
  campaign(150, on_pool({healthy(), healthy()}, options), of_pools);
}

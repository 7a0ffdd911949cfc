// SPDX-License-Identifier: Apache-2.0
// A wrong mesh is withheld wherever a mesh is returned, whatever is wrong with it, by the status that says so; and is
// returned as it is where the caller has turned the check off.
#include "withheld_cases.hpp"

#include <numeric>
#include <thread>

#include "batch/single.hpp"
#include "device_list.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// What a way to triangulate answers.
struct Answer {
  Status status = Status::ok;
  std::string message;
  std::vector<Triangulation> meshes;  ///< of a batch: of each problem
};

using Way = std::function<Answer(const WithheldCase&, const Options&)>;

template <class F>
Answer answer_of(F&& meshes) {
  try {
    return {Status::ok, "", meshes()};
  } catch (const Error& error) {
    return {error.status(), error.what(), {}};
  }
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void is_withheld(const WithheldCase& one, const Answer& answer, const std::string& reason) {
  CHECK(answer.status == Status::check_failed);
  CHECK_MESSAGE(contains(answer.message, "check: "), answer.message);
  CHECK_MESSAGE(contains(answer.message, reason.empty() ? one.reason : reason), answer.message);
  CHECK(answer.meshes.empty());
}

bool same(const Triangulation& mesh, const HostResult& host) {
  const HostResult own = withheld::on_host(mesh);
  return own.corners == host.corners && own.neighbours == host.neighbours && own.constrained == host.constrained;
}

/// One wrong mesh among the answers, or one for each run of a batch, and the others right.
void returned_as_it_is(const WithheldCase& one, const Answer& answer) {
  CHECK_MESSAGE(answer.status == Status::ok, answer.message);
  std::size_t wrong = 0;
  for (const Triangulation& mesh : answer.meshes) {
    if (same_bytes(mesh, one.right)) continue;
    ++wrong;
    if (one.wrong) CHECK(same(mesh, *one.wrong));
  }
  CHECK(wrong == (one.everywhere ? answer.meshes.size() : 1));
}

/// `of_runs`: what is said of a problem whose hull is not covered, where many share a mesh.
void each_case(const FaultyDevice& device, const Way& way, const std::string& of_runs = "") {
  for (const WithheldCase& one : device.cases) {
    CAPTURE(one.name);
    const bool counted = contains(one.reason, "corner of any") || contains(one.reason, "no triangles");
    is_withheld(one, way(one, one.options), counted ? of_runs : "");
    if (!one.returnable) continue;
    Options unchecked = one.options;
    unchecked.check = false;
    returned_as_it_is(one, way(one, unchecked));
  }
}

/// The edits have met the programs that the test has used.
void met(const std::vector<TextEdit>& edits) {
  for (const TextEdit& edit : edits) CHECK_MESSAGE(*edit.matched > 0, edit.from);
}

Answer on_host(Solver& solver, const WithheldCase& one, const Options& options) {
  return answer_of(
      [&] { return std::vector<Triangulation>{solver.triangulate(one.work.points, one.work.constraints, options)}; });
}

/// Runs of a batch's worker, which a pool would end with the first that fails: of copies of one problem, or of one that
/// is to be split alone.
class Worker {
 public:
  Worker(const runtime::CallHook& hook, std::size_t copies)
      : runtime_(app_device(), hook), primitives_(runtime_), staging_(runtime_), copies_(copies) {}

  Answer operator()(const WithheldCase& one, const Options& options) {
    const RaggedBatch batch(std::vector<Workload>(copies_, one.work));
    std::vector<std::uint32_t> numbers(copies_);
    std::iota(numbers.begin(), numbers.end(), 0u);
    const Answer answer = answer_of([&] {
      const ForestResult made =
          options.crossing == Crossing::split
              ? triangulate_single(runtime_, primitives_, batch.view(), 0, options)
              : triangulate_forest(runtime_, primitives_, batch.view(), numbers, options, staging_);
      std::vector<Triangulation> meshes;
      for (std::size_t p = 0; p < copies_; ++p) meshes.push_back(test::part_of(made, p));
      return meshes;
    });
    if (answer.status != Status::ok) runtime_.try_finish(), primitives_.release();
    return answer;
  }

 private:
  runtime::Runtime runtime_;
  Primitives primitives_;
  Staging staging_;
  std::size_t copies_;
};

const FaultyDevice& faulty() {
  static const FaultyDevice device;
  return device;
}

runtime::CallHook without_one_item(runtime::CallHook hook) {
  hook.tuning.one_item_vertices = 0;
  return hook;
}

// Before any test lists devices.
const std::vector<cl::Device> all_devices = every_device();

constexpr char not_covered[] = "do not cover its hull once";

/// Crossing constraints on a coarse lattice, so that what is rounded goes through many pixels.
Workload tangle(std::uint64_t seed) {
  Workload work = random_crossing(40, 30, 14, seed);
  for (Point& p : work.points) p = {1000 * p[0], 1000 * p[1]};
  return work;
}

/// All edges of a mesh are constraints, as they are when it is adopted: none has to be Delaunay.
Workload net(std::uint64_t seed) {
  Workload work = withheld::crowded(60, seed);
  const Triangulation mesh = test::solver().triangulate(work.points, {}, withheld::on_grid());
  work.constraints.clear();
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) work.constraints.push_back({t[k], t[(k + 1) % 3]});
  return work;
}

const std::vector<std::string> of_nets = {"orientation", "a link cut on one side", "a slit",
                                          "a piece without its flag"};
const std::vector<std::string> of_any_input = {"orientation", "a link cut on one side", "a flag too many",
                                               "a piece without its flag", "a flip undone"};

}  // namespace

TEST_CASE("a single call withholds every kind of wrong mesh, by one work-item and by many") {
  for (const bool few : {true, false}) {
    CAPTURE(few);
    Solver solver = hooked_solver(few ? faulty().hook() : without_one_item(faulty().hook()));
    each_case(faulty(), [&](const WithheldCase& one, const Options& options) { return on_host(solver, one, options); });
    const Workload other = uniform(500);  // the device is right where it is not made to err
    CHECK(same_bytes(solver.triangulate(other.points), test::solver().triangulate(other.points)));
  }
  met(faulty().gathers);
}

TEST_CASE("a call from the application's buffers withholds every kind of wrong mesh") {
  const App app;
  Solver solver = hooked_solver(faulty().hook(), app.queue);
  each_case(faulty(), [&](const WithheldCase& one, const Options& options) {
    const DevicePoints points = {Points::Type::float64, app.buffer(one.work.points), one.work.points.size(), 0};
    const DeviceConstraints constraints = {app.buffer(one.work.constraints), one.work.constraints.size(), 0};
    return answer_of(
        [&] { return std::vector<Triangulation>{solve(solver, points, constraints, options).download()}; });
  });
}

TEST_CASE("a batch withholds every kind of wrong mesh, problem by problem and all at once, by one work-item and many") {
  for (const bool few : {true, false})
    for (const std::size_t count : {std::size_t{1}, withheld_copies()}) {
      CAPTURE(few);
      CAPTURE(count);
      Worker worker(few ? faulty().hook() : without_one_item(faulty().hook()), count);
      each_case(faulty(), std::ref(worker), not_covered);
    }
  met(faulty().gathers);
  met(faulty().phases);
}

TEST_CASE("every device withholds a flip undone, a slit and a flag too many") {
  CHECK(all_devices.size() >= 2);
  for (const cl::Device& device : all_devices) {
    if (device() == app_device()()) continue;
    CAPTURE(device.getInfo<CL_DEVICE_NAME>());
    Solver solver = hooked_solver(faulty().hook(), {}, device);
    for (const char* name : {"a flip undone", "a slit", "a flag too many"}) {
      const WithheldCase& one = faulty().of(name);
      CAPTURE(one.name);
      is_withheld(one, on_host(solver, one, one.options), "");
      Options unchecked = one.options;
      unchecked.check = false;
      returned_as_it_is(one, on_host(solver, one, unchecked));
    }
  }
}

TEST_CASE("a device whose meshes fail the check is lost to its pool, and the others' meshes are returned") {
  const WithheldCase& one = faulty().of("a flip undone");
  const std::vector<Workload> problems(withheld_copies(), one.work);
  // The right one waits until the other is lost.
  std::atomic<bool> started{false}, lost{false};
  runtime::CallHook waiting = healthy();
  waiting.before = [&](const char* call, const char*) {
    const auto due = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (started && !lost && call == std::string("clEnqueueNDRangeKernel") && std::chrono::steady_clock::now() < due)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return CL_SUCCESS;
  };
  const auto handle = hooked_pool({faulty().hook(), waiting}, [&](int, const char* message) {
    lost = lost || contains(message, "is taken out of the pool: check: ");
  });
  DevicePool& pool = *handle->devices;
  started = true;
  Singles(problems, one.options).check(pool.triangulate(RaggedBatch(problems).view(), one.options));
  REQUIRE(pool.report(0).lost);
  CHECK(pool.report(0).lost->status() == Status::check_failed);
  CHECK(!pool.report(1).lost);
}

TEST_CASE("what is split, dropped, cut to a domain or adopted is withheld if the whole mesh is wrong") {
  const FaultyDevice device({{of_any_input, tangle, withheld::on_grid(Crossing::drop)},
                             {of_any_input, tangle, withheld::on_grid(Crossing::split)},
                             {of_nets, net, withheld::on_grid()}});
  REQUIRE(device.cases.size() == 2 * of_any_input.size() + of_nets.size());
  Solver solver = hooked_solver(device.hook());
  Worker worker(device.hook(), 1);  // in a batch what crosses is split alone
  each_case(device, [&](const WithheldCase& one, const Options& options) { return on_host(solver, one, options); });
  each_case(device, std::ref(worker));
  met(device.gathers);
  for (const WithheldCase& one : device.cases) {
    CAPTURE(one.name);
    Options options = one.options;
    const bool adopted = one.work.constraints.size() > 100;
    if (!adopted) REQUIRE(one.right.statistics.crossings > 0);
    options.domain = Domain::outer;
    is_withheld(one, on_host(solver, one, options), "");
    if (!adopted) continue;
    const auto adopt = [&](Solver& by) {
      return answer_of([&] {
        return std::vector<Triangulation>{by.adopt(one.work.points, one.right.triangles, {}, one.options).download()};
      });
    };
    is_withheld(one, adopt(solver), "");
    CHECK(adopt(test::solver()).status == Status::ok);
  }
}

TEST_CASE("each function of the C interface that fails the check gives its status, and no result") {
  const WithheldCase& one = faulty().of("a flip undone");
  const App app;
  Solver own = hooked_solver(faulty().hook()), theirs = hooked_solver(faulty().hook(), app.queue);
  const gcdt_input input = gcdt::detail::input(one.work.points, one.work.constraints);
  gcdt_options options = GCDT_OPTIONS_INIT;
  options.fixed_grid = 1, options.grid_cell = "1";
  const auto no_result = reinterpret_cast<gcdt_result*>(&own);
  gcdt_result* result = no_result;
  gcdt_error error = GCDT_ERROR_INIT;
  CHECK(gcdt_triangulate(own.handle(), &input, &options, &result) == GCDT_ERROR_CHECK_FAILED);
  REQUIRE(gcdt_last_error(own.handle(), &error) == GCDT_OK);
  CHECK(error.status == GCDT_ERROR_CHECK_FAILED);
  CHECK(contains(error.message, "check: "));
  CHECK(error.index_count == 2);  // the ends of the edge
  gcdt_cl_input buffers = GCDT_CL_INPUT_INIT;
  const cl::Buffer points = app.buffer(one.work.points), constraints = app.buffer(one.work.constraints);
  buffers.coordinate_type = GCDT_FLOAT64;
  buffers.vertices = points(), buffers.vertex_count = one.work.points.size();
  buffers.constraints = constraints(), buffers.constraint_count = one.work.constraints.size();
  CHECK(gcdt_cl_triangulate(theirs.handle(), &buffers, &options, 0, nullptr, &result) == GCDT_ERROR_CHECK_FAILED);
  CHECK(result == no_result);
  const RaggedBatch batch({one.work, one.work});
  gcdt_batch_input problems = GCDT_BATCH_INPUT_INIT;
  problems.problem_count = 2;
  problems.vertices = batch.vertices.data(), problems.vertex_offsets = batch.vertex_offsets.data();
  problems.constraints = batch.constraints.front().data();
  problems.constraint_offsets = batch.constraint_offsets.data();
  const auto pool = hooked_pool({faulty().hook()});
  const auto no_batch = reinterpret_cast<gcdt_batch*>(&own);
  gcdt_batch* made = no_batch;
  CHECK(gcdt_pool_triangulate(pool.get(), &problems, &options, &made) == GCDT_ERROR_CHECK_FAILED);
  CHECK(made == no_batch);
  gcdt_pool_device device = {};
  device.struct_size = sizeof device;
  REQUIRE(gcdt_pool_device_get(pool.get(), 0, &device) == GCDT_OK);
  CHECK(device.status == GCDT_ERROR_CHECK_FAILED);
  // The solvers work on.
  gcdt_input few = input;
  few.constraint_count = 0;
  CHECK(gcdt_triangulate(own.handle(), &few, &options, &result) == GCDT_OK);
  gcdt_result_release(result);
}

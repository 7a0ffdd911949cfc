// SPDX-License-Identifier: Apache-2.0
#include "solve/at_once.hpp"

#include <optional>
#include <vector>

#include "device/step.hpp"
#include "phases/check.hpp"
#include "phases/grow.hpp"

namespace gcdt {

namespace {

using runtime::LaunchTimes;
using runtime::Runtime;

// Output, check and numbers, launched.
struct Finish {
  LaunchedMesh mesh;
  runtime::Buffer<device::CheckReport> report;
  runtime::Buffer<cl_uint> representatives;
  HostCopies copies;
  cl::Event put, checked, numbered;  // the launches
};

// Numbers wait for the check on the device: if it finds a fault, corners stay vertices, by which check() tells it.
Finish launch_finish(Run& run, const LaunchTimes& times, const Vertices& vertices, bool behind_growth) {
  Runtime& runtime = run.runtime;
  Finish f;
  f.mesh = launch_output(runtime, run.primitives, run.mesh, vertices, behind_growth ? &run.counters : nullptr);
  f.put = times.last();
  f.report = launch_check(runtime, run.plan, f.mesh, vertices, run.pieces);
  f.checked = times.last();
  f.representatives = launch_numbers(runtime, vertices, f.mesh, run.pieces, f.report);
  f.numbered = times.last();
  if (!run.copied) return f;
  f.copies.add(f.mesh.mesh.corners);
  f.copies.add(f.mesh.mesh.neighbours);
  f.copies.add(f.mesh.mesh.constrained);
  f.copies.add(f.representatives);
  f.copies.add(run.pieces.ends);
  f.copies.add(run.pieces.source_offsets);
  f.copies.add(run.pieces.sources);
  return f;
}

// What the host waits for: the report, and the result, which it mostly is.
std::vector<runtime::HostRead> reads_of(Finish& f, device::CheckReport& found) {
  std::vector<runtime::HostRead> reads = {{f.report.handle(), &found, sizeof found}};
  f.copies.append_reads(reads);
  return reads;
}

FinishedMesh finished(Finish f, const device::CheckReport& found, std::uint32_t vertices, std::uint32_t pieces) {
  FinishedMesh made;
  made.mesh = std::move(f.mesh).of(found.triangles);
  if (gcdt_check_passed(found, vertices, pieces)) {
    made.representatives = std::move(f.representatives);
    made.copies = std::move(f.copies);
  }
  return made;
}

// All that is left is done by one work-item each, and nothing of it needs the host.
bool may_finish(const Run& run, std::uint32_t vertices) {
  const Plan& plan = run.plan;
  const Options& options = run.options;
  const bool by_one = plan.output == Plan::By::one && plan.check == Plan::By::one && plan.number == Plan::By::one;
  return by_one && vertices >= 3 && options.canonical && options.check && !options.refine && !run.wants_regions() &&
         run.runtime.may_time_launches();
}

// Takes what was launched behind the order out of the order's time, and returns how long it took, of `all`.
double share_time(Run& run, double all, const cl::Event& ordered, const cl::Event& grown, const Finish* f) {
  auto& ms = run.statistics.ms;
  if (LaunchTimes::milliseconds_between(ordered, f ? f->numbered : grown) > all) return 0;  // clocks that do not agree
  const double insert = LaunchTimes::milliseconds_between(ordered, grown);
  double behind = insert;
  if (f) {
    const double check = LaunchTimes::milliseconds_between(f->put, f->checked);
    ms.gather = LaunchTimes::milliseconds_between(grown, f->put);
    behind = LaunchTimes::milliseconds_between(ordered, f->numbered);
    ms.check += check;
    ms.output += behind - insert - check;
  }
  ms.insert += insert;
  ms.order -= behind;
  return behind;
}

}  // namespace

bool may_begin_at_once(const Run& run, std::uint32_t inputs) {
  return run.plan.order == Plan::By::one && grows_by_one_launch(run.plan, inputs) && run.runtime.may_time_launches();
}

OrderResult begin_at_once(Run& run, InputPoints points) {
  Runtime& runtime = run.runtime;
  const Stopwatch watch(runtime);
  const LaunchTimes times(runtime);
  LaunchedOrder order = launch_order(runtime, run.plan, std::move(points), run.options.grid);
  const cl::Event ordered = times.last();
  const Vertices& distinct = order.vertices;
  run.mesh = make_mesh(runtime, distinct.n(), distinct.roots);
  run.lists = make_work_lists(runtime, distinct.n(), distinct.roots);
  launch_grow(runtime, run.plan, distinct, run.mesh, run.lists, run.counters);
  const cl::Event grown = times.last();
  std::optional<Finish> finish;
  if (run.m == 0 && may_finish(run, distinct.n())) {
    run.no_pieces();
    finish = launch_finish(run, times, distinct, true);
  }

  device::OrderReport report;
  device::CheckReport found;
  std::vector<runtime::HostRead> reads = {{order.report.handle(), &report, sizeof report}, run.counters.to_read()};
  if (finish)
    for (const runtime::HostRead& read : reads_of(*finish, found)) reads.push_back(read);
  runtime.read_all(reads);
  const double all = watch.milliseconds();
  OrderResult result = finish_order(runtime, std::move(order), report);
  result.sort_ms = all;
  run.grown = result.merged == 0;
  if (!run.grown) {
    run.mesh = {};
    run.lists = {};
    return result;
  }
  result.sort_ms -= share_time(run, all, ordered, grown, finish ? &*finish : nullptr);
  if (finish && grew_all(run.counters.last()))
    run.finished = finished(std::move(*finish), found, result.vertices.n(), 0);
  return result;
}

bool may_finish_at_once(const Run& run) { return run.finished || may_finish(run, run.vertices.n()); }

void finish_at_once(Run& run) {
  auto& ms = run.statistics.ms;
  run.step("output", ms.output, 1, [&] {
    run.begin_output();
    if (run.finished) return;
    const Stopwatch watch(run.runtime);
    const LaunchTimes times(run.runtime);
    Finish f = launch_finish(run, times, run.vertices, false);
    device::CheckReport found;
    run.runtime.read_all(reads_of(f, found));
    const double check_ms = LaunchTimes::milliseconds_between(f.put, f.checked);
    ms.gather = watch.milliseconds() - LaunchTimes::milliseconds_between(f.put, f.numbered);
    ms.check += check_ms;
    ms.output -= check_ms;
    run.finished = finished(std::move(f), found, run.vertices.n(), run.pieces.count);
  });
  run.mesh = {};
  OrderedMesh ordered = std::move(run.finished->mesh);
  run.result.representatives = std::move(run.finished->representatives);
  run.result.copies = std::move(run.finished->copies);
  if (!run.result.representatives.allocated())  // a fault, or no triangles
    run.step("check", ms.check, [&] { check(run.runtime, run.plan, ordered, run.vertices, run.pieces); });
  run.step("output", ms.output, [&] { run.number(std::move(ordered)); });
}

}  // namespace gcdt

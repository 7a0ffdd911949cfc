// SPDX-License-Identifier: Apache-2.0
// The trace: its spans nest, and agree with the statistics of the same call.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

double ms(const TraceSpan& span) { return double(span.end_ns - span.begin_ns) / 1e6; }

bool holds(const TraceSpan& outer, const TraceSpan& inner) {
  return outer.begin_ns <= inner.begin_ns && inner.end_ns <= outer.end_ns;
}

struct Traced {
  std::vector<TraceSpan> spans;
  Statistics statistics;
};

Traced traced(const Workload& work) {
  Traced result;
  Solver solver(test_device(), {}, [&](const TraceSpan& span) { result.spans.push_back(span); });
  solver.solve(work.points, work.constraints);  // builds
  result.spans.clear();
  result.statistics = solver.solve(work.points, work.constraints).statistics();
  return result;
}

}  // namespace

TEST_CASE("launches lie in their phases, one after the other, and sums agree with the statistics") {
  const Traced run = traced(workload("random_pslg", 60));
  const Statistics& s = run.statistics;
  std::map<std::string, double> phases;
  std::vector<TraceSpan> outer, launches;
  for (const TraceSpan& span : run.spans) {
    CHECK(span.begin_ns <= span.end_ns);
    CHECK(span.device == s.device);
    CHECK(span.device_number == 0);
    (span.on_device ? launches : outer).push_back(span);
    if (!span.on_device) phases[span.name] += ms(span);
  }
  CHECK(launches.size() == s.launches);
  std::uint64_t end = 0;
  for (const TraceSpan& launch : launches) {
    CHECK(launch.begin_ns >= end);
    end = launch.end_ns;
    CHECK(std::any_of(outer.begin(), outer.end(),
                      [&](const TraceSpan& phase) { return phase.name == launch.phase && holds(phase, launch); }));
  }
  for (const TraceSpan& phase : outer)
    if (phase.name != phase.phase)
      CHECK(std::any_of(outer.begin(), outer.end(),
                        [&](const TraceSpan& other) { return other.name == phase.phase && holds(other, phase); }));
  CHECK(std::count_if(outer.begin(), outer.end(), [](const TraceSpan& span) {
          return span.phase == "plan" && span.name.compare(0, 9, "order by ") == 0;
        }) == 1);
  const std::map<std::string, double> told = {{"order", s.ms.order},   {"insert", s.ms.insert},
                                              {"flip", s.ms.flip},     {"check", s.ms.check},
                                              {"output", s.ms.output}, {"constrain", s.ms.constrain}};
  for (const auto& [name, milliseconds] : told) {
    CAPTURE(name);
    CHECK(phases[name] >= milliseconds);
    CHECK(phases[name] < milliseconds + 5);  // building programs, which is none, and two readings of a clock
  }
}

TEST_CASE("launches before an inner phase of their phase keep their time") {
  const Traced run = traced(uniform(20000));  // quantised, then sorted
  double quantised = 0;
  for (const TraceSpan& span : run.spans)
    if (span.on_device && span.name == "quantise") quantised += ms(span);
  CHECK(quantised > 0);
}

TEST_CASE("a call that fails leaves nothing in the next one's trace") {
  std::vector<TraceSpan> spans;
  Solver solver(test_device(), {}, [&](const TraceSpan& span) { spans.push_back(span); });
  const Workload work = uniform(500);
  CHECK_THROWS_AS(solver.solve(work.points, std::vector<Constraint>{{0, 500}}), Error);
  spans.clear();
  const Statistics s = solver.solve(work.points).statistics();
  CHECK(std::count_if(spans.begin(), spans.end(), [](const TraceSpan& span) { return span.on_device; }) ==
        static_cast<long>(s.launches));
  CHECK(std::count_if(spans.begin(), spans.end(), [](const TraceSpan& span) { return span.name == "order"; }) == 1);
}

TEST_CASE("what a trace function throws is dropped, and the result is the same") {
  const Workload work = uniform(500);
  Solver throwing(test_device(), {}, [](const TraceSpan&) { throw std::runtime_error("mine"); });
  CHECK(throwing.triangulate(work.points).triangles == solver().triangulate(work.points).triangles);
}

TEST_CASE("options of the version without a trace are taken as before") {
  const std::string device = test_device();
  gcdt_solver_options options = GCDT_SOLVER_OPTIONS_INIT;
  options.struct_size = offsetof(gcdt_solver_options, trace);
  options.device = device.c_str();
  options.trace = [](void*, const gcdt_trace_span*) { FAIL("not a member of that version"); };
  gcdt_solver* made = nullptr;
  REQUIRE(gcdt_solver_create(&options, &made) == GCDT_OK);
  CHECK(Solver(made).triangulate(uniform(50).points).triangles.size() > 0);
}

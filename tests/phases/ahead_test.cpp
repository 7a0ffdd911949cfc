// SPDX-License-Identifier: Apache-2.0
// Pieces that are enforced ahead of the others (phases/ahead.hpp): the result is the same, with less to walk, and what
// crosses is found as ever.
#include <doctest/doctest.h>

#include "kinds.hpp"
#include "solve/triangulate.hpp"
#include "workloads.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::uint32_t always = 0, never = 0xFFFFFFFFu;

/// What a call gives, or how it fails.
struct Seen {
  std::vector<cl_uint> corners, ends, sources, dropped;
  std::string error;
  std::vector<std::uint64_t> indices;
  bool operator==(const Seen& o) const {
    return corners == o.corners && ends == o.ends && sources == o.sources && dropped == o.dropped && error == o.error &&
           indices == o.indices;
  }
};

struct Called {
  Seen seen;
  Statistics statistics;
};

template <class T>
std::vector<cl_uint> words_of(runtime::Runtime& runtime, const runtime::Buffer<T>& buffer, std::size_t count) {
  std::vector<cl_uint> words(count * sizeof(T) / sizeof(cl_uint));
  if (count > 0) runtime.read_bytes(buffer.handle(), 0, words.data(), count * sizeof(T));
  return words;
}

Called call(runtime::Runtime& runtime, const Workload& work, std::optional<std::uint32_t> crossings_ahead,
            Crossing policy = Crossing::reject) {
  Tuning tuning = runtime.tuning();
  tuning.crossings_ahead = crossings_ahead;
  const Tuned tuned(runtime, tuning);
  Primitives primitives(runtime);
  runtime.memory().begin_call();
  Options options;
  options.crossing = policy;
  const Points points = work.points;
  const Constraints constraints = work.constraints;
  Called called;
  try {
    const DeviceTriangulation made = triangulate(runtime, primitives, source_of(runtime, points, constraints), options);
    called.seen.corners = words_of(runtime, made.mesh.corners, 3 * std::size_t{made.mesh.triangles});
    called.seen.ends = words_of(runtime, made.pieces.ends, made.pieces.count);
    called.seen.sources = words_of(runtime, made.pieces.sources, made.pieces.source_count);
    called.seen.dropped = words_of(runtime, made.dropped, made.dropped.size());
    called.statistics = made.statistics;
  } catch (const Error& error) {
    called.seen.error = error.what();
    called.seen.indices = error.indices();
  }
  return called;
}

/// Parallel lines, and one more from the lower end of line `from` to the upper end of line `to`.
Workload lines_and_one(std::uint32_t lines, std::uint32_t from, std::uint32_t to) {
  Workload work;
  for (std::uint32_t i = 0; i < lines; ++i) {
    work.points.push_back({64.0 * i, double(i % 3)});
    work.points.push_back({64.0 * i, 4000.0 + i % 5});
    work.constraints.push_back({2 * i, 2 * i + 1});
    work.points.push_back({64.0 * i + 31, 100.0 + 97 * (i * 7 % 40)});  // for the lines to cross faces
  }
  work.constraints.push_back({2 * from, 2 * to + 1});
  return work;
}

}  // namespace

TEST_CASE("the result is the same, and pieces cross fewer faces") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    const std::size_t n = runtime.kind() == DeviceKind::lanes ? 1000 : 4000;
    // sunray, hub: spokes of one vertex, whose first edges make it one of many faces.
    for (const char* name : {"sunray", "hub", "fan", "letters", "spiral", "star"}) {
      CAPTURE(name);
      const Workload work = workload(name, n);
      const Called at_once = call(runtime, work, never), in_turn = call(runtime, work, always);
      CHECK(at_once.seen.error == "");
      CHECK(at_once.seen == in_turn.seen);
      const Statistics &a = at_once.statistics, &b = in_turn.statistics;
      CHECK(b.cases.existing_edges + b.cases.pieces_walked == b.constraints_pieces);
      CHECK(a.constraints_pieces == b.constraints_pieces);
      CHECK(b.crossed_pairs <= a.crossed_pairs + a.crossed_pairs / 8 + 8);
      if (name == std::string("sunray") && n == 4000) CHECK(3 * b.crossed_pairs < 2 * a.crossed_pairs);
    }
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(seed);
      const Workload work = random_pslg(300, seed % 2 == 0 ? 40 : 100000, 200, seed);
      CHECK(call(runtime, work, never).seen == call(runtime, work, always).seen);
    }
  }
}

TEST_CASE("few crossings: all at once") {
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    const Workload work = workload("letters", 1000);
    CHECK(call(*device.runtime, work, {}).statistics.crossed_pairs ==
          call(*device.runtime, work, never).statistics.crossed_pairs);
  }
}

// Wherever the one that crosses stands among the pieces: ahead, or among the rest.
TEST_CASE("what crosses is found, dropped and split as ever") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    const bool lanes = runtime.kind() == DeviceKind::lanes;
    for (std::uint32_t from = 1; from < 36; from += lanes ? 17 : 5) {
      CAPTURE(from);
      const Workload work = lines_and_one(40, from, from + 3);
      for (const Crossing policy : {Crossing::reject, Crossing::drop, Crossing::split}) {
        const Seen at_once = call(runtime, work, never, policy).seen,
                   in_turn = call(runtime, work, always, policy).seen;
        CHECK((at_once.error != "") == (policy == Crossing::reject));
        CHECK(at_once == in_turn);
      }
    }
    for (std::uint64_t seed = 1; seed <= (lanes ? 1 : 4); ++seed) {
      CAPTURE(seed);
      const Workload work = random_crossing(100, 1000, 60, seed);
      for (const Crossing policy : {Crossing::reject, Crossing::drop, Crossing::split})
        CHECK(call(runtime, work, never, policy).seen == call(runtime, work, always, policy).seen);
    }
  }
}

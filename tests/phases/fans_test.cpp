// SPDX-License-Identifier: Apache-2.0
// Vertices with many faces: their fans, and walks that begin there or pass through.
#include "phases/fans.hpp"
#include "constrain/fan.h"
#include "constraint_oracle.hpp"
#include "kinds.hpp"
#include "phases/clean.hpp"
#include "phases/constrain.hpp"

using namespace fixture;

namespace {

constexpr std::uint32_t coarsest = 16;

struct Input {
  std::string name;
  std::vector<Point> points;
  std::vector<Constraint> constraints;
};

/// Points on a circle around a hub, each with its reflection in the hub: constraints from one to the other pass through
/// it. And constraints that begin in the hub.
Input wheel(std::int64_t rim) {
  Input input{"wheel", {{1 << 20, 1 << 20}}, {}};
  const double pi = 3.14159265358979;
  for (std::int64_t i = 0; i < rim / 2; ++i) {
    const double angle = pi * static_cast<double>(i) / static_cast<double>(rim / 2);
    const auto x = static_cast<std::int64_t>(1e6 * std::cos(angle)),
               y = static_cast<std::int64_t>(1e6 * std::sin(angle));
    input.points.push_back({(1 << 20) + x, (1 << 20) + y});
    input.points.push_back({(1 << 20) - x, (1 << 20) - y});
  }
  for (std::uint32_t i = 1; i < input.points.size(); i += 2)
    input.constraints.push_back(i % 4 == 1 ? Constraint{i, i + 1} : Constraint{0, i});
  return input;
}

/// Points on a circle around a hub, most of them in a sixth of it, and constraints from the hub to a third of them: the
/// middle of a fan is far from the middle of its angles. `turned`: by how many eighths.
Input uneven_wheel(std::int64_t rim, int turned) {
  Input input{"uneven wheel " + std::to_string(turned), {{1 << 20, 1 << 20}}, {}};
  const double pi = 3.14159265358979;
  for (std::int64_t i = 0; i < rim; ++i) {
    const double whole = static_cast<double>(i) / static_cast<double>(rim);
    const double at = whole < 0.7 ? whole / 0.7 / 6 : 1.0 / 6 + (whole - 0.7) / 0.3 * 5 / 6;
    const double angle = 2 * pi * at + pi / 4 * turned;
    input.points.push_back({(1 << 20) + static_cast<std::int64_t>(1e6 * std::cos(angle)),
                            (1 << 20) + static_cast<std::int64_t>(1e6 * std::sin(angle))});
    if (i % 3 == 0) input.constraints.push_back({0, static_cast<std::uint32_t>(i + 1)});
  }
  return input;
}

/// A row between two hubs, which are on the hull and have a constraint between them: across the row, or through a
/// vertex of it. Constraints from one hub to the row beside.
Input row(std::int64_t length, bool through_vertex) {
  const std::int64_t x = length + (through_vertex ? 0 : 1), y = 1 << 20;
  Input input{
      through_vertex ? "row through a vertex" : "row across an edge", {{x, y - length}, {x, y + length}}, {{0, 1}}};
  for (std::int64_t i = 0; i < length; ++i) input.points.push_back({2 * i, y});
  for (std::uint32_t i = 0; i < 20; ++i)
    input.constraints.push_back({0, 2 + i * static_cast<std::uint32_t>(length) / 20});
  return input;
}

std::vector<Input> inputs() {
  std::vector<Input> all = {wheel(1200), row(1000, false), row(1000, true)};
  for (int turned = 0; turned < 8; ++turned) all.push_back(uneven_wheel(700, turned));
  return all;
}

/// Every vertex of GCDT_FAN_LEAST faces and more has them all in its fan, each beside the next; no other has any.
void check_rings(const HostMesh& m, const std::vector<cl_uint>& begins, const std::vector<cl_uint2>& fans) {
  std::vector<std::uint32_t> degree(m.n, 0);
  for (const cl_uint4& c : m.corners)
    for (int k = 0; k < 3; ++k)
      if (c.s[k] < m.n) ++degree[c.s[k]];
  for (std::uint32_t v = 0; v < m.n; ++v) {
    const std::uint32_t size = begins[v + 1] - begins[v];
    REQUIRE(size == (degree[v] >= GCDT_FAN_LEAST ? degree[v] : 0));
    std::set<std::uint32_t> faces;
    for (std::uint32_t i = 0; i < size; ++i) {
      const cl_uint2 own = fans[begins[v] + i], next = fans[begins[v] + (i + 1) % size];
      const cl_uint* c = m.corners[own.s[0]].s;
      const auto k = static_cast<std::uint32_t>(std::find(c, c + 3, v) - c);
      REQUIRE(k < 3);
      CHECK(c[(k + 1) % 3] == own.s[1]);
      CHECK(c[(k + 2) % 3] == next.s[1]);
      faces.insert(own.s[0]);
    }
    CHECK(faces.size() == size);
    if (size > 0) CHECK(fans[begins[v]].s[1] < m.n);
  }
}

/// `flipped`: as where threads insert one vertex after the other; else the mesh before its last flips.
struct Walked : MeshOnDevice {
  Walked(runtime::Runtime& on, const Input& input, bool flipped)
      : MeshOnDevice(on, input.points, coarsest), constraints(renumbered(input.constraints, input.points, points)) {
    insert_all(flipped);
    if (flipped) history = freeze_all(runtime, vertices, mesh, counters);
    counters.zero();
  }
  CleanResult clean(Primitives& primitives) {
    const auto staged = stage(runtime, constraints);
    Cleaner cleaner(runtime, primitives, vertices, staged, n());
    return cleaner.clean(walked(), cleaner.keep(plan, {}), counters);
  }
  std::vector<Constraint> constraints;
};

template <class Check>
void on_all(Check&& check) {
  for (test::Treated& device : test::devices_as_all_kinds())
    for (const Input& input : inputs())
      for (const bool flipped : {false, true}) {
        CAPTURE(device.name);
        CAPTURE(input.name);
        CAPTURE(flipped);
        Walked walked(*device.runtime, input, flipped);
        check(*device.runtime, input, flipped, walked);
      }
}

}  // namespace

TEST_CASE("fans are the faces around vertices with many, in their order, from a finite corner") {
  on_all([](runtime::Runtime& runtime, const Input&, bool flipped, Walked& walked) {
    Primitives primitives(runtime);
    const Fans fans = make_fans(runtime, primitives, walked.vertices, walked.mesh, walked.counters);
    CHECK(fans.made);
    CHECK(walked.counters.read().failed == 0);
    std::vector<cl_uint> begins(walked.n() + 1);
    runtime.read(fans.begins, begins.data(), begins.size());
    std::vector<cl_uint2> faces(begins.back());
    runtime.read(fans.faces, faces.data(), faces.size());
    if (flipped) CHECK(!faces.empty());  // else the hub may be a late vertex, with few faces
    check_rings(walked.now(), begins, faces);
  });
}

TEST_CASE("constraints that begin at a vertex with many faces, or pass through it, are split where vertices are") {
  on_all([](runtime::Runtime& runtime, const Input& input, bool flipped, Walked& walked) {
    Primitives primitives(runtime);
    CleanResult clean = walked.clean(primitives);
    if (flipped) CHECK(walked.history.fans.made);  // else the hub may be a late vertex, with few faces
    const std::set<Constraint> expected = expected_pieces(walked.points, walked.constraints);
    CHECK(read_pieces(runtime, clean.pieces) == expected);
    if (input.name == "wheel") CHECK(clean.hits == input.constraints.size() / 2);
    const ConstrainResult result = constrain(runtime, primitives, walked.plan, walked.vertices, walked.mesh,
                                             walked.history, clean.pieces, walked.counters);
    REQUIRE(result.failed == 0);
    CHECK(!walked.history.fans.made);
    CHECK(marked_edges(walked.now()) == expected);
  });
}

// A turn passes a quarter of a hub's faces in the mean, or half.
TEST_CASE("a walk does not turn past all faces of a vertex") {
  const Input input = wheel(8000);
  for (test::Treated& device : test::devices_as_all_kinds()) {
    CAPTURE(device.name);
    Walked walked(*device.runtime, input, true);
    walked.plan.least_parts = walked.plan.most_parts = 0;  // whole constraints
    Primitives primitives(*device.runtime);
    walked.clean(primitives);
    const device::Counters& c = walked.counters.last();
    const std::uint64_t steps = wide(c.steps_low, c.steps_high), walks = input.constraints.size();
    CHECK(steps > walks);
    CHECK(steps < walks * (2 * GCDT_FAN_LEAST));
    // A thread has many walks. The first ones that fail take its patience away.
    if (device.runtime->kind() == DeviceKind::threads) CHECK(steps < walks * (4 * GCDT_LEAST_PATIENCE));
  }
}

TEST_CASE("inputs whose vertices have few faces make no fans") {
  for (test::Treated& device : test::devices_as_all_kinds()) {
    CAPTURE(device.name);
    runtime::Runtime& runtime = *device.runtime;
    Random random{7};
    Input input{"random", {}, {}};
    for (int i = 0; i < 3000; ++i) {
      const std::int64_t x = random.below(1 << 20);
      input.points.push_back({x, random.below(1 << 20)});
    }
    input.points = along_curve(input.points);
    for (std::uint32_t i = 0; i < 40; ++i) input.constraints.push_back({i, i + 2000});
    Walked walked(runtime, input, false);
    Primitives primitives(runtime);
    CHECK(read_pieces(runtime, walked.clean(primitives).pieces) == expected_pieces(walked.points, walked.constraints));
    CHECK(!walked.history.fans.made);
  }
}

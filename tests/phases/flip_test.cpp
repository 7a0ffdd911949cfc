// SPDX-License-Identifier: Apache-2.0
// Properties of the flip phase, by each of its ways (sweeps, lists, one work-group, with stamps that run out), on
// devices as what they are and as GPUs.
#include "phases/flip.hpp"

#include <numeric>

#include "kinds.hpp"
#include "mesh_fixture.hpp"
#include "oracle.hpp"

using namespace fixture;
using test::GridPoint;

namespace {

constexpr std::uint32_t none = 0, all = 0xFFFFFFFFu;

struct Way {
  std::string name;
  std::uint32_t least_sweep, sweep_share, one_group_edges, most_stamps;
  std::uint32_t least_patched = all, patch_vertices = 0, rounds_of_patch = 0, district_vertices = 0;
};

// A share of `all` edges: sweeps until there is no illegal edge.
const Way ways[] = {{"sweeps", none, all, none, all},
                    {"sweeps, then lists", none, 16, none, all},
                    {"lists", all, 1, none, all},
                    {"lists, then one group", all, 1, 300, all},
                    {"one group", all, 1, all, all},
                    {"sweeps, few stamps", none, all, none, 2},
                    {"lists, few stamps", all, 1, none, 3},
                    {"one group, few stamps", all, 1, all, 3},
                    {"patches", all, 1, all, all, none, 1024, 64},
                    {"small patches", all, 1, all, all, none, 40, 64},
                    {"patches of a vertex", none, all, none, all, none, 1, 64},
                    {"patches of few rounds, sweeps", none, all, none, all, none, 50, 2},
                    {"patches of no round, lists", all, 1, none, all, none, 50, none},
                    {"districts", all, 1, all, all, none, 40, 64, 60},
                    {"one district", all, 1, none, all, none, 24, 64, 1024},
                    {"districts of a vertex", all, 1, none, all, none, 8, 64, 1},
                    {"districts of few rounds, lists", all, 1, none, all, none, 8, 2, 24}};

Tuning tuning_of(const runtime::Runtime& runtime, const Way& way) {
  Tuning tuning = runtime.tuning();
  tuning.least_sweep = way.least_sweep, tuning.sweep_share = way.sweep_share;
  tuning.one_group_edges = way.one_group_edges, tuning.most_stamps = way.most_stamps;
  tuning.least_patched = way.least_patched, tuning.patch_vertices = way.patch_vertices;
  tuning.rounds_of_patch = way.rounds_of_patch;
  tuning.least_divided = way.district_vertices > 0 ? none : all, tuning.district_vertices = way.district_vertices;
  return tuning;
}

using Ends = std::pair<std::uint32_t, std::uint32_t>;

bool has_two_sides(const HostMesh& m, std::uint32_t e) {
  return m.edge_faces[2 * e] != GCDT_NONE && m.edge_faces[2 * e + 1] != GCDT_NONE;
}

// The ends of an edge with two sides, and the vertices across from it, ascending.
std::pair<Ends, Ends> quadrilateral(const HostMesh& m, std::uint32_t e) {
  const cl_uint r = m.edge_faces[2 * e], other = m.edge_faces[2 * e + 1];
  const cl_uint* c = m.corners[r >> 2].s;
  const cl_uint p = c[r & 3], q = m.corners[other >> 2].s[other & 3];
  return {std::minmax({c[((r & 3) + 1) % 3], c[((r & 3) + 2) % 3]}), std::minmax({p, q})};
}

bool is_finite(const HostMesh& m, const Ends& ends) { return ends.second < m.n; }

// By CGAL: is the edge with these ends illegal, where these vertices are across from it? All are finite.
bool illegal(const HostMesh& m, const std::pair<Ends, Ends>& of) {
  const auto point = [&](std::uint32_t v) { return GridPoint{m.points[v][0], m.points[v][1]}; };
  GridPoint a = point(of.first.first), b = point(of.first.second), p = point(of.second.first),
            q = point(of.second.second);
  if (test::orientation(a, b, p) < 0) std::swap(p, q);
  const int circle = test::in_circle(a, b, p, q);
  if (circle != 0) return circle > 0;
  return std::min(a, b) != std::min({a, b, p, q});
}

// Edges that flips have to come back to, and that are not queued.
std::size_t forgotten_edges(const HostMesh& m) {
  std::size_t count = 0;
  for (std::uint32_t e = 0; e < m.edges; ++e) {
    const cl_uint r0 = m.edge_faces[2 * e], r1 = m.edge_faces[2 * e + 1];
    if (!has_two_sides(m, e) || (m.marks[e] & (GCDT_MARK_CONSTRAINED | GCDT_MARK_QUEUED))) continue;
    const cl_uint *a = m.corners[r0 >> 2].s, *b = m.corners[r1 >> 2].s;
    const cl_uint k = r0 & 3;
    count += device::gcdt_must_flip(m.vertex(a[(k + 2) % 3]), m.vertex(a[k]), m.vertex(a[(k + 1) % 3]),
                                    m.vertex(b[r1 & 3])) != 0;
  }
  return count;
}

std::size_t queued_edges(const HostMesh& m) {
  return std::size_t(std::count_if(m.marks.begin(), m.marks.end(), [](cl_uint w) { return w & GCDT_MARK_QUEUED; }));
}

// What CGAL makes of the points and the marked edges.
std::set<std::array<std::uint32_t, 3>> expected_faces(const HostMesh& m) {
  std::vector<std::array<std::uint32_t, 2>> constraints;
  for (std::uint32_t e = 0; e < m.edges; ++e)
    if (m.marks[e] & GCDT_MARK_CONSTRAINED) {
      const Ends ends = quadrilateral(m, e).first;
      constraints.push_back({ends.first, ends.second});
    }
  return fixture::expected_faces(m.points, constraints);
}

// All vertices inserted at once, no edge flipped.
struct Unflipped : MeshOnDevice {
  Unflipped(runtime::Runtime& on, std::vector<Point> given) : MeshOnDevice(on, std::move(given), all) { insert(0); }
  void mark(const HostMesh& m) const { runtime.write(mesh.edge_marks, m.marks.data(), m.marks.size()); }
  FlipResult flip(const Progress& progress = {}) {
    ticker = Ticker(progress);
    return MeshOnDevice::flip();
  }
};

// Marks one in `one_in` of the finite edges; 0: none.
void constrain_some(Unflipped& mesh, std::uint32_t one_in) {
  HostMesh m = mesh.now();
  Random random{one_in};
  for (std::uint32_t e = 0; one_in > 0 && e < m.edges; ++e)
    if (has_two_sides(m, e) && is_finite(m, quadrilateral(m, e).first) && random.below(one_in) == 0)
      m.marks[e] |= GCDT_MARK_CONSTRAINED;
  mesh.mark(m);
}

template <class Test>
void for_all_ways(Test test) {
  for (test::Treated& device : test::devices_as_all_kinds())
    for (const Way& way : ways) {
      CAPTURE(device.name);
      CAPTURE(way.name);
      Tuning tuning = tuning_of(*device.runtime, way);
      tuning.rounds_per_read = tuning.rounds_of_group = 1;  // the caller is asked after each round
      const test::Tuned tuned(*device.runtime, tuning);
      test(*device.runtime);
    }
}

// All devices as GPUs that slide in each round of few edges, the first one, too.
std::vector<test::Treated> gpus_that_slide() {
  std::vector<test::Treated> made;
  for (const cl::Device& device : test::every_device()) {
    runtime::CallHook hook = test::treated_as(DeviceKind::gpu);
    hook.options = "-DGCDT_SLIDE_SHARE=0xFFFFFFFFu -DGCDT_SLIDE_PAUSE=0u";
    auto gpu = std::make_unique<runtime::Runtime>(device, hook);
    const std::string platform = gpu->info().platform;
    made.push_back({platform + " that slides", std::move(gpu)});
  }
  return made;
}

// Gives the faces, but for the root's, each other's numbers, as enforced constraints that cross much do.
void mix_faces(Unflipped& mesh) {
  const HostMesh m = mesh.now();
  std::vector<cl_uint> number(m.faces);
  std::iota(number.begin(), number.end(), 0u);
  Random random{3};
  for (std::uint32_t t = m.faces; t-- > 2;) std::swap(number[t], number[1 + random.below(t)]);
  std::vector<cl_uint4> face_data(2 * std::size_t{m.faces});
  for (std::uint32_t t = 0; t < m.faces; ++t) {
    face_data[GCDT_CORNERS(number[t])] = m.corners[t];
    face_data[GCDT_SIDES(number[t])] = m.sides[t];
  }
  std::vector<cl_uint> edge_faces(2 * std::size_t{m.edges});
  std::transform(m.edge_faces.begin(), m.edge_faces.end(), edge_faces.begin(), [&](cl_uint ref) {
    return ref == GCDT_NONE ? ref : number[GCDT_REF_FACE(ref)] << 2 | GCDT_REF_CORNER(ref);
  });
  mesh.runtime.write(mesh.mesh.face_data, face_data.data(), face_data.size());
  mesh.runtime.write(mesh.mesh.edge_faces, edge_faces.data(), edge_faces.size());
}

// The ends of the constrained edges.
std::set<Ends> constrained(const HostMesh& m) {
  std::set<Ends> ends;
  for (std::uint32_t e = 0; e < m.edges; ++e)
    if (m.marks[e] & GCDT_MARK_CONSTRAINED) ends.insert(quadrilateral(m, e).first);
  return ends;
}

// Flips a mesh that has illegal edges, with a look at it after each round, up to CGAL's triangulation.
void flip_and_watch(Unflipped& mesh) {
  const HostMesh before = mesh.now();
  REQUIRE(illegal_edges(before) > 0);
  std::uint64_t rounds = 0;
  const FlipResult result = mesh.flip([&](const char*, double) {
    const HostMesh m = mesh.now();
    CHECK(invalid_reason(m, m.n) == "");
    CHECK(forgotten_edges(m) == 0);
    ++rounds;
    return true;
  });
  const HostMesh flipped = mesh.now();
  const auto& within = mesh.counters.last().patch_rounds;
  CHECK(rounds + std::accumulate(std::begin(within), std::end(within), std::uint64_t{0}) == result.rounds);
  CHECK(result.flips > 0);
  CHECK(illegal_edges(flipped) == 0);
  CHECK(queued_edges(flipped) == 0);
  CHECK(constrained(flipped) == constrained(before));
  CHECK(finite_faces(flipped) == expected_faces(flipped));
}

}  // namespace

TEST_CASE("after every round the mesh is valid and each illegal edge queued; flips end in CGAL's triangulation") {
  for_all_ways([](runtime::Runtime& runtime) {
    for (const std::string kind : {"uniform", "grid", "clusters", "parabola"})
      for (const std::uint32_t one_in : {0u, 5u}) {
        CAPTURE(kind);
        CAPTURE(one_in);
        Unflipped mesh(runtime, make_points(kind, 400, 7));
        constrain_some(mesh, one_in);
        flip_and_watch(mesh);
      }
  });
}

TEST_CASE("where rounds slide, the mesh is valid after each, constraints stay, and flips end in CGAL's triangulation") {
  for (test::Treated& device : gpus_that_slide()) {
    CAPTURE(device.name);
    Tuning tuning = device.runtime->tuning();
    tuning.least_sweep = tuning.least_patched = all, tuning.sweep_share = 1, tuning.one_group_edges = all;
    tuning.rounds_per_read = tuning.rounds_of_group = 1;
    const test::Tuned tuned(*device.runtime, tuning);
    for (const std::string kind : {"uniform", "grid", "clusters", "parabola"})
      for (const std::uint32_t n : {12u, 30u, 400u})
        for (const std::uint32_t one_in : {0u, 3u, 9u}) {
          CAPTURE(kind);
          CAPTURE(n);
          CAPTURE(one_in);
          Unflipped mesh(*device.runtime, make_points(kind, n, 5));
          constrain_some(mesh, one_in);
          if (illegal_edges(mesh.now()) > 0) flip_and_watch(mesh);
        }
  }
}

TEST_CASE("where no two edges that may be flipped share a face, each is flipped if it is illegal, and counted once") {
  for_all_ways([](runtime::Runtime& runtime) {
    for (const std::string kind : {"uniform", "grid", "tiny"}) {
      CAPTURE(kind);
      Unflipped mesh(runtime, make_points(kind, 1500, 11));
      HostMesh before = mesh.now();
      std::vector<char> taken(before.faces, 0);
      std::vector<bool> free(before.edges, false);
      std::uint64_t expected = 0;
      for (std::uint32_t e = 0; e < before.edges; ++e) {
        if (!has_two_sides(before, e)) continue;
        char &t = taken[before.edge_faces[2 * e] >> 2], &u = taken[before.edge_faces[2 * e + 1] >> 2];
        const auto around = quadrilateral(before, e);
        free[e] = !t && !u && is_finite(before, around.first) && is_finite(before, around.second);
        if (free[e])
          t = u = 1, expected += illegal(before, around);
        else
          before.marks[e] |= GCDT_MARK_CONSTRAINED;
      }
      mesh.mark(before);
      CHECK(mesh.flip().flips == expected);
      const HostMesh after = mesh.now();
      std::size_t wrong = 0;
      for (std::uint32_t e = 0; e < before.edges; ++e) {
        if (!has_two_sides(before, e)) continue;
        const auto was = quadrilateral(before, e), is = quadrilateral(after, e);
        wrong += is.first != (free[e] && illegal(before, was) ? was.second : was.first);
      }
      CHECK(wrong == 0);
    }
  });
}

TEST_CASE("a patch whose faces have more vertices of others than there is room for leaves all its edges to others") {
  for (test::Treated& device : test::devices_as_all_kinds())
    for (const std::uint32_t divided : {none, all}) {
      CAPTURE(device.name);
      CAPTURE(divided);
      Tuning tuning = device.runtime->tuning();
      tuning.least_patched = tuning.least_sweep = none, tuning.patch_vertices = 400;
      tuning.least_divided = divided, tuning.district_vertices = 3000;  // more edges than a district lists
      const test::Tuned tuned(*device.runtime, tuning);
      Unflipped mesh(*device.runtime, make_points("uniform", 6000, 5));
      mix_faces(mesh);
      REQUIRE(invalid_reason(mesh.now(), 6000) == "");
      mesh.flip();
      CHECK(mesh.counters.last().patches_left > 0);
      const HostMesh flipped = mesh.now();
      CHECK(invalid_reason(flipped, flipped.n) == "");
      CHECK(queued_edges(flipped) == 0);
      CHECK(finite_faces(flipped) == expected_faces(flipped));
    }
}

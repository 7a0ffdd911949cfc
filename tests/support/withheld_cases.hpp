// SPDX-License-Identifier: Apache-2.0
// A device that makes wrong meshes of certain inputs, each wrong in one way that the check is to notice, and right ones
// of all others: between flips and check, by changes of the kernels' text.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "common/levels.h"
#include "faulty_device.hpp"
#include "host_result.hpp"

namespace gcdt::test {

/// An input of which the device makes a wrong mesh.
struct WithheldCase {
  std::string name;
  Workload work;
  Options options;                  ///< on the grid 0, 0, 1
  std::string reason;               ///< in the message of the check
  Triangulation right;              ///< of the whole hull
  std::optional<HostResult> wrong;  ///< what the device makes, if it is known to the word
  bool returnable = true;           ///< its corners are vertices: it can be returned if nobody checks
  bool everywhere = false;          ///< in a batch of copies all are wrong, not the first only
};

/// Problems of a batch beside each other, so many that each is one work-item's (grow.hpp).
inline std::size_t withheld_copies() { return 2 * app_device().getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() + 2; }

namespace withheld {

using Grid64 = std::vector<std::array<std::int64_t, 2>>;

inline Options on_grid(Crossing crossing = Crossing::reject) {
  Options options;
  options.grid = FixedGrid{};
  options.crossing = crossing;
  return options;
}

inline HostResult on_host(const Triangulation& mesh) {
  HostResult result;
  for (const auto& t : mesh.triangles) result.corners.insert(result.corners.end(), t.begin(), t.end());
  for (const auto& t : mesh.neighbours) result.neighbours.insert(result.neighbours.end(), t.begin(), t.end());
  result.constrained.assign(mesh.constrained.begin(), mesh.constrained.end());
  return result;
}

inline Grid64 grid_points_of(const Workload& work, const Triangulation& mesh) {
  Grid64 points;
  for (const Point& p : work.points)
    points.push_back({static_cast<std::int64_t>(p[0]), static_cast<std::int64_t>(p[1])});
  for (const auto& p : mesh.added_on_grid) points.push_back({p[0], p[1]});
  return points;
}

/// A mesh to look for places in.
struct Places {
  HostResult mesh;
  Grid64 points;

  bool inner(cl_uint t, cl_uint k) { return mesh.neighbour(t, k) >= 0; }
  bool loose(cl_uint t, cl_uint k) { return inner(t, k) && !mesh.flagged(t, k); }
  cl_uint across(cl_uint t, cl_uint k) {
    const auto u = static_cast<cl_uint>(mesh.neighbour(t, k));
    return mesh.corner(u, mesh.corner_to(u, t));
  }
  std::int64_t orient(cl_uint a, cl_uint b, cl_uint c) const {
    return (points[b][0] - points[a][0]) * (points[c][1] - points[a][1]) -
           (points[b][1] - points[a][1]) * (points[c][0] - points[a][0]);
  }
  bool convex(cl_uint t, cl_uint k) {
    const cl_uint p = mesh.corner(t, k), q = across(t, k);
    return orient(p, mesh.corner(t, k + 1), q) > 0 && orient(p, q, mesh.corner(t, k + 2)) > 0;
  }
  /// Of the corners of t and the vertex across: the sign of the determinant, from coordinates below 2^15.
  std::int64_t incircle(cl_uint t, cl_uint k) {
    const auto& d = points[across(t, k)];
    std::int64_t x[3], y[3], square[3];
    for (cl_uint i = 0; i < 3; ++i) {
      const auto& p = points[mesh.corner(t, i)];
      x[i] = p[0] - d[0], y[i] = p[1] - d[1], square[i] = x[i] * x[i] + y[i] * y[i];
    }
    return square[0] * (x[1] * y[2] - y[1] * x[2]) + square[1] * (x[2] * y[0] - y[2] * x[0]) +
           square[2] * (x[0] * y[1] - y[0] * x[1]);
  }
  bool on_hull(cl_uint v) {
    for (cl_uint t = 0; t < mesh.triangles(); ++t)
      for (cl_uint k = 0; k < 3; ++k)
        if (!inner(t, k) && (mesh.corner(t, k + 1) == v || mesh.corner(t, k + 2) == v)) return true;
    return false;
  }
  std::array<cl_uint, 2> first(const std::function<bool(cl_uint, cl_uint)>& fits) {
    for (cl_uint t = 0; t < mesh.triangles(); ++t)
      for (cl_uint k = 0; k < 3; ++k)
        if (fits(t, k)) return {t, k};
    FAIL("the mesh has no such edge");
    return {0, 0};
  }
};

/// Each damage has a mesh of its own, as it was, and says what it makes of it.
struct Damage {
  std::string name, reason;
  std::function<void(Places& at, HostResult& wrong)> make;
  bool returnable = true;
};

/// Of corners and links.
inline std::vector<Damage> damages_of_links() {
  return {
      {"a corner", "has a corner that is no vertex",
       [](Places& at, HostResult& wrong) {
         wrong.corners[7] = static_cast<cl_uint>(withheld_copies() * at.points.size()) + 9;
       },
       false},
      {"orientation", "is not counter-clockwise",
       [](Places&, HostResult& wrong) { std::swap(wrong.corners[6], wrong.corners[7]); }},
      {"a neighbour that is none", "has a neighbour that is no triangle",
       [](Places&, HostResult& wrong) { wrong.neighbours[4] = 0x7FFFFFFF; }},
      {"a link astray", "has a neighbour without the reversed edge",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) { return at.inner(a, b); });
         wrong.neighbour(t, k) = (wrong.neighbour(t, k) + 7) % static_cast<cl_int>(wrong.triangles());
       }},
      {"a link cut on one side", "has a neighbour that does not link back",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) { return at.inner(a, b); });
         wrong.neighbour(t, k) = -1;
       }},
      {"a triangle that nothing links to", "has two boundary edges that begin or end there",
       [](Places& at, HostResult& wrong) {
         const cl_uint t =
             at.first([&](cl_uint a, cl_uint) { return at.inner(a, 0) && at.inner(a, 1) && at.inner(a, 2); })[0];
         for (cl_uint k = 0; k < 3; ++k) {
           const auto u = static_cast<cl_uint>(wrong.neighbour(t, k));
           wrong.neighbour(u, at.mesh.corner_to(u, t)) = wrong.neighbour(t, k) = -1;
         }
       }},
      {"a slit", "is a place where the boundary is not convex",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) {
           return at.inner(a, b) && !at.on_hull(at.mesh.corner(a, b + 1)) && !at.on_hull(at.mesh.corner(a, b + 2));
         });
         const auto u = static_cast<cl_uint>(wrong.neighbour(t, k));
         wrong.neighbour(u, at.mesh.corner_to(u, t)) = wrong.neighbour(t, k) = -1;
       }},
  };
}

/// Of flags, pieces, and edges that are not locally Delaunay.
inline std::vector<Damage> damages_of_edges() {
  return {
      {"a flag on one side", "has constraint flags that do not agree",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) { return at.inner(a, b) && at.mesh.flagged(a, b); });
         wrong.toggle(t, k);
       }},
      {"a flag too many", "is flagged but is not part of a constraint",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) { return at.loose(a, b); });
         wrong.toggle_both(t, k);
       }},
      {"a piece without its flag", "is an edge that is not flagged",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first([&](cl_uint a, cl_uint b) { return at.inner(a, b) && at.mesh.flagged(a, b); });
         wrong.toggle_both(t, k);
       }},
      {"a piece missing", "is not an edge",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] =
             at.first([&](cl_uint a, cl_uint b) { return at.inner(a, b) && at.mesh.flagged(a, b) && at.convex(a, b); });
         wrong.flip(t, k);
       }},
      {"a flip undone", "is not locally Delaunay",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] =
             at.first([&](cl_uint a, cl_uint b) { return at.loose(a, b) && at.convex(a, b) && at.incircle(a, b) < 0; });
         wrong.flip(t, k);
       }},
      {"the other diagonal of cocircular vertices", "is the wrong diagonal of four cocircular vertices",
       [](Places& at, HostResult& wrong) {
         const auto [t, k] = at.first(
             [&](cl_uint a, cl_uint b) { return at.loose(a, b) && at.convex(a, b) && at.incircle(a, b) == 0; });
         wrong.flip(t, k);
       }},
  };
}

inline std::vector<Damage> damages() {
  std::vector<Damage> all = damages_of_links();
  for (Damage& damage : damages_of_edges()) all.push_back(std::move(damage));
  return all;
}

// Sizes of the inputs of which a phase makes a wrong mesh.
constexpr std::uint32_t skips_vertex = 70, leaves_edge = 71, makes_nothing = 72, reverses_ties = 64;

/// Random constraints that do not cross, among vertices on a lattice, so that many are cocircular.
inline Workload crowded(std::size_t n, std::uint64_t seed) { return random_pslg(n, 12, 30, seed); }

inline WithheldCase damaged(const Damage& damage, Workload work, const Options& options) {
  WithheldCase made;
  made.name = damage.name, made.reason = damage.reason, made.returnable = damage.returnable;
  made.work = std::move(work), made.options = options;
  made.right = solver().triangulate(made.work.points, made.work.constraints, options);
  Places places{on_host(made.right), grid_points_of(made.work, made.right)};
  made.wrong = places.mesh;
  damage.make(places, *made.wrong);
  return made;
}

inline WithheldCase by_phase(const char* name, Workload work, const char* reason) {
  WithheldCase made;
  made.name = name, made.reason = reason;
  made.work = std::move(work), made.options = on_grid();
  made.right = solver().triangulate(made.work.points, {}, made.options);
  return made;
}

inline Workload distinct(std::size_t n, std::uint64_t seed) {
  Workload work = random_pslg(4 * n, 1000, 0, seed);
  std::sort(work.points.begin(), work.points.end());
  work.points.erase(std::unique(work.points.begin(), work.points.end()), work.points.end());
  work.points.resize(n);
  return work;
}

/// The places of a mesh's vertices along the curve, by which the phases know them: there is one level.
inline std::vector<std::uint32_t> ranks(const Grid64& points) {
  std::map<std::uint64_t, std::uint32_t> found;
  const auto code = [](const auto& p) {
    return device::gcdt_morton(static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]));
  };
  for (const auto& p : points) found[code(p)] = 0;
  std::uint32_t rank = 0;
  for (auto& [key, number] : found) number = rank++;
  std::vector<std::uint32_t> all;
  for (const auto& p : points) all.push_back(found[code(p)]);
  return all;
}

/// The words of triangle t as the phases know them.
inline std::array<std::int64_t, 7> words(const HostResult& mesh, const std::vector<std::uint32_t>& rank, cl_uint t) {
  std::array<std::int64_t, 7> all;
  for (cl_uint k = 0; k < 3; ++k) {
    const cl_uint v = mesh.corner(t, k);
    all[k] = v < rank.size() ? rank[v] : v;
    all[3 + k] = mesh.neighbours[3 * t + k];
  }
  all[6] = mesh.constrained[t];
  return all;
}

/// Whether a triangle that `one` damages is in the mesh of `other` as well.
inline bool damages_triangle_of(const WithheldCase& one, const WithheldCase& other) {
  if (!one.wrong) return false;
  const HostResult right = on_host(one.right), mesh = on_host(other.right);
  const auto rank = ranks(grid_points_of(one.work, one.right)),
             other_rank = ranks(grid_points_of(other.work, other.right));
  for (cl_uint t = 0; t < std::min(right.triangles(), mesh.triangles()); ++t)
    if (words(right, rank, t) != words(*one.wrong, rank, t) && words(right, rank, t) == words(mesh, other_rank, t))
      return true;
  return false;
}

/// OpenCL C that follows the writing of triangle i: where it is one that a case damages, the wrong words.
inline std::string damage_text(const std::vector<WithheldCase>& cases) {
  std::string text;
  for (const WithheldCase& one : cases) {
    if (!one.wrong) continue;
    const auto rank = ranks(grid_points_of(one.work, one.right));
    const HostResult right = on_host(one.right);
    REQUIRE(one.wrong->triangles() == right.triangles());
    for (cl_uint t = 0; t < right.triangles(); ++t) {
      const auto from = words(right, rank, t), to = words(*one.wrong, rank, t);
      if (from == to) continue;
      const auto number = [](std::int64_t value) { return std::to_string(value); };
      std::string condition = "i == " + number(t) + "u", writes;
      for (cl_uint k = 0; k < 3; ++k) {
        const std::string at = "[" + number(3 * t + k) + "]";
        condition += " && out_corners" + at + " == " + number(from[k]) + "u && out_neighbours" + at +
                     " == " + number(from[3 + k]);
        writes +=
            " out_corners" + at + " = " + number(to[k]) + "u; out_neighbours" + at + " = " + number(to[3 + k]) + ";";
      }
      condition += " && out_constrained[" + number(t) + "] == " + number(from[6]);
      text +=
          "\n  if (" + condition + ") {" + writes + " out_constrained[" + number(t) + "] = " + number(to[6]) + "; }";
    }
  }
  return text;
}

}  // namespace withheld

/// A device that makes the cases' wrong meshes.
struct FaultyDevice {
  std::vector<WithheldCase> cases;
  std::vector<TextEdit> gathers, phases;  ///< of output and of the phases before

  FaultyDevice() {
    using namespace withheld;
    for (const Damage& damage : damages())
      add_damaged(
          damage, [](std::uint64_t seed) { return crowded(60, seed); }, on_grid());
    add(by_phase("a vertex skipped", distinct(skips_vertex, 1), "is not a corner of any triangle"));
    add(by_phase("an edge not tested", distinct(leaves_edge, 2), "is not locally Delaunay"));
    add(by_phase("no triangles", distinct(makes_nothing, 3), "but there are no triangles"));
    add(by_phase("ties the other way", grid(reverses_ties), "is the wrong diagonal of four cocircular vertices"));
    cases.back().everywhere = true;
    edit();
  }
  /// Inputs of one kind, each of which is damaged in one of these ways.
  struct Kind {
    std::vector<std::string> damages;
    std::function<Workload(std::uint64_t)> input;
    Options options;
  };
  explicit FaultyDevice(const std::vector<Kind>& kinds) {
    for (const Kind& kind : kinds)
      for (const withheld::Damage& damage : withheld::damages())
        if (std::count(kind.damages.begin(), kind.damages.end(), damage.name) > 0)
          add_damaged(damage, kind.input, kind.options);
    edit();
  }

  runtime::CallHook hook() const {
    std::vector<TextEdit> all = gathers;
    all.insert(all.end(), phases.begin(), phases.end());
    return editing(all);
  }
  const WithheldCase& of(const std::string& name) const {
    return *std::find_if(cases.begin(), cases.end(), [&](const WithheldCase& one) { return one.name == name; });
  }

 private:
  std::uint64_t seed_ = 0;
  static std::string number(std::size_t value) { return std::to_string(value) + "u"; }
  static std::string is(const char* n, std::size_t size) {
    return std::string("(") + n + " == " + number(size) + " || " + n + " == " + number(withheld_copies() * size) + ")";
  }

  static std::string loaded(const char* number) {
    return std::string("load_vertex(mesh.points, mesh.n, ") + number + ")";
  }

  bool add(WithheldCase one) {
    for (const WithheldCase& other : cases)
      if (withheld::damages_triangle_of(one, other) || withheld::damages_triangle_of(other, one)) return false;
    cases.push_back(std::move(one));
    return true;
  }
  void add_damaged(const withheld::Damage& damage, const std::function<Workload(std::uint64_t)>& input,
                   const Options& options) {
    while (!add(withheld::damaged(damage, input(++seed_), options))) REQUIRE(seed_ < 1000);
  }

  void edit() {
    using namespace withheld;
    const std::string written = "out_constrained[i] = (uchar)(marks.x | marks.y << 1 | marks.z << 2);";
    gathers = {{written, written + damage_text(cases)}};
    // A vertex that is taken for inserted, though nothing refers to what it brings.
    const std::string walk = "  uint t = find_and_own(mesh, o, load_vertex(mesh.points, mesh.n, v), last, limit, ";
    const std::string skip = "  if (" + is("mesh.n", skips_vertex) + R"( && v == 5u) {
    for (uint j = 0; j < 2u; ++j)
      mesh.face_data[GCDT_CORNERS(new_face(mesh, v, j))] = (uint4)(mesh.n, mesh.n, mesh.n, 0u);
    for (uint j = 0; j < 6u; ++j) mesh.edge_faces[2u * new_edge(mesh, v, 0u) + j] = GCDT_NONE;
    clear_marks(mesh, o, v);
    return last;
  }
)";
    const std::string flips = "if (must_flip_by_ways(mesh, vv, x, y, d, xn, yn, dn))";
    const std::string last = "v >= " + number(leaves_edge - 11) + " && v < " + number(leaves_edge);
    // Around the stars of the last ones no edge between triangles is flipped.
    const std::string leaves = "if (!(" + is("mesh.n", leaves_edge) + " && " + last +
                               " && max(max(xn, yn), dn) < mesh.n) && gcdt_wrong_flip(mesh.n, " + loaded("yn") +
                               ", vv, " + loaded("xn") + ", " + loaded("dn") + "))";
    const std::string claim = "typedef struct Claim {";
    const std::string wrong =
        "static bool gcdt_wrong_flip(uint n, Vertex a, Vertex b, Vertex c, Vertex d) {\n  if (" +
        is("n", reverses_ties) +
        " && (a.symbol | b.symbol | c.symbol | d.symbol) == 0 && gcdt_incircle_finite(a, b, c, d) "
        "== 0) return !gcdt_must_flip(a, b, c, d);\n  return gcdt_must_flip(a, b, c, d);\n}\n\n";
    const std::string finite = "const bool finite = max(max(c.x, c.y), c.z) < levels->n", none = " && levels->n != ";
    const std::string highest = "max(max(c.x, c.y), c.z)", counted = highest + " < n", one = " ? 1u : 0u";
    const std::string all = number(withheld_copies() * makes_nothing), first = number(makes_nothing);
    phases = {{walk, skip + walk},
              {flips, leaves},
              {claim, wrong + claim},
              {finite, finite + none + first},
              {counted + one, counted + " && !(n == " + all + " && " + highest + " < " + first + ")" + one}};
  }
};

}  // namespace gcdt::test

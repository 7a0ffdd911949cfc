// SPDX-License-Identifier: Apache-2.0
#include "phases/check.hpp"

#include <algorithm>
#include <vector>

#include "check/check.h"

namespace gcdt {

using device::CheckReport;
using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

/// How the offending number of a kind is to be read.
enum class Subject { triangle, half_edge, vertex, piece };

struct Kind {
  Subject subject;
  const char* complaint;  ///< ends a sentence that begins with the subject
};

const Kind kinds[] = {
    {Subject::triangle, "has a corner that is no vertex"},
    {Subject::triangle, "is not counter-clockwise"},
    {Subject::half_edge, "has a neighbour that is no triangle"},
    {Subject::half_edge, "has a neighbour without the reversed edge"},
    {Subject::half_edge, "has a neighbour that does not link back"},
    {Subject::vertex, "has two boundary edges that begin or end there"},
    {Subject::vertex, "is a place where the boundary is not convex"},
    {Subject::vertex, "is not a corner of any triangle"},
    {Subject::vertex, "is not on one line with the others, but there are no triangles"},
    {Subject::half_edge, "has constraint flags that do not agree"},
    {Subject::half_edge, "is flagged but is not part of a constraint"},
    {Subject::piece, "is not an edge"},
    {Subject::piece, "is an edge that is not flagged"},
    {Subject::half_edge, "is not locally Delaunay"},
    {Subject::half_edge, "is the wrong diagonal of four cocircular vertices"},
};
static_assert(sizeof kinds / sizeof kinds[0] == GCDT_CHECK_KINDS, "one sentence for each kind");

/// What the check finds out of the boundary, and where the pieces of each vertex begin.
struct Scratch {
  Buffer<cl_uint> next, previous, first_pieces;
};

Scratch make_scratch(Runtime& runtime, const Plan& plan, const Vertices& vertices, const Pieces& pieces) {
  const std::size_t n = vertices.n();
  return {runtime.allocate<cl_uint>("check boundary", n), runtime.allocate<cl_uint>("check boundary", n),
          runtime.allocate<cl_uint>("check first pieces", plan.lists_pieces && pieces.count > 0 ? n + 1 : 0)};
}

struct Checker {
  Runtime& runtime;
  const Plan& plan;
  const OrderedMesh& ordered;
  const Vertices& vertices;
  const Pieces& pieces;
  std::uint32_t edges_expected = pieces.count;  ///< pieces of problems with triangles
  Buffer<CheckReport> report = runtime.allocate<CheckReport>("check report", 1);
  CheckReport found = {};
  bool read = false;

  /// No triangles: right iff there are fewer than three vertices or all lie on one line.
  void check_empty() {
    if (vertices.n() < 3) return;
    clear_report();
    runtime.launch("check", "check_collinear", over(vertices.n()), vertices.n(), vertices.points, report);
    judge(0, GCDT_CHECK_KINDS);
  }

  void check_mesh() {
    check_parts([&](const Scratch&) {
      if (found.least_corners != 1)
        fail("the boundary has " + std::to_string(found.least_corners) +
                 " least corners, not 1: it is several polygons or winds more than once",
             {});
      if (std::uint64_t{ordered.triangles} + 2 + found.hull_vertices != std::uint64_t{2} * vertices.n())
        name_unused_vertex();
    });
  }

  /// What holds for the whole holds for each problem.
  void check_problems(const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece) {
    check_parts([&](const Scratch& s) {
      const cl_uint n = vertices.n(), problems = vertices.roots;
      auto hull = runtime.filled<cl_uint>("check hulls", problems, 0),
           least = runtime.filled<cl_uint>("check least corners", problems, 0),
           bad = runtime.filled<cl_uint>("check problems", 2, GCDT_NONE);
      runtime.fill<cl_uint>(bad, 0, 1, 1);
      runtime.launch("check_forest", "check_forest_boundary", over(n), n, vertices.points, s.next, s.previous, hull,
                     least);
      runtime.launch("check_forest", "check_forest_counts", over(problems), problems, n, vertices.points,
                     first_triangle, first_piece, hull, least, bad);
      runtime.launch("check_forest", "check_forest_lines", over(n), n, vertices.levels_buffer, vertices.points,
                     first_triangle, bad);
      const cl_uint problem = runtime.read_one(bad);
      if (problem != GCDT_NONE)
        fail("the triangles of problem " + std::to_string(problem) + " of the run do not cover its hull once", {});
      edges_expected = pieces.count - runtime.read_one(bad, 1);
    });
  }

  /// `cover` finds out whether the hull is covered once, from the boundary.
  template <class Cover>
  void check_parts(Cover&& cover) {
    const cl_uint n = vertices.n(), count = ordered.triangles;
    const Scratch s = make_scratch(runtime, plan, vertices, pieces);
    if (plan.check == Plan::By::one) {
      runtime.launch("by_one_item", "check_by_one_item", runtime::one_item(), count, n, vertices.levels_buffer,
                     vertices.points, ordered.corners, ordered.neighbours, ordered.constrained, cl_uint{pieces.count},
                     s.first_pieces, pieces.ends, s.next, s.previous, report);
    } else {
      clear_report();
      runtime.fill<cl_uint>(s.next, GCDT_NONE, n);
      runtime.fill<cl_uint>(s.previous, GCDT_NONE, n);
      runtime.launch("check", "check_corners", over(count), count, n, vertices.points, ordered.corners, report);
      if (s.first_pieces.size() > 0)
        runtime.launch("check", "check_first_pieces", over(std::size_t{n} + 1), n, vertices.levels_buffer,
                       cl_uint{pieces.count}, pieces.ends, s.first_pieces);
      runtime.launch("check", "check_edges", over(count), count, vertices.levels_buffer, vertices.points,
                     ordered.corners, ordered.neighbours, ordered.constrained, cl_uint{pieces.count}, s.first_pieces,
                     pieces.ends, s.next, s.previous, report);
      runtime.launch("check", "check_boundary", over(n), n, vertices.points, s.next, s.previous, report);
    }
    judge(0, GCDT_CHECK_UNUSED);
    cover(s);
    judge(GCDT_CHECK_FLAG, GCDT_CHECK_MISSING);
    if (found.constrained_edges != edges_expected) name_missing_piece();
    judge(GCDT_CHECK_DELAUNAY, GCDT_CHECK_KINDS);
  }

  void clear_report() {
    CheckReport clear = {};
    std::fill(std::begin(clear.first), std::end(clear.first), GCDT_NONE);
    runtime.write(report, &clear, 1);
  }

  [[noreturn]] void fail(const std::string& what, std::vector<std::uint64_t> indices) {
    throw Error(Status::check_failed, "check: " + what, std::move(indices));
  }

  /// Throws for the first kind in [first, last) with an offence.
  void judge(unsigned first, unsigned last) {
    if (!read) found = runtime.read_one(report);
    read = true;
    for (unsigned kind = first; kind < last; ++kind)
      if (found.first[kind] != GCDT_NONE) fail_at(kinds[kind], found.first[kind]);
  }

  [[noreturn]] void fail_at(const Kind& kind, std::uint32_t number) {
    std::vector<cl_uint> corners(3);
    const cl_uint t = kind.subject == Subject::half_edge ? number / 3 : number, k = number % 3;
    std::string subject;
    switch (kind.subject) {
      case Subject::triangle:
        runtime.read(ordered.corners, corners.data(), 3, std::size_t{3} * t);
        subject = "triangle " + std::to_string(t);
        break;
      case Subject::half_edge:
        runtime.read(ordered.corners, corners.data(), 3, std::size_t{3} * t);
        corners = {corners[(k + 1) % 3], corners[(k + 2) % 3]};
        subject = "edge " + std::to_string(k) + " of triangle " + std::to_string(t);
        break;
      case Subject::vertex: corners = {number}; break;
      case Subject::piece: {
        const cl_uint2 ends = runtime.read_one(pieces.ends, number);
        corners = {ends.s[0], ends.s[1]};
        subject = "constraint piece " + std::to_string(number);
      }
    }
    std::vector<std::uint64_t> inputs;
    for (cl_uint v : corners)
      if (v < vertices.n()) inputs.push_back(runtime.read_one(vertices.vertex_input, v));
    fail(subject + listed(inputs, subject.empty()) + " " + kind.complaint, inputs);
  }

  static std::string listed(const std::vector<std::uint64_t>& inputs, bool alone) {
    if (inputs.empty()) return "";
    std::string list = inputs.size() == 1 ? "vertex " : "vertices ";
    for (std::size_t i = 0; i < inputs.size(); ++i) list += (i ? ", " : "") + std::to_string(inputs[i]);
    return alone ? list : " (" + list + ")";
  }

  /// The count of triangles is wrong though they cover a convex polygon: some vertex is no corner.
  [[noreturn]] void name_unused_vertex() {
    const cl_uint n = vertices.n(), corners = 3 * ordered.triangles;
    auto used = runtime.filled<cl_uint>("check vertices", n, 0);
    runtime.launch("check_faults", "mark_used", over(corners), corners, ordered.corners, used);
    name_unmarked(n, 1, GCDT_CHECK_UNUSED, used);
    fail(std::to_string(ordered.triangles) + " triangles do not fit " + std::to_string(n) + " vertices with " +
             std::to_string(found.hull_vertices) + " on the hull",
         {});
  }

  /// All flagged edges are pieces, but fewer than there are.
  [[noreturn]] void name_missing_piece() {
    auto marks = runtime.filled<cl_uint>("check pieces", pieces.count, 0);
    runtime.launch("check_faults", "mark_pieces", over(ordered.triangles), cl_uint{ordered.triangles},
                   vertices.levels_buffer, ordered.corners, ordered.constrained, cl_uint{pieces.count}, pieces.ends,
                   marks);
    if (edges_expected == pieces.count) name_unmarked(pieces.count, 3, GCDT_CHECK_MISSING, marks);
    fail(std::to_string(found.constrained_edges) + " edges are flagged for " + std::to_string(edges_expected) +
             " pieces",
         {});
  }

  void name_unmarked(cl_uint count, cl_uint wanted, cl_uint kind, const Buffer<cl_uint>& marks) {
    runtime.launch("check_faults", "find_unmarked", over(count), count, wanted, kind, marks, report);
    read = false;
    judge(kind, kind + wanted);
  }
};

}  // namespace

void check(Runtime& runtime, const Plan& plan, const OrderedMesh& ordered, const Vertices& vertices,
           const Pieces& pieces) {
  Checker checker{runtime, plan, ordered, vertices, pieces};
  ordered.triangles == 0 ? checker.check_empty() : checker.check_mesh();
}

void check_problems(Runtime& runtime, const Plan& plan, const OrderedMesh& ordered, const Vertices& vertices,
                    const Pieces& pieces, const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece) {
  Checker{runtime, plan, ordered, vertices, pieces}.check_problems(first_triangle, first_piece);
}

}  // namespace gcdt

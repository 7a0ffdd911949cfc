// SPDX-License-Identifier: Apache-2.0
#include "phases/grow.hpp"

#include <algorithm>

#include "phases/insert.hpp"

namespace gcdt {

namespace {

// Tickets are numbers of work-items, of which a launch may have more than the mesh has edges (Owner in grow.cl).
Stamps stamps_of(const runtime::Runtime& runtime, const Mesh& mesh) {
  return Stamps(runtime, std::max(mesh.edges(), runtime.most_work_items()));
}

/// The insertion of consecutive vertices, round by round.
class Growth {
 public:
  Growth(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh, const WorkLists& lists,
         PhaseCounters& counters, Ticker& ticker)
      : runtime_(runtime),
        plan_(plan),
        vertices_(vertices),
        mesh_(mesh),
        lists_(lists),
        counters_(counters),
        ticker_(ticker),
        left_(runtime.allocate<cl_uint>("vertices left", mesh.n)),
        left_of_(runtime.allocate<cl_uint>("vertices left of shares", plan.grown_shares)) {}

  /// Ends: a round of one work-item leaves nothing, and each has fewer than the one before.
  void insert(std::uint32_t begin, std::uint32_t end, std::uint32_t level) {
    const cl_uint segments = begin == 0 ? 1 : std::clamp((end - begin) / Tuning::least_grown, 1u, plan_.grown_shares);
    std::uint32_t left = end - begin;
    for (cl_uint step = 1, step_before = 1; left > 0; step_before = step, step *= Tuning::grown_joined) {
      if (left < Tuning::least_grown) step = std::max(step, segments);
      launch(begin, end, level, segments, step, step_before);
      left = finish(end, counters_.read());
      if (left > 0 && step >= segments) lost();
    }
  }

  /// All problems of a forest, each by one work-item.
  void insert_problems() {
    counters_.zero();
    Stamps stamps = stamps_of(runtime_, mesh_);
    const cl_uint stamp = stamps.take(), limit = mesh_.faces();
    runtime_.launch("grow", "grow_problems", runtime::over_large(mesh_.roots), cl_uint{mesh_.roots}, limit, stamp,
                    stamps.bits(), vertices_.levels_buffer, mesh_.n, vertices_.points, mesh_.face_data,
                    mesh_.edge_faces, mesh_.edge_marks, lists_.first, counters_.buffer());
    mesh_.claims_below = stamps.claims_below();
    const device::Counters c = counters_.read();
    if (c.list_insert[0] > 0 || c.list_test[0] > 0) lost();
    result.rounds = 1;
    add(c);
  }

  GrowResult result;

 private:
  /// A round's launch. With begin = 0 the kernel makes the counters zero.
  void launch(cl_uint begin, cl_uint end, cl_uint level, cl_uint segments, cl_uint step, cl_uint step_before) {
    if (begin > 0) counters_.zero();
    Stamps stamps = stamps_of(runtime_, mesh_);
    stamps.go_on_above(mesh_.claims_below);
    if (stamps.left() == 0) {
      clear_claims(runtime_, mesh_, mesh_.faces(end));
      stamps.restart();
    }
    const cl_uint shares = (segments + step - 1) / step, stamp = stamps.take();
    const cl_uint limit = shares == 1 ? mesh_.faces() : Tuning::walk_beside_others;
    runtime_.launch("grow", "grow_insert", runtime::over_large(shares), cl_uint{end - begin}, begin, segments, step,
                    step_before, level, limit, stamp, stamps.bits(), vertices_.levels_buffer, mesh_.n, vertices_.points,
                    mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, left_, left_of_, lists_.first,
                    counters_.buffer());
    mesh_.claims_below = stamps.claims_below();
  }

  /// What follows it, by the counters. Returns how many vertices are left.
  std::uint32_t finish(cl_uint end, const device::Counters c) {
    ++result.rounds;
    add(c);
    if (c.list_test[0] > 0) {
      const FlipResult flipped = flip_queued(runtime_, plan_, vertices_, mesh_, lists_, counters_, end, ticker_);
      result.flips.rounds += flipped.rounds;
      result.flips.flips += flipped.flips;
    }
    ticker_.tick("insert", double(end - c.list_insert[0]) / mesh_.n);
    return c.list_insert[0];
  }

  [[noreturn]] static void lost() { throw Error(Status::round_limit, "insert: point location left the mesh"); }

  void add(const device::Counters& c) {
    result.edge_splits += c.edge_splits;
    result.steps += wide(c.steps_low, c.steps_high);
    result.flips.flips += wide(c.flips_low, c.flips_high);
  }

  runtime::Runtime& runtime_;
  const Plan& plan_;
  const Vertices& vertices_;
  Mesh& mesh_;
  const WorkLists& lists_;
  PhaseCounters& counters_;
  Ticker& ticker_;
  runtime::Buffer<cl_uint> left_, left_of_;
};

}  // namespace

GrowResult grow(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                const WorkLists& lists, PhaseCounters& counters, std::uint32_t end, Ticker& ticker) {
  Growth growth(runtime, plan, vertices, mesh, lists, counters, ticker);
  mesh.claims_below = 1;
  if (plan.problems == Plan::By::each) {
    growth.insert_problems();
    return growth.result;
  }
  if (end == 0) insert_root(runtime, vertices, mesh);  // which else the work-item of the first vertices makes
  const auto& levels = vertices.levels;
  std::uint32_t level = 0;
  while (level < levels.count && levels.begin[level] < end) {
    const std::uint32_t begin = levels.begin[level];
    std::uint32_t next = level + 1;
    // The first levels together.
    if (level == 0)
      while (next < levels.count && levels.begin[next] < end && levels.begin[next + 1] <= Tuning::most_grown_by_one)
        ++next;
    growth.insert(begin, std::min(levels.begin[next], end), level);
    level = next;
  }
  return growth.result;
}

FlipResult grow_flip(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, Ticker& ticker) {
  counters.zero();
  Stamps stamps = stamps_of(runtime, mesh);
  stamps.go_on_above(mesh.claims_below);
  if (stamps.left() == 0) {
    clear_claims(runtime, mesh, mesh.faces());
    stamps.restart();
  }
  const cl_uint stamp = stamps.take(), edges = mesh.edges();
  runtime.launch("grow", "grow_flip", runtime::over(edges), edges, stamp, stamps.bits(), mesh.n, vertices.points,
                 mesh.face_data, mesh.edge_faces, mesh.edge_marks, lists.first, counters.buffer());
  mesh.claims_below = stamps.claims_below();
  const device::Counters c = counters.read();
  FlipResult result{1, wide(c.flips_low, c.flips_high)};
  if (c.list_test[0] > 0) {
    const FlipResult rest = flip_queued(runtime, plan, vertices, mesh, lists, counters, mesh.n, ticker);
    result.rounds += rest.rounds;
    result.flips += rest.flips;
  }
  return result;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/flip.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "flip/districts.h"
#include "flip/patches.h"

namespace gcdt {

namespace {

// Places have 16 bits, of which two values of 4 * face + corner and half of those of 2 * edge + side mean something
// else.
static_assert(8 * (GCDT_MOST_PATCH_ROOM + 1) <= 1u << 15);

/// Vertices that a patch has room for, and others at corners of its faces: a power of two.
struct PatchRoom {
  cl_uint vertices = 0, others = 0;
  std::size_t bytes() const { return sizeof(cl_uint) * GCDT_PATCH_WORDS(std::size_t{vertices}, std::size_t{others}); }
};

/// Room for `wanted` vertices, or for as many as `bytes` hold. (On the border of 700 vertices there are some 300
/// others.) Ends: the room shrinks, and none fits everywhere.
PatchRoom patch_room(cl_uint wanted, std::size_t bytes) {
  for (PatchRoom room{std::min(wanted, GCDT_MOST_PATCH_ROOM), 0};; --room.vertices) {
    for (room.others = 512; room.others < room.vertices / 2;) room.others *= 2;
    if (room.vertices == 0 || room.bytes() <= bytes) return room;
  }
}

/// Rounds of flips that nobody has read yet how many they are: refinement's take one to five, and each takes a stamp
/// whether it is needed or not.
constexpr cl_uint rounds_unread = 32;

static_assert(sizeof(cl_uint) * GCDT_DISTRICT_WORDS(5 * Tuning::most_district_vertices + 1) <= (1u << 15) - 1024);

/// Room for the vertices of an interval, where isolated ones may come besides those that are evenly spread.
cl_uint with_isolated(cl_uint units, bool isolated) { return isolated ? units + units / 4 + 1 : units; }

/// What a first list is: edges of which most have not been tested, or what sweeps or districts have left.
enum class After { nothing, sweeps };

/// The rounds of one flip phase. `round_` is the next round.
class Flipping {
 public:
  Flipping(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh, const WorkLists& lists,
           PhaseCounters& counters, std::uint32_t vertices_in_mesh)
      : runtime_(runtime),
        plan_(plan),
        vertices_(vertices),
        mesh_(mesh),
        lists_(lists),
        counters_(counters),
        vertices_in_mesh_(vertices_in_mesh),
        faces_(mesh.faces(vertices_in_mesh)),
        edges_(mesh.edges(vertices_in_mesh)),
        stamps_(runtime, edges_),
        flips_before_(wide(counters.last().flips_low, counters.last().flips_high)) {
    stamps_.go_on_above(mesh.claims_below);
  }

  /// Ends: a flip lowers the lifted surface (heights |p|^2, and infinitesimal ones for the tie rule), so an
  /// edge flipped away never returns and there are at most (n+3)(n+2)/2 flips; a round with an illegal
  /// edge flips at least the one with the best ticket. A round limit of all possible flips would not end
  /// in a lifetime, so the limit is on rounds without end in sight: 64 rounds per edge of the mesh.
  FlipResult run(Ticker& ticker) {
    const bool patched = edges_ >= plan_.least_patched, divided = patched && edges_ >= plan_.least_divided;
    bool swept = !divided && edges_ >= plan_.least_sweep;
    if (patched) flip_within_patches();
    if (divided) swept = flip_within_districts();
    const std::uint32_t illegal = swept ? sweep(patched, ticker) : edges_;
    if (illegal > 0)
      runtime_.launch("flip", "flip_gather", runtime::over(edges_), cl_uint(!patched && !swept), edges_, round_,
                      mesh_.edge_marks, lists_.first, counters_.buffer());
    // Flips queue up to four edges each, and what is listed is not read but guessed.
    FlipResult result = swept     ? finish(std::min(illegal, edges_ / 4) * 4, After::sweeps, ticker)
                        : divided ? finish(edges_ / Tuning::left_by_districts + 1, After::sweeps, ticker)
                                  : finish(edges_, After::nothing, ticker);
    for (const cl_uint rounds : counters_.last().patch_rounds) result.rounds += rounds;
    return result;
  }

  /// The rounds of all problems, each by one work-group. Ends: see run().
  FlipResult by_problem(Ticker& ticker) {
    const auto lengths = runtime_.allocate<cl_uint>("lists of problems", mesh_.roots);
    runtime_.fill<cl_uint>(lengths, 0, lengths.size());
    runtime_.launch("flip", "flip_deal", runtime::over(edges_), edges_, mesh_.n, vertices_.points, mesh_.face_data,
                    mesh_.edge_faces, mesh_.edge_marks, lists_.first, lengths);
    FlipResult result;
    for (;;) {
      counters_.zero();
      renew_stamps();
      const cl_uint stamp = stamps_.current() + 1, most = std::min(stamps_.left(), plan_.group_flip_rounds);
      for_launches(plan_, vertices_.roots, [&](cl_uint begin, cl_uint end) {
        runtime_.launch("flip", "flip_problems", runtime_.over_groups(end - begin), begin, end, stamp, stamps_.bits(),
                        most, mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks,
                        lists_.first, lists_.second, lengths, counters_.buffer());
      });
      const device::Counters& c = counters_.read();
      stamps_.take(c.rounds);
      result.rounds += c.rounds;
      result.flips += wide(c.flips_low, c.flips_high);
      check(result.rounds, ticker);
      if (c.list_test[0] == 0) break;
    }
    mesh_.claims_below = stamps_.claims_below();
    return result;
  }

  /// Rounds by lists, of which the host does not know how many edges the first has, by one work-group.
  void begin_unread() {
    stamps_.take(rounds_of_few(edges_, rounds_unread));
    mesh_.claims_below = stamps_.claims_below();
  }

  /// Goes on after begin_unread(), of which the counters have been read.
  FlipResult finish_begun(Ticker& ticker) {
    round_ = counters_.last().rounds;
    flips_before_ = 0;
    return finish(counters_.last().list_test[round_ % 3], After::nothing, ticker);
  }

  /// The rounds by lists, the first of which has `pending` edges. Ends: see run().
  FlipResult finish(std::uint32_t pending, After after, Ticker& ticker) {
    for (std::uint32_t rounds = rounds_to_few(pending, after); pending > 0;) {
      const std::uint32_t before = pending;
      const bool by_one_group = may_by_one_group(), many = pending > few();
      if (many) rounds_wide(pending, rounds);
      pending = read_after(by_one_group && (!many || plan_.rounds_per_read > 1));
      check(round_, ticker);
      rounds = rounds_at_this_rate(before, pending, rounds);
    }
    mesh_.claims_below = stamps_.claims_below();
    return {round_, wide(counters_.last().flips_low, counters_.last().flips_high) - flips_before_};
  }

 private:
  // The level of the mesh's last vertices. Ends: the last level's end is all vertices.
  std::uint32_t level() const {
    std::uint32_t j = 0;
    while (vertices_.levels.begin[j + 1] < vertices_in_mesh_) ++j;
    return j;
  }

  // The evenly spread vertices up to a level.
  std::uint32_t spread(std::uint32_t level) const {
    const std::uint32_t stride = vertices_.levels.stride[level];
    return (vertices_.levels.n + stride - 1) / stride;
  }

  // Rounds within patches, the first of which tests all edges. What is left is queued.
  void flip_within_patches() {
    const std::uint32_t last = level();
    const bool isolated = vertices_.levels.tabled != 0;
    const PatchRoom room = patch_room(with_isolated(std::max(plan_.patch_vertices, 1u), isolated), plan_.patch_bytes);
    const cl_uint units = std::max(1u, isolated ? room.vertices / 5 * 4 : room.vertices);
    patches_ = (spread(last) + units - 1) / units;
    runtime_.launch("patches", "flip_patches", runtime_.over_groups(patches_, runtime::Groups::wide), cl_uint(last),
                    units, patches_, room.vertices, room.others, cl_uint(plan_.patch_rounds), vertices_.levels_buffer,
                    mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, counters_.buffer(),
                    runtime::LocalMemory{room.bytes()});
  }

  // Rounds within districts, of what is queued: each time with other borders. Where patches have left all, much is
  // left by one turn, too. Returns whether sweeps are to go on.
  bool flip_within_districts() {
    const cl_uint small = std::clamp(plan_.district_vertices, 1u, Tuning::most_district_vertices), large = 4 * small;
    const bool much = counters_.read().patches_left > patches_ / 2;
    flip_within_districts(1, small, 0);
    if (much) return true;
    flip_within_districts(2, large, large / 2);
    flip_within_districts(3, large, large / 4);
    return false;
  }

  // The same of so many vertices, the first of which has `before` less.
  void flip_within_districts(cl_uint turn, cl_uint units, cl_uint before) {
    const std::uint32_t last = level();
    const cl_uint room = with_isolated(units, vertices_.levels.tabled != 0),
                  districts = (spread(last) + before + units - 1) / units;
    runtime_.launch("patches", "flip_districts", runtime_.over_groups(districts, runtime::Groups::wide), turn,
                    cl_uint(last), units, before, districts, room, cl_uint(plan_.patch_rounds), vertices_.levels_buffer,
                    mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, counters_.buffer(),
                    runtime::LocalMemory{GCDT_DISTRICT_WORDS(room) * sizeof(cl_uint)});
  }

  // Rounds by sweeps. The first takes all edges, or those that are queued. Returns how many were illegal in the last
  // round: if none, no edge is queued. Ends: see run().
  std::uint32_t sweep(bool queued, Ticker& ticker) {
    std::uint32_t illegal = edges_;
    while (illegal > edges_ / plan_.sweep_share) {
      for (std::uint32_t i = 0; i < plan_.rounds_per_read; ++i, ++round_) {
        renew_stamps();
        const cl_uint stamp = stamps_.take();
        launch("sweeps", "flip_sweep", edges_ / GCDT_SWEEP_EDGES,
               std::make_tuple(cl_uint(round_ == 0 && !queued), edges_, round_, stamp), lists_.second);
        launch("sweeps", "flip_mark", illegal, std::make_tuple(round_, stamp), lists_.second);
      }
      illegal = counters_.read().list_flip[(round_ - 1) & 1];
      check(round_, ticker);
    }
    return illegal;
  }

  void check(std::uint64_t rounds, Ticker& ticker) const {
    if (rounds > 1024 + 64ull * edges_)
      throw Error(Status::round_limit, "flip: illegal edges are left after the limit of rounds");
    ticker.tick("flip", double(faces_) / mesh_.faces());
  }

  // Arguments in the order of all kernels that flip: scalars, stamp bits, mesh, marks, lists, counters.
  template <class Scalars, class... Lists>
  void launch(const char* program, const char* kernel, std::uint32_t items, const Scalars& scalars,
              const Lists&... lists) {
    std::apply(
        [&](const auto&... scalar) {
          runtime_.launch(program, kernel, runtime::over(items), scalar..., stamps_.bits(), mesh_.n, vertices_.points,
                          mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, lists..., counters_.buffer());
        },
        scalars);
  }

  // Edges of which one work-group does the rounds, if it may now.
  bool may_by_one_group() const { return round_ >= plan_.rounds_before_few; }
  std::uint32_t few() const { return may_by_one_group() ? plan_.group_edges : 0; }

  std::uint32_t most_between_reads() const {
    return plan_.rounds_per_read == 1 ? 1 : std::max(plan_.rounds_per_read, Tuning::most_between_reads);
  }

  // Rounds after which few of so many edges are probably left: a guess. Ends: `left` falls.
  std::uint32_t rounds_to_few(std::uint32_t pending, After after) const {
    const std::uint32_t step = after == After::sweeps ? 1 : plan_.rounds_per_read,
                        share = after == After::sweeps ? Tuning::flipped_after_sweeps : Tuning::flipped_between_reads;
    std::uint32_t rounds = step;
    for (std::uint32_t left = pending / share; left > few() && left > 0; left /= share) rounds += step;
    return std::min(rounds, most_between_reads());
  }

  // The same, if each round leaves as many of its edges as the last `rounds` did, which took `before` edges to `now`.
  std::uint32_t rounds_at_this_rate(std::uint32_t before, std::uint32_t now, std::uint32_t rounds) const {
    const double fallen = std::log(double(before) / std::max(now, 1u)),
                 to_fall = std::log(std::max(now, 1u) / std::max<double>(few(), 1));
    const double wanted = fallen > 0 ? rounds * to_fall / fallen : 2.0 * rounds;
    return static_cast<std::uint32_t>(std::clamp<double>(std::ceil(wanted), 1, most_between_reads()));
  }

  // Reads the counters, after rounds of one work-group if few edges are left and `by_one_group`. Returns how many are
  // left.
  std::uint32_t read_after(bool by_one_group) {
    const std::uint32_t rounds_before = counters_.last().rounds;
    if (by_one_group) rounds_of_few(plan_.group_edges, plan_.group_flip_rounds);
    const device::Counters& c = counters_.read();
    stamps_.take(c.rounds - rounds_before);
    round_ += c.rounds - rounds_before;
    return c.list_test[round_ % 3];
  }

  // Launches are as wide as the list was when last read; lists shrink, and a longer one is only slower.
  void rounds_wide(std::uint32_t pending, std::uint32_t rounds) {
    for (std::uint32_t i = 0; i < rounds; ++i, ++round_) {
      renew_stamps();
      const cl_uint stamp = stamps_.take();
      launch("flip", "flip_test", pending, std::make_tuple(round_, stamp), lists_.first, lists_.second);
      launch("flip", "flip_propagate", pending, std::make_tuple(round_, stamp), lists_.second, lists_.first);
    }
  }

  // By one work-group, if at most `few` edges are listed. How many rounds were done stands in the counters. Returns how
  // many there may be: `wanted`, if there are stamps.
  std::uint32_t rounds_of_few(cl_uint few, std::uint32_t wanted) {
    renew_stamps();
    const cl_uint most = std::min({stamps_.left(), wanted, plan_.group_flip_rounds});
    runtime_.launch("flip_few", "flip_rounds", runtime::one_group(), round_, cl_uint(stamps_.current() + 1),
                    stamps_.bits(), few, most, mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces,
                    mesh_.edge_marks, lists_.first, lists_.second, counters_.buffer());
    return most;
  }

  void renew_stamps() {
    if (stamps_.left() > 0) return;
    clear_claims(runtime_, mesh_, faces_);
    stamps_.restart();
  }

  runtime::Runtime& runtime_;
  const Plan& plan_;
  const Vertices& vertices_;
  Mesh& mesh_;
  const WorkLists& lists_;
  PhaseCounters& counters_;
  std::uint32_t vertices_in_mesh_;
  cl_uint faces_, edges_;
  cl_uint patches_ = 0;
  Stamps stamps_;
  std::uint64_t flips_before_;
  cl_uint round_ = 0;
};

}  // namespace

FlipResult flip(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh, Ticker& ticker) {
  Flipping flipping(runtime, plan, vertices, mesh, lists, counters, vertices_in_mesh);
  return plan.problems == Plan::By::groups ? flipping.by_problem(ticker) : flipping.run(ticker);
}

FlipResult flip_queued(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                       const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh,
                       Ticker& ticker) {
  return Flipping(runtime, plan, vertices, mesh, lists, counters, vertices_in_mesh)
      .finish(counters.last().list_test[0], After::nothing, ticker);
}

void flip_few_unread(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh) {
  Flipping(runtime, plan, vertices, mesh, lists, counters, vertices_in_mesh).begin_unread();
}

FlipResult flip_left(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                     const WorkLists& lists, PhaseCounters& counters, std::uint32_t vertices_in_mesh, Ticker& ticker) {
  return Flipping(runtime, plan, vertices, mesh, lists, counters, vertices_in_mesh).finish_begun(ticker);
}

}  // namespace gcdt

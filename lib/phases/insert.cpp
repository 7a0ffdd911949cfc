// SPDX-License-Identifier: Apache-2.0
#include "phases/insert.hpp"

#include <tuple>

namespace gcdt {

namespace {

// Every round inserts at least the vertex with the best ticket, and a face with k vertices loses about
// two thirds of them to each child: real inputs take tens of rounds. The limit only stops a device
// that computes wrongly.
constexpr std::uint32_t round_limit = 1u << 20;

/// One level's rounds. Round `round_` has its votes cast whenever a member function is entered.
class LevelInsertion {
 public:
  LevelInsertion(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                 const History& history, bool tree, const WorkLists& lists, PhaseCounters& counters,
                 std::uint32_t candidates)
      : runtime_(runtime),
        plan_(plan),
        vertices_(vertices),
        mesh_(mesh),
        history_(history),
        tree_(tree),
        lists_(lists),
        counters_(counters),
        stamps_(runtime, candidates),
        remaining_(history.end - history.begin) {}

  void locate() {
    freeze();
    stamps_.take();
    launch("insert", "insert_locate", over_level(),
           std::forward_as_tuple(history_.level, stamps_.bits(), vertices_.levels_buffer), list(1), counters_.buffer());
  }

  /// All rounds of all problems, each by one work-group. Stamps are the rounds' numbers: of tickets for so few
  /// candidates there are more than round_limit. Ends: see round_limit.
  std::uint64_t by_problem(Ticker& ticker) {
    freeze();
    const auto lengths = runtime_.allocate<cl_uint>("lists of problems", 2 * std::size_t{mesh_.roots});
    for (std::uint32_t left_before = 0; remaining_ > 0;) {
      for_launches(plan_, vertices_.roots, [&](cl_uint begin, cl_uint end) {
        launch("insert", "insert_problems", runtime_.over_groups(end - begin),
               std::forward_as_tuple(begin, end, history_.level, tree_, round_, stamps_.bits(), plan_.group_rounds,
                                     vertices_.levels_buffer),
               list(0), list(1), lengths, counters_.buffer());
      });
      const device::Counters& c = counters_.read();
      round_ = c.rounds + 1;
      remaining_ = c.list_insert[0] - left_before;  // the device adds up what launches leave
      left_before = c.list_insert[0];
      check(c, ticker);
    }
    mesh_.claims_below = std::uint64_t{round_} << stamps_.bits();
    return round_ - 1;
  }

  /// Ends: see round_limit.
  std::uint64_t finish(Ticker& ticker) {
    for (std::uint32_t rounds = rounds_at_first(); remaining_ > 0;
         rounds = between_reads(rounds_to_few(remaining_ / 4))) {
      const bool by_one_group = may_by_one_group();
      if (remaining_ > few())
        for (std::uint32_t i = 0; i < rounds; ++i) round();
      if (by_one_group) rounds_in_one_group();
      const device::Counters& c = counters_.read();
      round_ += c.rounds - rounds_seen_;
      stamps_.take(c.rounds - rounds_seen_);
      rounds_seen_ = c.rounds;
      remaining_ = c.list_insert[round_ & 1];
      check(c, ticker);
    }
    mesh_.claims_below = stamps_.claims_below();
    return round_ - 1;
  }

 private:
  void freeze() {
    const cl_uint faces = mesh_.faces(history_.begin);
    runtime_.fill<cl_uint>(history_.vertex_face, 0, history_.begin);
    launch("freeze", "insert_freeze", runtime::over(faces), std::tie(faces), counters_.buffer());
    counters_.are_zero();
  }

  void check(const device::Counters& c, Ticker& ticker) const {
    if (c.failed) throw Error(Status::round_limit, "insert: point location left the mesh");
    if (round_ > round_limit) throw Error(Status::round_limit, "insert: vertices are left after the limit of rounds");
    ticker.tick("insert", double(history_.end - remaining_) / mesh_.n);
  }

  // Vertices of which one work-group does the rounds, if it may now.
  bool may_by_one_group() const { return round_ > plan_.rounds_before_few; }
  std::uint32_t few() const { return may_by_one_group() ? plan_.group_vertices : 0; }

  // Rounds after which few vertices are probably left, if the first of them leaves `left`, and each further one a
  // quarter, since most faces with vertices have one. Ends: `left` falls.
  std::uint32_t rounds_to_few(std::uint32_t left) const {
    std::uint32_t rounds = 1;
    for (; left > few() && left > 0; left /= 4) ++rounds;
    return rounds;
  }

  // The same of a level's first rounds: one leaves a third; and before that, while most faces have more than one
  // vertex, a half. Ends: `left` falls.
  std::uint32_t rounds_at_first() const {
    std::uint32_t crowded = 0;
    for (std::uint64_t left = remaining_; left > std::uint64_t{Tuning::crowded_level} * history_.begin && left > 1;
         left /= 2)
      ++crowded;
    return between_reads(rounds_to_few(remaining_ / 3) + crowded);
  }
  std::uint32_t between_reads(std::uint32_t rounds) const {
    return plan_.rounds_per_read == 1
               ? 1
               : std::min(rounds, std::max(plan_.rounds_per_read, Tuning::most_insertion_rounds));
  }

  void round() {
    renew_stamps(1);
    launch("insert", "insert_split", over_remaining(), std::tuple_cat(std::tie(tree_), standing_round()), list(round_),
           counters_.buffer());
    ++round_;
    stamps_.take();
    launch("insert", "insert_vote", over_remaining(), standing_round(), list(round_ - 1), list(round_),
           counters_.buffer());
  }

  // If few vertices are left, which nobody has read yet.
  void rounds_in_one_group() {
    renew_stamps(1);
    const cl_uint most = std::min(stamps_.left(), plan_.group_rounds);
    launch("insert_few", "insert_rounds", runtime::one_group(),
           std::make_tuple(tree_, round_, stamps_.current(), stamps_.bits(), cl_uint(plan_.group_vertices), most),
           list(0), list(1), counters_.buffer());
  }

  // Before the stamps run out the claim words are cleared and the standing votes are cast again.
  void renew_stamps(std::uint32_t wanted) {
    if (stamps_.left() >= wanted) return;
    clear_claims(runtime_, mesh_, mesh_.faces(history_.end));
    stamps_.restart();
    stamps_.take();
    launch("insert", "insert_revote", over_remaining(), standing_round(), list(round_), counters_.buffer());
  }

  // Arguments in the order of all kernels: scalars, mesh, history, lists, counters.
  template <class Scalars, class... Last>
  void launch(const char* program, const char* kernel, runtime::Range range, const Scalars& scalars,
              const Last&... last) {
    std::apply(
        [&](const auto&... scalar) {
          runtime_.launch(program, kernel, range, scalar..., mesh_.n, vertices_.points, mesh_.face_data,
                          mesh_.edge_faces, history_.begin, history_.end, history_.top, history_.vertex_face,
                          history_.nodes, history_.shape, last...);
        },
        scalars);
  }
  std::tuple<cl_uint, cl_uint, cl_uint> standing_round() const { return {round_, stamps_.current(), stamps_.bits()}; }
  runtime::Range over_level() const { return runtime::over(history_.end - history_.begin); }
  // As wide as the list was when last read.
  runtime::Range over_remaining() const { return runtime::over(remaining_); }
  const runtime::Buffer<cl_uint>& list(cl_uint round) const { return round & 1 ? lists_.second : lists_.first; }

  runtime::Runtime& runtime_;
  const Plan& plan_;
  const Vertices& vertices_;
  Mesh& mesh_;
  const History& history_;
  cl_uint tree_;
  const WorkLists& lists_;
  PhaseCounters& counters_;
  Stamps stamps_;
  cl_uint round_ = 1;
  std::uint32_t rounds_seen_ = 0, remaining_;
};

}  // namespace

History make_history(runtime::Runtime& runtime, const device::Levels& levels, std::uint32_t roots) {
  const std::size_t coarse = levels.begin[levels.count - 1];
  std::size_t largest = 0;
  for (std::uint32_t j = 0; j < levels.count; ++j)
    largest = std::max<std::size_t>(largest, levels.begin[j + 1] - levels.begin[j]);
  const std::size_t top_faces = 2 * coarse + roots;
  History history;
  history.top = runtime.allocate<cl_uint4>("top layer", 2 * std::size_t{top_faces});
  history.vertex_face = runtime.allocate<cl_uint>("faces of coarse vertices", coarse);
  history.nodes = runtime.allocate<cl_uint4>("history nodes", largest);
  history.shape = runtime.allocate<cl_uint>("history shapes", largest);
  history.fans = no_fans(runtime);
  history.gates = no_gates(runtime);
  return history;
}

History freeze_all(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh, PhaseCounters& counters) {
  History history;
  history.level = vertices.levels.count;
  history.begin = history.end = mesh.n;
  history.top = runtime.allocate<cl_uint4>("top layer", 2 * std::size_t{mesh.faces()});
  history.vertex_face = runtime.allocate<cl_uint>("faces of coarse vertices", mesh.n);
  history.nodes = runtime.allocate<cl_uint4>("history nodes", 0);
  history.shape = runtime.allocate<cl_uint>("history shapes", 0);
  history.fans = no_fans(runtime);
  history.gates = no_gates(runtime);
  const cl_uint faces = mesh.faces();
  runtime.fill<cl_uint>(history.vertex_face, 0, mesh.n);
  runtime.launch("freeze", "insert_freeze", runtime::over(faces), faces, mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces, history.begin, history.end, history.top, history.vertex_face, history.nodes,
                 history.shape, counters.buffer());
  counters.are_zero();
  mesh.claims_below = 1;
  return history;
}

void insert_root(runtime::Runtime& runtime, const Vertices& vertices, Mesh& mesh) {
  runtime.fill<cl_uint>(mesh.edge_marks, 0, mesh.edges());
  runtime.launch("mesh", "mesh_root", runtime::over(mesh.roots), mesh.n, vertices.points, mesh.face_data,
                 mesh.edge_faces);
}

std::uint64_t insert_level(runtime::Runtime& runtime, const Plan& plan, const Vertices& vertices, Mesh& mesh,
                           History& history, bool located_in, const WorkLists& lists, PhaseCounters& counters,
                           unsigned level, Ticker& ticker) {
  history.level = level;
  history.begin = vertices.levels.begin[level];
  history.end = vertices.levels.begin[level + 1];
  if (plan.problems == Plan::By::groups)
    return LevelInsertion(runtime, plan, vertices, mesh, history, located_in, lists, counters, vertices.largest)
        .by_problem(ticker);
  LevelInsertion insertion(runtime, plan, vertices, mesh, history, located_in, lists, counters,
                           history.end - history.begin);
  insertion.locate();
  return insertion.finish(ticker);
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/refine.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

// The candidate with the greatest ticket wins in each round, and winners are new grid points, so there are at most as
// many rounds as vertices are added. Real ones take tens or hundreds; this only stops a device that computes wrongly.
constexpr std::uint64_t most_rounds = 1u << 20;

// Of RefineReport: the words that a round counts from zero, and those that refine_aim and refine_place count.
constexpr std::size_t words_of_round = 8, first_of_candidates = 5;
constexpr std::size_t words_of_report = sizeof(device::RefineReport) / sizeof(cl_uint);

// Room that is made at a time, as a share of the vertices that are there.
constexpr std::uint32_t least_room = 1024;
// Faces for each block of lists of cavities. Most candidates win, and winners have six faces each; where more triangles
// than that are too large at once, their cavities are gone through again.
constexpr std::uint32_t faces_per_block = 16;

constexpr std::uint32_t most_doublings = GCDT_MOST_DOUBLINGS;

/// Of what an insertion and its flips have counted.
void check_settled(bool failed, std::uint32_t inserted) {
  if (failed) throw Error(Status::round_limit, "refine: a tour around a vertex did not end");
  if (inserted == 0) throw Error(Status::round_limit, "refine: a round inserted nothing");
}

/// Makes `buffer` hold `size` elements, of which the first `kept` stay.
template <class T>
void enlarge(runtime::Runtime& runtime, Buffer<T>& buffer, const char* name, std::size_t size, std::size_t kept) {
  Buffer<T> larger = runtime.allocate<T>(name, size);
  if (kept > 0) runtime.copy(buffer, larger, kept);
  buffer = std::move(larger);
}

}  // namespace

Refiner::Refiner(runtime::Runtime& runtime, Primitives& primitives, const device::RefineRules& rules,
                 std::uint64_t most_added, Vertices vertices, Mesh mesh, Subsegments subsegments, Buffer<cl_uint> sizes,
                 Buffer<cl_ulong> areas)
    : runtime_(runtime),
      primitives_(primitives),
      rules_(rules),
      most_added_(std::min(most_added, max_vertices - vertices.input_vertex.size())),
      vertices_(std::move(vertices)),
      mesh_(std::move(mesh)),
      plan_(make_plan(runtime, vertices_)),
      counters_(runtime),
      inputs_(vertices_.n()),
      origins_begin_(subsegments.origins.allocated() ? 0 : inputs_),
      knows_sharp_(subsegments.sharp.allocated()),
      subsegments_(subsegments.count),
      rules_buffer_(runtime.upload_one("rules of refinement", rules)),
      sizes_(std::move(sizes)),
      areas_(std::move(areas)),
      no_places_(runtime.allocate<cl_int>("places", 0)),
      pieces_(std::move(subsegments.pieces)),
      sharp_(std::move(subsegments.sharp)),
      edge_pieces_(std::move(subsegments.edge_pieces)),
      origins_(std::move(subsegments.origins)),
      report_(runtime.filled<cl_uint>("report of refinement", words_of_report, 0)) {
  if (!areas_.allocated()) areas_ = runtime.allocate<cl_ulong>("areas of labels", 0);
  if (!sizes_.allocated()) sizes_ = runtime.allocate<cl_uint>("wanted lengths", 0);
  if (!knows_sharp_) sharp_ = runtime_.filled<cl_uint>("sharp ends of pieces", subsegments_, 0);
  make_room(static_cast<std::uint32_t>(std::min<std::uint64_t>(most_added_, inputs_ / 2 + least_room)));
}

// Everything that grows with the vertices: `more` of them can be added from now on.
void Refiner::make_room(std::uint32_t more) {
  const std::uint32_t before = mesh_.n, all = count() + more;
  const std::size_t vertices = count(), faces = mesh_.faces(count()), edges = mesh_.edges(count());
  lists_ = {};
  bad_before_ = {};
  aiming_ = {};
  asked_ = {};
  enlarge(runtime_, vertices_.points, "points", all, vertices);
  enlarge(runtime_, origins_, "origins of vertices", all - origins_begin_, count() - origins_begin_);
  if (rules_.sized) enlarge(runtime_, sizes_, "wanted lengths", all, vertices);
  mesh_.n = all;
  enlarge(runtime_, mesh_.face_data, "faces", 2 * std::size_t{mesh_.faces()}, 2 * faces);
  enlarge(runtime_, mesh_.edge_faces, "edge faces", 2 * std::size_t{mesh_.edges()}, 2 * edges);
  enlarge(runtime_, mesh_.edge_marks, "edge marks", mesh_.edges(), edges);
  enlarge(runtime_, edge_pieces_, "pieces of edges", mesh_.edges(), edges);
  runtime_.launch("renew", "refine_room", over(faces), static_cast<cl_uint>(faces), before, all, cl_uint(!labelled_),
                  mesh_.face_data);
  lists_ = make_work_lists(runtime_, all);
  enlarge(runtime_, bad_, "triangles to be mended", mesh_.faces(), last_.bad);
  bad_before_ = runtime_.allocate<cl_uint>("triangles to be mended before", mesh_.faces());
  aiming_ = runtime_.allocate<cl_uint>("triangles that do not wait", mesh_.faces());
  cavities_ = {};
  cavities_ = runtime_.allocate<cl_uint>("cavities", GCDT_BLOCK * std::size_t{mesh_.faces() / faces_per_block + 1});
  const std::size_t known = urgency_.size();
  enlarge(runtime_, urgency_, "urgency of faces", mesh_.faces(), known);
  runtime_.fill<cl_uint>(urgency_, 0, mesh_.faces() - known, known);
  enlarge(runtime_, ways_, "ways to worse triangles", mesh_.faces(), known);
  runtime_.fill<cl_uchar>(ways_, 0, mesh_.faces() - known, known);
  // A vertex makes two subsegments of one.
  asked_ = runtime_.allocate<cl_uint>("subsegments to be split", std::size_t{subsegments_} + (all - inputs_));
}

void Refiner::keep(const Buffer<cl_uint>& refs, const Buffer<cl_int>& kept, cl_uint count) {
  labelled_ = true;
  runtime_.launch("renew", "refine_label", over(count), count, cl_uint(!kept.allocated()), refs,
                  kept.allocated() ? kept : no_places_, mesh_.face_data);
  if (knows_sharp_) return;
  runtime_.launch("renew", "refine_sharp", over(2 * std::size_t{mesh_.edges(inputs_)}), mesh_.edges(inputs_), mesh_.n,
                  vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, pieces_, edge_pieces_, sharp_);
}

device::RefineReport Refiner::read_report() {
  cl_uint words[words_of_report];
  runtime_.read(report_, words, words_of_report);
  device::RefineReport report;
  std::memcpy(&report, words, sizeof report);
  return report;
}

// Which faces are to be mended: last_.bad of them, in bad_, when that is read. If edges are left from flips that nobody
// has read, none is judged.
void Refiner::judge_faces() {
  const cl_uint faces = mesh_.faces(count()),
                most_faces = unread_ ? mesh_.faces(std::min(mesh_.n, count() + last_.candidates)) : faces;
  if (!report_begun_) runtime_.fill<cl_uint>(report_, 0, words_of_round);
  report_begun_ = false;
  if (!keys_.allocated()) {
    const std::size_t room = faces / 4 + least_room;
    keys_ = runtime_.allocate<cl_ulong>("keys of candidates", room);
    numbers_ = runtime_.allocate<cl_uint>("candidates in order", room);
    candidates_ = runtime_.allocate<cl_uint4>("candidates", room);
  }
  std::swap(bad_, bad_before_);
  const bool knows = judged_.vertices > 0 && mesh_.claims_cleared == judged_.cleared;
  const auto threshold = static_cast<cl_uint>(knows ? judged_.claims : 0);
  const cl_uint were_bad = knows ? judged_.bad : 0, added = count() - judged_.vertices;
  if (finds_stars_) {
    launch_judge("tail", "refine_judge_stars", over(judged_.bad + added), capacity(), asked_, keys_, numbers_,
                 candidates_, report_, bad_before_, bad_, urgency_, judged_.bad, judged_.vertices, added);
  } else {
    ++result_.sweeps;
    launch_judge("judge", "refine_judge", over(were_bad + most_faces), capacity(), asked_, keys_, numbers_, candidates_,
                 report_, bad_before_, bad_, urgency_, faces, threshold, were_bad, judged_.vertices, cl_uint(unread_),
                 counters_.buffer());
  }
  judged_before_ = judged_;
  judged_.claims = mesh_.claims_below;
  judged_.cleared = mesh_.claims_cleared;
  judged_.vertices = count();
  finds_stars_ = judges_by_stars();
}

// `idle`: how many times none was found since the last one. Finds the candidates of what is bad.
void Refiner::find_candidates(std::uint32_t idle, Ticker& ticker) {
  wait(idle);
  do {
    aim(idle);
    if (read_candidates()) break;
    if (edges_left_ > 0) {
      flip_what_is_left(ticker);
      judge_faces();
      wait(idle);
    }
  } while (true);  // ends: flips leave no edge, and there is room for all candidates the second time
}

void Refiner::wait(std::uint32_t idle) {
  runtime_.launch("judge", "refine_wait", over(mesh_.faces(count())), mesh_.n, vertices_.points, mesh_.face_data,
                  mesh_.edge_faces, mesh_.edge_marks, report_, bad_, urgency_, ways_, aiming_, result_.searches,
                  cl_uint(idle > 0), teamed());
}

void Refiner::aim(std::uint32_t idle) {
  launch_judge("judge", "refine_aim", over(mesh_.faces(count())), capacity(), asked_, keys_, numbers_, candidates_,
               report_, aiming_, urgency_, GCDT_FACES_OF_ANY << std::min(idle, most_doublings), result_.searches,
               blocks(), cavities_, chosen(), teamed());
  launch_judge("judge", "refine_place", over(subsegments_ + added_), capacity(), asked_, keys_, numbers_, candidates_,
               report_, edge_pieces_, sharp_, blocks(), cavities_, teamed());
}

// False: there was no room for all, but there is the second time, when the same ones are found; or edges are left.
bool Refiner::read_candidates() {
  last_ = read_report();
  if (unread_) take_settled();
  if (last_.failed) throw Error(Status::round_limit, "refine: a walk or a tour did not end");
  if (edges_left_ > 0) return false;
  judged_.bad = last_.bad;
  if (last_.candidates <= capacity()) return true;
  const std::size_t room = last_.candidates + last_.candidates / 4;
  runtime_.reserve(keys_, "keys of candidates", room);
  runtime_.reserve(numbers_, "candidates in order", room);
  runtime_.reserve(candidates_, "candidates", room);
  runtime_.fill<cl_uint>(report_, 0, words_of_round - first_of_candidates, first_of_candidates);
  return false;
}

// Brings the candidates into order of precedence, the last first of all. All of them have won so far. Subsegments are
// not asked for any more.
void Refiner::rank_candidates() {
  const cl_uint candidates = last_.candidates;
  const bool by_count = runtime_.kind() == DeviceKind::gpu && candidates <= runtime_.tuning().most_ranked_by_count;
  if (!by_count) primitives_.sort(keys_, numbers_, candidates);
  runtime_.reserve(won_, "winners", std::size_t{candidates} + 1);
  runtime_.reserve(ranks_, "ranks of candidates", keys_.size());
  const std::size_t items = by_count ? std::size_t{candidates} * GCDT_COUNTING_TEAM : candidates;
  runtime_.launch("refine", by_count ? "refine_count_ranks" : "refine_rank",
                  over(std::max<std::size_t>(items, last_.asked)), candidates, mesh_.n, vertices_.points,
                  mesh_.face_data, mesh_.edge_faces, keys_, candidates_, numbers_, ranks_, won_, asked_,
                  mesh_.edge_marks, report_, counters_.buffer());
  counters_.are_zero();
}

// won_ becomes the scan of the candidates that hold all that they claim.
void Refiner::choose_winners() {
  const cl_uint candidates = last_.candidates, listed = std::min(last_.blocks, blocks());
  Stamps stamps(runtime_, candidates);
  stamps.go_on_above(mesh_.claims_below);
  if (stamps.left() == 0) {
    clear_claims(runtime_, mesh_, mesh_.faces(count()));
    stamps.restart();
  }
  stamp_ = stamps.take();
  bits_ = stamps.bits();
  mesh_.claims_below = stamps.claims_below();
  runtime_.launch("refine", "refine_claim", over(std::size_t{candidates} + listed), candidates, stamp_, bits_, mesh_.n,
                  vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks, numbers_, ranks_, candidates_,
                  listed, cavities_, chosen(), won_, report_, teamed());
  primitives_.exclusive_scan(won_, won_, candidates);
}

// Leaves of the winners those with the greatest tickets.
void Refiner::keep_greatest(std::uint32_t winners, std::uint32_t most) {
  const cl_uint candidates = last_.candidates;
  const auto in_order = runtime_.allocate<cl_uint>("winners in order", std::size_t{candidates} + 1);
  runtime_.launch("refine", "refine_in_order", over(candidates), candidates, numbers_, won_, in_order);
  primitives_.scan_total(in_order, candidates);
  runtime_.launch("refine", "refine_last_in_order", over(candidates), candidates, winners, most, numbers_, in_order,
                  won_);
  primitives_.scan_total(won_, candidates);
}

// Inserts winners, `most` of them at most, those with the greatest tickets. How many there are is read before only
// where not all candidates may be inserted, or have room.
void Refiner::insert(std::uint32_t most) {
  if (last_.candidates > std::min(most, mesh_.n - count())) {
    const std::uint32_t winners = runtime_.read_one(won_, last_.candidates);
    if (winners > most) keep_greatest(winners, most);
    const std::uint32_t more = std::min(winners, most);
    if (more > mesh_.n - count()) {
      const std::uint64_t room = std::max<std::uint64_t>(more, count() / 2 + least_room);
      make_room(static_cast<std::uint32_t>(std::min<std::uint64_t>(most_added_ - added_, room)));
    }
  }
  report_begun_ = true;
  runtime_.launch("refine", "refine_insert", over(last_.candidates), last_.candidates, count(), stamp_, bits_,
                  rules_.sized, mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks,
                  edge_pieces_, numbers_, ranks_, candidates_, won_, vertices_.points, origins_begin_, origins_, sizes_,
                  lists_.first, counters_.buffer(), report_);
}

// Makes the mesh Delaunay, and counts the winners. Where one work-group takes all flips, in the many small rounds at
// the end, a GPU goes on to the next search at once, and what was settled is read with what that finds: each read lets
// the GPU wait for the host.
void Refiner::settle(Ticker& ticker) {
  const std::uint32_t before = count(), most = std::min(mesh_.n, before + last_.candidates);
  unread_ = runtime_.kind() == DeviceKind::gpu && last_.candidates <= runtime_.tuning().most_unread;
  if (unread_) {
    flip_few_unread(runtime_, plan_, vertices_, mesh_, lists_, counters_, most);
    return;
  }
  const std::uint32_t inserted = counters_.read().list_insert[0];
  const FlipResult flipped = flip_queued(runtime_, plan_, vertices_, mesh_, lists_, counters_, most, ticker);
  const device::Counters& c = counters_.last();
  check_settled(c.failed != 0, inserted);
  result_.flips += wide(c.flips_low, c.flips_high);
  result_.flip_rounds += flipped.rounds;
  added_ += inserted;
  look_for_stars(before, flipped.rounds > 0);
}

// The report says what was settled since the host read the counters. Edges that are left are counted later.
void Refiner::take_settled() {
  const device::RefineSettled& s = last_.settled;
  unread_ = false;
  check_settled(s.failed != 0, s.inserted);
  added_ += s.inserted;
  edges_left_ = s.left;
  if (edges_left_ > 0) return;
  judged_.vertices = count();
  result_.flips += wide(s.flips_low, s.flips_high);
  result_.flip_rounds += s.rounds;
}

// Nothing was judged, since edges are left from flips that nobody has read.
void Refiner::flip_what_is_left(Ticker& ticker) {
  std::swap(bad_, bad_before_);
  judged_ = judged_before_;
  --result_.sweeps;
  counters_.read();
  const FlipResult flipped = flip_left(runtime_, plan_, vertices_, mesh_, lists_, counters_, count(), ticker);
  result_.flips += flipped.flips;
  result_.flip_rounds += flipped.rounds;
  edges_left_ = 0;
}

// Whether all that has changed can be judged by the stars of the vertices from `first` on. Flips may have taken from a
// vertex what it was made with.
void Refiner::look_for_stars(std::uint32_t first, bool flipped) {
  if (!judges_by_stars()) return;
  if (flipped) {
    runtime_.launch("tail", "refine_find_stars", over(count() - first), first, count() - first, mesh_.n,
                    vertices_.points, mesh_.face_data, mesh_.edge_faces, counters_.buffer());
    counters_.read();
  }
  finds_stars_ = counters_.last().lost == 0;
}

// Claims, and insertion of those that win. Returns false where none may be inserted.
bool Refiner::insert_candidates(Ticker& ticker) {
  rank_candidates();
  const auto most = most_left();
  result_.complete = most > 0;
  if (most == 0) return false;
  if (result_.rounds == most_rounds) throw Error(Status::round_limit, "refine: there were too many rounds");
  choose_winners();
  result_.candidates += last_.candidates;
  insert(most);
  settle(ticker);
  ++result_.rounds;
  return true;
}

RefineResult Refiner::run(Ticker& ticker) {
  result_ = {};
  for (std::uint32_t idle = 0;;) {
    ticker.tick("refine", most_added_ == 0 ? 1
                                           : double(added_) / double(std::min<std::uint64_t>(
                                                                  most_added_, 4 * std::uint64_t{inputs_})));
    judge_faces();
    if (is_small(idle)) {
      const std::uint32_t stage = do_small_rounds(idle, ticker);
      if (stage == GCDT_TAIL_ENDED) break;
      if (stage != GCDT_TAIL_CANDIDATES) continue;
      while (!read_candidates()) aim(idle);
    } else {
      find_candidates(idle, ticker);
    }
    was_small_ = false;
    ++result_.searches;
    result_.aims += last_.aiming;
    if (last_.candidates == 0) {
      rank_candidates();
      if (last_.aiming == last_.bad && last_.sitting_out == 0) break;
      // All that did not wait aimed in vain, and are in no one's way from now on, or sat out: next time all may aim,
      // and go through twice as many faces.
      if (++idle > last_.bad + most_doublings) throw Error(Status::round_limit, "refine: triangles wait for ever");
      continue;
    }
    idle = 0;
    if (!insert_candidates(ticker)) break;
  }
  explain();
  return result_;
}

}  // namespace gcdt

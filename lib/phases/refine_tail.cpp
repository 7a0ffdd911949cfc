// SPDX-License-Identifier: Apache-2.0
// Rounds of refinement that one work-item does by itself (kernels/refine/tail.cl).
#include <cstddef>

#include "phases/refine.hpp"

namespace gcdt {

namespace {

constexpr std::size_t words_of_tail = sizeof(device::RefineTail) / sizeof(cl_uint),
                      begin_of_tail = offsetof(device::RefineReport, tail) / sizeof(cl_uint);

}  // namespace

// Rounds get smaller, but for the first ones: the next is taken to be no larger than the last.
bool Refiner::is_small(std::uint32_t idle) const {
  return judges_by_stars() && !was_small_ && result_.rounds > 0 && last_.aiming <= runtime_.tuning().most_tail_aims &&
         idle <= GCDT_MOST_DOUBLINGS && most_left() > 0;
}

// Faces have been judged. Returns where the rounds have stopped, GCDT_TAIL_...
std::uint32_t Refiner::do_small_rounds(std::uint32_t& idle, Ticker& ticker) {
  Stamps stamps(runtime_, mesh_.edges());
  stamps.go_on_above(mesh_.claims_below);
  if (stamps.left() < GCDT_TAIL_STAMPS) {
    clear_claims(runtime_, mesh_, mesh_.faces(count()));
    stamps.restart();
  }
  counters_.zero();
  runtime_.fill<cl_uint>(report_, 0, words_of_tail, begin_of_tail);
  runtime_.reserve(won_, "winners", std::size_t{GCDT_TAIL_CANDIDATES_MOST} + 1);
  runtime_.reserve(ranks_, "ranks of candidates", keys_.size());
  const auto room = static_cast<std::uint32_t>(std::min<std::uint64_t>(mesh_.n, std::uint64_t{count()} + most_left()));
  launch_judge("tail", "refine_tail", runtime::one_group(), capacity(), asked_, keys_, numbers_, candidates_, report_,
               edge_pieces_, sharp_, bad_, bad_before_, urgency_, ways_, aiming_, blocks(), cavities_, ranks_, won_,
               vertices_.points, origins_, sizes_, lists_.first, lists_.second, counters_.buffer(), count(),
               stamps.current(), stamps.bits(), stamps.current() + stamps.left(), result_.searches, idle,
               runtime_.tuning().rounds_of_tail, runtime_.tuning().most_tail_aims, room);
  last_ = read_report();
  judged_.bad = last_.bad;
  if (last_.failed) throw Error(Status::round_limit, "refine: a walk or a tour did not end");
  stamps.take(last_.tail.stamp - stamps.current());
  take_over(stamps);
  idle = last_.tail.idle;
  was_small_ = last_.tail.stage == GCDT_TAIL_JUDGE && last_.tail.searches == 0;
  if (last_.tail.stage == GCDT_TAIL_FLIPS) {
    counters_.read();
    result_.flip_rounds += flip_queued(runtime_, plan_, vertices_, mesh_, lists_, counters_, count(), ticker).rounds;
    result_.flips += wide(counters_.last().flips_low, counters_.last().flips_high);
  }
  return last_.tail.stage;
}

// What the rounds did, and what they leave.
void Refiner::take_over(const Stamps& stamps) {
  const device::RefineTail& tail = last_.tail;
  mesh_.claims_below = stamps.claims_below();
  if (tail.judgings > 0) {
    judged_.vertices = tail.judged;
    judged_.claims = (std::uint64_t{tail.stamp_judged} + 1) << stamps.bits();
    judged_.cleared = mesh_.claims_cleared;
  }
  if (tail.judgings % 2 == 1) std::swap(bad_, bad_before_);
  finds_stars_ = tail.lost == 0;
  added_ = tail.vertices - inputs_;
  result_.rounds += tail.rounds;
  result_.searches += tail.searches;
  result_.aims += tail.aims;
  result_.candidates += tail.candidates;
  result_.flips += wide(tail.flips_low, tail.flips_high);
  result_.flip_rounds += tail.flip_rounds;
}

}  // namespace gcdt

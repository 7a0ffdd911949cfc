// SPDX-License-Identifier: Apache-2.0
#include "phases/split.hpp"

#include <algorithm>
#include <cmath>

#include "constrain/snap.h"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

Splitter::Splitter(runtime::Runtime& runtime, Primitives& primitives, const Buffer<cl_uint2>& constraints,
                   std::uint32_t inputs)
    : runtime_(runtime),
      primitives_(primitives),
      constraints_(constraints),
      inputs_(inputs),
      count_(cl_uint(constraints.size())) {
  touched_ = runtime_.filled<cl_uint>("marked constraints", std::size_t(count_) + 1, 0);
}

std::uint64_t Splitter::find(const WalkedMesh& walked, const Pieces& pieces, PhaseCounters& counters) {
  CrossingPieces crossing(runtime_, primitives_, walked, pieces, counters);
  if (crossing.count() == 0) return 0;
  gather_points(crossing, walked, pieces);
  mark(crossing, pieces, false);
  return pairs_;
}

std::uint32_t Splitter::mark(const WalkedMesh& walked, const Pieces& pieces, PhaseCounters& counters) {
  CrossingPieces crossing(runtime_, primitives_, walked, pieces, counters);
  return mark(crossing, pieces, true);
}

const Buffer<cl_uint>& Splitter::mark_crossing(const WalkedMesh& walked, const Pieces& pieces,
                                               PhaseCounters& counters) {
  CrossingPieces crossing(runtime_, primitives_, walked, pieces, counters);
  mark(crossing, pieces, false);
  return touched_;
}

std::uint32_t Splitter::mark(CrossingPieces& crossing, const Pieces& pieces, bool linked) {
  auto newly = runtime_.filled<cl_uint>("newly marked", 1, 0);
  crossing.for_windows([&](const Buffer<cl_uint2>& pairs, cl_uint some) {
    runtime_.launch("split", "split_touch", over(some), some, cl_uint(linked), pieces.source_offsets, pieces.sources,
                    linked ? owners_ : touched_, pairs, touched_, newly);
  });
  const cl_uint more = runtime_.read_one(newly);
  marked_ += more;
  return more;
}

// Window by window: the pixels known so far and those of the next pairs, sorted, of each the least
// pair kept.
void Splitter::gather_points(CrossingPieces& crossing, const WalkedMesh& walked, const Pieces& pieces) {
  auto total = runtime_.filled<cl_uint>("pairs of constraints", 2, 0);
  crossing.for_windows([&](const Buffer<cl_uint2>& pairs, cl_uint some) {
    const cl_uint before = distinct_;
    auto keys = runtime_.allocate<cl_ulong>("pixels of crossings", std::size_t(before) + some);
    auto named = runtime_.allocate<cl_uint2>("constraints of crossings", std::size_t(before) + some);
    auto numbers = runtime_.allocate<cl_uint>("crossings", std::size_t(before) + some);
    if (before > 0) {
      runtime_.copy(keys_, keys, before);
      runtime_.copy(least_, named, before);
    }
    runtime_.launch("split", "split_points", over(some), some, before, walked.vertices.points, pieces.ends,
                    pieces.source_offsets, pieces.sources, pairs, keys, named, numbers, total);
    keep_distinct(std::move(keys), std::move(numbers), named, before + some);
  });
  cl_uint words[2];
  runtime_.read(total, words, 2);
  pairs_ = wide(words[0], words[1]);
}

void Splitter::keep_distinct(Buffer<cl_ulong> keys, Buffer<cl_uint> numbers, const Buffer<cl_uint2>& named,
                             cl_uint count) {
  primitives_.sort(keys, numbers, count, GCDT_PIXEL_KEY_BITS);
  auto firsts = runtime_.allocate<cl_uint>("first crossings", std::size_t(count) + 1);
  runtime_.launch("clean", "mark_first", over(count), count, keys, firsts);
  distinct_ = primitives_.scan_total(firsts, count);
  keys_ = runtime_.allocate<cl_ulong>("distinct pixels", distinct_);
  least_ = runtime_.filled<cl_uint2>("least pairs", distinct_, {{GCDT_NONE, GCDT_NONE}});
  runtime_.launch("split", "split_least_first", over(count), count, keys, numbers, firsts, named, keys_, least_);
  runtime_.launch("split", "split_least_second", over(count), count, numbers, firsts, named, least_);
}

Vertices Splitter::add(Vertices vertices) {
  auto fresh = runtime_.allocate<cl_uint>("new pixels", std::size_t(distinct_) + 1);
  runtime_.launch("split", "split_is_new", over(distinct_), distinct_, vertices.levels_buffer, vertices.points, keys_,
                  fresh);
  added_.count = primitives_.scan_total(fresh, distinct_);
  check_vertex_count(std::uint64_t(inputs_) + added_.count);
  auto list = runtime_.allocate<cl_uint>("list of new pixels", added_.count);
  primitives_.compact_indices(fresh, list, distinct_);
  added_.points = runtime_.allocate<cl_int2>("added vertices", added_.count);
  added_.crossing = runtime_.allocate<cl_uint2>("constraints of added vertices", added_.count);
  InputPoints joined;
  joined.n = inputs_ + added_.count;
  joined.type = coordinates_type(Points::Type::int32);
  joined.coordinates = runtime_.allocate<cl_ulong>("joined vertices", joined.n);
  runtime_.launch("split", "split_join", over(joined.n), inputs_, cl_uint(added_.count), vertices.points,
                  vertices.input_vertex, list, keys_, least_, joined.coordinates, added_.points, added_.crossing);
  const Grid grid = vertices.grid;
  const auto decimals = vertices.decimals;
  vertices = {};
  keys_ = {};
  least_ = {};
  const Plan plan = make_plan(runtime_, {1, joined.n, joined.n});
  Vertices all = order(runtime_, primitives_, plan, std::move(joined), FixedGrid{}).vertices;
  all.grid = grid;
  all.decimals = decimals;
  return all;
}

const Buffer<cl_uint2>& Splitter::route(const Plan& plan, const Vertices& vertices) {
  const cl_uint n = vertices.n();
  auto offsets_of_marked = runtime_.allocate<cl_uint>("marked before", std::size_t(count_) + 1);
  primitives_.exclusive_scan(touched_, offsets_of_marked, count_);
  auto list = runtime_.allocate<cl_uint>("list of marked", marked_);
  primitives_.compact_indices(offsets_of_marked, list, count_);
  auto ends = runtime_.allocate<cl_uint2>("ends of marked", marked_);
  runtime_.launch("split", "split_ends", over(marked_), cl_uint(marked_), list, constraints_, vertices.input_vertex,
                  ends);
  auto codes = runtime_.allocate<cl_ulong>("codes by rank", n);
  runtime_.launch("split", "split_codes", over(n), n, vertices.levels_buffer, vertices.points, codes);

  const PieceParts parts = parts_by_length(runtime_, primitives_, plan, vertices, ends, marked_);
  auto offsets = runtime_.allocate<cl_uint>("vertices of parts", std::size_t(parts.capacity) + 1);
  auto areas = runtime_.allocate<cl_ulong>("areas of parts", parts.capacity);
  auto total = runtime_.filled<cl_uint>("vertices of all parts", 2, 0);
  auto walk = [&](cl_uint emit, const Buffer<cl_uint>& hits) {
    runtime_.launch("route", "route_walk", over(parts.capacity), emit, cl_uint(marked_), parts.capacity, n,
                    vertices.levels_buffer, vertices.points, codes, ends, parts.begins, offsets, hits, areas, total);
  };
  walk(0, offsets);
  cl_uint words[2];
  runtime_.read(total, words, 2);
  const std::uint64_t links = count_ + wide(words[0], words[1]);
  if (links > GCDT_MAX_CONSTRAINTS)
    throw Error(Status::out_of_memory, "split: more than 2^31 - 1 parts of constraints: " + std::to_string(links));
  primitives_.exclusive_scan(offsets, offsets, parts.capacity);
  const cl_uint found = words[0];
  auto hits = runtime_.allocate<cl_uint>("vertices of constraints", found);
  if (found > 0) walk(1, hits);

  auto farthest = runtime_.allocate<cl_ulong2>("farthest vertices", marked_);
  auto starts = runtime_.allocate<cl_uint>("first links", std::size_t(count_) + 1);
  runtime_.fill<cl_uint>(starts, 1, count_);
  runtime_.launch("route", "route_totals", over(marked_), cl_uint(marked_), vertices.points, ends, list, parts.begins,
                  offsets, areas, farthest, starts);
  primitives_.exclusive_scan(starts, starts, count_);
  links_ = runtime_.allocate<cl_uint2>("links", links);
  owners_ = runtime_.allocate<cl_uint>("owners of links", links);
  runtime_.launch("route", "route_unmarked", over(count_), count_, touched_, constraints_, starts, links_, owners_);
  runtime_.launch("route", "route_links", over(parts.capacity), cl_uint(marked_), vertices.levels_buffer,
                  vertices.vertex_input, ends, list, parts.begins, offsets, hits, starts, links_, owners_);
  measure(farthest);
  return links_;
}

void Splitter::measure(const Buffer<cl_ulong2>& farthest) {
  std::vector<cl_ulong2> all(marked_);
  runtime_.read(farthest, all.data(), all.size());
  largest_move_ = 0;
  for (const cl_ulong2& f : all) largest_move_ = std::max(largest_move_, double(f.s[0]) / std::sqrt(double(f.s[1])));
}

void Splitter::name_sources(Pieces& pieces) {
  const cl_uint count = pieces.source_count;
  if (count > 0) runtime_.launch("route", "route_sources", over(count), count, owners_, pieces.sources);
}

}  // namespace gcdt

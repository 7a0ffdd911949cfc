// SPDX-License-Identifier: Apache-2.0
#include "batch/copy.hpp"

#include <algorithm>

namespace gcdt {

using runtime::Buffer;

namespace {

/// Elements for which an array gets room, with n vertices and m constraints. Only overlaps, which cut pieces, need
/// more.
std::uint64_t room_for(const ResultArray& array, const ProblemRanges& ranges) {
  const std::uint64_t n = ranges.first_input.back(), m = ranges.first_constraint.back();
  if (array.there != There::always) return 0;
  switch (array.per) {
    case Per::triangle: return 2 * n;
    case Per::vertex: return n;
    case Per::piece:
    case Per::source: return m;
    case Per::piece_bound: return m + ranges.count();
    default: return 0;
  }
}

class Copy {
 public:
  Copy(runtime::Runtime& runtime, const ProblemRanges& ranges, Staging& staging, ForestResult& result)
      : runtime_(runtime), ranges_(ranges), problems_(ranges.count()), staging_(staging), result_(result) {}

  void run(const DeviceTriangulation& made, const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece) {
    const Begins triangles = wide_of(first_triangle), pieces = wide_of(first_piece);
    const Begins inputs(ranges_.first_input.begin(), ranges_.first_input.end());
    for (const ResultArray& array : result_arrays) {
      if (array.there == There::on_demand || array.there == There::with_added || !has(made, array)) continue;
      if (array.per == Per::triangle) begins(array.number) = triangles;
      if (array.per == Per::vertex) begins(array.number) = inputs;
      if (array.per == Per::piece) begins(array.number) = pieces;
      if (array.per == Per::piece_bound)
        bounds(made.pieces, pieces);
      else
        whole(made, array);
    }
    renumber_dropped(made.dropped.size());
    remember_sizes();
  }

 private:
  using Begins = std::vector<std::uint64_t>;

  template <class T>
  T* room(std::int32_t number, std::size_t count) {
    return result_.arrays[static_cast<std::size_t>(number)].reuse<T>(count);
  }
  Begins& begins(std::int32_t number) { return result_.begins[static_cast<std::size_t>(number)]; }

  /// Copies the array as it is on the device, where one problem's part follows the other's.
  void whole(const DeviceTriangulation& made, const ResultArray& array) {
    const std::size_t bytes = elements(made, array) * array.element_bytes;
    runtime_.read_bytes(array.memory(made), 0, room<unsigned char>(array.number, bytes), bytes);
  }

  Begins wide_of(const Buffer<cl_uint>& buffer) {
    std::vector<cl_uint> words(std::size_t{problems_} + 1);
    runtime_.read(buffer, words.data(), words.size());
    return {words.begin(), words.end()};
  }

  // A problem has one more source offset than it has pieces, and its first one is 0.
  void bounds(const Pieces& made, const Begins& first) {
    const std::size_t count = made.count;
    cl_uint* offsets = staging_.offsets.reuse<cl_uint>(count + 1);
    runtime_.read(made.source_offsets, offsets, count + 1);
    auto* local = room<cl_uint>(GCDT_SOURCE_OFFSETS, count + problems_);
    auto &offset_begins = begins(GCDT_SOURCE_OFFSETS), &source_begins = begins(GCDT_SOURCES);
    for (std::size_t p = 0; p < problems_; ++p) {
      offset_begins.push_back(first[p] + p);
      source_begins.push_back(offsets[first[p]]);
      for (std::size_t i = first[p]; i <= first[p + 1]; ++i) *local++ = offsets[i] - offsets[first[p]];
    }
    offset_begins.push_back(count + problems_);
    source_begins.push_back(made.source_count);
  }

  // On the device dropped constraints are numbered through the run.
  void renumber_dropped(std::size_t count) {
    auto* local = reinterpret_cast<cl_uint*>(result_.arrays[GCDT_DROPPED].bytes.get());
    std::size_t i = 0;
    for (std::size_t p = 0; p < problems_; ++p) {
      begins(GCDT_DROPPED).push_back(i);
      for (; i < count && local[i] < ranges_.first_constraint[p + 1]; ++i) local[i] -= ranges_.first_constraint[p];
    }
    begins(GCDT_DROPPED).push_back(i);
  }

  void remember_sizes() {
    for (const ResultArray& array : result_arrays) {
      const std::uint64_t most = room_for(array, ranges_);
      if (most > 0)
        staging_.filled[static_cast<std::size_t>(array.number)] =
            std::min(1.0, static_cast<double>(begins(array.number).back()) / static_cast<double>(most));
    }
  }

  runtime::Runtime& runtime_;
  const ProblemRanges& ranges_;
  std::uint32_t problems_;
  Staging& staging_;
  ForestResult& result_;
};

}  // namespace

ForestRoom::ForestRoom(const runtime::Runtime& runtime, const ProblemRanges& ranges, const Staging& staging,
                       ForestResult& result) {
  if (!runtime::prepares_host_memory(runtime) || ranges.first_input.back() < Tuning::least_prepared_vertices) return;
  try {
    std::vector<runtime::HostRoom::Range> touched;
    for (const ResultArray& array : result_arrays) {
      const auto slot = static_cast<std::size_t>(array.number);
      const std::uint64_t most = room_for(array, ranges);
      if (most == 0) continue;
      const std::size_t bytes = most * array.element_bytes;
      auto* memory = result.arrays[slot].make<unsigned char>(bytes);
      touched.push_back({memory, static_cast<std::size_t>(static_cast<double>(bytes) * staging.filled[slot])});
    }
    room_.emplace(touched, 1);
  } catch (const std::bad_alloc&) {
    // copy_forest() asks for the memory again, and reports it.
  }
}

void copy_forest(runtime::Runtime& runtime, const DeviceTriangulation& made, const Buffer<cl_uint>& first_triangle,
                 const Buffer<cl_uint>& first_piece, const ProblemRanges& ranges, Staging& staging,
                 ForestResult& result) {
  Copy(runtime, ranges, staging, result).run(made, first_triangle, first_piece);
}

}  // namespace gcdt

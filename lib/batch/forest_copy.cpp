// SPDX-License-Identifier: Apache-2.0
#include "batch/forest_copy.hpp"

#include <algorithm>

namespace gcdt {

using runtime::Buffer;

namespace {

// The system's pages are no smaller.
constexpr std::size_t page = 4096;

/// Elements that an array has room for, for n vertices and m constraints; more come only where overlaps cut pieces.
std::uint64_t room_for(int kind, std::uint64_t n, std::uint64_t m, std::uint64_t problems) {
  switch (kind) {
    case GCDT_TRIANGLES:
    case GCDT_NEIGHBOURS:
    case GCDT_CONSTRAINED: return 2 * n;
    case GCDT_REPRESENTATIVES: return n;
    case GCDT_PIECES:
    case GCDT_SOURCES: return m;
    case GCDT_SOURCE_OFFSETS: return m + problems;
    default: return 0;
  }
}

class Copy {
 public:
  Copy(runtime::Runtime& runtime, const ProblemRanges& ranges, Staging& staging, ForestResult& result)
      : runtime_(runtime), ranges_(ranges), problems_(ranges.count()), staging_(staging), result_(result) {}

  void run(const DeviceTriangulation& made, const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece) {
    const OrderedMesh& mesh = made.mesh;
    const std::size_t triangles = mesh.triangles;
    read(mesh.corners, room<cl_uint>(GCDT_TRIANGLES, 3 * triangles), 3 * triangles);
    read(mesh.neighbours, room<cl_int>(GCDT_NEIGHBOURS, 3 * triangles), 3 * triangles);
    read(mesh.constrained, room<cl_uchar>(GCDT_CONSTRAINED, triangles), triangles);
    for (const int kind : {GCDT_TRIANGLES, GCDT_NEIGHBOURS, GCDT_CONSTRAINED}) begins(kind) = wide_of(first_triangle);
    const std::size_t inputs = ranges_.first_input.back();
    read(made.representatives, room<cl_uint>(GCDT_REPRESENTATIVES, inputs), inputs);
    begins(GCDT_REPRESENTATIVES).assign(ranges_.first_input.begin(), ranges_.first_input.end());
    pieces(made.pieces, wide_of(first_piece));
    dropped(made.dropped);
    if (made.regions.region.allocated()) regions(made.regions, triangles);
    remember_sizes();
  }

 private:
  template <class T>
  T* room(int kind, std::size_t count) {
    return result_.arrays[static_cast<std::size_t>(kind)].reuse<T>(count);
  }
  std::vector<std::uint64_t>& begins(int kind) { return result_.begins[static_cast<std::size_t>(kind)]; }

  template <class T>
  void read(const Buffer<T>& from, T* to, std::size_t count) {
    runtime_.read(from, to, count);
  }

  std::vector<std::uint64_t> wide_of(const Buffer<cl_uint>& buffer) {
    std::vector<cl_uint> words(std::size_t{problems_} + 1);
    read(buffer, words.data(), words.size());
    return {words.begin(), words.end()};
  }

  // The source offsets of a problem start at 0 and end with one more than it has pieces.
  void pieces(const Pieces& made, std::vector<std::uint64_t> first) {
    const std::size_t count = made.count;
    runtime_.read_bytes(made.ends.handle(), 0, room<cl_uint2>(GCDT_PIECES, count), count * sizeof(cl_uint2));
    read(made.sources, room<cl_uint>(GCDT_SOURCES, made.source_count), made.source_count);
    cl_uint* offsets = staging_.offsets.reuse<cl_uint>(count + 1);
    read(made.source_offsets, offsets, count + 1);
    auto* local = room<cl_uint>(GCDT_SOURCE_OFFSETS, count + problems_);
    auto &offset_begins = begins(GCDT_SOURCE_OFFSETS), &source_begins = begins(GCDT_SOURCES);
    for (std::size_t p = 0; p < problems_; ++p) {
      offset_begins.push_back(first[p] + p);
      source_begins.push_back(offsets[first[p]]);
      for (std::size_t i = first[p]; i <= first[p + 1]; ++i) *local++ = offsets[i] - offsets[first[p]];
    }
    offset_begins.push_back(count + problems_);
    source_begins.push_back(made.source_count);
    begins(GCDT_PIECES) = std::move(first);
  }

  void regions(const Regions& made, std::size_t triangles) {
    read(made.region, room<cl_uint>(GCDT_REGIONS, triangles), triangles);
    read(made.depth, room<cl_uint>(GCDT_DEPTHS, triangles), triangles);
    read(made.winding, room<cl_int>(GCDT_WINDINGS, triangles), triangles);
    read(made.seed, room<cl_int>(GCDT_REGION_SEEDS, triangles), triangles);
    for (const int kind : {GCDT_REGIONS, GCDT_DEPTHS, GCDT_WINDINGS, GCDT_REGION_SEEDS})
      begins(kind) = begins(GCDT_TRIANGLES);
  }

  void dropped(const Buffer<cl_uint>& made) {
    auto* local = room<cl_uint>(GCDT_DROPPED, made.size());
    read(made, local, made.size());
    std::size_t i = 0;
    for (std::size_t p = 0; p < problems_; ++p) {
      begins(GCDT_DROPPED).push_back(i);
      for (; i < made.size() && local[i] < ranges_.first_constraint[p + 1]; ++i)
        local[i] -= ranges_.first_constraint[p];
    }
    begins(GCDT_DROPPED).push_back(i);
  }

  void remember_sizes() {
    for (int kind = 0; kind < static_cast<int>(ForestResult::array_count); ++kind) {
      const auto slot = static_cast<std::size_t>(kind);
      const std::uint64_t most = room_for(kind, ranges_.first_input.back(), ranges_.first_constraint.back(), problems_);
      if (most > 0)
        staging_.filled[slot] = std::min(1.0, static_cast<double>(begins(kind).back()) / static_cast<double>(most));
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
  const std::uint64_t n = ranges.first_input.back(), m = ranges.first_constraint.back(), problems = ranges.count();
  if (!runtime::prepares_host_memory(runtime) || n < Tuning::least_prepared_vertices) return;
  try {
    thread_ = std::thread([this, &staging, &result, n, m, problems] { make(staging, result, n, m, problems); });
  } catch (const std::system_error&) {
    // No thread to be had: copy_forest() makes the room.
  }
}

// Ends after a pass over the arrays.
void ForestRoom::make(const Staging& staging, ForestResult& result, std::uint64_t n, std::uint64_t m,
                      std::uint64_t problems) {
  try {
    for (int kind = 0; kind < static_cast<int>(ForestResult::array_count); ++kind) {
      const auto slot = static_cast<std::size_t>(kind);
      const std::uint64_t most = room_for(kind, n, m, problems);
      if (most == 0) continue;
      const std::size_t bytes = most * gcdt_element_bytes(kind);
      auto* memory = result.arrays[slot].make<unsigned char>(bytes);
      const auto touched = static_cast<std::size_t>(static_cast<double>(bytes) * staging.filled[slot]);
      for (std::size_t at = 0; at < touched; at += page) {
        if (enough_) return;
        *static_cast<volatile unsigned char*>(memory + at) = 0;
      }
    }
  } catch (const std::bad_alloc&) {
    // copy_forest() asks again, and reports it.
  }
}

void ForestRoom::wait() {
  enough_ = true;
  if (thread_.joinable()) thread_.join();
}

void copy_forest(runtime::Runtime& runtime, const DeviceTriangulation& made, const Buffer<cl_uint>& first_triangle,
                 const Buffer<cl_uint>& first_piece, const ProblemRanges& ranges, Staging& staging,
                 ForestResult& result) {
  Copy(runtime, ranges, staging, result).run(made, first_triangle, first_piece);
}

}  // namespace gcdt

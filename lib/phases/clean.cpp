// SPDX-License-Identifier: Apache-2.0
#include "phases/clean.hpp"

#include <array>

#include "device/step.hpp"

namespace gcdt {

using runtime::over;

runtime::Buffer<cl_uint2> stage(runtime::Runtime& runtime, Constraints constraints) {
  static_assert(sizeof(Constraint) == sizeof(cl_uint2), "a constraint is copied as it is");
  return runtime.upload("constraints", reinterpret_cast<const cl_uint2*>(constraints.data()), constraints.size());
}

Error index_error(std::uint64_t constraint, std::uint64_t end, std::uint64_t vertices) {
  return Error(Status::index_out_of_range,
               "constraint " + std::to_string(constraint) + ": its " + (end == 1 ? "second" : "first") +
                   " end is no vertex; there are " + std::to_string(vertices),
               {constraint, end});
}

Pieces merge_runs(runtime::Runtime& runtime, Primitives& primitives, const runtime::Buffer<cl_uint>& firsts,
                  cl_uint count) {
  Pieces pieces;
  pieces.source_count = count;
  pieces.count = primitives.scan_total(firsts, count);
  pieces.source_offsets = runtime.allocate<cl_uint>("source offsets", std::size_t(pieces.count) + 1);
  primitives.compact_indices(firsts, pieces.source_offsets, count);
  runtime.fill<cl_uint>(pieces.source_offsets, count, 1, pieces.count);
  return pieces;
}

Cleaner::Cleaner(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                 const runtime::Buffer<cl_uint2>& constraints, std::uint32_t inputs)
    : runtime_(runtime),
      primitives_(primitives),
      vertices_(vertices),
      inputs_(inputs),
      count_(cl_uint(constraints.size())),
      constraints_(constraints) {}

Cleaner::Kept Cleaner::keep(const Plan& plan, const std::vector<cl_uint>& wanted) {
  const cl_uint all = wanted.empty();
  auto ends = runtime_.allocate<cl_uint2>("ends of constraints", count_);
  // Behind the flags their sum, and the first end that is no input point.
  auto kept = runtime_.allocate<cl_uint>("kept constraints", std::size_t(count_) + 2);
  const auto wanted_buffer = runtime_.upload("wanted constraints", wanted);
  runtime_.fill<cl_uint>(kept, GCDT_NONE, 1, std::size_t(count_) + 1);
  runtime_.launch("clean", "clean_map", over(count_), count_, cl_uint(inputs_), constraints_, vertices_.input_vertex,
                  wanted_buffer, all, ends, kept);
  primitives_.exclusive_scan(kept, kept, count_);
  std::array<cl_uint, 2> found;
  runtime_.read(kept, found.data(), found.size(), count_);
  if (found[1] != GCDT_NONE) throw index_error(found[1] / 2, found[1] % 2, inputs_);
  Kept result;
  result.count = found[0];
  result.list = runtime_.allocate<cl_uint>("list of constraints", result.count);
  result.ends = runtime_.allocate<cl_uint2>("ends of kept constraints", result.count);
  primitives_.compact_indices(kept, result.list, count_);
  runtime_.launch("clean", "clean_gather", over(result.count), result.count, result.list, ends, result.ends);
  result.along_curve = plan.along_curve;
  if (result.along_curve) put_along_curve(result);
  return result;
}

// Constraints that lie side by side cross the same faces: a thread that walks them one after the other has these in its
// cache.
void Cleaner::put_along_curve(Kept& kept) {
  auto keys = runtime_.allocate<cl_uint>("ranks of constraints", kept.count);
  auto places = runtime_.allocate<cl_uint>("places of constraints", kept.count);
  runtime_.launch("clean", "clean_ranks", over(kept.count), kept.count, vertices_.levels_buffer, kept.ends, keys,
                  places);
  primitives_.sort(keys, places, kept.count, std::max(1u, bit_width(vertices_.n())));
  auto list = runtime_.allocate<cl_uint>("list of constraints", kept.count);
  auto ends = runtime_.allocate<cl_uint2>("ends of kept constraints", kept.count);
  runtime_.launch("clean", "clean_gather", over(kept.count), kept.count, places, kept.ends, ends);
  runtime_.launch("clean", "clean_gather_list", over(kept.count), kept.count, places, kept.list, list);
  kept.list = std::move(list);
  kept.ends = std::move(ends);
  kept.places = std::move(places);
}

// Pieces are written in the order of their sources, in whatever order these were walked: sorting them keeps the sources
// of equal ones ascending.
void Cleaner::place_pieces(const Kept& kept, const PieceParts& parts, const runtime::Buffer<cl_uint>& offsets,
                           runtime::Buffer<cl_uint>& firsts) {
  firsts = runtime_.allocate<cl_uint>("first pieces of constraints", kept.along_curve ? kept.count + 1u : 0u);
  if (!kept.along_curve) return;
  runtime_.launch("clean", "clean_count", over(kept.count), kept.count, parts.begins, offsets, kept.places, firsts);
  primitives_.exclusive_scan(firsts, firsts, kept.count);
}

CleanResult Cleaner::clean(const WalkedMesh& walked, const std::vector<cl_uint>& wanted, PhaseCounters& counters) {
  const Kept kept = keep(walked.plan, wanted);
  const std::uint64_t selected =
      wanted.empty() ? count_ : std::count_if(wanted.begin(), wanted.end(), [](cl_uint w) { return w != 0; });
  CleanResult result;
  result.zero_length = selected - kept.count;
  runtime_.end_step();
  Step walking(runtime_, "walk");
  const PieceParts parts = parts_by_length(runtime_, primitives_, walked.plan, vertices_, kept.ends, kept.count);
  auto part_face = runtime_.allocate<cl_uint>("first faces of parts", parts.capacity);
  auto crossed = runtime_.filled<cl_uint>("faces crossed by constraints", count_, 0);
  auto whole = runtime_.allocate<cl_uint2>("parts of whole constraints", count_);
  auto offsets = runtime_.allocate<cl_uint>("hits of parts", std::size_t(parts.capacity) + 1);
  auto walk = [&](cl_uint emit, const runtime::Buffer<cl_uint>& hits) {
    walked.launch(runtime_, "clean", "clean_walk", over(parts.capacity),
                  std::make_tuple(emit, kept.count, parts.capacity), kept.ends, kept.list, parts.begins, part_face,
                  offsets, hits, crossed, counters.buffer());
  };
  walk(0, offsets);
  primitives_.exclusive_scan(offsets, offsets, parts.capacity);
  if (counters.read().failed) throw Error(Status::check_failed, "clean: a walk along a constraint left the mesh");
  result.walk_ms = walking.end();
  const cl_uint hits = counters.last().hits;
  result.hits = hits;
  auto hit_list = runtime_.allocate<cl_uint>("vertices on constraints", hits);
  if (hits > 0) walk(1, hit_list);

  const cl_uint count = hits + kept.count;
  const unsigned bits = std::max(1u, bit_width(vertices_.n()));
  auto keys = runtime_.allocate<cl_ulong>("keys of pieces", count);
  auto sources = runtime_.allocate<cl_uint>("sources of pieces", count);
  runtime::Buffer<cl_uint> firsts;
  place_pieces(kept, parts, offsets, firsts);
  runtime_.launch("clean", "clean_pieces", over(parts.capacity), kept.count, cl_uint(kept.along_curve), cl_uint(bits),
                  vertices_.levels_buffer, kept.ends, parts.begins, offsets, hit_list, kept.list,
                  kept.along_curve ? kept.places : kept.list, firsts, keys, sources, crossed, whole);
  result.pieces = merge(vertices_, std::move(keys), std::move(sources), crossed, whole, count, bits);
  result.pieces.walked.faces = std::move(part_face);
  return result;
}

Pieces Cleaner::merge(const Vertices& vertices, runtime::Buffer<cl_ulong> keys, runtime::Buffer<cl_uint> sources,
                      const runtime::Buffer<cl_uint>& crossed, const runtime::Buffer<cl_uint2>& whole, cl_uint count,
                      unsigned bits) {
  primitives_.sort_by_prefix(keys, sources, count, 2 * bits, bits);
  auto firsts = runtime_.allocate<cl_uint>("first pieces", std::size_t(count) + 1);
  runtime_.launch("clean", "mark_first", over(count), count, keys, firsts);
  Pieces pieces = merge_runs(runtime_, primitives_, firsts, count);
  pieces.ends = runtime_.allocate<cl_uint2>("pieces", pieces.count);
  pieces.walked.weights = runtime_.allocate<cl_uint>("weights of pieces", pieces.count);
  pieces.walked.parts = runtime_.allocate<cl_uint2>("parts of whole pieces", pieces.count);
  runtime_.launch("clean", "clean_ends", over(pieces.count), pieces.count, cl_uint(bits), vertices.levels_buffer, keys,
                  pieces.source_offsets, sources, crossed, whole, pieces.ends, pieces.walked.weights,
                  pieces.walked.parts);
  pieces.sources = std::move(sources);
  return pieces;
}

}  // namespace gcdt

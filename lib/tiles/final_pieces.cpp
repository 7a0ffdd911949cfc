// SPDX-License-Identifier: Apache-2.0
#include "tiles/final_pieces.hpp"

#include "tiles/indices.hpp"
#include "tiles/read_back.hpp"

namespace gcdt::tiles {

using runtime::over;
using runtime::Runtime;

namespace {

template <class T>
Array<T> from_file(Spill& file, std::size_t count) {
  Array<T> all(count);
  file.take<T>([&](Span<T> part, std::size_t first) { std::copy(part.begin(), part.end(), all.begin() + first); });
  return all;
}

}  // namespace

std::uint64_t FinalPieces::device_bytes() const {
  std::uint64_t bytes = 0;
  if (ends.allocated()) bytes += ends.bytes();
  if (offsets.allocated()) bytes += offsets.bytes();
  if (sources.allocated()) bytes += sources.bytes();
  return bytes;
}

void FinalPieces::number_ends(Runtime& runtime, const runtime::Buffer<cl_uint>& ids) {
  if (count > 0) runtime.launch("tiles", "tile_input_numbers", over(2 * std::size_t{count}), 2 * count, ids, ends);
}

void FinalPieces::spill(Runtime& runtime, const std::string& directory) {
  spilled_.reset();
  Spilled made;
  made.with_offsets = offsets.allocated();
  if (count > 0 && !directory.empty()) {
    made.file.emplace(directory);
    made.file->put(runtime, ends);
    if (made.with_offsets) made.file->put(runtime, offsets);
    made.file->put(runtime, sources);
  } else if (count > 0) {
    made.in_memory.ends = read_array<Constraint>(runtime, ends, count);
    if (made.with_offsets) made.in_memory.offsets = read_array<std::uint32_t>(runtime, offsets, std::size_t{count} + 1);
    made.in_memory.sources = read_array<std::uint32_t>(runtime, sources, source_count);
  }
  spilled_ = std::move(made);
}

HostPieces FinalPieces::take(std::uint64_t n, std::uint64_t constraints) {
  HostPieces taken = std::move(spilled_->in_memory);
  if (spilled_->file) {
    taken.ends = from_file<Constraint>(*spilled_->file, count);
    if (spilled_->with_offsets) taken.offsets = from_file<std::uint32_t>(*spilled_->file, std::size_t{count} + 1);
    taken.sources = from_file<std::uint32_t>(*spilled_->file, source_count);
    spilled_->file.reset();
  }
  check_ends_below(taken.ends, n, "the end of a piece is no vertex of the input");
  check_below(taken.sources, constraints, "a source of a piece is no constraint of the input");
  if (spilled_->with_offsets) check_offsets(taken.offsets, count, source_count, "the sources of a piece are not there");
  return taken;
}

FinalPieces::OnItsWay FinalPieces::begin_write(Runtime& runtime, const runtime::Buffer<cl_uint>& ids,
                                               const runtime::Buffer<cl_int2>& points, const SeamPieces& seam,
                                               const SeamKeys& keys, const PieceBerth& to) const {
  OnItsWay made;
  const auto of_seam = made.of_seam = static_cast<cl_uint>(seam.pieces.size());
  if (count == 0) return made;
  const cl_uint with_offsets = offsets.allocated() ? 1 : 0;
  const runtime::Buffer<cl_uint>& own_offsets = with_offsets ? offsets : sources;  // any, without
  made.before = runtime.allocate<cl_uint>("kept pieces before", of_seam);
  made.sources_before = runtime.allocate<cl_uint>("sources before", of_seam);
  if (of_seam > 0) {
    const auto given = runtime.allocate<cl_ulong2>("keys of the seam's pieces", of_seam);
    runtime.write_bytes(given.memory(), 0, keys.data(), of_seam * sizeof(keys[0]));
    runtime.launch("tiles", "pieces_before", over(of_seam), of_seam, cl_uint{count}, with_offsets, given, ends,
                   own_offsets, points, made.before, made.sources_before);
  }
  const auto seam_offsets =
      runtime.upload("sources of the seam's pieces", seam.source_offsets.data(), std::size_t{of_seam} + 1);
  const std::size_t all = std::size_t{count} + of_seam, all_sources = std::size_t{source_count} + seam.sources.size();
  made.ends = runtime.allocate<cl_uint2>("output pieces", all);
  made.offsets = runtime.allocate<cl_uint>("output offsets", all);
  made.sources = runtime.allocate<cl_uint>("output sources", all_sources);
  runtime.launch("tiles", "pieces_write", over(count), cl_uint{count}, of_seam, with_offsets, cl_uint{to.first_source},
                 made.before, seam_offsets, ids, ends, own_offsets, sources, made.ends, made.offsets, made.sources);
  made.reads = {{made.ends.memory(), to.ends, all * sizeof(Constraint)},
                {made.offsets.memory(), to.offsets, all * sizeof(std::uint32_t)},
                {made.sources.memory(), to.sources, all_sources * sizeof(std::uint32_t)}};
  return made;
}

PiecesBefore FinalPieces::end_write(Runtime& runtime, const OnItsWay& written) const {
  if (count == 0)
    return {std::vector<std::uint32_t>(written.of_seam, 0), std::vector<std::uint32_t>(written.of_seam, 0)};
  PiecesBefore found{read_all_of<std::uint32_t>(runtime, written.before, written.of_seam),
                     read_all_of<std::uint32_t>(runtime, written.sources_before, written.of_seam)};
  const auto ascends = [](const std::vector<std::uint32_t>& numbers, std::uint32_t most) {
    check_each(numbers.size(), "a piece of the seam has no place among the tile's",
               [&](std::size_t i) { return numbers[i] <= (i + 1 < numbers.size() ? numbers[i + 1] : most); });
  };
  ascends(found.pieces, count), ascends(found.sources, source_count);
  return found;
}

}  // namespace gcdt::tiles

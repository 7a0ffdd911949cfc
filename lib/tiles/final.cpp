// SPDX-License-Identifier: Apache-2.0
#include "tiles/final.hpp"

#include "device/step.hpp"
#include "tiles/indices.hpp"
#include "tiles/tiles.h"

namespace gcdt::tiles {

using runtime::over;
using runtime::Runtime;

std::uint64_t FinalTriangles::device_bytes() const {
  if (!on_device()) return 0;
  return corners.bytes() + neighbours.bytes() + constrained.bytes() + (ids.allocated() ? ids.bytes() : 0) +
         (points.allocated() ? points.bytes() : 0) + (before.allocated() ? before.bytes() : 0) + pieces.device_bytes();
}

void FinalTriangles::compact(Runtime& runtime) {
  if (!before.allocated()) return;
  auto own_corners = runtime.allocate<cl_uint>("final corners", 3 * std::size_t{count});
  auto own_neighbours = runtime.allocate<cl_int>("final neighbours", 3 * std::size_t{count});
  auto own_flags = runtime.allocate<cl_uchar>("final flags", count);
  if (count > 0)
    runtime.launch("tiles", "tile_finals", over(triangles), cl_uint{triangles}, before, corners, neighbours,
                   constrained, own_corners, own_neighbours, own_flags);
  triangles = count;
  corners = std::move(own_corners), neighbours = std::move(own_neighbours), constrained = std::move(own_flags);
  before = {};
}

std::function<void(Runtime& runtime)> FinalTriangles::begin_spill(Runtime& runtime, const SpillTo& to) {
  compact(runtime);
  auto made = std::make_shared<Spilled>();
  made->berth = to.in_result;
  if (!to.directory.empty())
    made->file.emplace(to.directory);
  else if (!to.in_result.triangles)
    made->berth = {made->triangles.make<Triangle>(count), made->neighbours.make<Neighbours>(count),
                   made->constrained.make<std::uint8_t>(count)};
  if (ids.allocated()) {
    // Corners and ends become input numbers, and must not be made so twice, whatever fails in between.
    if (!corners_numbered_) {
      take_codes(runtime);
      const cl_uint words = 3 * count;
      if (words > 0) runtime.launch("tiles", "tile_input_numbers", over(words), words, ids, corners);
      corners_numbered_ = true;
    }
    pieces.number_ends(runtime, ids);
    const runtime::Buffer<cl_uint> in_use = std::move(ids);
    points = {};
    runtime.finish();
  }
  spilled_ = made;
  return [this, made, directory = to.directory](Runtime& any) {
    Step reading(any, "spill");
    pieces.spill(any, directory);
    if (made->file) {
      made->file->put(any, corners);
      made->file->put(any, neighbours);
      made->file->put(any, constrained);
    } else if (count > 0) {
      any.read_all({{corners.memory(), made->berth.triangles, count * sizeof(Triangle)},
                    {neighbours.memory(), made->berth.neighbours, count * sizeof(Neighbours)},
                    {constrained.memory(), made->berth.constrained, count}});
    }
    reading.end();
    made->done = true;
  };
}

void FinalTriangles::take_codes(Runtime& runtime) {
  codes.resize((count + GCDT_TILE_STEP - 1) / GCDT_TILE_STEP);
  if (codes.empty()) return;
  const auto size = static_cast<cl_uint>(codes.size());
  const auto made = runtime.allocate<cl_ulong>("codes of final triangles", size);
  runtime.launch("tiles", "tile_codes", over(size), size, corners, points, made);
  runtime.read(made, codes.data(), size);
}

void FinalTriangles::end_spill() {
  if (!spilled_) return;
  if (spilled_->done)
    corners = {}, neighbours = {}, constrained = {}, pieces.leave();
  else
    spilled_.reset();
}

void FinalTriangles::spill(Runtime& runtime, const SpillTo& to) {
  try {
    begin_spill(runtime, to)(runtime);
  } catch (...) {
    end_spill();
    throw;
  }
  end_spill();
}

void FinalTriangles::leave_result() {
  const Berth from = berth();
  Berth& to = spilled_->berth;
  to = {spilled_->triangles.make<Triangle>(count), spilled_->neighbours.make<Neighbours>(count),
        spilled_->constrained.make<std::uint8_t>(count)};
  std::copy(from.triangles, from.triangles + count, to.triangles);
  std::copy(from.neighbours, from.neighbours + count, to.neighbours);
  std::copy(from.constrained, from.constrained + count, to.constrained);
}

void FinalTriangles::release() {
  corners = {}, neighbours = {}, constrained = {}, before = {}, ids = {}, points = {};
  pieces.leave();
  forget(codes);
  spilled_.reset();
}

namespace {

/// The first part of a large tile is on its way while the rest is put into its order: so many chunks' worth of
/// triangles are worth that, of which the first part is such a part.
constexpr std::size_t chunks_worth_parts = 1024;
constexpr cl_uint part_written_first = 8;

/// Waits for what a side queue does, whatever happens.
struct Resting {
  const runtime::SideQueue* side;
  ~Resting() {
    if (side) side->rest();
  }
};

}  // namespace

std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      const Berth& to, const std::vector<runtime::HostRead>& behind) {
  const cl_uint seam = places.of_seam;
  const std::size_t count = std::size_t{final.count} + seam;
  Runtime& runtime = lent.runtime;
  if (final.count == 0) {
    runtime.read_all(behind);
    return std::vector<std::uint32_t>(seam, 0);
  }
  const cl_uint triangles = final.triangles, all_final = final.before.allocated() ? 0 : 1;
  const runtime::Buffer<cl_uint>& finals_before = all_final ? final.corners : final.before;  // any, if all are
  auto before = runtime.allocate<cl_uint>("final triangles before", seam);
  if (seam > 0) {
    const SeamKeys given = places.make_keys();
    auto keys = runtime.allocate<cl_ulong2>("keys of the seam's triangles", seam);
    runtime.write_bytes(keys.memory(), 0, given.data(), seam * sizeof(given[0]));
    runtime.launch("tiles", "tile_before", over(seam), seam, triangles, all_final, keys, final.corners, final.points,
                   finals_before, before);
  }
  auto at = runtime.allocate<cl_uint>("places of final triangles", triangles);
  runtime.launch("tiles", "tile_places", over(triangles), triangles, all_final, seam, finals_before, before, at);
  const auto corners = runtime.allocate<cl_uint>("output corners", 3 * count);
  const auto others = runtime.allocate<cl_int>("output neighbours", 3 * count);
  const auto flags = runtime.allocate<cl_uchar>("output flags", count);
  const auto write = [&](cl_uint begin, cl_uint end) {  // of the tile's triangles
    runtime.launch("tiles", "tile_write", over(end - begin), end - begin, begin, cl_uint{places.first}, at, final.ids,
                   final.corners, final.neighbours, final.constrained, corners, others, flags);
  };
  const auto reads = [&](std::size_t begin, std::size_t end) -> std::vector<runtime::HostRead> {
    const std::size_t some = end - begin;
    return {{corners.memory(), to.triangles + begin, some * sizeof(Triangle), begin * sizeof(Triangle)},
            {others.memory(), to.neighbours + begin, some * sizeof(Neighbours), begin * sizeof(Neighbours)},
            {flags.memory(), to.constrained + begin, some, begin}};
  };
  const Resting resting{lent.side};
  const std::size_t bytes = count * (sizeof(Triangle) + sizeof(Neighbours) + 1);
  const bool in_parts = lent.side && bytes / chunks_worth_parts >= runtime.tuning().least_chunked;
  cl_uint part = in_parts ? triangles / part_written_first : 0;
  // So many final ones are in the part. None goes down, so what is before that place in the result is among them.
  cl_uint first = part == 0 || all_final ? part : runtime.read_one(final.before, part);
  if (first > final.count) refuse("a tile's device has counted more than there are");
  if (first == 0 || first == count) part = first = 0;  // one of the two reads would be empty
  if (part > 0) {
    write(0, part);
    runtime.finish();
    lent.side->begin([&reads, first](Runtime& any) {
      Step reading(any, "read beside");
      any.read_all(reads(0, first));
      reading.end();
    });
  }
  write(part, triangles);
  if (part > 0) lent.side->wait();
  std::vector<runtime::HostRead> rest = reads(first, count);
  rest.insert(rest.end(), behind.begin(), behind.end());
  runtime.read_all(rest);
  std::vector<std::uint32_t> counts(seam);
  runtime.read(before, counts.data(), seam);
  check_before(counts, final.count);
  return counts;
}

}  // namespace gcdt::tiles

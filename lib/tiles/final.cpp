// SPDX-License-Identifier: Apache-2.0
#include "tiles/final.hpp"

#include "device/step.hpp"

namespace gcdt::tiles {

using runtime::over;
using runtime::Runtime;

void FinalTriangles::spill(Runtime& runtime, const std::string& directory) {
  auto spilled = std::make_unique<Spill>(directory);
  spilled->put(runtime, corners);
  spilled->put(runtime, neighbours);
  spilled->put(runtime, constrained);
  spilled->put(runtime, ids);
  spilled->put(runtime, points);
  release();
  spilled_ = std::move(spilled);
}

void FinalTriangles::load(Runtime& runtime) {
  corners = spilled_->take<cl_uint>(runtime, "final corners");
  neighbours = spilled_->take<cl_int>(runtime, "final neighbours");
  constrained = spilled_->take<cl_uchar>(runtime, "final flags");
  ids = spilled_->take<cl_uint>(runtime, "input numbers of a tile");
  points = spilled_->take<cl_int2>(runtime, "points of a tile");
  spilled_.reset();
}

void FinalTriangles::release() {
  corners = {}, neighbours = {}, constrained = {}, ids = {}, points = {};
  spilled_.reset();
}

std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      Triangle* triangles, Neighbours* neighbours, std::uint8_t* constrained) {
  const auto seam = static_cast<cl_uint>(places.keys.size());
  const std::size_t count = std::size_t{final.count} + seam;
  if (final.count == 0) return std::vector<std::uint32_t>(seam, 0);
  Runtime& runtime = lent.runtime;
  Step writing(runtime, "write");
  if (!final.on_device()) final.load(runtime);
  auto before = runtime.allocate<cl_uint>("final triangles before", seam);
  if (seam > 0) {
    auto keys = runtime.allocate<cl_ulong2>("keys of the seam's triangles", seam);
    runtime.write_bytes(keys.handle(), 0, places.keys.data(), seam * sizeof(places.keys[0]));
    runtime.launch("tiles", "tile_before", over(seam), seam, final.count, keys, final.corners, final.points, before);
  }
  auto at = runtime.allocate<cl_uint>("places of final triangles", final.count);
  runtime.launch("tiles", "tile_places", over(final.count), final.count, seam, before, at);
  const auto corners = runtime.allocate<cl_uint>("output corners", 3 * count);
  const auto others = runtime.allocate<cl_int>("output neighbours", 3 * count);
  const auto flags = runtime.allocate<cl_uchar>("output flags", count);
  runtime.launch("tiles", "tile_write", over(final.count), final.count, cl_uint{places.first}, at, final.ids,
                 final.corners, final.neighbours, final.constrained, corners, others, flags);
  runtime.read_all({{corners.handle(), triangles, count * sizeof(Triangle)},
                    {others.handle(), neighbours, count * sizeof(Neighbours)},
                    {flags.handle(), constrained, count}});
  std::vector<std::uint32_t> counts(seam);
  runtime.read(before, counts.data(), seam);
  writing.end();
  return counts;
}

}  // namespace gcdt::tiles

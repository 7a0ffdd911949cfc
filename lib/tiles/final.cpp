// SPDX-License-Identifier: Apache-2.0
#include "tiles/final.hpp"

#include "device/step.hpp"

namespace gcdt::tiles {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

template <class Use>
void FinalTriangles::for_arrays(Use&& use) {
  use(corners, 0), use(neighbours, 1), use(constrained, 2), use(ids, 3), use(points, 4);
}

template <class T>
void FinalTriangles::spill_one(Runtime& runtime, Buffer<T>& buffer, std::size_t slot) {
  counts_[slot] = buffer.size();
  runtime.read(buffer, spilled_[slot].make<T>(buffer.size()), buffer.size());
  buffer = {};
}

template <class T>
void FinalTriangles::load_one(Runtime& runtime, Buffer<T>& buffer, std::size_t slot) {
  buffer = runtime.upload("final triangles", reinterpret_cast<const T*>(spilled_[slot].bytes.get()), counts_[slot]);
  spilled_[slot] = {};
}

void FinalTriangles::spill(Runtime& runtime) {
  for_arrays([&](auto& buffer, std::size_t slot) { spill_one(runtime, buffer, slot); });
}

void FinalTriangles::release() {
  for_arrays([&](auto& buffer, std::size_t slot) { buffer = {}, spilled_[slot] = {}; });
}

void FinalTriangles::load(Runtime& runtime) {
  for_arrays([&](auto& buffer, std::size_t slot) { load_one(runtime, buffer, slot); });
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
  runtime.read_all({{corners.handle(), triangles + places.first, count * sizeof(Triangle)},
                    {others.handle(), neighbours + places.first, count * sizeof(Neighbours)},
                    {flags.handle(), constrained + places.first, count}});
  std::vector<std::uint32_t> counts(seam);
  runtime.read(before, counts.data(), seam);
  writing.end();
  return counts;
}

}  // namespace gcdt::tiles

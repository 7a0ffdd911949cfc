// SPDX-License-Identifier: Apache-2.0
#include "tiles/near.hpp"

#include "tiles/indices.hpp"
#include "tiles/passages.h"
#include "tiles/read_back.hpp"

namespace gcdt::tiles {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

/// Marks the triangles that are near in `near`, and their corners in `used`; both become scans. Returns how many there
/// are of each.
std::array<cl_uint, 2> mark(Runtime& runtime, Primitives& primitives, const OrderedMesh& mesh,
                            const Buffer<cl_int2>& points, const Buffer<cl_uint>& ends, const Buffer<cl_uint>& near,
                            const Buffer<cl_uint>& used) {
  const auto cells = runtime.filled<cl_uint>("cells near passages", GCDT_PASSAGE_ROWS * GCDT_PASSAGE_WORDS, 0);
  const auto passages = static_cast<cl_uint>(ends.size() / 2), vertices = static_cast<cl_uint>(points.size());
  runtime.launch("passages", "passage_cells", over(passages), passages, ends, points, cells);
  runtime.launch("passages", "passage_near", over(mesh.triangles), mesh.triangles, mesh.corners, points, cells, near,
                 used);
  const std::array<cl_uint, 2> counts = {primitives.scan_total(near, mesh.triangles),
                                         primitives.scan_total(used, vertices)};
  if (counts[0] > mesh.triangles || counts[1] > vertices) refuse("a tile's device has counted more than there are");
  return counts;
}

}  // namespace

NearMesh near_mesh(Runtime& runtime, Primitives& primitives, const OrderedMesh& mesh, const Buffer<cl_int2>& points,
                   const std::vector<Passage>& passages) {
  std::vector<std::uint32_t> numbers;
  for (const Passage& passage : passages) numbers.push_back(passage.from), numbers.push_back(passage.to);
  const auto count = static_cast<cl_uint>(numbers.size());
  const Buffer<cl_uint> ends = runtime.upload("ends of passages", numbers);
  const auto near = runtime.allocate<cl_uint>("triangles near passages", std::size_t{mesh.triangles} + 1);
  const auto used = runtime.filled<cl_uint>("their corners", points.size() + 1, 0);
  const auto [triangles, vertices] = mark(runtime, primitives, mesh, points, ends, near, used);

  NearMesh made;
  const auto taken = runtime.allocate<cl_uint>("numbers of near triangles", triangles);
  const auto corners = runtime.allocate<cl_uint>("corners of near triangles", 3 * std::size_t{triangles});
  const auto neighbours = runtime.allocate<cl_int>("neighbours of near triangles", 3 * std::size_t{triangles});
  runtime.launch("passages", "passage_take", over(mesh.triangles), mesh.triangles, near, used, mesh.corners,
                 mesh.neighbours, taken, corners, neighbours);
  made.triangles.resize(triangles), made.neighbours.resize(triangles);
  runtime.read_bytes(corners.memory(), 0, made.triangles.data(), triangles * sizeof(Triangle));
  runtime.read_bytes(neighbours.memory(), 0, made.neighbours.data(), triangles * sizeof(Neighbours));

  made.numbers = read_all_of<std::uint32_t>(runtime, taken, triangles);
  check_below(made.numbers, mesh.triangles, "a triangle near a constraint is none of the tile");

  const auto list = runtime.allocate<cl_uint>("vertices near passages", vertices);
  primitives.compact_indices(used, list, points.size());
  const auto gathered = [&](const Buffer<cl_uint>& from, cl_uint size) {
    const auto where = runtime.allocate<cl_int2>("points", size);
    runtime.launch("tiles", "tile_gather_points", over(size), size, from, points, where);
    return read_array<GridPoint>(runtime, where, size);
  };
  made.points = gathered(list, vertices);
  // A vertex that no near triangle has would get another one's number.
  const GridPoints end_points = gathered(ends, count);
  const auto renumbered = runtime.allocate<cl_uint>("ends among near vertices", count);
  runtime.launch("tiles", "tile_gather", over(count), count, ends, used, renumbered);
  numbers = read_all_of<std::uint32_t>(runtime, renumbered, count);
  check_each(count, "a constraint ends at a vertex that no triangle of the tile has", [&](std::size_t i) {
    return numbers[i] < made.points.size() && made.points[numbers[i]] == end_points[i];
  });
  made.passages = passages;
  for (std::size_t i = 0; i < passages.size(); ++i)
    made.passages[i].from = numbers[2 * i], made.passages[i].to = numbers[2 * i + 1];
  return made;
}

}  // namespace gcdt::tiles

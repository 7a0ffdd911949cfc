// SPDX-License-Identifier: Apache-2.0
#include "batch/alone.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::Runtime;

namespace {

/// Programs for one triangulation, as long as it lives.
class OneMesh {
 public:
  explicit OneMesh(Runtime& runtime) : runtime_(runtime) { runtime_.build_for_forests(false); }
  ~OneMesh() { runtime_.build_for_forests(true); }
  OneMesh(const OneMesh&) = delete;
  OneMesh& operator=(const OneMesh&) = delete;

 private:
  Runtime& runtime_;
};

Points points_of(const BatchInput& batch, std::uint32_t p) {
  const auto count = static_cast<std::size_t>(batch.n(p));
  const auto from = [&](auto number) {
    return Points::pairs(static_cast<const decltype(number)*>(batch.vertices) + 2 * batch.vertex_offsets[p], count);
  };
  switch (batch.type) {
    case Points::Type::float32: return from(float{});
    case Points::Type::int32: return from(std::int32_t{});
    case Points::Type::int64: return from(std::int64_t{});
    default: return from(double{});
  }
}

/// Copies what a call has left on the device.
class ResultCopy {
 public:
  ResultCopy(Runtime& runtime, ForestResult& result) : runtime_(runtime), result_(result) {}

  void run(const DeviceTriangulation& made) {
    const OrderedMesh& mesh = made.mesh;
    const Pieces& pieces = made.pieces;
    take(GCDT_TRIANGLES, mesh.corners, mesh.triangles, 3);
    take(GCDT_NEIGHBOURS, mesh.neighbours, mesh.triangles, 3);
    take(GCDT_CONSTRAINED, mesh.constrained, mesh.triangles);
    take(GCDT_REPRESENTATIVES, made.representatives, made.representatives.size());
    take(GCDT_PIECES, pieces.ends, pieces.count);
    take(GCDT_SOURCE_OFFSETS, pieces.source_offsets, std::size_t{pieces.count} + 1);
    take(GCDT_SOURCES, pieces.sources, pieces.source_count);
    take(GCDT_DROPPED, made.dropped, made.dropped.size());
    take(GCDT_ADDED, made.added.points, made.added.count);
    take(GCDT_ADDED_CROSSINGS, made.added.crossing, made.added.count);
    if (!made.regions.region.allocated()) return;
    take(GCDT_REGIONS, made.regions.region, mesh.triangles);
    take(GCDT_DEPTHS, made.regions.depth, mesh.triangles);
    take(GCDT_WINDINGS, made.regions.winding, mesh.triangles);
    take(GCDT_REGION_SEEDS, made.regions.seed, mesh.triangles);
  }

 private:
  /// `count` elements of `width` numbers each.
  template <class T>
  void take(int kind, const Buffer<T>& from, std::size_t count, std::size_t width = 1) {
    const auto slot = static_cast<std::size_t>(kind);
    result_.begins[slot] = {0, count};
    runtime_.read(from, result_.arrays[slot].make<T>(count * width), count * width);
  }

  Runtime& runtime_;
  ForestResult& result_;
};

}  // namespace

ForestResult triangulate_alone(Runtime& runtime, Primitives& primitives, const BatchInput& batch, std::uint32_t number,
                               const Options& options) {
  const OneMesh programs(runtime);
  Options own = options;
  own.canonical = true;
  const Points points = points_of(batch, number);
  const Constraints constraints = {batch.constraints + batch.constraint_offsets[number],
                                   static_cast<std::size_t>(batch.m(number))};
  const InputSource source = {points.size(), constraints.size(), [&] {
                                return DeviceInput{stage(runtime, points), stage(runtime, constraints)};
                              }};
  runtime.memory().begin_call();
  const DeviceTriangulation made = Pipeline(runtime, primitives, source, own).run();
  ForestResult result;
  runtime.tracer().begin_phase("copy");
  ResultCopy(runtime, result).run(made);
  runtime.tracer().end_phase();
  result.problems = {number};
  result.grids = {made.statistics.grid};
  result.together = {{made.statistics.vertices_rounded_together, made.statistics.rounded_pair}};
  result.statistics = made.statistics;
  return result;
}

}  // namespace gcdt

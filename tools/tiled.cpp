// SPDX-License-Identifier: Apache-2.0
#include "tiled.hpp"

#include <gcdt/gcdt_pool.hpp>

#include "progress.hpp"

namespace gcdt::command {

namespace {

/// The names of the devices that did some of the work.
std::string names_of(const Pool& pool) {
  std::string names;
  for (const PoolDevice& device : pool.devices())
    if (device.runs > 0) names += (names.empty() ? "" : ", ") + device.info.name;
  return names;
}

/// What the arrays say.
void count(const io::Input& input, const io::MeshArrays& mesh, Statistics& s) {
  s.n = input.vertices.size(), s.m = input.constraints.size();
  for (std::uint32_t v = 0; v < mesh.representative.size(); ++v) s.vertices_merged += mesh.representative[v] != v;
  for (const Constraint& c : input.constraints)
    s.constraints_zero += mesh.representative[c[0]] == mesh.representative[c[1]];
  s.constraints_pieces = mesh.pieces.size();
  s.constraints_overlapping = mesh.sources.size() - mesh.pieces.size();
  s.constraints_dropped = mesh.dropped.size();
  s.triangles = mesh.triangles.size();
  s.version = version();
}

}  // namespace

bool wants_pool(const TriangulateArguments& arguments) {
  return arguments.tiles > 0 || arguments.memory > 0 || arguments.device == "all" ||
         arguments.device.find(',') != std::string::npos;
}

Computed triangulate_on_pool(const io::Input& input, const TriangulateArguments& arguments, const Options& options,
                             Trace trace, Measured& measured) {
  const Stopwatch watch;
  Pool pool(arguments.device, {}, std::move(trace), arguments.memory, arguments.spill);
  Options own = options;
  const auto devices = static_cast<std::uint32_t>(pool.devices().size());
  own.tiles = arguments.tiles > 0 || devices < 2 ? arguments.tiles : devices;
  const std::vector<std::uint64_t> n = {0, input.vertices.size()}, m = {0, input.constraints.size()};
  Computed made;
  made.of_pool = pool.triangulate({input.vertices, n, input.constraints, m}, own);
  const BatchResult& result = *made.of_pool;
  if (const std::optional<Error> error = result.error(0)) throw *error;
  Statistics& s = made.mesh.statistics;
  s = detail::statistics(result, 0);
  made.mesh.added = grid_coordinates(s.grid, result.added_on_grid(0));
  count(input, made.arrays(), s);
  s.device = names_of(pool);
  s.ms.call = watch.milliseconds();
  measured.tiles = result.tiles(0);
  return made;
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
#include "tiles/ranks.hpp"

#include "device/parts.hpp"
#include "device/step.hpp"
#include "tiles/domain.hpp"
#include "tiles/input_exchange.hpp"

namespace gcdt::tiles {

namespace {

/// All ranks' elements, in the order of the ranks, at the first one.
template <class T>
void collect(Team& team, ForestResult& result, std::int32_t array) {
  std::vector<Bytes> messages(team.size());
  const Span<T> own = array_of<T>(result, array);
  messages[0].resize(own.size() * sizeof(T));
  if (!own.empty()) std::memcpy(messages[0].data(), own.data(), messages[0].size());
  result.arrays[static_cast<std::size_t>(array)] = {};
  std::vector<Bytes> all = team.exchange(std::move(messages));
  if (!team.is_first()) return;
  std::size_t bytes = 0;
  for (const Bytes& some : all) bytes += some.size();
  auto* to = reinterpret_cast<unsigned char*>(room<T>(result, array, bytes / sizeof(T)));
  for (Bytes& some : all) {
    if (!some.empty()) std::memcpy(to, some.data(), some.size());
    to += some.size();
    forget(some);
  }
}

/// The offsets of a rank's pieces count from its own first source: here from that of all.
void shift_offsets(Team& team, ForestResult& result) {
  const std::size_t pieces = result.begins[GCDT_PIECES].back();
  std::vector<std::uint64_t> sources(team.size(), 0);
  sources[team.rank()] = result.begins[GCDT_SOURCES].back();
  team.raise(sources.data(), sources.size());
  std::uint64_t before = 0;
  for (std::size_t rank = 0; rank < team.rank(); ++rank) before += sources[rank];
  auto* offsets = elements_of<std::uint32_t>(result, GCDT_SOURCE_OFFSETS);
  for (std::size_t i = 0; i <= pieces; ++i) offsets[i] += static_cast<std::uint32_t>(before);
  // The last one is the next rank's first.
  if (team.rank() + 1 < team.size()) result.begins[GCDT_SOURCE_OFFSETS] = {0, pieces};
}

}  // namespace

RankResult triangulate_rank(DevicePool& pool, Team& team, InputBlock block, const Options& options, std::size_t tiles,
                            const Cut& cut) {
  check_vertex_count(block.all_vertices);
  RankResult made;
  TiledReport report;
  const std::uint64_t first = begin_of_part(block.all_vertices, team.rank(), team.size()),
                      first_constraint = begin_of_part(block.all_constraints, team.rank(), team.size());
  GridInput input{{Points(block.vertices), first, {}, block.all_vertices},
                  {},
                  {},
                  {block.constraints, first_constraint, {}, block.all_constraints, {}},
                  {}};
  {
    const Timed timed(report.ms_share);
    {
      Survey surveyed;
      Staged staged(pool, input.given.points, tiles / team.size());
      input.chosen = staged.choose(options.grid, surveyed, first, team);
      if (block.all_vertices > 0) take_survey(input, surveyed, team);
    }
    made.cuts = cut(input);
    check_ends(input, team);
    const Timed exchanging(made.ms_exchange);
    input.constraints.end_points = end_points(team, input);
    made.own = exchange_vertices(team, input, made.cuts);
    forget(block.vertices);
    input.given = {Points(made.own.vertices), 0, made.own.numbers, block.all_vertices};
  }
  Staged staged(pool, input.given.points, tiles / team.size());
  TiledRun run(pool, team, input, staged, made.cuts, options, report);
  made.part = run.solve();
  describe(run, input, options, report, made.part.result);
  made.chosen = input.chosen;
  return made;
}

ForestResult gather_result(Team& team, RankResult& rank, Points points, Constraints constraints,
                           const Options& options) {
  ForestResult result = std::move(rank.part.result);
  if (!team.is_alone()) {
    shift_offsets(team, result);
    collect<Triangle>(team, result, GCDT_TRIANGLES);
    collect<Neighbours>(team, result, GCDT_NEIGHBOURS);
    collect<std::uint8_t>(team, result, GCDT_CONSTRAINED);
    collect<Constraint>(team, result, GCDT_PIECES);
    collect<std::uint32_t>(team, result, GCDT_SOURCE_OFFSETS);
    collect<std::uint32_t>(team, result, GCDT_SOURCES);
    gather(team, rank.part.merged);
    if (!team.is_first()) return {};
    const std::size_t n = points.size() + result.statistics.vertices_added;
    auto* representative = room<std::uint32_t>(result, GCDT_REPRESENTATIVES, n);
    for_each_in_threads(n, [&](std::size_t v) { representative[v] = static_cast<std::uint32_t>(v); });
    for (const Constraint& pair : rank.part.merged) representative[pair[0]] = pair[1];
  }
  if ((options.regions || options.domain != Domain::hull) && result.statistics.triangles > 0) {
    const GridInput whole{
        {points, 0, {}, points.size()}, rank.chosen, {}, {constraints, 0, {}, constraints.size(), {}}, {}};
    select_domain(whole, options, result);
  }
  return result;
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
// Proves, from the constraints of the input, which edges of the mesh are constrained (docs/contract.md, 3).
//
// A constraint is kept iff it is a chain of edges. Under Crossing::drop that is the rule given there, if every
// constraint that is no chain crosses an earlier one that is. By induction over the input order: let it hold for all
// earlier ones. If this one is a chain it crosses no kept one, since edges of one mesh do not cross, and is
// rightly kept. If it is none, it is rightly dropped iff it crosses an earlier kept one, that is an edge of one.
// Equal constraints have equal fates, so the first one stands for all.
#include <algorithm>

#include "proof/mesh.hpp"

namespace gcdt::proof {

namespace {

/// The least constraint on the first edge that the segment crosses and that belongs to a constraint before `limit`.
std::uint32_t crossed_before(const Mesh& mesh, const Sources& sources, const Segment& segment, std::uint32_t limit) {
  std::uint32_t found = none;
  walk_across(mesh, segment, [&](std::uint32_t h) {
    if (sources[h] < limit) found = sources[h];
    return found != none;
  });
  return found;
}

}  // namespace

std::uint32_t find_chain(const Mesh& mesh, const Segment& segment, Chain& chain) {
  chain.clear();
  for (std::uint32_t v = segment.a; v != segment.b;) {
    const auto exit = mesh.leave(v, segment.b);
    if (!exit.along_edge) return exit.half_edge;
    chain.push_back(exit.half_edge);
    v = exit.end;
  }
  return none;
}

void record(const Mesh& mesh, const Chain& chain, std::uint32_t constraint, Sources& sources) {
  for (std::uint32_t h : chain)
    for (std::uint32_t side : {h, mesh.twin(h)})
      if (side != none) sources[side] = std::min(sources[side], constraint);
}

std::vector<Segment> distinct_segments(const Sites& sites, Constraints constraints) {
  std::vector<Segment> segments;
  segments.reserve(constraints.size());
  for (std::uint32_t c = 0; c < constraints.size(); ++c) {
    const auto a = sites.representative[constraints[c][0]], b = sites.representative[constraints[c][1]];
    if (a != b) segments.push_back({std::min(a, b), std::max(a, b), c});
  }
  auto key = [](const Segment& s) { return std::uint64_t(s.a) << 32 | s.b; };
  // Stable: of equal ones the first is the least constraint.
  std::stable_sort(segments.begin(), segments.end(),
                   [&](const Segment& s, const Segment& t) { return key(s) < key(t); });
  const auto end = std::unique(segments.begin(), segments.end(),
                               [&](const Segment& s, const Segment& t) { return key(s) == key(t); });
  segments.erase(end, segments.end());
  return segments;
}

std::string prove_constraints(const Sites& sites, const Mesh& mesh, Constraints constraints, Crossing crossing,
                              Sources& sources) {
  sources.assign(mesh.half_edges(), none);
  std::vector<Segment> missing;
  std::vector<std::uint32_t> crossed;
  Chain chain;
  for (const Segment& segment : distinct_segments(sites, constraints)) {
    const std::uint32_t h = find_chain(mesh, segment, chain);
    if (h == none) {
      record(mesh, chain, segment.constraint, sources);
      continue;
    }
    missing.push_back(segment);
    crossed.push_back(h);
    if (crossing == Crossing::reject) break;
  }
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const Segment& segment = missing[i];
    if (crossing == Crossing::drop && crossed_before(mesh, sources, segment, segment.constraint) != none) continue;
    const std::uint32_t other = crossed_before(mesh, sources, segment, none);
    return say("constraint ", segment.constraint, " (", segment.a, "-", segment.b,
               ") is not a chain of edges: it crosses ", mesh.edge_name(crossed[i]),
               other != none ? say(" and constraint ", other) : "",
               crossing == Crossing::drop ? ", but no earlier constraint that was kept" : "");
  }
  return {};
}

}  // namespace gcdt::proof

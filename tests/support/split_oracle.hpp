// SPDX-License-Identifier: Apache-2.0
// Splitting crossings by definition (docs/splitting.md), by brute force in rational arithmetic: the oracle.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "grid_oracle.hpp"
#include "workloads.hpp"

namespace oracle {

using GridPair = std::array<std::int64_t, 2>;
using Edge = std::array<GridPair, 2>;  // the lesser end first
using Links = std::vector<GridPair>;   // the vertices along a constraint

struct Split {
  std::uint64_t crossings = 0;                             // pairs of constraints
  std::map<GridPair, std::array<std::uint32_t, 2>> added;  // with the least pair of constraints
  std::vector<Links> links;                                // one per constraint
  std::set<std::uint32_t> moved;                           // constraints that are routed
  std::map<Edge, std::vector<std::uint32_t>> pieces;       // with their constraints
};

Integer turn(const GridPair& a, const GridPair& b, const GridPair& c);

/// Where the insides of two segments cross.
std::optional<std::array<Rational, 2>> crossing(const GridPair& a, const GridPair& b, const GridPair& c,
                                                const GridPair& d);

/// Does segment a-b meet the pixel of h? If it meets the closed square in a stretch, the middle of that is in the
/// half-open square, or the stretch lies in a side that is not.
bool meets(const GridPair& a, const GridPair& b, const GridPair& h);

inline Edge edge_of(const GridPair& a, const GridPair& b) { return a < b ? Edge{a, b} : Edge{b, a}; }

Split split(const std::vector<GridPair>& points, const std::vector<gcdt::Constraint>& constraints);

}  // namespace oracle

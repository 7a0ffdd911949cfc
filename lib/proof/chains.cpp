// SPDX-License-Identifier: Apache-2.0
#include "proof/chains.hpp"

#include <tuple>

namespace gcdt::proof {

ChainSearch::ChainSearch(const Sites& sites, std::uint32_t inputs, const MeshView& view)
    : sites_(sites), inputs_(inputs), first_(sites.at.size() + 1), tried_(sites.at.size(), none) {
  // The two directions of each edge; twice those of inner edges, which links are nevertheless found by once.
  struct End {
    std::uint32_t from, to;
    bool flagged;
    bool operator<(const End& other) const { return std::tie(from, to) < std::tie(other.from, other.to); }
  };
  std::vector<End> ends;
  for (std::size_t t = 0; t < view.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = view.triangles[t][(k + 1) % 3], q = view.triangles[t][(k + 2) % 3];
      const bool flagged = !view.constrained || (view.constrained[t] >> k & 1);
      ends.push_back({p, q, flagged});
      ends.push_back({q, p, flagged});
    }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i < ends.size();) {
    std::size_t end = i;
    bool flagged = false;
    for (; end < ends.size() && !(ends[i] < ends[end]); ++end) flagged |= ends[end].flagged;
    if (flagged || end - i == 1) {
      to_.push_back(ends[i].to);
      ++first_[ends[i].from + 1];
    }
    i = end;
  }
  for (std::size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
}

/// The nearest vertex along the piece that was not tried, of those within half a cell if there are any.
std::uint32_t ChainSearch::next_link(const Piece& piece, const Ruler& ruler, std::uint32_t from,
                                     std::uint32_t number) const {
  const std::int64_t at = ruler.place(sites_.at[from]);
  const bool border = !piece.keeps_left || !piece.keeps_right;
  std::uint32_t best = none;
  auto key = [&](std::uint32_t v) { return std::make_pair(!ruler.is_near(sites_.at[v]), ruler.place(sites_.at[v])); };
  for (std::uint64_t i = first_[from]; i < first_[from + 1]; ++i) {
    const std::uint32_t v = to_[i];
    const Vertex p = sites_.at[v];
    const std::int64_t place = ruler.place(p);
    if (v != piece.b && (v < inputs_ || place <= at || place >= ruler.length() || tried_[v] == number ||
                         !(ruler.is_near(p) || (border && ruler.is_far(p)))))
      continue;
    if (best == none || key(v) < key(best)) best = v;
  }
  return best;
}

std::string ChainSearch::find(Piece& piece, std::uint32_t number) {
  piece.chain = {piece.a};
  if (!piece.keeps_left && !piece.keeps_right) {
    piece.chain.push_back(piece.b);
    return {};
  }
  const Ruler ruler(sites_.at[piece.a], sites_.at[piece.b]);
  while (!piece.chain.empty() && piece.chain.back() != piece.b) {
    const std::uint32_t next = next_link(piece, ruler, piece.chain.back(), number);
    if (next == none) {
      piece.chain.pop_back();
      continue;
    }
    tried_[next] = number;
    piece.chain.push_back(next);
  }
  if (!piece.chain.empty()) return {};
  return say(piece.constrained ? "the constraint" : "the hull", " between vertices ", piece.a, " and ", piece.b,
             " is no chain of edges within its bound");
}

namespace {

/// The side of the chain's link on which a vertex is, of the link over its place; 0 on it.
int side_of_chain(const Sites& sites, const Piece& piece, const Ruler& ruler, std::uint32_t v) {
  const std::int64_t place = ruler.place(sites.at[v]);
  const auto after =
      std::lower_bound(piece.chain.begin() + 1, piece.chain.end() - 1, place,
                       [&](std::uint32_t link, std::int64_t wanted) { return ruler.place(sites.at[link]) < wanted; });
  const std::int64_t turn = sites.turn(*(after - 1), *after, v);
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

}  // namespace

std::string prove_sides(const Sites& sites, std::uint32_t inputs, const std::vector<Piece>& pieces) {
  std::vector<std::uint32_t> by_x, by_y;
  for (std::uint32_t v = 0; v < inputs; ++v)
    if (sites.is_representative(v)) by_x.push_back(v);
  by_y = by_x;
  std::sort(by_x.begin(), by_x.end(), [&](auto v, auto w) { return sites.at[v].x < sites.at[w].x; });
  std::sort(by_y.begin(), by_y.end(), [&](auto v, auto w) { return sites.at[v].y < sites.at[w].y; });
  for (const Piece& piece : pieces) {
    const Vertex a = sites.at[piece.a], b = sites.at[piece.b];
    const Ruler ruler(a, b);
    const bool bent = std::any_of(piece.chain.begin(), piece.chain.end(),
                                  [&](std::uint32_t v) { return ruler.off(sites.at[v]) != 0; });
    if (!bent) continue;
    const auto& sorted = ruler.by_x() ? by_x : by_y;
    const auto coordinate = [&](Vertex v) { return ruler.by_x() ? v.x : v.y; };
    const std::int32_t low = std::min(coordinate(a), coordinate(b)), high = std::max(coordinate(a), coordinate(b));
    auto i = std::lower_bound(sorted.begin(), sorted.end(), low,
                              [&](std::uint32_t v, std::int32_t at) { return coordinate(sites.at[v]) < at; });
    for (; i != sorted.end() && coordinate(sites.at[*i]) <= high; ++i) {
      // Links are nearer than a cell: what is farther is on the same side of both.
      if (*i == piece.a || *i == piece.b || ruler.off(sites.at[*i]) >= ruler.length()) continue;
      const std::int64_t turn = sites.turn(piece.a, piece.b, *i);
      if (side_of_chain(sites, piece, ruler, *i) != (turn > 0 ? 1 : turn < 0 ? -1 : 0))
        return say("vertex ", *i, " has changed sides of what runs from vertex ", piece.a, " to ", piece.b);
    }
  }
  return {};
}

}  // namespace gcdt::proof

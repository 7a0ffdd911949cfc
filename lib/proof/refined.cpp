// SPDX-License-Identifier: Apache-2.0
// The proof reduces a refined mesh to one that is not refined. The input's own mesh is made once more: its edges on
// constraints and on the hull are the pieces, with what the domain keeps on either side of them. Each must be a chain
// of the mesh's edges. The mesh of all vertices under the links of these chains, made once more, too, and proved, says
// what the triangles must be: those beside which the pieces keep something. So the mesh is planar, Delaunay with the
// tie rule, and covers what it should, without a word about how it came to be.
#include "proof/refined.hpp"

#include <cmath>
#include <random>

#include "proof/chains.hpp"
#include "proof/wanted.hpp"
#include "proof/whole.hpp"

namespace gcdt::proof {

namespace {

/// The edges of the mesh that was refined. `seed_of`: by triangle. Sets `piece_of` by half-edge.
std::vector<Piece> pieces_of(const Sites& sites, const Completion& mesh, const std::vector<char>& keep,
                             const std::vector<std::uint32_t>& seed_of, std::vector<std::uint32_t>& piece_of) {
  std::vector<Piece> pieces;
  piece_of.assign(3 * keep.size(), none);
  for (std::uint32_t h = 0; h < 3 * keep.size(); ++h) {
    const std::uint32_t twin = mesh.twin(h);
    if ((!mesh.constrained(h) && twin != none) || twin < h) continue;
    piece_of[h] = static_cast<std::uint32_t>(pieces.size());
    if (twin != none) piece_of[twin] = piece_of[h];
    const auto& corners = mesh.triangles()[h / 3];
    const std::uint32_t from = corners[(h % 3 + 1) % 3], to = corners[(h % 3 + 2) % 3];
    const bool left = keep[h / 3], right = twin != none && keep[twin / 3];
    const std::uint32_t seed_left = seed_of[h / 3], seed_right = twin != none ? seed_of[twin / 3] : none;
    if (before(sites.at[from], sites.at[to]))
      pieces.push_back({from, to, mesh.constrained(h), left, right, seed_left, seed_right});
    else
      pieces.push_back({to, from, mesh.constrained(h), right, left, seed_right, seed_left});
  }
  return pieces;
}

/// Of the links of chains, by their ends.
struct Link {
  std::array<std::uint32_t, 2> ends;  ///< along the piece
  std::uint32_t piece;
};

class Proof {
 public:
  Proof(Points points, Constraints constraints, const MeshView& view, const Grid& grid, const Options& options)
      : points_(points), constraints_(constraints), view_(view), grid_(grid), options_(options) {}

  RefinedProof run() {
    RefinedProof& p = proof_;
    p.reason = place();
    if (p.reason.empty() && plain_->flat && (view_.triangles.size() > 0 || view_.added.size() > 0))
      p.reason = "there are triangles or added vertices, but all vertices are on one line";
    if (!p.reason.empty() || plain_->flat) return p;
    p.reason = find_pieces();
    if (p.reason.empty()) p.reason = find_chains();
    if (p.reason.empty()) p.reason = compare();
    if (p.reason.empty()) p.reason = prove_sides(*all_, inputs_, pieces_);
    if (p.reason.empty()) p.reason = judge();
    if (!p.reason.empty()) p.excuses.clear();
    return p;
  }

 private:
  std::string place() {
    std::string reason = place_sites(points_, constraints_, {}, grid_, plain_);
    if (reason.empty()) reason = place_sites(points_, constraints_, view_.added, grid_, all_);
    if (!reason.empty()) return reason;
    inputs_ = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t v = inputs_; v < all_->at.size(); ++v) {
      if (!all_->is_representative(v))
        return say("added vertex ", v, " is at the place of vertex ", all_->representative[v]);
      // A refined mesh that was refined again has those of each in order.
      if (v == inputs_ || !before(all_->at[v - 1], all_->at[v])) rows_.push_back(v);
    }
    proof_.refinements = rows_.size();
    rows_.push_back(static_cast<std::uint32_t>(all_->at.size()));
    if (reason = order_rows(); !reason.empty()) return reason;
    std::vector<char> used(all_->at.size(), 0);
    for (const auto& corners : view_.triangles)
      for (const std::uint32_t v : corners) {
        if (v >= used.size()) return say("vertex ", v, " does not exist");
        used[v] = 1;
      }
    for (std::uint32_t v = inputs_; v < used.size(); ++v)
      if (!used[v]) return say("added vertex ", v, " is in no triangle");
    return {};
  }

  /// What a vertex was put on was there: no vertex of a later row.
  std::string order_rows() const {
    if (view_.added_origin.size() != view_.added.size()) return {};
    for (std::size_t row = 0; row + 1 < rows_.size(); ++row)
      for (std::uint32_t v = rows_[row]; v < rows_[row + 1]; ++v)
        for (std::size_t k = 0; k < 3; ++k)
          if (const std::uint32_t on = view_.added_origin[v - inputs_][k]; on >= rows_[row + 1] && on < rows_.back())
            return say("added vertices are not in order from vertex ", rows_[row + 1] - 1, " on: vertex ", v,
                       " was put on vertex ", on);
    return {};
  }

  std::string find_pieces() {
    Rebuilt rebuilt{*plain_, inputs_, constraints_, options_.crossing, steps_};
    std::string reason = rebuilt.run();
    if (!reason.empty()) return reason;
    const Completion& mesh = *rebuilt.mesh;
    MeshView whole;
    whole.triangles = mesh.triangles();
    const Verification proved = verify(points_, constraints_, whole, grid_, options_.crossing);
    if (!proved.valid) return say("the whole mesh made for comparison is not valid: ", proved.reason);
    Mesh topology(*plain_, whole);
    topology.prove_topology();
    const Flood flood(mesh, topology, rebuilt.paths);
    std::vector<std::uint32_t> seed_of;
    const auto of_region = seeded(*plain_, mesh, flood, grid_, options_.region_seeds, steps_);
    for (const std::uint32_t region : flood.region) seed_of.push_back(of_region[region]);
    const std::vector<char> keep = chosen(*plain_, mesh, flood, grid_, options_, steps_);
    std::vector<std::uint32_t> piece_of;
    pieces_ = pieces_of(*plain_, mesh, keep, seed_of, piece_of);
    find_sharp_ends(*plain_, mesh, keep, piece_of, pieces_);
    return {};
  }

  std::string find_chains() {
    ChainSearch search(*all_, inputs_, view_);
    piece_of_.assign(all_->at.size(), none);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      Piece& piece = pieces_[i];
      if (auto reason = search.find(piece, i); !reason.empty()) return reason;
      const bool fixed = options_.refine->splits == Splits::none ||
                         (options_.refine->splits == Splits::inner && !(piece.keeps_left && piece.keeps_right));
      if (fixed && piece.split())
        return say("what must not be split, from vertex ", piece.a, " to ", piece.b, ", has vertex ", piece.chain[1]);
      measure(piece, i);
      for (std::size_t k = 0; k + 1 < piece.chain.size(); ++k)
        links_.push_back({{piece.chain[k], piece.chain[k + 1]}, i});
    }
    return {};
  }

  void measure(const Piece& piece, std::uint32_t number) {
    const Vertex a = all_->at[piece.a], b = all_->at[piece.b];
    const Ruler ruler(a, b);
    const double length = std::hypot(double(b.x) - a.x, double(b.y) - a.y);
    for (std::size_t k = 1; k + 1 < piece.chain.size(); ++k) {
      const Vertex v = all_->at[piece.chain[k]];
      piece_of_[piece.chain[k]] = number;
      ++proof_.on_chains;
      proof_.far += ruler.is_far(v);
      proof_.move = std::max(proof_.move, double(ruler.off(v)) / length);
    }
  }

  /// The mesh of all vertices under all links, as it must be, and then as it is.
  std::string compare() {
    whole_.emplace(*all_, steps_);
    std::vector<Link> order = links_;
    std::minstd_rand random;
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Constraint> constraints;
    for (const Link& link : order) {
      if (!whole_->constrain(link.ends[0], link.ends[1]))
        return say("the edge between vertices ", link.ends[0], " and ", link.ends[1],
                   " of a constraint crosses another");
      constraints.push_back(link.ends);
    }
    whole_->sort();
    std::vector<std::array<std::int32_t, 2>> on_grid;
    for (const Vertex v : all_->at) on_grid.push_back({v.x, v.y});
    Grid unit;
    unit.kind = Grid::Kind::fixed;
    MeshView whole;
    whole.triangles = whole_->triangles();
    const Verification proved = verify(on_grid, constraints, whole, unit, Crossing::reject);
    if (!proved.valid) return say("the mesh made for comparison is not valid: ", proved.reason);
    std::string reason = keep_sides();
    if (!reason.empty()) return reason;
    comparison_.emplace(*whole_, keep_, flags_, view_);
    return comparison_->run();
  }

  /// What the links keep on their sides, with its region seed, spread to the next links; and which half-edges are
  /// flagged.
  std::string keep_sides() {
    const std::size_t triangles = whole_->triangles().size();
    std::vector<std::pair<std::array<std::uint32_t, 2>, std::uint32_t>> by_ends;
    for (std::uint32_t h = 0; h < 3 * triangles; ++h)
      if (whole_->constrained(h)) by_ends.push_back({ends(h), h});
    std::sort(by_ends.begin(), by_ends.end());
    constexpr char unknown = 2;
    keep_.assign(triangles, unknown);
    seed_.assign(triangles, none);
    flags_.assign(3 * triangles, 0);
    link_of_.assign(3 * triangles, none);
    std::vector<std::uint32_t> stack;
    std::string reason;
    const auto mark = [&](std::uint32_t t, bool kept, std::uint32_t seed) {
      if (keep_[t] == unknown)
        stack.push_back(t);
      else if ((keep_[t] != char(kept) || seed_[t] != seed) && reason.empty())
        reason = say("what is on one side of a constraint joins the other side at vertex ", whole_->triangles()[t][0]);
      keep_[t] = char(kept);
      seed_[t] = seed;
    };
    for (const Link& link : links_) {
      const Piece& piece = pieces_[link.piece];
      for (const bool back : {false, true}) {
        const std::array<std::uint32_t, 2> wanted = {link.ends[back], link.ends[!back]};
        const auto found = std::lower_bound(by_ends.begin(), by_ends.end(), std::make_pair(wanted, 0u));
        if (found == by_ends.end() || found->first != wanted) continue;  // on the hull, or a vertex is on it
        flags_[found->second] |= char(piece.constrained);
        link_of_[found->second] = link.piece;
        mark(found->second / 3, back ? piece.keeps_right : piece.keeps_left, back ? piece.seed_right : piece.seed_left);
      }
    }
    while (!stack.empty() && reason.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (!whole_->constrained(h) && whole_->twin(h) != none) mark(whole_->twin(h) / 3, keep_[t], seed_[t]);
    }
    for (char& kept : keep_) kept = kept == 1;
    return reason;
  }

  std::array<std::uint32_t, 2> ends(std::uint32_t h) const {
    const auto& corners = whole_->triangles()[h / 3];
    return {corners[(h % 3 + 1) % 3], corners[(h % 3 + 2) % 3]};
  }

  // ---- Quality ----

  /// Everything that is asked for of a triangle, and whether it may be worse.
  std::string judge() {
    Wanted wanted(*options_.refine, grid_);
    if (auto reason = wanted.find_lengths(*all_, inputs_, view_.added_origin); !reason.empty()) return reason;
    const Mending mending({*all_, *whole_, keep_, pieces_, link_of_}, wanted, *options_.refine);
    for (std::uint32_t g = 0; g < view_.triangles.size(); ++g) {
      const std::uint32_t t = comparison_->right_of()[g];
      const auto& corners = whole_->triangles()[t];
      const Shape s = shape_of(*all_, corners);
      const bool sharp = wanted.is_sharp(s), large = wanted.is_large(s, corners, seed_[t]);
      const Excuse of_angle = sharp ? excuse_of_angle(t, s) : Excuse::as_wanted;
      const bool excused = of_angle != Excuse::as_wanted;
      const Excuse excuse = excused && !large             ? of_angle
                            : !sharp && !large            ? Excuse::as_wanted
                            : wanted.is_short(s.shortest) ? Excuse::short_side
                                                          : mending.excuse(t, s, sharp && !excused);
      if (excuse == Excuse::limit && !may_be_limited())
        return say(comparison_->name(g), " has ", sharp ? "an angle below the least one" : "more than the largest area",
                   ", and nothing excuses it");
      proof_.excuses.push_back(excuse);
      ++proof_.excused[static_cast<std::size_t>(excuse)];
      if (!options_.refine->conforming) continue;
      if (auto reason = judge_borders(t, g, wanted, mending); !reason.empty()) return reason;
    }
    return {};
  }

  bool may_be_limited() const { return options_.refine->most_added <= view_.added.size(); }

  /// Edges beside constraints are Delaunay if no corner is in the circle over one: unless its halves would be too
  /// short, or it cannot be split.
  std::string judge_borders(std::uint32_t t, std::uint32_t given, const Wanted& wanted, const Mending& mending) {
    const auto& c = whole_->triangles()[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!whole_->constrained(3 * t + k)) continue;
      const std::uint32_t from = c[(k + 1) % 3], to = c[(k + 2) % 3];
      const Direction u(all_->at[c[k]], all_->at[from]), v(all_->at[c[k]], all_->at[to]),
          side(all_->at[from], all_->at[to]);
      if (u.x * v.x + u.y * v.y >= 0) continue;
      ++proof_.encroached;
      if (!may_be_limited() && !wanted.is_short(side.x * side.x + side.y * side.y, 2) &&
          mending.excuse_of_side(3 * t + k) == Excuse::limit)
        return say(comparison_->name(given), " has a corner in the circle over its side from vertex ", from, " to ", to,
                   ", which is a constraint or of the hull, and nothing excuses it");
    }
    return {};
  }

  Excuse excuse_of_angle(std::uint32_t t, const Shape& s) const {
    // Of several least angles any one excuses.
    const auto& c = whole_->triangles()[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Direction u(all_->at[c[k]], all_->at[c[(k + 1) % 3]]), v(all_->at[c[k]], all_->at[c[(k + 2) % 3]]);
      if (u.x * v.x + u.y * v.y != s.dot) continue;
      if (whole_->constrained(3 * t + (k + 1) % 3) && whole_->constrained(3 * t + (k + 2) % 3))
        return Excuse::input_angle;
      if (is_beside_angle(c[(k + 1) % 3], c[(k + 2) % 3])) return Excuse::beside_angle;
    }
    return Excuse::as_wanted;
  }

  /// Added vertices on two pieces with a common end, about as far from it (Miller, Pav and Walkington).
  bool is_beside_angle(std::uint32_t u, std::uint32_t v) const {
    if (piece_of_[u] == none || piece_of_[v] == none || piece_of_[u] == piece_of_[v]) return false;
    const Piece &p = pieces_[piece_of_[u]], &q = pieces_[piece_of_[v]];
    const std::uint32_t z = p.a == q.a || p.a == q.b ? p.a : p.b;
    if (z != q.a && z != q.b) return false;
    const auto distance = [&](std::uint32_t w) {
      const Direction d(all_->at[z], all_->at[w]);
      return std::floor(std::sqrt(static_cast<long double>(d.x * d.x + d.y * d.y)));
    };
    const long double du = distance(u), dv = distance(v);
    return std::abs(du - dv) <= 2 + std::floor(std::max(du, dv) / 512);
  }

  const Points points_;
  const Constraints constraints_;
  const MeshView& view_;
  const Grid& grid_;
  const Options& options_;
  std::uint64_t steps_ = 0;
  std::uint32_t inputs_ = 0;
  std::optional<Sites> plain_, all_;
  std::vector<std::uint32_t> rows_;  // where the added vertices of each refinement begin, and the end
  std::vector<Piece> pieces_;
  std::vector<Link> links_;
  std::vector<std::uint32_t> piece_of_;  // by vertex: the piece that an added one is on, or none
  std::optional<Completion> whole_;
  std::vector<char> keep_, flags_;      // of it: by triangle, by half-edge
  std::vector<std::uint32_t> link_of_;  // of it: by half-edge, the piece along it, or none
  std::vector<std::uint32_t> seed_;     // of it: by triangle, the region's seed, or none
  std::optional<Comparison> comparison_;
  RefinedProof proof_;
};

}  // namespace

RefinedProof verify_refined(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid,
                            const Options& options) {
  return Proof(points, constraints, mesh, grid, options).run();
}

}  // namespace gcdt::proof

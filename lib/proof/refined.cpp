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
#include "proof/whole.hpp"

namespace gcdt::proof {

namespace {

/// The edges of the mesh that was refined.
std::vector<Piece> pieces_of(const Sites& sites, const Completion& mesh, const std::vector<char>& keep) {
  std::vector<Piece> pieces;
  for (std::uint32_t h = 0; h < 3 * keep.size(); ++h) {
    const std::uint32_t twin = mesh.twin(h);
    if ((!mesh.constrained(h) && twin != none) || twin < h) continue;
    const auto& corners = mesh.triangles()[h / 3];
    const std::uint32_t from = corners[(h % 3 + 1) % 3], to = corners[(h % 3 + 2) % 3];
    const bool left = keep[h / 3], right = twin != none && keep[twin / 3];
    if (before(sites.at[from], sites.at[to]))
      pieces.push_back({from, to, mesh.constrained(h), left, right});
    else
      pieces.push_back({to, from, mesh.constrained(h), right, left});
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
      if (v > inputs_ && !before(all_->at[v - 1], all_->at[v]))
        return say("added vertices are not in order from vertex ", v - 1, " on");
    }
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
    pieces_ = pieces_of(*plain_, mesh, chosen(*plain_, mesh, flood, grid_, options_, steps_));
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

  /// What the links keep on their sides, spread to the next links; and which half-edges are flagged.
  std::string keep_sides() {
    const std::size_t triangles = whole_->triangles().size();
    std::vector<std::pair<std::array<std::uint32_t, 2>, std::uint32_t>> by_ends;
    for (std::uint32_t h = 0; h < 3 * triangles; ++h)
      if (whole_->constrained(h)) by_ends.push_back({ends(h), h});
    std::sort(by_ends.begin(), by_ends.end());
    constexpr char unknown = 2;
    keep_.assign(triangles, unknown);
    flags_.assign(3 * triangles, 0);
    std::vector<std::uint32_t> stack;
    std::string reason;
    const auto mark = [&](std::uint32_t t, bool kept) {
      if (keep_[t] == unknown) stack.push_back(t);
      if (keep_[t] != unknown && keep_[t] != char(kept) && reason.empty())
        reason = say("what is on one side of a constraint joins the other side at vertex ", whole_->triangles()[t][0]);
      keep_[t] = char(kept);
    };
    for (const Link& link : links_) {
      const Piece& piece = pieces_[link.piece];
      for (const bool back : {false, true}) {
        const std::array<std::uint32_t, 2> wanted = {link.ends[back], link.ends[!back]};
        const auto found = std::lower_bound(by_ends.begin(), by_ends.end(), std::make_pair(wanted, 0u));
        if (found == by_ends.end() || found->first != wanted) continue;  // on the hull, or a vertex is on it
        flags_[found->second] |= char(piece.constrained);
        mark(found->second / 3, back ? piece.keeps_right : piece.keeps_left);
      }
    }
    while (!stack.empty() && reason.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (!whole_->constrained(h) && whole_->twin(h) != none) mark(whole_->twin(h) / 3, keep_[t]);
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
    const Refinement& wanted = *options_.refine;
    constexpr long double pi = 3.141592653589793238462643383279502884L;
    // The least tangent, in units of 2^-31, less the last digit of the one who made the mesh.
    const auto tangent = wanted.least_angle > 0
                             ? Wide(std::floor(std::ldexp(std::tan(wanted.least_angle * pi / 180), 31))) - 1
                             : Wide(0);
    const long double cell = grid_.cell();
    const long double most = wanted.most_area / (cell * cell / 2) * (1 + 1e-12L);
    const long double least = std::max(8.0L, std::ceil(wanted.least_length / cell));
    for (std::uint32_t g = 0; g < view_.triangles.size(); ++g) {
      const std::uint32_t t = comparison_->right_of()[g];
      const Shape s = shape_of(t);
      const bool sharp =
          Wide(s.area) * (Wide(1) << 31)<Wide(s.dot) * tangent, large = static_cast<long double>(s.area)> most;
      Excuse excuse = Excuse::as_wanted;
      if (sharp || large) {
        const Excuse of_angle = sharp ? excuse_of_angle(t, s) : Excuse::as_wanted;
        const bool is_short = static_cast<long double>(s.shortest) < least * least;
        excuse = sharp && !large && of_angle != Excuse::as_wanted ? of_angle
                 : is_short                                       ? Excuse::short_side
                                                                  : Excuse::by_call;
        const bool asked = wanted.most_added != UINT64_MAX || wanted.splits != Splits::all;
        if (excuse == Excuse::by_call && !asked)
          return say(comparison_->name(g), " has ",
                     sharp ? "an angle below the least one" : "more than the largest area", ", and nothing excuses it");
      }
      proof_.excuses.push_back(excuse);
      ++proof_.excused[static_cast<std::size_t>(excuse)];
    }
    return {};
  }

  /// Of a triangle: its doubled area, its largest corner product, in corner k, where the least angle is, and the square
  /// of the side across from there, which is the shortest.
  struct Shape {
    std::int64_t area, dot, shortest;
    std::uint32_t k;
  };

  Shape shape_of(std::uint32_t t) const {
    const auto& c = whole_->triangles()[t];
    Shape s = {all_->turn(c[0], c[1], c[2]), -1, 0, 0};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Direction u(all_->at[c[k]], all_->at[c[(k + 1) % 3]]), v(all_->at[c[k]], all_->at[c[(k + 2) % 3]]),
          across(all_->at[c[(k + 1) % 3]], all_->at[c[(k + 2) % 3]]);
      const std::int64_t dot = u.x * v.x + u.y * v.y;
      if (dot > s.dot) s.dot = dot, s.k = k, s.shortest = across.x * across.x + across.y * across.y;
    }
    return s;
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
  std::vector<Piece> pieces_;
  std::vector<Link> links_;
  std::vector<std::uint32_t> piece_of_;  // by vertex: the piece that an added one is on, or none
  std::optional<Completion> whole_;
  std::vector<char> keep_, flags_;  // of it: by triangle, by half-edge
  std::optional<Comparison> comparison_;
  RefinedProof proof_;
};

}  // namespace

RefinedProof verify_refined(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid,
                            const Options& options) {
  return Proof(points, constraints, mesh, grid, options).run();
}

}  // namespace gcdt::proof

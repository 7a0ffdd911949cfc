// SPDX-License-Identifier: Apache-2.0
#include "proof/mending.hpp"

#include <algorithm>
#include <cmath>

#include "proof/delaunay.hpp"

namespace gcdt::proof {

namespace {

Wide dot(Vertex from, Vertex a, Vertex b) {
  const Direction u(from, a), v(from, b);
  return Wide(u.x) * v.x + Wide(u.y) * v.y;
}

Wide squared(Vertex a, Vertex b) { return dot(a, b, b); }

/// floor(numerator / denominator), denominator > 0.
Wide floored(Wide numerator, Wide denominator) {
  const Wide quotient = numerator / denominator;
  return quotient - (quotient * denominator > numerator);
}

/// Half up.
std::int64_t rounded(Wide numerator, Wide denominator) {
  return static_cast<std::int64_t>(floored(2 * numerator + denominator, 2 * denominator));
}

/// At less than 60 degrees to the left of p, seen from z.
bool within_60(Vertex z, Vertex p, Vertex q) {
  const Wide along = dot(z, p, q), turn = orient(z, p, q);
  return along > 0 && turn > 0 && 1000000 * turn < 1732051 * along;
}

/// Places along a piece, as they are rounded to the grid.
class Rounding {
 public:
  explicit Rounding(Vertex a, Vertex b) : a_(a), d_(a, b), ruler_(a, b), length_(ruler_.length()) {}

  std::int64_t place(Vertex v) const { return ruler_.place(v); }
  std::int64_t length() const { return length_; }
  /// The other coordinate half up or, `other_way`, as it would be on the other side of the piece. False: there is none.
  bool at(std::int64_t k, bool other_way, Vertex& v) const {
    const Wide across = Wide(k) * (ruler_.by_x() ? d_.y : d_.x);
    std::int64_t aside = rounded(across, length_);
    if (other_way) {
      if (Wide(aside) * length_ == across) return false;
      aside += Wide(aside) * length_ < across ? 1 : -1;
    }
    const std::int64_t along = ruler_.by_x() || d_.y >= 0 ? k : -k;
    v.x = static_cast<std::int32_t>(a_.x + (ruler_.by_x() ? along : aside));
    v.y = static_cast<std::int32_t>(a_.y + (ruler_.by_x() ? aside : along));
    return true;
  }
  /// The place at distance 2^j from an end, the least such distance above a third of a length.
  std::int64_t shell(Wide squared_length) const {
    Wide square = 1;
    while (square <= squared_length / 9) square *= 4;
    const Wide whole = Wide(d_.x) * d_.x + Wide(d_.y) * d_.y, room = square * length_ * length_;
    std::int64_t k = 0;
    for (std::int64_t bit = std::int64_t(1) << 30; bit > 0; bit /= 2)
      if (Wide(k + bit) * (k + bit) * whole <= room) k += bit;
    return k;
  }

 private:
  Vertex a_;
  Direction d_;
  Ruler ruler_;
  std::int64_t length_;
};

}  // namespace

Mending::Mending(const MendedMesh& mesh, const Wanted& wanted, const Refinement& refinement)
    : m_(mesh), wanted_(wanted), refinement_(refinement) {
  constexpr long double pi = 3.141592653589793238462643383279502884L, radians = pi / 180 / 1e6L;
  const bool by_angle = refinement.least_angle > 0;
  const long long millionths = by_angle ? std::llround(refinement.least_angle * 1e6) : 1000000;
  if (by_angle) lens_ = std::llround(std::ldexp(std::tan(2 * millionths * radians), 31));
  off_centre_ = std::llround(std::ldexp(0.475L / std::tan(static_cast<long double>(millionths / 2) * radians), 24));
}

// Of several least angles that of the corner that is least in (x, y).
Mending::Target Mending::target(std::uint32_t t, const Shape& shape) const {
  std::uint32_t at = shape.k;
  for (std::uint32_t k = 0; k < 3; ++k)
    if (dot(corner(t, k), corner(t, k + 1), corner(t, k + 2)) == shape.dot && corner(t, k).key() < corner(t, at).key())
      at = k;
  const Vertex p = corner(t, at + 1), q = corner(t, at + 2), r = corner(t, at);
  if (2 * off_centre_ * shape.area < (Wide(1) << 24) * shape.dot) {
    const Wide one = Wide(1) << 24, k = 2 * off_centre_;
    return {static_cast<std::int64_t>(floored((Wide(p.x) + q.x) * one + k * (Wide(p.y) - q.y) + one, 2 * one)),
            static_cast<std::int64_t>(floored((Wide(p.y) + q.y) * one + k * (Wide(q.x) - p.x) + one, 2 * one))};
  }
  const Direction u(p, q), v(p, r);
  const Wide lu = squared(p, q), lv = squared(p, r), whole = 2 * Wide(shape.area);
  return {p.x + rounded(v.y * lu - u.y * lv, whole), p.y + rounded(u.x * lv - v.x * lu, whole)};
}

bool Mending::lesser_ends(std::uint32_t t, std::uint32_t k, std::uint32_t j) const {
  const auto ends = [&](std::uint32_t side) {
    const std::uint64_t from = corner(t, side + 1).key(), to = corner(t, side + 2).key();
    return std::make_pair(std::min(from, to), std::max(from, to));
  };
  return ends(k) < ends(j);
}

/// Over sides that are no constraints and have the target beyond them, of two over the one with lesser ends. Returns
/// the triangle in which it ends; `stop`: the constraint that stops it, or on which the target is. Ends: with each step
/// the target's power to the circles falls.
std::uint32_t Mending::walk(std::uint32_t t, const Target& to, std::uint32_t& stop, bool& at_vertex) const {
  for (;;) {
    std::uint32_t free = 3, stopped = 3, on = 3, zeros = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vertex from = corner(t, k + 1), end = corner(t, k + 2);
      const Direction side(from, end);
      const Wide turn = Wide(side.x) * (to.y - from.y) - Wide(side.y) * (to.x - from.x);
      if (turn == 0) {
        ++zeros;
        on = k;
      } else if (turn < 0) {
        std::uint32_t& least = ends_at(3 * t + k) ? stopped : free;
        if (least == 3 || lesser_ends(t, k, least)) least = k;
      }
    }
    if (free != 3) {
      t = m_.mesh.twin(3 * t + free) / 3;
      continue;
    }
    stop = stopped != 3 ? 3 * t + stopped : zeros == 1 && ends_at(3 * t + on) ? 3 * t + on : none;
    at_vertex = stopped == 3 && zeros == 2;
    return t;
  }
}

bool Mending::in_lens(Vertex p, Vertex q, Vertex r) const {
  const Wide along = dot(r, p, q);
  if (along >= 0) return false;
  if (refinement_.conforming) return true;
  const Wide area = orient(p, q, r);
  return (area < 0 ? -area : area) * (Wide(1) << 31) < -along * lens_;
}

bool Mending::is_fixed(std::uint32_t h) const {
  if (refinement_.splits == Splits::none) return true;
  const std::uint32_t twin = m_.mesh.twin(h);
  return refinement_.splits == Splits::inner && !(m_.keep[h / 3] && twin != none && m_.keep[twin / 3]);
}

void Mending::meet(std::uint32_t h, InTheWay& way) const {
  if (is_fixed(h)) {
    way.fixed = true;
    return;
  }
  way.any = true;
  way.place |= has_place(h);
}

Excuse Mending::excuse_of_side(std::uint32_t h) const {
  return is_fixed(h) ? Excuse::fixed : has_place(h) ? Excuse::limit : Excuse::refused;
}

Excuse Mending::excuse(std::uint32_t t, const Shape& shape, bool sharp) const {
  const Target to = target(t, shape);
  InTheWay way;
  bool near = false;
  std::uint32_t stop = none;
  const std::uint32_t root = walk(t, to, stop, near);
  if (stop != none) meet(stop, way);
  if (stop == none && !near) {  // the cavity: what is joined to the root and has the target in its circle
    const Vertex x = {static_cast<std::int32_t>(to.x), static_cast<std::int32_t>(to.y)};
    const Wide times = sharp ? 8 : 4, least = sharp ? 5 : 1;
    std::vector<std::uint32_t> cavity = {root};
    for (std::size_t i = 0; i < cavity.size(); ++i)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t h = 3 * cavity[i] + k, twin = m_.mesh.twin(h);
        const Vertex p = corner(cavity[i], k + 1), q = corner(cavity[i], k + 2);
        near |= times * squared(p, x) < least * shape.shortest;
        if (ends_at(h)) {
          if (in_lens(p, q, x)) meet(h, way);
        } else if (std::find(cavity.begin(), cavity.end(), twin / 3) == cavity.end() &&
                   incircle(corner(twin / 3, 0), corner(twin / 3, 1), corner(twin / 3, 2), x) > 0) {
          cavity.push_back(twin / 3);
        }
      }
  }
  if (way.fixed) return Excuse::fixed;
  if (way.any) return way.place ? Excuse::limit : Excuse::refused;
  return near ? Excuse::target : Excuse::limit;
}

// ---- Places on constraints ------------------------------------------------------------------------------

bool Mending::has_place(std::uint32_t h) const {
  const Vertex p = corner(h / 3, h + 1), q = corner(h / 3, h + 2);
  const Wide length = squared(p, q);
  if (m_.piece_of[h] == none || wanted_.is_short(static_cast<std::int64_t>(length), 2)) return false;
  const Piece& piece = m_.pieces[m_.piece_of[h]];
  const Rounding rounding(m_.sites.at[piece.a], m_.sites.at[piece.b]);
  const std::int64_t first = rounding.place(p), last = rounding.place(q), low = std::min(first, last),
                     high = std::max(first, last), step = std::max<std::int64_t>(1, (high - low) / 16);
  const bool sharp_low = low == 0 && piece.sharp_a, sharp_high = high == rounding.length() && piece.sharp_b;
  std::int64_t middle = (low + high) / 2;
  if (sharp_low != sharp_high) {
    const std::int64_t shell = rounding.shell(length);
    middle = sharp_low ? shell : rounding.length() - shell;
  }
  const std::uint32_t twin = m_.mesh.twin(h);
  const bool border = !m_.keep[h / 3] || twin == none || !m_.keep[twin / 3];
  for (const bool other_way : {false, true})
    for (const std::int64_t away : {std::int64_t(0), step, -step, 2 * step, -2 * step}) {
      const std::int64_t k = middle + away;
      Vertex m;
      if (k > low && k < high && (!other_way || border) && rounding.at(k, other_way, m) && is_valid(h, m)) return true;
    }
  return false;
}

/// A vertex at m must lie on the side, or in a triangle beside it. What is outside of the convex hull is not looked at:
/// there is no place.
bool Mending::is_valid(std::uint32_t h, Vertex m) const {
  const Vertex p = corner(h / 3, h + 1), q = corner(h / 3, h + 2);
  const std::int64_t side = orient(p, q, m);
  if (side == 0) return dot(m, p, q) < 0;
  const std::uint32_t near = side > 0 ? h : m_.mesh.twin(h);
  return near != none && fits(near, m);
}

bool Mending::fits(std::uint32_t h, Vertex m) const {
  const std::uint32_t t = h / 3, beyond_p = 3 * t + (h + 1) % 3, beyond_q = 3 * t + (h + 2) % 3;
  const Vertex r = corner(t, h), p = corner(t, h + 1), q = corner(t, h + 2);
  const std::int64_t at_p = orient(q, r, m), at_q = orient(r, p, m);
  if (!m_.keep[t] && at_p < 0 && at_q > 0) return orient(p, m, r) > 0 && fits_beyond(beyond_p, m);
  if (!m_.keep[t] && at_q < 0 && at_p > 0) return orient(m, q, r) > 0 && fits_beyond(beyond_q, m);
  if (at_p < 0 || at_q < 0 || (at_p == 0 && at_q == 0)) return false;
  if (at_p == 0) return !m_.mesh.constrained(beyond_p);
  return at_q != 0 || !m_.mesh.constrained(beyond_q);
}

bool Mending::fits_beyond(std::uint32_t h, Vertex m) const {
  const std::uint32_t twin = m_.mesh.twin(h);
  if (m_.mesh.constrained(h) || twin == none) return false;
  std::uint32_t on = none;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::int64_t side = orient(corner(twin / 3, k + 1), corner(twin / 3, k + 2), m);
    if (side < 0 || (side == 0 && on != none)) return false;
    if (side == 0) on = 3 * (twin / 3) + k;
  }
  return on == none || !m_.mesh.constrained(on);
}

void find_sharp_ends(const Sites& sites, const Completion& mesh, const std::vector<char>& keep,
                     const std::vector<std::uint32_t>& piece_of, std::vector<Piece>& pieces) {
  const auto mark = [&](std::uint32_t piece, std::uint32_t z) {
    (pieces[piece].a == z ? pieces[piece].sharp_a : pieces[piece].sharp_b) = true;
  };
  for (std::uint32_t first = 0; first < piece_of.size(); ++first) {
    if (piece_of[first] == none) continue;
    const std::uint32_t z = mesh.triangles()[first / 3][(first + 1) % 3];
    const Vertex p = sites.at[mesh.triangles()[first / 3][(first + 2) % 3]];
    // Counter-clockwise around z, from the triangle beside the piece on. Ends: at 60 degrees.
    for (std::uint32_t h = first; h != none && keep[h / 3];) {
      if (!within_60(sites.at[z], p, sites.at[mesh.triangles()[h / 3][h % 3]])) break;
      const std::uint32_t side = previous(h);  // from the apex to z
      if (piece_of[side] != none) {
        mark(piece_of[first], z);
        mark(piece_of[side], z);
        break;
      }
      h = mesh.twin(side);
    }
  }
}

}  // namespace gcdt::proof

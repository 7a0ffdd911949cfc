// SPDX-License-Identifier: Apache-2.0
// Why a triangle that is worse than wanted could not be mended, found anew in the mesh for the proof of refined meshes
// (docs/refinement.md, "A round": 3 and 4 say what would mend it).
#pragma once

#include "proof/chains.hpp"
#include "proof/wanted.hpp"

namespace gcdt::proof {

/// Why a triangle may be worse than wanted (GCDT_EXCUSE_...); `as_wanted`: it is not.
enum class Excuse : std::uint8_t { as_wanted, input_angle, beside_angle, short_side, limit, target, fixed, refused };
constexpr std::size_t excuse_kinds = 8;

/// The mesh of all vertices, and what is known of it.
struct MendedMesh {
  const Sites& sites;
  const Completion& mesh;
  const std::vector<char>& keep;               ///< by triangle
  const std::vector<Piece>& pieces;            ///< with their chains
  const std::vector<std::uint32_t>& piece_of;  ///< by half-edge: the piece of which it is a link, or none
};

class Mending {
 public:
  Mending(const MendedMesh& mesh, const Wanted& wanted, const Refinement& refinement);

  /// Of a kept triangle with sides that are long enough: target, fixed, refused, or limit, if a vertex would mend it.
  /// `sharp`: for its angle, else for its size.
  Excuse excuse(std::uint32_t t, const Shape& shape, bool sharp) const;
  /// The same of a half-edge on a constraint or on the border that is to be split: fixed, refused or limit.
  Excuse excuse_of_side(std::uint32_t h) const;

 private:
  struct Target {
    std::int64_t x, y;  // below 2^39
  };
  struct InTheWay {
    bool fixed = false, any = false, place = false;
  };
  const std::array<std::uint32_t, 3>& corners(std::uint32_t t) const { return m_.mesh.triangles()[t]; }
  Vertex corner(std::uint32_t t, std::uint32_t k) const { return m_.sites.at[corners(t)[k % 3]]; }
  /// Nothing goes on across a constraint, or the border.
  bool ends_at(std::uint32_t h) const { return m_.mesh.constrained(h) || m_.mesh.twin(h) == none; }
  Target target(std::uint32_t t, const Shape& shape) const;
  std::uint32_t walk(std::uint32_t t, const Target& to, std::uint32_t& stop, bool& at_vertex) const;
  bool lesser_ends(std::uint32_t t, std::uint32_t k, std::uint32_t j) const;
  bool in_lens(Vertex p, Vertex q, Vertex r) const;
  void meet(std::uint32_t h, InTheWay& way) const;
  bool is_fixed(std::uint32_t h) const;
  bool has_place(std::uint32_t h) const;
  bool is_valid(std::uint32_t h, Vertex m) const;
  bool fits(std::uint32_t h, Vertex m) const;
  bool fits_beyond(std::uint32_t h, Vertex m) const;

  const MendedMesh m_;
  const Wanted& wanted_;
  const Refinement& refinement_;
  Wide lens_ = 0, off_centre_ = 0;  // units of 2^-31, 2^-24
};

/// Sets `sharp_a` and `sharp_b` of the pieces: whether another one meets it there at less than 60 degrees over kept
/// triangles. `mesh`: that of the input; `piece_of`: by half-edge, or none.
void find_sharp_ends(const Sites& sites, const Completion& mesh, const std::vector<char>& keep,
                     const std::vector<std::uint32_t>& piece_of, std::vector<Piece>& pieces);

}  // namespace gcdt::proof

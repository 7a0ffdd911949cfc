// SPDX-License-Identifier: Apache-2.0
// Proves that a mesh was made by splitting the crossings of its constraints (docs/splitting.md).
//
// A constraint is straight if it is a chain of edges under docs/contract.md, 3, routed if the vertices whose pixels it
// meets, one after the other, are a chain of edges. Proved is that the added vertices are the pixels of the crossings,
// all of them, that the constraints that cross are routed, and of the others exactly those that would cross a routed
// one.
//
// All crossings are seen: two constraints that cross outside of the pixels of vertices meet the pixel of one vertex in
// common (the motion in docs/splitting.md carries edges, which do not cross, to the constraints), and for every
// vertex all pairs that meet its pixel are tested, but those of two constraints that end there.
#include <algorithm>

#include "proof/pixels.hpp"

namespace gcdt::proof {

namespace {

/// A constraint that meets the pixel of a vertex.
struct Meeting {
  std::uint32_t vertex, segment;
};

std::string name(const Segment& s) { return say("constraint ", s.constraint, " (", s.a, "-", s.b, ")"); }

struct CrossingSearch {
  const Sites& sites;
  const PixelTree& tree;
  const std::uint32_t inputs;
  const std::vector<Segment>& segments;
  std::vector<bool>& crosses;
  std::vector<std::uint64_t> places = {};  // of all vertices, ascending

  /// Every pixel with a crossing is that of a vertex, and every added vertex has a crossing in its pixel.
  std::string run() {
    crosses.assign(segments.size(), false);
    for (const Vertex at : sites.at) places.push_back(at.key());
    std::sort(places.begin(), places.end());
    std::vector<Meeting> meetings;
    for (std::uint32_t s = 0; s < segments.size(); ++s)
      for (std::uint32_t v : tree.along(segments[s].a, segments[s].b)) meetings.push_back({v, s});
    std::sort(meetings.begin(), meetings.end(), [](const Meeting& a, const Meeting& b) {
      return a.vertex != b.vertex ? a.vertex < b.vertex : a.segment < b.segment;
    });
    std::vector<bool> founded(sites.at.size(), false);
    for (std::size_t begin = 0, end; begin < meetings.size(); begin = end) {
      const std::uint32_t v = meetings[begin].vertex;
      std::vector<std::uint32_t> through, ending;
      for (end = begin; end < meetings.size() && meetings[end].vertex == v; ++end) {
        const std::uint32_t s = meetings[end].segment;
        (segments[s].a == v || segments[s].b == v ? ending : through).push_back(s);
      }
      for (std::size_t i = 0; i < through.size(); ++i) {
        for (std::size_t j = i + 1; j < through.size(); ++j)
          if (auto reason = check_pair(v, through[i], through[j], founded); !reason.empty()) return reason;
        for (std::uint32_t s : ending)
          if (auto reason = check_pair(v, through[i], s, founded); !reason.empty()) return reason;
      }
    }
    for (std::uint32_t v = inputs; v < sites.at.size(); ++v)
      if (!founded[v]) return say("added vertex ", v, ": no constraints cross in its pixel");
    return {};
  }

  /// Two constraints that meet the pixel of v.
  std::string check_pair(std::uint32_t v, std::uint32_t s, std::uint32_t t, std::vector<bool>& founded) {
    const Vertex a = sites.at[segments[s].a], b = sites.at[segments[s].b];
    const Vertex c = sites.at[segments[t].a], d = sites.at[segments[t].b];
    const auto pixel = pixel_of_crossing(a, b, c, d);
    if (!pixel) return {};
    if (pixel->key() == sites.at[v].key()) {
      // At a vertex of the input itself they are split there, and do not cross.
      if (v < inputs && orient(a, b, *pixel) == 0 && orient(c, d, *pixel) == 0) return {};
      founded[v] = true;
      crosses[s] = crosses[t] = true;
      return {};
    }
    if (std::binary_search(places.begin(), places.end(), pixel->key())) return {};  // looked at there
    return say(name(segments[s]), " and ", name(segments[t]), " cross, but no vertex was added at grid point (",
               pixel->x, ", ", pixel->y, ")");
  }
};

struct SplitProof {
  const Sites& sites;
  const Mesh& mesh;
  const std::uint32_t inputs;
  const std::vector<Segment>& segments;
  Sources& sources;
  const PixelTree tree = PixelTree(sites);
  Sources routed_edge = {};  // none: not of a route
  std::vector<bool> crosses = {};

  std::string run() {
    sources.assign(mesh.half_edges(), none);
    routed_edge.assign(mesh.half_edges(), none);
    auto reason = find_crossing(sites, tree, inputs, segments, crosses);
    if (reason.empty()) reason = check_chains();
    return reason;
  }

  std::string name(std::uint32_t s) const { return proof::name(segments[s]); }

  std::string check_chains() {
    std::vector<std::uint32_t> left;
    Chain chain;
    for (std::uint32_t s = 0; s < segments.size(); ++s) {
      if (crosses[s]) {
        const std::uint32_t v = route(s);
        if (v != none)
          return say(name(s),
                     " crosses another one, but is not routed through the vertices near it: no edge leaves vertex ", v,
                     " to the next of them");
      } else if (find_chain(mesh, segments[s], chain) == none) {
        record(mesh, chain, segments[s].constraint, sources);
      } else {
        left.push_back(s);
      }
    }
    // What is left must cross a routed one. Ends: each round has routed another.
    for (bool more = true; more && !left.empty();) {
      more = false;
      for (std::size_t i = 0; i < left.size();) {
        if (!crosses_routed(left[i])) {
          ++i;
          continue;
        }
        const std::uint32_t v = route(left[i]);
        if (v != none)
          return say(name(left[i]), " crosses a routed one, but is not routed itself: no edge leaves vertex ", v,
                     " to the next vertex near it");
        left[i] = left.back();
        left.pop_back();
        more = true;
      }
    }
    if (left.empty()) return {};
    return say(name(*std::min_element(left.begin(), left.end())), " is not a chain of edges, though it crosses none");
  }

  /// Records the constraint along its route, or returns the vertex from which no edge leads to the next one.
  std::uint32_t route(std::uint32_t s) {
    Chain chain;
    const auto vertices = tree.along(segments[s].a, segments[s].b);
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      const auto exit = mesh.leave(vertices[i], vertices[i + 1]);
      if (!exit.along_edge || exit.end != vertices[i + 1]) return vertices[i];
      chain.push_back(exit.half_edge);
    }
    record(mesh, chain, segments[s].constraint, sources);
    record(mesh, chain, 0, routed_edge);
    return none;
  }

  bool crosses_routed(std::uint32_t s) const {
    bool found = false;
    walk_across(mesh, segments[s], [&](std::uint32_t h) { return found = routed_edge[h] != none; });
    return found;
  }
};

}  // namespace

std::string check_added(const Sites& sites, std::uint32_t inputs) {
  for (std::uint32_t v = inputs; v < sites.at.size(); ++v) {
    if (!sites.is_representative(v))
      return say("added vertex ", v, " is where vertex ", sites.representative[v], " is");
    if (v == inputs) continue;
    if (sites.at[v - 1].key() > sites.at[v].key())
      return say("added vertices ", v - 1, " and ", v, " are not in order of x and y");
  }
  return {};
}

std::string find_crossing(const Sites& sites, const PixelTree& tree, std::uint32_t inputs,
                          const std::vector<Segment>& segments, std::vector<bool>& crosses) {
  return CrossingSearch{sites, tree, inputs, segments, crosses}.run();
}

std::string prove_split(const Sites& sites, const Mesh& mesh, std::uint32_t inputs, Constraints constraints,
                        Sources& sources) {
  const std::vector<Segment> segments = distinct_segments(sites, constraints);
  return SplitProof{sites, mesh, inputs, segments, sources}.run();
}

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
#include "svg_fill.hpp"

#include <algorithm>

namespace gcdt::io {

namespace {

// Pale, so that edges stand out, and distinct for most eyes.
constexpr std::array<const char*, 7> colours = {"#cfe3c8", "#f6e2b3", "#f3c9c0", "#c9d9ee",
                                                "#e0cfe8", "#d6e9e6", "#ead9c4"};

/// A colour for each region: the first that no earlier region across an edge has; else any.
std::vector<std::uint8_t> colours_of_regions(const Triangulation& mesh) {
  std::uint32_t count = 0;
  for (const std::uint32_t region : mesh.region) count = std::max(count, region + 1);
  std::vector<std::array<std::uint32_t, 2>> pairs;  // a region, and a lesser one across an edge
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t across : mesh.neighbours[t])
      if (across >= 0 && mesh.region[static_cast<std::size_t>(across)] < mesh.region[t])
        pairs.push_back({mesh.region[t], mesh.region[static_cast<std::size_t>(across)]});
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::uint8_t> chosen(count);
  auto pair = pairs.begin();
  for (std::uint32_t region = 0; region < count; ++region) {
    std::array<bool, colours.size()> taken{};
    for (; pair != pairs.end() && (*pair)[0] == region; ++pair) taken[chosen[(*pair)[1]]] = true;
    const auto free = std::find(taken.begin(), taken.end(), false);
    chosen[region] = static_cast<std::uint8_t>(free == taken.end() ? region % colours.size() : free - taken.begin());
  }
  return chosen;
}

/// Path data around all triangles of one colour. Each has its inside to the left, so that as many edges come to a
/// vertex as leave it: a walk over unused edges ends where it began, and only there.
class Borders {
 public:
  explicit Borders(const Canvas& canvas) : canvas_(canvas), starts_(canvas.places.size() + 1) {}

  void add(std::uint32_t from, std::uint32_t to) { edges_.push_back({from, to}); }

  void draw(OutputFile& file) {
    for (const auto& edge : edges_) ++starts_[edge[0] + 1];
    for (std::size_t v = 1; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
    ends_.resize(edges_.size());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const auto& edge : edges_) ends_[next[edge[0]]++] = edge[1];
    next.assign(starts_.begin(), starts_.end() - 1);
    for (const auto& edge : edges_)
      while (next[edge[0]] < starts_[edge[0] + 1]) walk(file, edge[0], next);
  }

 private:
  void walk(OutputFile& file, std::uint32_t at, std::vector<std::size_t>& next) {
    const Canvas::Place first = canvas_.places[at];
    Canvas::Place from = first;
    bool drawn = false;
    while (next[at] < starts_[at + 1]) {
      at = ends_[next[at]++];
      const Canvas::Place to = canvas_.places[at];
      const std::int32_t x = to[0] - from[0], y = to[1] - from[1];
      if (x == 0 && y == 0) continue;
      if (!drawn) file.print("M{} {}l", first[0], first[1]);
      file.print("{}{}{}{}", drawn && x >= 0 ? " " : "", x, y >= 0 ? " " : "", y);
      drawn = true;
      from = to;
    }
    if (drawn) file.write("z\n");
  }

  const Canvas& canvas_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<std::size_t> starts_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace

void fill_regions(OutputFile& file, const Canvas& canvas, const Triangulation& mesh) {
  const std::vector<std::uint8_t> colour = colours_of_regions(mesh);
  for (std::size_t c = 0; c < colours.size(); ++c) {
    Borders borders(canvas);
    bool any = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (colour[mesh.region[t]] != c) continue;
      any = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t across = mesh.neighbours[t][k];
        if (across < 0 || colour[mesh.region[static_cast<std::size_t>(across)]] != c)
          borders.add(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
      }
    }
    if (!any) continue;
    file.print("<path fill=\"{}\" d=\"", colours[c]);
    borders.draw(file);
    file.print("\"/>\n");
  }
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// The structured mutator of graphs: adds what is hard for a constrained Delaunay triangulation.
#pragma once

#include <algorithm>
#include <random>

#include "pslg.hpp"

namespace gcdt::fuzz {

class Shapes {
 public:
  Shapes(Graph& graph, unsigned seed) : graph_(graph), random_(seed) {}

  void mutate() {
    switch (below(12)) {
      case 0: return grid();
      case 1: return circle();
      case 2: return run();
      case 3: return overlaps();
      case 4: return crossings();
      case 5: return star();
      case 6: return ring();
      case 7: return copies();
      case 8: return moved();
      case 9: return fewer();
      case 10: return on_constraint();
      default: return choices();
    }
  }

 private:
  unsigned below(unsigned end) { return end == 0 ? 0 : static_cast<unsigned>(random_() % end); }
  unsigned between(unsigned least, unsigned most) { return least + below(most - least + 1); }

  /// The vertex's number; that of the last one if there is no room for more.
  std::uint8_t add(int x, int y) {
    const auto clamp = [](int c) { return static_cast<std::uint8_t>(std::clamp(c, 0, 255)); };
    if (graph_.vertices.size() < most_vertices) graph_.vertices.push_back({clamp(x), clamp(y)});
    return static_cast<std::uint8_t>(graph_.vertices.size() - 1);
  }
  void join(std::uint8_t a, std::uint8_t b) {
    if (graph_.constraints.size() < most_constraints) graph_.constraints.push_back({a, b});
  }
  std::uint8_t any() {
    if (graph_.vertices.empty()) add(static_cast<int>(below(256)), static_cast<int>(below(256)));
    return static_cast<std::uint8_t>(below(static_cast<unsigned>(graph_.vertices.size())));
  }

  /// A rectangle of the lattice, now and then with its diagonals as constraints.
  void grid() {
    const int columns = static_cast<int>(between(2, 8)), rows = static_cast<int>(between(2, 8));
    const int step = static_cast<int>(between(1, 20)), x = static_cast<int>(below(200)),
              y = static_cast<int>(below(200));
    std::vector<std::uint8_t> numbers;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) numbers.push_back(add(x + j * step, y + i * step));
    if (below(2) == 0) return;
    for (int i = 0; i + 1 < rows; ++i)
      for (int j = 0; j + 1 < columns; ++j)
        join(numbers[static_cast<std::size_t>(i * columns + j)],
             numbers[static_cast<std::size_t>((i + 1) * columns + j + 1)]);
  }

  /// Lattice points on one circle: the twelve at distance 5, or the twenty at 25, now and then with chords.
  void circle() {
    static constexpr int near[][2] = {{5, 0}, {4, 3}, {3, 4}},
                         far[][2] = {{25, 0}, {24, 7}, {20, 15}, {15, 20}, {7, 24}};
    const int scale = static_cast<int>(between(1, 4)), x = static_cast<int>(below(256)),
              y = static_cast<int>(below(256));
    std::vector<std::uint8_t> numbers;
    const auto quarter = [&](const auto& points) {
      for (const auto& p : points)
        for (int turn = 0, a = p[0], b = p[1]; turn < 4; ++turn) {
          numbers.push_back(add(x + scale * a, y + scale * b));
          const int turned = -b;
          b = a, a = turned;
        }
    };
    below(2) == 0 ? quarter(near) : quarter(far);
    for (unsigned i = below(6); i > 0; --i)
      join(numbers[below(static_cast<unsigned>(numbers.size()))],
           numbers[below(static_cast<unsigned>(numbers.size()))]);
  }

  /// A long constraint, and vertices that are on it or a cell beside it.
  void run() {
    const int x = static_cast<int>(below(256)), y = static_cast<int>(below(256)), dx = static_cast<int>(below(256)) - x,
              dy = static_cast<int>(below(256)) - y, count = static_cast<int>(between(2, 20));
    const std::uint8_t first = add(x, y), last = add(x + dx, y + dy);
    std::uint8_t before = first;
    for (int i = 1; i < count; ++i) {
      const std::uint8_t next = add(x + dx * i / count, y + dy * i / count + static_cast<int>(below(3)) - 1);
      if (below(3) == 0) join(before, next);
      before = next;
    }
    join(first, last);
  }

  /// Constraints along one line that share parts.
  void overlaps() {
    const int x = static_cast<int>(below(128)), y = static_cast<int>(below(128)), dx = static_cast<int>(below(12)),
              dy = static_cast<int>(below(12));
    std::vector<std::uint8_t> numbers;
    for (int i = 0; i < 8; ++i) numbers.push_back(add(x + i * dx, y + i * dy));
    for (unsigned i = between(2, 8); i > 0; --i) join(numbers[below(8)], numbers[below(8)]);
  }

  /// Constraints between vertices that are there.
  void crossings() {
    for (unsigned i = between(1, 12); i > 0; --i) {
      const std::uint8_t a = any();
      join(a, any());
    }
  }

  /// Constraints through one small place.
  void star() {
    const int x = static_cast<int>(between(40, 200)), y = static_cast<int>(between(40, 200));
    for (unsigned i = between(3, 10); i > 0; --i) {
      const int dx = static_cast<int>(below(80)) - 40, dy = static_cast<int>(below(80)) - 40,
                off = static_cast<int>(below(2));
      const std::uint8_t a = add(x + dx, y + dy);
      join(a, add(x - dx + off, y - dy));
    }
  }

  /// A closed line, which may cross itself.
  void ring() {
    const std::size_t first = graph_.vertices.size();
    for (unsigned i = between(3, 12); i > 0; --i) add(static_cast<int>(below(256)), static_cast<int>(below(256)));
    const std::size_t end = graph_.vertices.size();
    for (std::size_t v = first; v < end; ++v)
      join(static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v + 1 < end ? v + 1 : first));
  }

  /// Vertices that are there once more, and constraints between them.
  void copies() {
    for (unsigned i = between(1, 8); i > 0; --i) {
      const std::uint8_t v = any();
      const std::uint8_t copy = add(graph_.vertices[v][0], graph_.vertices[v][1]);
      if (below(2) == 0) join(copy, any());
    }
  }

  void moved() {
    for (unsigned i = between(1, 4); i > 0; --i) {
      auto& [x, y] = graph_.vertices[any()];
      x = static_cast<std::uint8_t>(std::clamp(x + static_cast<int>(below(3)) - 1, 0, 255));
      y = static_cast<std::uint8_t>(std::clamp(y + static_cast<int>(below(3)) - 1, 0, 255));
    }
  }

  /// Without some constraints; or without the last vertices and what joins them.
  void fewer() {
    if (below(2) == 0) {
      for (unsigned i = between(1, 8); i > 0 && !graph_.constraints.empty(); --i)
        graph_.constraints.erase(graph_.constraints.begin() + below(static_cast<unsigned>(graph_.constraints.size())));
      return;
    }
    const std::size_t left = below(static_cast<unsigned>(graph_.vertices.size() + 1));
    graph_.vertices.resize(left);
    auto& all = graph_.constraints;
    all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& c) { return c[0] >= left || c[1] >= left; }),
              all.end());
  }

  /// A vertex in the middle of a constraint, or beside it, and one that goes on from there.
  void on_constraint() {
    if (graph_.constraints.empty()) return crossings();
    const auto& [a, b] = graph_.constraints[below(static_cast<unsigned>(graph_.constraints.size()))];
    const auto p = graph_.vertices[a], q = graph_.vertices[b];
    const std::uint8_t middle = add((p[0] + q[0]) / 2, (p[1] + q[1]) / 2);
    if (below(2) == 0) join(middle, any());
  }

  void choices() {
    Choices& c = graph_.choices;
    std::uint8_t* const all[] = {&c.crossing, &c.domain, &c.scale, &c.way, &c.refinement, &c.seeds};
    *all[below(choice_bytes)] = static_cast<std::uint8_t>(below(256));
  }

  Graph& graph_;
  std::minstd_rand random_;
};

}  // namespace gcdt::fuzz

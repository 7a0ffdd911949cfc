// SPDX-License-Identifier: Apache-2.0
// The list of inputs, and the files they travel in between the timer and its peers.
#include "inputs.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>

namespace gcdt::bench {

namespace {

constexpr std::size_t million = 1000000;

void add(std::vector<Input>& rows, const char* name, std::initializer_list<std::size_t> sizes) {
  for (const std::size_t size : sizes) rows.push_back({name, size, {}});
}

std::string stem(const std::string& path) {
  const std::size_t slash = path.find_last_of('/'), begin = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t dot = path.find_last_of('.');
  return path.substr(begin, dot == std::string::npos || dot < begin ? std::string::npos : dot - begin);
}

}  // namespace

std::vector<Input> inputs(List list, const std::vector<std::string>& maps) {
  std::vector<Input> rows;
  if (list == List::scaling) {
    add(rows, "uniform", {100000, 300000, million, 3 * million, 10 * million, 30 * million, 100 * million});
    return rows;
  }
  if (list == List::shapes) {
    for (const std::string& name : test::growth_names()) {
      if (name != "letters") add(rows, name.c_str(), {1000});  // they begin with 20,000
      add(rows, name.c_str(), {10000});
      if (name == "parabola")
        add(rows, name.c_str(), {46341});  // no more fit the grid
      else
        add(rows, name.c_str(), {100000, million});
    }
    return rows;
  }
  const bool gpu = list == List::gpu;
  add(rows, "uniform", {1000, million});
  add(rows, "gaussian", {million});
  add(rows, "ring", {million});
  add(rows, "grid", {256 * 256, 512 * 512, 1024 * 1024});
  for (const char* k : {"1", "2", "3", "4", "5", "6"})
    add(rows, (std::string("synthetic_cons_") + k).c_str(), {million});
  add(rows, "airport", {47000, 93000});
  add(rows, "letters", {98000, 970000});
  add(rows, "star", {million});
  add(rows, "fan", {200000});
  add(rows, "spiral", {100000});
  for (const std::string& path : maps) rows.push_back({stem(path), 0, path});
  add(rows, "dirty", {million});
  add(rows, "lined_grid", {million});
  add(rows, "coasts", {415000});
  add(rows, "leafs", {1700000});
  add(rows, "uniform", {3 * million, 5 * million});
  if (!gpu) return rows;
  add(rows, "leafs", {3400000});
  for (const char* name : {"gaussian", "ring"}) add(rows, name, {3 * million, 5 * million});
  for (const char* name : {"uniform", "gaussian", "ring"}) add(rows, name, {7 * million, 9 * million});
  add(rows, "uniform", {10 * million});
  add(rows, "coasts", {10 * million});
  return rows;
}

std::vector<Input> quick(const std::vector<Input>& rows, std::size_t most) {
  std::vector<Input> few;
  std::set<std::pair<std::string, std::size_t>> seen;
  for (Input row : rows) {
    row.size = std::min(row.size, most);
    if (seen.insert({row.name, row.size}).second) few.push_back(row);
  }
  return few;
}

bool selected(const Input& input, const std::string& selection) {
  if (selection.empty()) return true;
  std::stringstream words(selection);
  for (std::string word; std::getline(words, word, ',');)
    if (word == input.name || word == input.name + ":" + std::to_string(input.size)) return true;
  return false;
}

Workload make(const Input& input,
              const std::function<Array<std::array<std::uint32_t, 3>>(const std::vector<Point>&)>& triangles) {
  if (!input.path.empty()) return read_poly(input.path);
  if (input.name == "leafs") return leafs(input.size);
  if (input.name == "airport") return airport(input.size);
  if (input.name == "coasts") return coasts(input.size);
  if (input.name == "dirty") return dirty(input.size);
  if (input.name == "lined_grid") return lined_grid(input.size);
  const std::string synthetic = "synthetic_cons_";
  if (input.name.compare(0, synthetic.size(), synthetic) != 0) return test::workload(input.name, input.size);
  const int k = std::atoi(input.name.c_str() + synthetic.size());
  return test::synthetic_cons(input.size, k, [&](const std::vector<Point>& points) {
    std::vector<Segment> edges;
    for (const auto& t : triangles(points))
      for (int i = 0; i < 3; ++i) edges.push_back({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  });
}

namespace {

// All points of a square of integers, at most n, in random order.
struct Square {
  std::uint32_t side = 1;
  std::vector<std::uint32_t> number;  ///< the vertex at place x + side y
  Workload work;
};

Square square(std::size_t n, test::Random& random) {
  Square all;
  while ((std::size_t{all.side} + 1) * (all.side + 1) <= n) ++all.side;
  all.number.resize(std::size_t{all.side} * all.side);
  for (std::uint32_t v = 0; v < all.number.size(); ++v) all.number[v] = v;
  test::shuffle(all.number, random);
  all.work.points.resize(all.number.size());
  for (std::uint32_t v = 0; v < all.number.size(); ++v)
    all.work.points[all.number[v]] = {static_cast<double>(v % all.side), static_cast<double>(v / all.side)};
  return all;
}

}  // namespace

Workload lined_grid(std::size_t n) {
  test::Random random(22001);
  auto [side, number, work] = square(n, random);
  const std::uint32_t lines = 8 * side / 15, rows = lines - lines / 2;
  for (std::uint32_t i = 0; i < lines; ++i) {
    const std::uint32_t at = i / 2 * side / rows, begin = i % 2 ? at : side * at;
    work.constraints.push_back({number[begin], number[begin + (side - 1) * (i % 2 ? side : 1)]});
  }
  return work;
}

Workload dirty(std::size_t n) {
  test::Random random(20001);
  auto [side, number, work] = square(n, random);
  while (work.constraints.size() < n) {
    const auto v = static_cast<std::uint32_t>(random.below(number.size()));
    const auto steps = static_cast<std::uint32_t>(random.below(8));
    const bool along_x = random.below(2) != 0;
    if ((along_x ? v % side : v / side) + steps >= side) continue;
    const std::uint32_t w = v + steps * (along_x ? 1 : side);
    const bool back = random.below(2) != 0;
    work.constraints.push_back({number[back ? w : v], number[back ? v : w]});
  }
  return work;
}

// Vertices without attributes or markers first, then segments; no holes. That is all that maps need.
Workload read_poly(const std::string& path) {
  const auto bad = [&](const char* what) { throw std::runtime_error(path + ": " + what); };
  std::ifstream file(path);
  if (!file) bad("cannot be opened");
  std::stringstream text;
  for (std::string line; std::getline(file, line);) text << line.substr(0, line.find('#')) << '\n';
  std::size_t n = 0, dimension = 0, attributes = 0, markers = 0, m = 0;
  text >> n >> dimension >> attributes >> markers;
  if (!text || dimension != 2 || attributes != 0) bad("no plain list of vertices");
  Workload work;
  std::size_t first = 0, skip = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t number = 0;
    std::string x, y;
    text >> number >> x >> y;
    for (std::size_t k = 0; k < markers; ++k) text >> skip;
    if (i == 0) first = number;
    work.points.push_back({std::strtod(x.c_str(), nullptr), std::strtod(y.c_str(), nullptr)});
  }
  text >> m >> markers;
  for (std::size_t i = 0; i < m; ++i) {
    std::size_t number = 0, a = 0, b = 0;
    text >> number >> a >> b;
    for (std::size_t k = 0; k < markers; ++k) text >> skip;
    if (a < first || b < first || a - first >= n || b - first >= n) bad("a segment ends at no vertex");
    work.constraints.push_back({static_cast<std::uint32_t>(a - first), static_cast<std::uint32_t>(b - first)});
  }
  if (!text) bad("ends too soon");
  return work;
}

void write_pslg(const Workload& work, const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be written");
  const std::int64_t counts[2] = {static_cast<std::int64_t>(work.points.size()),
                                  static_cast<std::int64_t>(work.constraints.size())};
  const auto put = [&](const void* data, std::size_t size, std::size_t count) {
    if (std::fwrite(data, size, count, file.get()) != count) throw std::runtime_error(path + ": cannot be written");
  };
  put("PSLGBIN1", 1, 8);
  put(counts, sizeof counts[0], 2);
  put(work.points.data(), sizeof(Point), work.points.size());
  put(work.constraints.data(), sizeof(Segment), work.constraints.size());
}

Workload read_pslg(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  const auto get = [&](void* data, std::size_t size, std::size_t count) {
    if (std::fread(data, size, count, file.get()) != count) throw std::runtime_error(path + ": no whole PSLGBIN1 file");
  };
  char magic[8];
  std::int64_t counts[2];
  get(magic, 1, sizeof magic);
  get(counts, sizeof counts[0], 2);
  if (std::memcmp(magic, "PSLGBIN1", sizeof magic) != 0 || counts[0] < 0 || counts[1] < 0)
    throw std::runtime_error(path + ": no PSLGBIN1 file");
  Workload work;
  work.points.resize(static_cast<std::size_t>(counts[0]));
  work.constraints.resize(static_cast<std::size_t>(counts[1]));
  get(work.points.data(), sizeof(Point), work.points.size());
  get(work.constraints.data(), sizeof(Segment), work.constraints.size());
  return work;
}

}  // namespace gcdt::bench

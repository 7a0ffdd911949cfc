// SPDX-License-Identifier: Apache-2.0
// The table hashes.txt: what small workloads gave when a person last decided that it is right. Read, made and printed.
#pragma once

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gcdt/gcdt_pool.hpp>

#include "result_hash.hpp"
#include "workloads.hpp"

namespace gcdt::test {

/// A line of the table. `how`: words that are options, split by commas, or "-".
struct KeptHash {
  std::string name;
  std::size_t n = 0;
  std::string how, hash;
};

/// The table's rows; comments and empty lines are skipped. Throws if a row is not one.
inline std::vector<KeptHash> read_kept_hashes(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  std::vector<KeptHash> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream text(line);
    KeptHash row;
    if (!(text >> row.name >> row.n >> row.how >> row.hash)) throw std::runtime_error(path + ": no row: " + line);
    rows.push_back(row);
  }
  return rows;
}

inline std::string hash_text(std::uint64_t hash) {
  char buffer[17];
  std::snprintf(buffer, sizeof buffer, "%016" PRIx64, hash);
  return buffer;
}

/// Synthetic-cons needs Delaunay edges; here the library under test makes them itself.
inline std::vector<Segment> delaunay_edges(Solver& solver, const std::vector<Point>& points) {
  std::set<Segment> edges;
  for (const auto& t : solver.triangulate(points).triangles)
    for (int k = 0; k < 3; ++k) edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  return {edges.begin(), edges.end()};
}

/// Any workload() and those that need more than a name and a size.
inline Workload make_workload(Solver& solver, const std::string& name, std::size_t n) {
  const std::string synthetic = "synthetic_cons_";
  if (name == "random_crossing") return random_crossing(n, static_cast<std::uint32_t>(n), n / 4, 11);
  if (name.compare(0, synthetic.size(), synthetic) != 0) return workload(name, n);
  return synthetic_cons(n, std::stoi(name.substr(synthetic.size())),
                        [&](const std::vector<Point>& points) { return delaunay_edges(solver, points); });
}

/// Options from the words of `how`. Seeds, where they matter, are vertices of the input.
inline Options options_of(const std::string& how, const Workload& work) {
  Options options;
  std::istringstream words(how == "-" ? "" : how);
  for (std::string word; std::getline(words, word, ',');) {
    static const std::pair<const char*, Domain> domains[] = {{"even-odd", Domain::even_odd},
                                                             {"nonzero", Domain::nonzero},
                                                             {"holes", Domain::holes},
                                                             {"outer", Domain::outer},
                                                             {"outer-holes", Domain::outer_holes}};
    const auto* domain =
        std::find_if(std::begin(domains), std::end(domains), [&](const auto& named) { return word == named.first; });
    if (domain != std::end(domains))
      options.domain = domain->second;
    else if (word == "drop" || word == "split")
      options.crossing = word == "drop" ? Crossing::drop : Crossing::split;
    else if (word == "refine")
      options.refine = Refinement{};
    else if (word == "regions")
      options.regions = true;
    else
      throw std::runtime_error("no option is called " + word);
  }
  if (options.domain == Domain::holes || options.domain == Domain::outer_holes)
    options.hole_seeds = {work.points.at(0)};
  if (options.regions) options.region_seeds = {work.points.at(work.points.size() / 2)};
  return options;
}

/// As the kept hashes are made: without region_seed, which is -1 in a batch.
inline Triangulation part_of(const BatchResult& batch, std::size_t p) {
  Triangulation part = detail::triangulation(batch, p);
  part.region_seed.clear();
  part.added.clear();
  return part;
}

/// `n` problems of 3 to 80 vertices, some with many equal ones; their constraints cross if they may.
inline std::uint64_t hash_of_batch(Pool& pool, std::size_t n, const std::string& how) {
  Batch batch;
  const Options options = options_of(how, {});
  for (std::size_t p = 0; p < n; ++p) {
    const std::size_t points = 3 + p * 37 % 78;
    const auto side = static_cast<std::uint32_t>(4 + p * 11 % 60);
    const Workload work = options.crossing == Crossing::reject ? random_pslg(points, side, points, p)
                                                               : random_crossing(points, side, points / 4, p);
    batch.add(work.points, work.constraints);
  }
  const BatchResult result = pool.triangulate(batch.view(), options);
  Hash hash;
  for (std::size_t p = 0; p < n; ++p) {
    if (result.error(p)) throw *result.error(p);
    hash.add(result_hash(part_of(result, p)));
  }
  return hash.value();
}

/// A device to make hashes on. Its pool is only made if there is a batch.
class Hasher {
 public:
  explicit Hasher(const std::string& device) : Hasher(Solver(device), [device] { return Pool(device); }) {}
  Hasher(Solver solver, std::function<Pool()> make_pool)
      : solver_(std::move(solver)), make_pool_(std::move(make_pool)) {}
  Solver& solver() { return solver_; }

  /// The hash of what the workload of a row gives here.
  std::string hash(const KeptHash& row) {
    if (row.name == "batch") {
      if (!pool_) pool_ = std::make_unique<Pool>(make_pool_());
      return hash_text(hash_of_batch(*pool_, row.n, row.how));
    }
    const Workload work = make_workload(solver_, row.name, row.n);
    return hash_text(result_hash(solver_.triangulate(work.points, work.constraints, options_of(row.how, work))));
  }

 private:
  Solver solver_;
  std::function<Pool()> make_pool_;
  std::unique_ptr<Pool> pool_;
};

}  // namespace gcdt::test

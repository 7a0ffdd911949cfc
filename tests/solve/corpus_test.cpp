// SPDX-License-Identifier: Apache-2.0
// The corpus itself, proved without the library: hand-derived numbers against exact brute force.
#include "corpus.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "oracle.hpp"

using namespace gcdt::test;

namespace {

const std::string folder = std::string(GCDT_TEST_DATA) + "/corpus";

/// Decimals and reals need the grid; the rest has integer coordinates within 2^53.
bool has_integer_coordinates(const Workload& work) {
  for (const Point& p : work.points)
    for (double c : p)
      if (!(std::fabs(c) < 0x1p53 && c == std::floor(c))) return false;
  return true;
}

}  // namespace

TEST_CASE("the manifest lists every file of the corpus and nothing else") {
  std::set<std::string> listed, present;
  for (const CorpusEntry& entry : read_manifest(folder)) {
    CHECK(listed.insert(entry.name).second);
    CHECK((entry.status == "ok" || entry.status == "crossing" || entry.status == "invalid"));
  }
  for (const auto& file : std::filesystem::directory_iterator(folder))
    if (file.path().extension() == ".poly") present.insert(file.path().filename().string());
  CHECK(listed == present);
}

TEST_CASE("triangles and crossings in the manifest hold for the files") {
  std::size_t checked = 0;
  for (const CorpusEntry& entry : read_manifest(folder)) {
    const Workload work = read_poly(folder + "/" + entry.name);
    if (entry.status == "invalid" || !has_integer_coordinates(work)) continue;
    CAPTURE(entry.name);
    const auto points = integers(work.points);
    CHECK(static_cast<long>(triangle_count(points)) == entry.triangles);
    CHECK(static_cast<long>(crossings(points, work.constraints).size()) == entry.crossings);
    CHECK((entry.status == "crossing") == (entry.crossings > 0));
    ++checked;
  }
  CHECK(checked > 45);
}

TEST_CASE("the minimal files start with a mesh of their vertices; only slip_1 and slip_2 have crossings") {
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder + "/minimal")) {
    const Minimal minimal = read_minimal(file.path().string());
    CAPTURE(file.path().string());
    const auto points = integers(minimal.input.points);
    CHECK(minimal.start.size() == triangle_count(points));
    for (const auto& t : minimal.start) CHECK(orientation(points[t[0]], points[t[1]], points[t[2]]) > 0);
    const std::string name = file.path().stem().string();
    CHECK(crossings(points, minimal.input.constraints).empty() == (name != "slip_1" && name != "slip_2"));
    ++files;
  }
  CHECK(files == 36);
}

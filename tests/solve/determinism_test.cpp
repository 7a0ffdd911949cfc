// SPDX-License-Identifier: Apache-2.0
// The same input gives the same bytes: on PoCL in twenty runs, ten with one thread and ten with
// two, and on Mesa's rusticl. Each setting needs a process of its own: the program result_hash.
#include <doctest/doctest.h>

#include <array>
#include <cinttypes>
#include <cstdio>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "result_hash.hpp"
#include "solver_fixture.hpp"

using namespace gcdt::test;

namespace {

struct Case {
  const char* name;
  std::size_t size;
};

// Small, yet with many conflicts between work-items: ties, long constraints, hubs, holes, duplicates.
const Case cases[] = {{"uniform", 3000},    {"grid", 1024},          {"clusters", 2000}, {"fan", 2000},
                      {"hub", 400},         {"spiral", 1000},        {"letters", 2000},  {"random_pslg", 60},
                      {"random_pslg", 300}, {"lattice_circle", 1000}};
// As large as a thread's share of work, and the race for it, begin to matter.
const Case large_cases[] = {{"uniform", 100000}, {"letters", 98000}, {"fan", 100000}, {"clusters", 100000}};
// On rusticl a tenth as fast: two sizes that reach the kernels of large inputs.
const Case large_rusticl_cases[] = {{"uniform", 60000}, {"letters", 30000}};

/// The hashes that result_hash prints, a word each; empty if it failed.
std::vector<std::string> hashes(const std::string& environment, const std::string& device, const Case& input,
                                int runs) {
  const std::string command = environment + " '" RESULT_HASH "' '" + device + "' " + input.name + " " +
                              std::to_string(input.size) + " " + std::to_string(runs);
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string output;
  for (std::array<char, 512> line; std::fgets(line.data(), static_cast<int>(line.size()), pipe) != nullptr;)
    output += line.data();
  INFO(command);
  CHECK(pclose(pipe) == 0);
  std::vector<std::string> result;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, size, hash;
    words >> name >> size >> hash;
    result.push_back(hash);
  }
  CHECK(result.size() == static_cast<std::size_t>(runs));
  return result;
}

std::string text(std::uint64_t hash) {
  char buffer[17];
  std::snprintf(buffer, sizeof buffer, "%016" PRIx64, hash);
  return buffer;
}

std::string threads(int count) {  // the old name of the variable and the new one
  return "POCL_MAX_PTHREAD_COUNT=" + std::to_string(count) + " POCL_CPU_MAX_CU_COUNT=" + std::to_string(count);
}

std::string hash_here(const Case& input) {
  const Workload work = workload(input.name, input.size);
  return text(result_hash(solver().triangulate(work.points, work.constraints)));
}

/// One and two threads give one hash in twenty runs, which is that of this process.
void check_threads(const Case& input) {
  CAPTURE(input.name);
  std::set<std::string> different;
  for (int count : {1, 2})
    for (const std::string& hash : hashes(threads(count), test_device(), input, 10)) different.insert(hash);
  CHECK(different.size() == 1);
  CHECK(different.count(hash_here(input)) == 1);
}

void check_rusticl(const Case& input) {
  CAPTURE(input.name);
  const std::vector<std::string> found = hashes("RUSTICL_ENABLE=swrast", "llvmpipe", input, 1);
  REQUIRE(found.size() == 1);
  CHECK(found[0] == hash_here(input));
}

}  // namespace

TEST_CASE("one and two threads give the same bytes in twenty runs") {
  for (const Case& input : cases) check_threads(input);
}

TEST_CASE("so they do with 100,000 vertices") {
  for (const Case& input : large_cases) check_threads(input);
}

TEST_CASE("rusticl gives the same bytes as PoCL") {  // no 64-bit atomics, no fp64; missing, this fails
  for (const Case& input : cases) check_rusticl(input);
  for (const Case& input : large_rusticl_cases) check_rusticl(input);
}

TEST_CASE("the hash tells results apart in every array") {
  const Workload work = random_pslg(40, 9, 60, 1);
  const gcdt::Triangulation mesh = solver().triangulate(work.points, work.constraints);
  REQUIRE(mesh.triangles.size() > 1);
  REQUIRE(!mesh.sources.empty());
  std::set<std::uint64_t> values{result_hash(mesh)};
  const auto with = [&](auto change) {
    gcdt::Triangulation other = mesh;
    change(other);
    values.insert(result_hash(other));
  };
  with([](auto& m) { std::swap(m.triangles[0], m.triangles[1]); });
  with([](auto& m) { m.neighbours[0][0] ^= 1; });
  with([](auto& m) { m.constrained[0] ^= 1; });
  with([](auto& m) { m.representative[1] ^= 1; });
  with([](auto& m) { std::swap(m.pieces[0][0], m.pieces[0][1]); });
  with([](auto& m) { m.source_offsets[1] += 1; });
  with([](auto& m) { m.sources[0] ^= 1; });
  with([](auto& m) { m.dropped.push_back(0); });
  CHECK(values.size() == 9);
}

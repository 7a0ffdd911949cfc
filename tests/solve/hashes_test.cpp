// SPDX-License-Identifier: Apache-2.0
// Every device gives the bytes that are kept as hashes in hashes.txt: a change of results is a decision, never a
// side effect.
#include <doctest/doctest.h>

#include "device_list.hpp"
#include "kept_hashes.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before anything else lists devices.
const std::size_t device_count = every_device().size();

const std::vector<KeptHash>& rows() {
  static const std::vector<KeptHash> all = read_kept_hashes(GCDT_TEST_DATA "/hashes.txt");
  return all;
}

void check_rows(const std::string& device) {
  Hasher hasher(device);
  CAPTURE(hasher.solver().device().name);
  for (const KeptHash& row : rows()) {
    CAPTURE(row.name);
    CAPTURE(row.n);
    CAPTURE(row.how);
    CHECK(hasher.hash(row) == row.hash);
  }
}

}  // namespace

TEST_CASE("every device gives the kept bytes") {
  for (std::size_t number = 0; number < device_count; ++number) check_rows(std::to_string(number));
}

TEST_CASE("the device that tests or users name gives the kept bytes") {
  for (const char* variable : {"GCDT_TEST_DEVICE", "GCDT_DEVICE"})
    if (const char* named = std::getenv(variable)) check_rows(named);
}

TEST_CASE("the table has every workload, every way with crossings, every domain, and batches") {
  std::set<std::string> names, words;
  std::set<std::pair<std::string, std::string>> batches;
  for (const KeptHash& row : rows()) {
    names.insert(row.name);
    std::istringstream how(row.how);
    for (std::string word; std::getline(how, word, ',');) words.insert(word);
    if (row.name == "batch") batches.insert({row.name, row.how});
    CHECK(row.hash.size() == 16);
  }
  for (const std::string& name : workload_names()) {
    CAPTURE(name);
    CHECK(names.count(name) == 1);
  }
  for (const char* word : {"-", "drop", "split", "even-odd", "nonzero", "holes", "outer", "outer-holes", "regions"}) {
    CAPTURE(word);
    CHECK(words.count(word) == 1);
  }
  for (const char* how : {"-", "drop", "split", "even-odd"}) {
    CAPTURE(how);
    CHECK(batches.count({"batch", how}) == 1);
  }
}

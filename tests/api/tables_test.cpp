// SPDX-License-Identifier: Apache-2.0
// The tables of statuses (gcdt/statuses.hpp) and statistics (gcdt/statistics.def): they have all that the headers
// declare, each with its own name, and lead both ways.
#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "api/state.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(GCDT_TEST_DATA "/../" + path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// What stands between two words in a file, without comments.
std::string part_of(const std::string& path, const std::string& from, const std::string& to) {
  const std::string text = text_of(path);
  const std::size_t begin = text.find(from), end = text.find(to, begin);
  REQUIRE(end != std::string::npos);
  const std::string part = text.substr(begin + from.size(), end - begin - from.size());
  const std::regex comments(R"(/\*[^]*?\*/|//[^\n]*)");
  return std::regex_replace(part, comments, "");
}

std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), expression), last; i != last; ++i) found.insert(i->str(1));
  return found;
}

/// Of the statistics: members of gcdt_statistics, and names, by these.
std::map<std::string, std::string> rows() {
  std::map<std::string, std::string> all;
#define GCDT_STATISTIC(member, name) CHECK(all.emplace(#member, #name).second);
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT GCDT_STATISTIC
#include <gcdt/statistics.def>
  return all;
}

}  // namespace

TEST_CASE("every status of C++ has a row, and every code of C") {
  const auto names = matches(part_of("include/gcdt/types.hpp", "enum class Status {", "};"), R"((\w+),)");
  std::set<Status> rows;
  std::set<std::int32_t> codes;
  std::set<std::string> sentences;
  for (const detail::StatusRow& row : detail::statuses) {
    CAPTURE(row.sentence);
    CHECK(rows.insert(row.status).second);
    CHECK(codes.insert(row.code).second);
    CHECK(sentences.insert(gcdt_strerror(row.code)).second);
    CHECK(detail::status_of(row.code) == row.status);
    CHECK(detail::row_of(row.status) == &row);
    CHECK(api::code_of(Error(row.status, "")) == row.code);
  }
  CHECK(rows.size() == names.size());
  for (const detail::CodeRow& row : detail::other_codes) {
    CAPTURE(row.sentence);
    CHECK(codes.insert(row.code).second);
    CHECK(sentences.insert(gcdt_strerror(row.code)).second);
    CHECK(detail::status_of(row.code) == row.status);
  }
  const auto declared = matches(part_of("include/gcdt/gcdt.h", "GCDT_OK = 0,", "};"), R"(= (-\d+))");
  CHECK(declared.size() > 20);
  for (const std::string& code : declared) {
    CAPTURE(code);
    CHECK(codes.count(std::stoi(code)) == 1);
  }
  for (const std::int32_t code : codes)
    if (code <= -20000) CHECK(declared.count(std::to_string(code)) == 1);
}

TEST_CASE("codes of OpenCL: little memory is one status, others are a failed device, and the code is kept") {
  for (const cl_int code :
       {CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_RESOURCES, CL_OUT_OF_HOST_MEMORY, CL_INVALID_BUFFER_SIZE})
    CHECK(detail::status_of(code) == Status::out_of_memory);
  for (const cl_int code : {CL_DEVICE_NOT_FOUND, CL_BUILD_PROGRAM_FAILURE, CL_INVALID_KERNEL_ARGS, -9999})
    CHECK(detail::status_of(code) == Status::device_failed);
  CHECK(api::code_of(Error(Status::device_failed, "", {}, 0, CL_INVALID_EVENT)) == CL_INVALID_EVENT);
}

TEST_CASE("every member of gcdt_statistics has a row, and its name is the one of C++") {
  std::set<std::string> members;
  for (const std::string& declaration : [] {
         const std::string part = part_of("include/gcdt/gcdt.h", "typedef struct gcdt_statistics {", "} gcdt_stat");
         return matches(part, R"(\s*([^;]+);)");
       }()) {
    const auto names = matches(declaration, R"((\w+)\s*(?:\[\d+\])?\s*(?:,|$))");
    members.insert(names.begin(), names.end());
  }
  for (const char* other : {"struct_size", "grid", "rounded_pair"}) CHECK(members.erase(other) == 1);
  std::set<std::string> found;
  for (const auto& [member, name] : rows()) {
    found.insert(member);
    const std::string own = name.rfind("cases.", 0) == 0 ? name.substr(6) : name;
    CHECK(std::regex_replace(own, std::regex(R"(\.)"), "_") == member);
  }
  CHECK(found == members);
}

TEST_CASE("every statistic comes from the library to C++") {
  const Result result = solver().solve(Points(std::vector<std::array<double, 2>>{{0, 0}, {1, 0}, {0, 1}}));
  Statistics& inside = result.handle()->data.statistics;
  const Statistics before = inside;
  std::uint64_t number = 1000;
#define GCDT_STATISTIC(member, name) inside.name = static_cast<decltype(inside.name)>(++number);
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT(member, name) inside.name = std::to_string(++number);
#include <gcdt/statistics.def>
  inside.rounded_pair = {7, 8};
  inside.notes = {"one", "two"};
  const Statistics outside = result.statistics();
#define GCDT_STATISTIC(member, name) CHECK(outside.name == inside.name);
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT GCDT_STATISTIC
#include <gcdt/statistics.def>
  CHECK(outside.rounded_pair == inside.rounded_pair);
  CHECK(outside.notes == inside.notes);
  CHECK(outside.grid.cell_exponent == inside.grid.cell_exponent);
  inside = before;
}

TEST_CASE("docs/statistics.md has every name in the file of --stats") {
  const auto documented = matches(text_of("docs/statistics.md"), R"(`(\w+)`)");
  std::set<std::string> names;
#define GCDT_STATISTIC_OTHER(name) names.insert(#name);
#define GCDT_STATISTIC(member, name) names.insert(#name);
#define GCDT_STATISTIC_TEXT GCDT_STATISTIC
#include <gcdt/statistics.def>
  for (const std::string& name : names) {
    CAPTURE(name);
    const std::size_t dot = name.find('.');
    CHECK(documented.count(name.substr(0, dot)) == 1);
    if (name.rfind("ms.", 0) == 0) CHECK(documented.count(name.substr(dot + 1)) == 1);
  }
}

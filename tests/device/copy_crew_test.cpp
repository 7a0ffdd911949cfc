// SPDX-License-Identifier: Apache-2.0
// The threads that copy between chunks and the caller's memory.
#include <doctest/doctest.h>

#include <algorithm>

#include "barred_memory.hpp"
#include "device/copy_crew.hpp"
#include "device/tuning.hpp"
#include "fresh_memory.hpp"
#include "random_bytes.hpp"
#include "threads_here.hpp"

using namespace gcdt;
using namespace gcdt::runtime;
using namespace gcdt::test;

namespace {

constexpr std::size_t piece = Tuning::copied_at_once;

bool is_there_behind_first_piece(const std::vector<unsigned char>& found, const std::vector<unsigned char>& given) {
  return std::equal(found.begin() + piece, found.end(), given.begin() + piece);
}

}  // namespace

#ifdef __linux__
TEST_CASE("a crew starts helpers when copies are begun, as many as it may, and keeps them") {
  const std::size_t slots = 4, bytes = 1000;
  const std::vector<unsigned char> given = random_bytes(slots * bytes, 3);
  std::vector<unsigned char> found(given.size());
  const std::size_t before = threads_here();
  CopyCrew crew(slots);
  crew.limit(2);
  CHECK(threads_here() == before);
  const auto copy = [&](std::size_t i) {
    crew.begin(i, {found.data() + i * bytes, given.data() + i * bytes, bytes, false});
    crew.wait(i);
  };
  for (std::size_t i = 0; i < slots; ++i) {
    copy(i);
    CHECK(threads_here() == before + 1);
  }
  CHECK(found == given);
  crew.limit(1);
  CHECK(crew.has_helpers());
  CHECK(threads_here() == before + 1);
  // Awake for a copy that its caller does not wait for. (The first sleep is the helper's, who may have come just now.)
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::vector<unsigned char> by_helper(bytes);
  CHECK(comes_true([&] {
    crew.begin(0, {by_helper.data(), given.data(), bytes, false});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    crew.forget();
    return std::equal(by_helper.begin(), by_helper.end(), given.begin());
  }));
}
#endif

TEST_CASE("a crew copies what it is given, by any number of threads, and forgets the rest when it ends") {
  const std::size_t slots = 4, bytes = 2 * piece + 100000;
  const std::vector<unsigned char> given = random_bytes(40 * bytes, 3);
  for (const unsigned threads : {0u, 1u, 2u, 7u})
    for (const bool to_caller : {false, true}) {
      CAPTURE(threads);
      std::vector<unsigned char> found(given.size());
      CopyCrew crew(slots);
      crew.limit(threads);
      CHECK(crew.has_helpers() == (threads > 1));
      for (std::size_t i = 0; i < 40; ++i) {
        crew.wait(i % slots);
        crew.begin(i % slots, {found.data() + i * bytes, given.data() + i * bytes, bytes, to_caller});
      }
      for (std::size_t i = 0; i < slots; ++i) crew.wait(i);
      CHECK(found == given);
    }
  std::vector<unsigned char> none(slots * bytes);
  CopyCrew alone(slots);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < slots; ++i) alone.begin(i, {none.data() + i * bytes, given.data(), bytes, false});
    alone.forget();
  }
  {
    const CrewAtWork work(alone, 1);
    for (std::size_t i = 0; i < slots; ++i) work.crew.begin(i, {none.data() + i * bytes, given.data(), bytes, false});
  }
  for (std::size_t i = 0; i < slots; ++i) alone.wait(i);
  CHECK(none == std::vector<unsigned char>(slots * bytes));
  for (int round = 0; round < 50; ++round) {
    std::vector<unsigned char> found(slots * bytes);
    {
      CopyCrew crew(slots);
      crew.limit(3);
      for (std::size_t i = 0; i < slots; ++i)
        crew.begin(i, {found.data() + i * bytes, given.data() + i * bytes, bytes, false});
    }
    const std::vector<unsigned char> at_end = found;
    if (round % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    CHECK(found == at_end);
  }
}

TEST_CASE("a copy is made by all threads that are free, in pieces") {
  const std::vector<unsigned char> given = random_bytes(3 * piece + 5, 7);
  for (const bool to_caller : {false, true}) {
    BarredMemory from(given);
    std::vector<unsigned char> found(given.size()), next(1);
    CopyCrew crew(2);
    crew.limit(2);
    const OpenedAtEnd in_any_case{{&from}};  // the crew waits for its threads then
    crew.begin(0, {found.data(), from.data(), found.size(), to_caller});
    REQUIRE(comes_true([&] { return from.reached(); }));
    crew.begin(1, {next.data(), given.data(), 1, to_caller});
    crew.wait(1);  // the helper is held: what is there is this thread's
    CHECK(is_there_behind_first_piece(found, given));
    from.open();
    crew.wait(0);
    CHECK(found == given);
  }
}

TEST_CASE("a copy to the caller is made by one thread while others wait") {
  const std::vector<unsigned char> given = random_bytes(2 * piece, 7);
  for (const bool to_caller : {false, true}) {
    BarredMemory first(given), second(given);
    std::vector<unsigned char> found[3];
    for (std::vector<unsigned char>& bytes : found) bytes.resize(given.size());
    CopyCrew crew(3);
    crew.limit(2);
    const OpenedAtEnd in_any_case{{&first, &second}};
    crew.begin(0, {found[0].data(), first.data(), piece, to_caller});
    REQUIRE(comes_true([&] { return first.reached(); }));  // so the helper makes none of the next before there are two
    crew.begin(1, {found[1].data(), second.data(), given.size(), to_caller});
    crew.begin(2, {found[2].data(), given.data(), given.size(), to_caller});
    first.open();
    REQUIRE(comes_true([&] { return second.reached(); }));
    crew.wait(2);
    CHECK(is_there_behind_first_piece(found[1], given) == !to_caller);
    second.open();
    crew.wait(1);
    CHECK(found[1] == given);
    CHECK(found[2] == given);
  }
}

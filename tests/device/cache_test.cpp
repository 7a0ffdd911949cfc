// SPDX-License-Identifier: Apache-2.0
// The cache of programs when writing to it fails or the process is killed there, when it holds what it should not, and
// when several processes fill it at once, some of which are killed: what it gives is whole, and it never fails.
#include <sys/stat.h>
#include <gcdt/gcdt.hpp>

#include <chrono>
#include <random>
#include <thread>

#include "cache_folder.hpp"
#include "device/cache.hpp"
#include "device/programs.hpp"
#include "device/runtime.hpp"
#include "file_faults.hpp"

using namespace gcdt;
using namespace gcdt::testing;
namespace fs = std::filesystem;

namespace {

/// A folder that is the cache, of this process and its children.
struct Cache : ScratchFolder {
  Cache() {
    test::set_variable("GCDT_DISABLE_CACHE", "0");
    test::set_variable("GCDT_CACHE_DIR", *this / "");
  }
  void clear() const {
    for (const std::string& name : names()) fs::remove_all(*this / name);
  }
};

std::string content_of(std::uint64_t number) {
  std::mt19937_64 random(number);
  std::string bytes(1 + random() % 200000, 0);
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}
std::string entry_of(std::uint64_t number) { return cache::entry("program", {std::to_string(number)}); }

int number(const char* variable, int usual) {
  const char* given = std::getenv(variable);
  return given ? std::atoi(given) : usual;
}

void make_old(const std::string& path) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(2));
}

}  // namespace

TEST_CASE("storing fails somewhere: the entry is the one before or the new one, and nothing else is left") {
  const Cache cache;
  const std::string entry = entry_of(1), before = content_of(2), after = content_of(3);
  for (const bool was_there : {false, true})
    for (const char* fault : {"fail", "full"}) {
      const unsigned calls = for_each_call(
          cache, fault,
          [&] {
            cache.clear();
            if (was_there) cache::store(entry, before);
          },
          [&] { cache::store(entry, after); },
          [&](const Ended& ended) {
            CHECK(ended.error == "");  // a cache never fails
            const auto kept = cache::load(entry);
            CHECK((kept ? kept == after || (was_there && kept == before) : !was_there));
            CHECK(cache.names() == (kept ? std::vector{entry} : std::vector<std::string>()));
          });
      CHECK(calls >= 3);
    }
}

TEST_CASE(
    "storing is killed somewhere: the same, and what is left of it goes with a process that stores an hour later") {
  const Cache cache;
  const std::string entry = entry_of(1), other = entry_of(2), before = content_of(2), after = content_of(3);
  const auto store_elsewhere = [&](const std::string& name, const std::string& content) {
    CHECK(Child([&] { cache::store(name, content); }).wait().error == "");
  };
  int left = 0;
  for_each_call(
      cache, "kill",
      [&] {
        cache.clear();
        store_elsewhere(entry, before);
      },
      [&] { cache::store(entry, after); },
      [&](const Ended&) {
        const auto kept = cache::load(entry);
        CHECK((kept == before || kept == after));
        const std::vector<std::string> names = cache.names();
        left += names.size() > 1;
        store_elsewhere(other, after);
        CHECK(cache.names().size() == names.size() + 1);  // it may be another process that is at it
        for (const std::string& name : names) make_old(cache / name);
        store_elsewhere(other, after);
        std::vector<std::string> whole{entry, other};
        std::sort(whole.begin(), whole.end());
        CHECK(cache.names() == whole);
      });
  CHECK(left >= 2);
}

TEST_CASE("a process looks once for what is left in a folder") {
  const Cache first;
  const std::string entry = entry_of(1), left = entry + ".123";
  const auto leave = [&](const Cache& cache) { make_old(cache.write(left, "half")); };
  leave(first);
  cache::store(entry, "content");
  CHECK(first.names() == std::vector{entry});
  leave(first);
  cache::store(entry, "content");
  CHECK(first.names() == std::vector{entry, left});
  const Cache second;
  leave(second);
  cache::store(entry, "content");
  CHECK(second.names() == std::vector{entry});
}

TEST_CASE("files that are nobody's stay in a folder that is the cache") {
  const Cache cache;
  const std::vector<std::string> names = {"README.txt", "data.1", "program-0123.5", entry_of(7) + ".txt"};
  for (const std::string& name : names) make_old(cache.write(name, "mine"));
  cache::store(entry_of(1), "content");
  for (const std::string& name : names) CHECK(cache.read(name) == "mine");
}

TEST_CASE("what stands where an entry should be is passed over, whatever it is") {
  const Cache cache;
  const std::string entry = entry_of(1), path = cache / entry, content = content_of(4);
  const std::vector<std::pair<const char*, std::function<void()>>> ways = {
      {"an empty folder", [&] { fs::create_directory(path); }},
      {"a folder", [&] { fs::create_directories(path + "/inside"); }},
      {"a pipe", [&] { REQUIRE(mkfifo(path.c_str(), 0600) == 0); }},
      {"a link to nothing", [&] { fs::create_symlink(cache / "none", path); }},
      {"a link to a device", [&] { fs::create_symlink("/dev/zero", path); }},
      {"no bytes", [&] { cache.write(entry, ""); }},
      {"another cache's", [&] { cache.write(entry, "gcdt cache 1\n" + cache::digest(content) + "\n" + content); }},
      {"a terabyte of zeros", [&] { fs::resize_file(cache.write(entry, ""), std::uintmax_t{1} << 40); }},
  };
  for (const auto& [name, make] : ways) {
    CAPTURE(std::string(name));
    cache.clear();
    make();
    const Ended ended = Child([&] {
                          if (cache::load(entry)) throw std::runtime_error("it was taken");
                          cache::store(entry, content);
                          const auto kept = cache::load(entry);
                          if (kept && *kept != content) throw std::runtime_error("it was taken");
                        }).wait();
    CHECK(ended.error == "");
    for (const std::string& left : cache.names()) CHECK((left == entry || left == "none"));
  }
}

TEST_CASE("a folder without permission to write: entries are read, and none is stored") {
  const Cache cache;
  const std::string entry = entry_of(1), content = content_of(4);
  cache::store(entry, content);
  fs::permissions(cache / "", fs::perms(0555));
  const Ended ended = Child([&] {
                        if (geteuid() == 0 && setuid(65534) != 0) throw std::runtime_error("cannot be another user");
                        if (cache::load(entry) != content) throw std::runtime_error("it is not read");
                        cache::store(entry_of(2), content);
                        if (cache::load(entry_of(2))) throw std::runtime_error("it was stored");
                      }).wait();
  fs::permissions(cache / "", fs::perms(0755));
  CHECK(ended.error == "");
  CHECK(cache.names() == std::vector{entry});
}

TEST_CASE("eight processes fill it at once, and are killed at random: what each finds is whole") {
  const Cache cache;
  constexpr std::uint64_t entries = 40;
  const int rounds = number("GCDT_CACHE_ROUNDS", 40);
  const auto fill = [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < 400; ++i) {
      const std::uint64_t n = random() % entries;
      const auto found = cache::load(entry_of(n));
      if (found && *found != content_of(n)) throw std::runtime_error("other bytes");
      if (!found || random() % 4 == 0) cache::store(entry_of(n), content_of(n));
    }
  };
  std::mt19937_64 random(5);
  int killed = 0;
  for (int round = 0; round < rounds; ++round) {
    if (round % 8 == 0) cache.clear();
    std::vector<std::unique_ptr<Child>> children;
    for (int c = 0; c < 8; ++c) {
      const std::uint64_t seed = random();
      children.push_back(std::make_unique<Child>([&, seed] { fill(seed); }));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
    for (int c = 0; c < 7; ++c) children[static_cast<std::size_t>(c)]->kill();
    if (round % 8 != 7) children[7]->kill();
    for (const auto& child : children) {
      const Ended ended = child->wait();
      CHECK(ended.error == "");
      killed += ended.killed;
    }
    for (std::uint64_t n = 0; n < entries; ++n) {
      const auto found = cache::load(entry_of(n));
      CHECK((!found || *found == content_of(n)));
    }
  }
  CHECK(killed > rounds);
  MESSAGE(killed << " processes killed");
}

namespace {

/// Makes two programs, as a process does that keeps them, and runs one. Throws if what it computes is wrong.
void use_programs() {
  runtime::CallHook hook;
  hook.keep_programs = true;
  runtime::Runtime runtime(runtime::all_devices().at(select_device("cpu")), hook);
  const std::vector<cl_uint> offsets = {0, 0, 1, 2, 2};
  const auto in = runtime.allocate<cl_uint>("offsets", offsets.size());
  const auto out = runtime.allocate<cl_uint>("references", 4);
  runtime.write(in, offsets.data(), offsets.size());
  runtime.launch("select", "select_refs", runtime::over(4), cl_uint{4}, in, out);
  if (runtime.read_one(out, 0) != 4 || runtime.read_one(out, 1) != 8) throw std::runtime_error("wrong bytes");
  runtime::build_program(runtime, "sort32_serial");
}

}  // namespace

TEST_CASE("processes make programs at once, two and eight of them; some are killed") {
  const Cache cache;
  const ScratchFolder drivers;  // the driver's own cache: its files are killed, too
  test::set_variable("POCL_CACHE_DIR", drivers / "");
  for (const int processes : {2, 8}) {
    cache.clear();
    std::vector<std::unique_ptr<Child>> children;
    for (int c = 0; c < processes; ++c) children.push_back(std::make_unique<Child>(use_programs));
    for (const auto& child : children) CHECK(child->wait().error == "");
    CHECK(cache.names().size() == 4);  // three programs, and the self-test's verdict; nothing else
  }
  const auto start = std::chrono::steady_clock::now();
  cache.clear();
  CHECK(Child(use_programs).wait().error == "");
  const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  std::mt19937_64 random(6);
  int killed = 0;
  for (int round = 0; round < number("GCDT_CACHE_ROUNDS", 40) / 8; ++round) {
    cache.clear();
    Child one(use_programs), two(use_programs);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<std::uint64_t>(whole.count())));
    one.kill();
    killed += one.wait().killed;
    CHECK(two.wait().error == "");
    CHECK(Child(use_programs).wait().error == "");
  }
  MESSAGE(killed << " processes killed");
  CHECK(killed > 0);
}

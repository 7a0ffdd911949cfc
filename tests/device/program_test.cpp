// SPDX-License-Identifier: Apache-2.0
// Programs build without a warning everywhere, and the cache of built ones neither lies nor fails.
#include <doctest/doctest.h>
#include <gcdt/gcdt.hpp>

#include <map>
#include <mutex>
#include <thread>

#include "cache_folder.hpp"
#include "device/cache.hpp"
#include "device/programs.hpp"
#include "device/runtime.hpp"
#include "device_list.hpp"

using namespace gcdt;
using test::CacheFolder;
namespace fs = std::filesystem;

namespace {

cl::Device default_device() {
  const auto all = test::every_device();
  return all.at(select_device("cpu"));
}

// How often a runtime made programs, and from what.
struct Builds {
  int from_source = 0, from_binary = 0;
};

// PoCL keeps programs itself, and the library does not then, unless told.
runtime::CallHook keeping() {
  runtime::CallHook hook;
  hook.keep_programs = true;
  hook.tuning.works_here = false;  // the device is tested at once
  return hook;
}

// Makes a runtime, runs a kernel in it, of another program than the self-test's, and checks the result.
Builds use_a_program(runtime::CallHook hook = keeping()) {
  std::map<std::string, int> calls;
  hook.before = [&](const char* call, const char*) { return ++calls[call], CL_SUCCESS; };
  runtime::Runtime runtime(default_device(), hook);
  const std::vector<cl_uint> offsets = {0, 0, 1, 2, 2};
  const auto in = runtime.allocate<cl_uint>("offsets", offsets.size());
  const auto out = runtime.allocate<cl_uint>("references", 4);
  runtime.write(in, offsets.data(), offsets.size());
  runtime.launch("select", "select_refs", runtime::over(4), cl_uint{4}, in, out);
  CHECK(runtime.read_one(out, 0) == 4);  // faces 1 and 2, corner 0
  CHECK(runtime.read_one(out, 1) == 8);
  return {calls["clCreateProgramWithSource"], calls["clCreateProgramWithBinary"]};
}

std::vector<fs::path> files(const fs::path& folder, const std::string& kind) {
  std::vector<fs::path> found;
  for (const auto& file : fs::directory_iterator(folder))
    if (file.path().filename().string().rfind(kind, 0) == 0) found.push_back(file.path());
  return found;
}

runtime::CallHook with_options(const char* options) {
  runtime::CallHook hook = keeping();
  hook.options = options;
  return hook;
}

// Replaces each `what` by its `with` all over a program's text.
struct Edit {
  std::string what, with;
};
runtime::CallHook with_edits(const std::vector<Edit>& edits) {
  runtime::CallHook hook;
  hook.edit = [=](std::string& source) {
    for (const Edit& edit : edits)
      for (std::size_t at = 0; (at = source.find(edit.what, at)) != std::string::npos; at += edit.with.size())
        source.replace(at, edit.what.size(), edit.with);
  };
  return hook;
}

// Damages every file of the cache, then expects that all is built again and whole afterwards.
template <class Damage>
void check_damage(Damage damage) {
  CacheFolder cache;
  use_a_program();
  std::map<fs::path, std::string> before;
  for (const auto& file : files(cache.path(), "")) {
    before[file] = test::file_text(file);
    test::write_file(file, damage(before[file]));
  }
  REQUIRE(before.size() >= 3);
  const Builds again = use_a_program();
  CHECK(again.from_source == 2);
  CHECK(again.from_binary == 0);
  const std::size_t head = std::string("gcdt cache 3\n").size() + cache::digest("").size() + 1;
  for (const auto& [file, text] : before) CHECK(test::file_text(file).size() > head);
  const Builds warm = use_a_program();
  CHECK(warm.from_source == 0);
}

}  // namespace

TEST_CASE("every embedded program builds without a warning on every device, mul_hi emulated or not") {
  const auto all = test::every_device();
  REQUIRE(runtime::kernel_source_count > 0);
  for (const auto& device : all)
    for (const bool emulated : {false, true}) {
      test::set_variable("GCDT_DISABLE_CACHE", "1");
      runtime::Runtime runtime(device, with_options(emulated ? "-Werror -DGCDT_EMULATE_MUL_HI" : "-Werror"));
      for (std::size_t i = 0; i < runtime::kernel_source_count; ++i) {
        CAPTURE(runtime.info().name);
        CAPTURE(runtime::kernel_sources[i].program);
        const char* const program = runtime::kernel_sources[i].program;
        const std::string text = runtime::kernel_sources[i].text;
        if (emulated && text.find("GCDT_EMULATE_MUL_HI") == std::string::npos) continue;  // the same program
        runtime.use_programs(runtime::Meshes::one);
        CHECK_NOTHROW(runtime::build_program(runtime, program));
        runtime.use_programs(runtime::Meshes::many);
        if (runtime::info_of(program).differs_for_many) CHECK_NOTHROW(runtime::build_program(runtime, program));
      }
    }
}

TEST_CASE("the table of programs has those that are embedded, and what their texts say of them") {
  std::map<std::string, std::string> texts;
  for (std::size_t i = 0; i < runtime::kernel_source_count; ++i)
    texts[runtime::kernel_sources[i].program] = runtime::kernel_sources[i].text;
  for (const auto& [name, text] : texts) {
    CAPTURE(name);
    const runtime::ProgramInfo& info = runtime::info_of(name.c_str());
    const auto has = [&text = text](const char* words) { return text.find(words) != std::string::npos; };
    CHECK(info.differs_for_many == (has("#ifdef GCDT_FOREST") && !has("#define GCDT_FOREST\n")));
    // A bundle has the kernels of its programs.
    for (const char* bundle : {info.bundle, info.bundle_elsewhere}) {
      if (!bundle) continue;
      REQUIRE(texts.count(bundle) == 1);
      for (std::size_t at = text.find("kernel void "); at != std::string::npos; at = text.find("kernel void ", at + 1))
        CHECK(texts[bundle].find(text.substr(at, text.find('(', at) - at + 1)) != std::string::npos);
    }
  }
  CHECK_THROWS_AS(runtime::info_of("no_such_program"), Error);
}

TEST_CASE("a program that does not build is an error with the compiler's words") {
  CacheFolder cache;
  try {
    use_a_program(with_edits({{"typedef ulong u64;", "typedef no_such_type u64;"}}));
    FAIL("it built");
  } catch (const Error& error) {
    CHECK(error.status() == Status::device_failed);
    CHECK(std::string(error.what()).find("no_such_type") != std::string::npos);
  }
  CHECK(fs::is_empty(cache.path()));
}

// The values are those of the reference implementation.
TEST_CASE("the digest is MurmurHash3 of 128 bits") {
  CHECK(cache::digest("") == "00000000000000000000000000000000");
  CHECK(cache::digest("a") == "85555565f6597889e6b53a48510e895a");
  CHECK(cache::digest("foobar") == "bdd2ae7116c85a4574a255e0baf8d6af");
  CHECK(cache::digest("The quick brown fox jumps over the lazy dog") == "e34bbc7bbc071b6c7a433ca9c49a9347");
  CHECK(cache::digest(std::string(1000000, 'a')) == "e0a6d504ec11a52eb72ec68997dfb489");
}

TEST_CASE("entries differ when any part differs, also where only the cut between parts moves") {
  CHECK(cache::entry("x", {"ab", "c"}) != cache::entry("x", {"a", "bc"}));
  CHECK(cache::entry("x", {"ab"}) != cache::entry("y", {"ab"}));
  CHECK(cache::entry("x", {"ab"}) != cache::entry("x", {"ab", ""}));
  CHECK(cache::entry("x", {"ab"}) == cache::entry("x", {"ab"}));
}

TEST_CASE("the folder follows the variables, and GCDT_DISABLE_CACHE wins") {
  CacheFolder cache;
  CHECK(cache::folder() == cache.path());
  test::set_variable("GCDT_DISABLE_CACHE", "1");
  CHECK(cache::folder().empty());
  test::set_variable("GCDT_DISABLE_CACHE", "0");
  test::set_variable("GCDT_CACHE_DIR", "");
#if !defined(_WIN32)
  test::set_variable("XDG_CACHE_HOME", "/xdg");
  CHECK(cache::folder() == fs::path("/xdg/gcdt"));
  test::set_variable("XDG_CACHE_HOME", "relative");
  CHECK(cache::folder().is_absolute());
#endif
}

TEST_CASE("a second run takes programs from the cache, and other options do not") {
  CacheFolder cache;
  const Builds cold = use_a_program();
  CHECK(cold.from_source == 2);  // the self-test's and the one used
  CHECK(cold.from_binary == 0);
  CHECK(files(cache.path(), "program-").size() == 2);
  CHECK(files(cache.path(), "selftest-").size() == 1);
  CHECK(files(cache.path(), "").size() == 3);  // no temporary file stays
  const Builds warm = use_a_program();
  CHECK(warm.from_source == 0);
  CHECK(warm.from_binary == 1);  // the self-test's verdict is known
  CHECK(use_a_program(with_options("-DOTHER")).from_source == 2);
}

TEST_CASE("programs that the driver keeps are not kept twice") {
  CacheFolder cache;
  use_a_program({});
  const bool pocl = runtime::describe(default_device()).platform == "Portable Computing Language";
  CHECK(files(cache.path(), "program-").size() == (pocl ? 0 : 2));
  CHECK(files(cache.path(), "selftest-").size() == 1);
}

TEST_CASE("with the cache off nothing is written") {
  CacheFolder cache;
  test::set_variable("GCDT_DISABLE_CACHE", "1");
  CHECK(use_a_program().from_source == 2);
  CHECK(use_a_program().from_source == 2);
  CHECK(fs::is_empty(cache.path()));
}

TEST_CASE("a corrupted entry is built again") {
  check_damage([](std::string text) {
    text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
    return text;
  });
}

TEST_CASE("a truncated entry is built again") {
  check_damage([](const std::string& text) { return text.substr(0, text.size() - 1); });
  check_damage([](const std::string& text) { return text.substr(0, 20); });
  check_damage([](const std::string&) { return std::string(); });
}

TEST_CASE("a whole entry that the driver refuses is built again") {
  CacheFolder cache;
  use_a_program();
  for (const auto& file : files(cache.path(), "program-")) cache::store(file.filename().string(), "not a program");
  CHECK(use_a_program().from_source == 1);
  const Builds warm = use_a_program();
  CHECK(warm.from_source == 0);
  CHECK(warm.from_binary == 1);
}

TEST_CASE("a folder that cannot be made or written is no error") {
  CacheFolder cache;
  const fs::path file = cache.path() / "file";
  test::write_file(file, "in the way");
  for (const fs::path& place : {file, file / "below"}) {
    test::set_variable("GCDT_CACHE_DIR", place.string());
    CHECK(use_a_program().from_source == 2);
  }
  CHECK(test::file_text(file) == "in the way");
}

TEST_CASE("two runtimes that start at once share a cache") {
  CacheFolder cache;
  const cl::Device device = default_device();
  std::mutex mutex;
  std::vector<std::string> errors;
  auto work = [&] {
    try {
      runtime::Runtime runtime(device, keeping());
      for (const char* program : {"select", "sort32_serial", "sort64_serial"}) runtime::build_program(runtime, program);
    } catch (const std::exception& error) {
      std::lock_guard<std::mutex> lock(mutex);
      errors.push_back(error.what());
    }
  };
  for (int round = 0; round < 3; ++round) {
    std::thread one(work), two(work);
    one.join();
    two.join();
  }
  CHECK(errors.empty());
  CHECK(files(cache.path(), "").size() == 5);
  CHECK(use_a_program().from_source == 0);
}

TEST_CASE("a device that computes wrongly is refused, and the error names the operation") {
  struct Break {
    const char *what, *with, *named;
  };
  const Break breaks[] = {
      {"atomic_add(", "atomic_sub(", "atomic_add"},
      {"atomic_min(", "atomic_max(", "atomic_min"},
      {"atomic_max(", "atomic_min(", "atomic_max"},
      {"atomic_or(", "atomic_xor(", "atomic_or"},
      {"atomic_and(", "atomic_or(", "atomic_and"},
      {"atomic_inc(&words[5])", "words[5]++ + 1", "atomic_inc"},
      {"atomic_cmpxchg(&words[7], GCDT_NONE, i)", "words[7]", "atomic_cmpxchg"},
      {"= a * b;", "= (a * b) & 0xFFFFFFFFFFFFul;", "64-bit multiplication"},
      {"+ (carry >> 32)", "", "32-bit products in 64 bits"},
      {"sum = a + b", "sum = a ^ b", "64-bit addition"},
      {"sum < a ? 1 : 0", "(long)sum < (long)a ? 1 : 0", "carry of a 64-bit addition"},
      {"a << by", "a << (by & 31u)", "64-bit shift to the left"},
      {"= a >> by", "= a >> (by & 31u)", "64-bit shift to the right"},
      {"(u64)((i64)a >> by)", "a >> by", "64-bit arithmetic shift"},
  };
  for (const Break& b : breaks) {
    CacheFolder cache;
    CAPTURE(std::string(b.named));
    try {
      use_a_program(with_edits({{b.what, b.with}}));
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.status() == Status::device_failed);
      CHECK(std::string(error.what()).find(b.named) != std::string::npos);
    }
    CHECK(files(cache.path(), "selftest-").empty());
  }
}

TEST_CASE("a device whose mul_hi is wrong works with the emulation, and is remembered") {
  CacheFolder cache;
  // The device's own, and its compiler's, whichever is used.
  const runtime::CallHook hook = with_edits({{"return mul_hi(a, b);", "return (u64)mul_hi((uint)a, (uint)b);"},
                                             {"((wide)a * b) >> 64", "((wide)a * b) >> 63"}});
  for (int run = 0; run < 2; ++run) {
    runtime::Runtime runtime(default_device(), hook);
    CHECK(runtime.build_options("order").find("-DGCDT_EMULATE_MUL_HI") != std::string::npos);
    CHECK(runtime.launches() == 0);
    CHECK(runtime.meter().peak == 0);
  }
  CHECK(files(cache.path(), "selftest-").size() == 1);
  runtime::Runtime sound(default_device());
  CHECK(sound.build_options("order").find("-DGCDT_EMULATE_MUL_HI") == std::string::npos);
}

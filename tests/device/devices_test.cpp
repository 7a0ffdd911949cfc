// SPDX-License-Identifier: Apache-2.0
// Listing and choosing devices; every OpenCL call failing in turn.
#include <doctest/doctest.h>
#include <gcdt/gcdt.hpp>

#include <algorithm>
#include <future>
#include <numeric>
#include <stdexcept>

#include "cache_folder.hpp"
#include "device_list.hpp"
#include "solve/triangulate.hpp"

using namespace gcdt;

namespace {

std::string message_of(const std::string& spec) {
  try {
    select_device(spec);
  } catch (const Error& error) {
    CHECK(error.status() == Status::no_device);
    return error.what();
  }
  return {};
}

std::string upper(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return s;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("devices are listed with what the library needs to know") {
  const auto handles = test::every_device();
  const auto all = devices();
  REQUIRE(!all.empty());
  CHECK(all.size() == handles.size());
  for (const auto& d : all) {
    CAPTURE(d.name);
    CHECK(!d.name.empty());
    CHECK(!d.platform.empty());
    CHECK(!d.driver.empty());
    CHECK(has(d.version, "OpenCL "));
    CHECK(d.memory_bytes >= d.largest_buffer_bytes);
    CHECK(d.largest_buffer_bytes > 0);
    CHECK(d.local_bytes >= 16384);
    CHECK(d.compute_units > 0);
    CHECK(d.largest_work_group > 0);
  }
}

TEST_CASE("a device is chosen by auto, kind, number and part of a name") {
  test::every_device();
  test::set_variable("GCDT_DEVICE", "");
  const auto all = devices();
  bool ambiguous = true;
  const std::size_t chosen = select_device("auto", &ambiguous);
  CHECK(!ambiguous);
  const bool any_gpu = std::any_of(all.begin(), all.end(), [](const DeviceInfo& d) { return d.is_gpu; });
  CHECK(all.at(chosen).is_gpu == any_gpu);
  CHECK(select_device("") == chosen);
  CHECK(all.at(select_device("cpu")).is_cpu);
  if (any_gpu)
    CHECK(all.at(select_device("gpu")).is_gpu);
  else
    CHECK(has(message_of("gpu"), "no OpenCL device fits \"gpu\""));
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(select_device(std::to_string(i)) == i);
    const std::size_t by_name = select_device(upper(all[i].name));
    CHECK(all[by_name].name == all[i].name);
    CHECK(select_device(all[i].platform) <= i);
  }
}

TEST_CASE("an ambiguous name takes the first device and says so") {
  test::every_device();
  const auto all = devices();
  bool ambiguous = false;
  REQUIRE_MESSAGE(all.size() >= 2, "needs two devices: install mesa-opencl-icd beside PoCL");
  // A letter that at least two devices have in common.
  std::string common;
  for (char c = 'a'; c <= 'z' && common.empty(); ++c)
    if (std::count_if(all.begin(), all.end(),
                      [&](const DeviceInfo& d) { return has(upper(d.name), upper(std::string(1, c))); }) >= 2)
      common = std::string(1, c);
  REQUIRE(!common.empty());
  const std::size_t chosen = select_device(common, &ambiguous);
  CHECK(ambiguous);
  for (std::size_t i = 0; i < chosen; ++i) CHECK(!has(upper(all[i].name + " " + all[i].platform), upper(common)));
}

TEST_CASE("GCDT_DEVICE is used when nothing is asked for") {
  test::every_device();
  const auto all = devices();
  const std::string last = std::to_string(all.size() - 1);
  test::set_variable("GCDT_DEVICE", last);
  CHECK(select_device("") == all.size() - 1);
  CHECK(select_device("0") == 0);
  test::set_variable("GCDT_DEVICE", "no such thing");
  CHECK(has(message_of(""), "no such thing"));
  test::set_variable("GCDT_DEVICE", "");
}

TEST_CASE("a choice that fits nothing is an error that lists what there is") {
  test::every_device();
  const auto all = devices();
  for (const std::string& spec :
       {std::string("no such thing"), std::to_string(all.size()), std::string("99999999999999999999")}) {
    const std::string message = message_of(spec);
    CHECK(has(message, "\"" + spec + "\""));
    for (const auto& d : all) CHECK(has(message, d.name));
  }
}

#ifndef _WIN32
// Run in a child process, because the OpenCL loader reads its folder once.
TEST_CASE("child: no device at all" * doctest::skip()) {
  CHECK(devices().empty());
  const std::string message = message_of("auto");
  CHECK(has(message, "no OpenCL device found"));
  CHECK(has(message, "pocl-opencl-icd"));
  for (const char* spec : {"cpu", "gpu", "0", "x"}) CHECK(has(message_of(spec), "install"));
}

TEST_CASE("without any driver the list is empty and the error says what to install") {
  test::CacheFolder empty;  // any empty folder
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = "env -u OCL_ICD_FILENAMES OCL_ICD_VENDORS=" + empty.path().string() + " '" + self +
                              "' --no-skip -tc='child: no device at all' | grep -q '1 passed'";
  CHECK(std::system(command.c_str()) == 0);
}
#endif

namespace {

// A square with a vertex inside, which has the way of few vertices; throws Error if a call fails.
void triangulate_few(runtime::Runtime& runtime, Primitives& primitives) {
  const std::vector<std::array<double, 2>> points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}};
  const InputSource source = {
      points.size(), 0, [&] {
        return DeviceInput{stage(runtime, points), runtime.allocate<cl_uint2>("constraints", 0)};
      }};
  const Options options;
  const DeviceTriangulation made = gcdt::triangulate(runtime, primitives, source, options);
  CHECK(made.mesh.triangles == 4);
}

// A scan, two sorts and a triangulation, small; throws Error if a call fails.
void small_work(runtime::Runtime& runtime) {
  Primitives primitives(runtime);
  std::vector<cl_ulong> keys(5000);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = (i * 2654435761u) % 65536;
  std::vector<cl_uint> values(keys.size());
  std::iota(values.begin(), values.end(), 0u);
  auto key_buffer = runtime.allocate<cl_ulong>("keys", keys.size());
  auto value_buffer = runtime.allocate<cl_uint>("values", values.size());
  const auto sums = runtime.allocate<cl_uint>("sums", values.size() + 1);
  runtime.write(key_buffer, keys.data(), keys.size());
  runtime.write(value_buffer, values.data(), values.size());
  primitives.exclusive_scan(value_buffer, sums, values.size());
  const cl_uint total = runtime.read_one(sums, values.size());
  CHECK(total == 5000u * 4999u / 2);
  primitives.sort(key_buffer, value_buffer, keys.size(), 16);
  runtime.fill(sums, cl_uint{0}, values.size());
  runtime.flush();
  runtime.read(key_buffer, keys.data(), keys.size());
  CHECK(std::is_sorted(keys.begin(), keys.end()));
  std::vector<cl_uint> zeros(values.size(), 1);
  std::vector<cl_ulong> same_keys(keys.size());
  runtime.read_all({{sums.handle(), zeros.data(), zeros.size() * sizeof(cl_uint)},
                    {key_buffer.handle(), same_keys.data(), same_keys.size() * sizeof(cl_ulong)}});
  CHECK(same_keys == keys);
  CHECK(std::count(zeros.begin(), zeros.end(), 0u) == std::ptrdiff_t(zeros.size()));
  runtime.finish();
  triangulate_few(runtime, primitives);
}

/// Scans of more and more items, with launches of one width for all where there is another runtime.
void widening_work(const cl::Device& device) {
  runtime::CallHook hook;
  hook.tuning.width = 4096;  // whatever the driver
  runtime::Runtime runtime(device, hook);
  Primitives primitives(runtime);
  for (std::size_t n = 64; n <= 64 * 64; n += 64) {
    const auto values = runtime.allocate<cl_uint>("values", n + 1);
    const std::vector<cl_uint> ones(n + 1, 1);
    runtime.write(values, ones.data(), n + 1);
    primitives.exclusive_scan(values, values, n);
    if (runtime.read_one(values, n) != n) throw std::runtime_error("wrong sum");
  }
}

struct Outcome {
  bool error = false;
  std::uint64_t calls = 0;       // up to the end or the error
  std::uint64_t loads = 0;       // programs taken from the cache
  std::uint64_t bytes_left = 0;  // in the meter
};

constexpr std::uint64_t never = ~0ull;

// Runs the work with call number `broken` failing; afterwards the same runtime must work, if there is
// one.
Outcome run_with_failure(const cl::Device& device, std::uint64_t broken, cl_int code) {
  Outcome outcome;
  runtime::CallHook hook;
  hook.keep_programs = true;
  hook.before = [&](const char* call, const char*) {
    outcome.loads += has(call, "clCreateProgramWithBinary");
    return outcome.calls++ == broken ? code : CL_SUCCESS;
  };
  std::unique_ptr<runtime::Runtime> runtime;
  try {
    runtime = std::make_unique<runtime::Runtime>(device, hook);
    small_work(*runtime);
  } catch (const Error& error) {
    outcome.error = true;
    const bool expected = error.status() == Status::device_failed || error.status() == Status::out_of_memory;
    CHECK(expected);
    const bool says_why = has(error.what(), "clBuildProgram") || has(error.what(), std::to_string(code));
    CHECK(says_why);
    CHECK(std::string(error.what()).size() > 20);
  }
  if (runtime) {
    const Outcome so_far = outcome;
    broken = never;
    CHECK(runtime->meter().now == 0);
    small_work(*runtime);
    outcome = so_far;
    outcome.bytes_left = runtime->meter().now;
  }
  return outcome;
}

}  // namespace

TEST_CASE("two at once on a device, whose launches are all of one width for few items and many, compute rightly") {
  const cl::Device device = test::every_device().at(select_device("cpu"));
  for (int i = 0; i < 20; ++i) {
    std::future<void> other = std::async(std::launch::async, [&] { widening_work(device); });
    CHECK_NOTHROW(widening_work(device));
    CHECK_NOTHROW(other.get());
  }
}

TEST_CASE("whichever OpenCL call fails, it is an Error, nothing leaks, and the runtime works again") {
  const cl::Device device = test::every_device().at(select_device("cpu"));
  test::set_variable("GCDT_DISABLE_CACHE", "1");
  const Outcome sound = run_with_failure(device, never, CL_SUCCESS);
  CHECK(!sound.error);
  REQUIRE(sound.calls > 50);
  for (std::uint64_t k = 0; k < sound.calls; ++k) {
    CAPTURE(k);
    const Outcome outcome = run_with_failure(device, k, k % 2 ? CL_OUT_OF_RESOURCES : CL_INVALID_OPERATION);
    CHECK(outcome.error);
    CHECK(outcome.calls == k + 1);
    CHECK(outcome.bytes_left == 0);
  }
}

TEST_CASE("with a warm cache a failing call is an Error or is worked around, and nothing leaks") {
  const cl::Device device = test::every_device().at(select_device("cpu"));
  test::CacheFolder cache;
  run_with_failure(device, never, CL_SUCCESS);
  const Outcome sound = run_with_failure(device, never, CL_SUCCESS);
  REQUIRE(sound.loads > 0);
  std::uint64_t errors = 0;
  for (std::uint64_t k = 0; k < sound.calls; ++k) {
    CAPTURE(k);
    const Outcome outcome = run_with_failure(device, k, CL_INVALID_OPERATION);
    errors += outcome.error;
    CHECK(outcome.bytes_left == 0);
  }
  // All but the two calls that load each program: its source is built instead.
  CHECK(errors == sound.calls - 2 * sound.loads);
}

// SPDX-License-Identifier: Apache-2.0
// The predicates on every OpenCL device against the host's, byte for byte.
#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <string>

#include "device_list.hpp"
#include "tuples.hpp"

using namespace gcdt;

namespace {

/// Adds the test's kernel to the program of the check, which has the predicates.
runtime::CallHook with_kernel() {
  std::ifstream file(GCDT_TEST_DATA "/support/predicate_values.h");
  std::string added;
  for (std::string line; std::getline(file, line);)
    if (line.rfind("#include", 0) != 0) added += line + "\n";
  runtime::CallHook hook;
  hook.edit = [added](std::string& source) {
    if (source.find("kernel void check_corners(") != std::string::npos) source += added;
  };
  return hook;
}

}  // namespace

TEST_CASE("every device computes every predicate exactly as the host does") {
  constexpr std::size_t batch = 1 << 17, batches = 8;
  const std::vector<cl::Device> all = test::every_device();
  std::vector<std::unique_ptr<runtime::Runtime>> runtimes;
  for (const auto& device : all) {
    runtimes.push_back(std::make_unique<runtime::Runtime>(device, with_kernel()));
    MESSAGE("device: " << runtimes.back()->info().name << " (" << runtimes.back()->info().platform << ")");
  }
  test::TupleMaker maker(5);
  std::vector<device::PredicateTuple> tuples(batch);
  std::vector<device::PredicateValues> wanted(batch), values(batch);
  for (std::size_t b = 0; b < batches; ++b) {
    for (std::size_t i = 0; i < batch; ++i) {
      tuples[i] = maker.next();
      wanted[i] = device::gcdt_evaluate_predicates(tuples[i]);
    }
    for (auto& runtime : runtimes) {
      CAPTURE(runtime->info().name);
      const auto in = runtime->allocate<device::PredicateTuple>("tuples", batch);
      const auto out = runtime->allocate<device::PredicateValues>("values", batch);
      runtime->write(in, tuples.data(), batch);
      runtime->launch("check", "evaluate_predicates", runtime::over(batch), static_cast<cl_uint>(batch), in, out);
      runtime->read(out, values.data(), batch);
      CHECK(std::memcmp(values.data(), wanted.data(), batch * sizeof(device::PredicateValues)) == 0);
    }
  }
}

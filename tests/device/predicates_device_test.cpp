// SPDX-License-Identifier: Apache-2.0
// The predicates on every OpenCL device against the host's, byte for byte.
#include <doctest/doctest.h>

#include <cstring>

#include "device_list.hpp"
#include "tuples.hpp"

using namespace gcdt;

TEST_CASE("every device computes every predicate exactly as the host does") {
  constexpr std::size_t batch = 1 << 17, batches = 8;
  const std::vector<cl::Device> all = test::every_device();
  std::vector<std::unique_ptr<runtime::Runtime>> runtimes;
  for (const auto& device : all) {
    runtimes.push_back(std::make_unique<runtime::Runtime>(device));
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
      runtime->launch("predicates", "evaluate_predicates", runtime::over(batch), static_cast<cl_uint>(batch), in, out);
      runtime->read(out, values.data(), batch);
      CHECK(std::memcmp(values.data(), wanted.data(), batch * sizeof(device::PredicateValues)) == 0);
    }
  }
}

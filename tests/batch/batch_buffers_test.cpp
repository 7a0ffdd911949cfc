// SPDX-License-Identifier: Apache-2.0
// Batches in device memory: the same bytes as from and to host arrays; order is honoured; what does not fit is refused.
#include <chrono>
#include <thread>

#include "batch_cases.hpp"
#include "opencl_app.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

std::vector<Workload> problems() {
  std::vector<Workload> all = smallest_problems();
  for (const std::size_t points : {5, 30, 200}) all.push_back(workload("random_pslg", points));
  all.push_back(problem({{0, 0}, {1, 1}}, {{0, 7}}));  // invalid
  return all;
}

DeviceBatch device_batch(const App& app, const RaggedBatch& batch) {
  return {Points::Type::float64,         batch.vertex_offsets.size() - 1,
          app.buffer(batch.vertices),    app.buffer(batch.vertex_offsets),
          app.buffer(batch.constraints), app.buffer(batch.constraint_offsets)};
}

BatchResult from_host(Pool& pool, const RaggedBatch& batch) {
  return pool.triangulate({batch.vertices, batch.vertex_offsets, batch.constraints, batch.constraint_offsets});
}

/// An array of all problems in host memory, and where each problem's begins.
struct Flat {
  std::vector<unsigned char> bytes;
  std::vector<std::uint64_t> offsets;
};

Flat flat_of(const BatchResult& result, std::int32_t array) {
  Flat flat;
  flat.offsets.resize(result.size() + 1);
  REQUIRE(gcdt_batch_copy(result.handle(), array, nullptr, 0, flat.offsets.data()) == GCDT_OK);
  flat.bytes.resize(flat.offsets.back() * gcdt_element_bytes(array));
  REQUIRE(gcdt_batch_copy(result.handle(), array, flat.bytes.data(), flat.offsets.back(), nullptr) == GCDT_OK);
  return flat;
}

}  // namespace

TEST_CASE("a batch in device memory has the bytes of one on the host, into device memory as well") {
  const App app;
  Pool pool(test_device());  // with a context of its own
  const RaggedBatch batch(problems());
  const BatchResult expected = from_host(pool, batch), result = triangulate(pool, app.queue, device_batch(app, batch));
  REQUIRE(result.size() == expected.size());
  CHECK(result.statistics().failed == 1);
  CHECK(result.error(result.size() - 1)->indices() == std::vector<std::uint64_t>{0, 1});
  for (const auto& [array, name] : arrays()) {
    CAPTURE(name);
    const Flat flat = flat_of(expected, array);
    const std::size_t bytes = gcdt_element_bytes(array), shift = 3 * bytes;
    std::vector<unsigned char> around(flat.bytes.size() + 2 * shift, 0xA5);
    const cl::Buffer to = app.buffer(around), offsets = app.buffer(8 * flat.offsets.size());
    copy(result, array, app.queue, to, flat.offsets.back(), 3, offsets);
    std::copy(flat.bytes.begin(), flat.bytes.end(), around.begin() + static_cast<std::ptrdiff_t>(shift));
    CHECK(app.read<unsigned char>(to, around.size()) == around);
    CHECK(app.read<std::uint64_t>(offsets, flat.offsets.size()) == flat.offsets);
  }
}

TEST_CASE("arrays that problems of a batch do not have are empty, and those that no result has an error") {
  Pool pool(test_device());
  const BatchResult result = from_host(pool, RaggedBatch(problems()));
  for (const std::int32_t array : {GCDT_ADDED, GCDT_ADDED_CROSSINGS, GCDT_REGIONS})
    CHECK(flat_of(result, array).bytes.empty());
  CHECK(gcdt_batch_copy(result.handle(), 999, nullptr, 0, nullptr) == GCDT_ERROR_INVALID_ARGUMENT);
}

TEST_CASE("a batch without constraints, and one of nothing, need no buffers for what is not there") {
  const App app;
  Pool pool(test_device());
  const RaggedBatch batch({uniform(50), problem({}), uniform(20)});
  DeviceBatch given = device_batch(app, batch);
  given.constraints = {}, given.constraint_offsets = {};
  CHECK(flat_of(triangulate(pool, app.queue, given), GCDT_TRIANGLES).bytes ==
        flat_of(from_host(pool, batch), GCDT_TRIANGLES).bytes);
  CHECK(triangulate(pool, app.queue, {}).size() == 0);
}

TEST_CASE("a problem in device memory is cut into tiles, and the result goes into device memory") {
  const App app;
  Pool pool(test_device());
  const RaggedBatch one({workload("letters", 2000)});
  Options options;
  options.domain = Domain::outer_holes;
  options.hole_seeds = {workload("letters", 2000).points[5]};
  const BatchResult expected =
      pool.triangulate({one.vertices, one.vertex_offsets, one.constraints, one.constraint_offsets}, options);
  options.tiles = 3;
  const BatchResult result = triangulate(pool, app.queue, device_batch(app, one), options);
  CHECK(expected.tiles(0).tiles == 0);
  CHECK(result.tiles(0).tiles == 3);
  for (const std::int32_t array : {GCDT_TRIANGLES, GCDT_NEIGHBOURS, GCDT_CONSTRAINED, GCDT_PIECES, GCDT_REGIONS}) {
    CAPTURE(array);
    const Flat flat = flat_of(expected, array);
    REQUIRE(flat.offsets.back() > 0);
    const cl::Buffer to = app.buffer(flat.bytes.size());
    copy(result, array, app.queue, to, flat.offsets.back());
    CHECK(app.read<unsigned char>(to, flat.bytes.size()) == flat.bytes);
  }
}

TEST_CASE("the events of the wait list come first") {
  const App app;
  Pool pool(test_device());
  const RaggedBatch batch({uniform(50)});
  const DeviceBatch given = device_batch(app, batch);
  const std::vector<std::array<double, 2>> zeros(batch.vertices.size(), {0, 0});
  REQUIRE(app.queue.enqueueWriteBuffer(given.vertices, CL_TRUE, 0, 16 * zeros.size(), zeros.data()) == CL_SUCCESS);
  cl::UserEvent allowed(app.context);
  // Another queue writes the vertices once it may.
  const cl::CommandQueue writer(app.context, app_device());
  const std::vector<cl::Event> before = {allowed};
  cl::Event written;
  REQUIRE(writer.enqueueWriteBuffer(given.vertices, CL_FALSE, 0, 16 * zeros.size(), batch.vertices.data(), &before,
                                    &written) == CL_SUCCESS);
  writer.flush();
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    allowed.setStatus(CL_COMPLETE);
  });
  const BatchResult result = triangulate(pool, app.queue, given, {}, {written});
  later.join();
  CHECK(flat_of(result, GCDT_TRIANGLES).bytes == flat_of(from_host(pool, batch), GCDT_TRIANGLES).bytes);
}

TEST_CASE("buffers that do not hold what is said, of another context, or closed to the host are refused") {
  const App app, other;
  Pool pool(test_device());
  const RaggedBatch batch({uniform(50), uniform(20)});
  const DeviceBatch right = device_batch(app, batch);
  const auto refused = [&](const DeviceBatch& given) {
    return error_of([&] { triangulate(pool, app.queue, given); }).status();
  };
  DeviceBatch wrong = right;
  wrong.problems = 3;
  CHECK(refused(wrong) == Status::buffer_too_small);
  wrong = right;
  wrong.vertex_offsets = app.buffer(std::vector<std::uint64_t>{0, 50, 71});
  CHECK(refused(wrong) == Status::buffer_too_small);
  wrong.vertex_offsets = app.buffer(std::vector<std::uint64_t>{50, 0, 70});
  CHECK(refused(wrong) == Status::invalid_argument);
  wrong = right;
  wrong.vertices = other.buffer(batch.vertices);
  CHECK(refused(wrong) == Status::wrong_context);
  wrong = right;
  wrong.vertices = app.buffer(16 * batch.vertices.size(), CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS);
  CHECK(refused(wrong) == Status::buffer_access);
  wrong = right;
  wrong.vertex_offsets = {};
  CHECK(refused(wrong) == Status::invalid_argument);

  const BatchResult result = triangulate(pool, app.queue, right);
  const std::uint64_t triangles = flat_of(result, GCDT_TRIANGLES).offsets.back();
  const cl::Buffer small = app.buffer(12 * triangles - 1), enough = app.buffer(12 * triangles);
  CHECK(error_of([&] { copy(result, GCDT_TRIANGLES, app.queue, small, triangles); }).status() ==
        Status::buffer_too_small);
  CHECK(error_of([&] { copy(result, GCDT_TRIANGLES, app.queue, enough, triangles - 1); }).status() ==
        Status::buffer_too_small);
  CHECK(error_of([&] { copy(result, GCDT_TRIANGLES, other.queue, enough, triangles); }).status() ==
        Status::wrong_context);
  copy(result, GCDT_TRIANGLES, app.queue, enough, triangles);
}

// SPDX-License-Identifier: Apache-2.0
// Nothing is written beside a buffer, and no result depends on what a fresh buffer holds: the kept hashes come out of
// buffers between guards (tests/support/guard_layer.cpp), each of just the bytes asked for and filled with a pattern,
// on PoCL as it is and treated as a GPU, of solvers, batches, tiles and queries.
#include <doctest/doctest.h>

#include "faulty_device.hpp"
#include "guard_layer.hpp"
#include "kept_hashes.hpp"
#include "kinds.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Guards& guards() {
  static Guards& of_layer = (solver(), guards_of(GCDT_GUARD_LAYER));
  return of_layer;
}

/// Nothing is wrong with any guard, and many were looked at since the last time.
void check_guards() {
  static std::uint64_t before = 0;
  const std::vector<std::string> wrong = guards().check();
  for (const std::string& line : wrong) FAIL_CHECK(line);
  CHECK(guards().looks > before + 10);
  before = guards().looks;
}

runtime::CallHook fresh(DeviceKind kind, const Tuning& tuning = {}) {
  runtime::CallHook hook;
  hook.tuning = tuning;
  hook.tuning.kind = kind;
  hook.tuning.fresh_buffers = true;
  hook.tuning.works_here = false;  // the host's memory has no guards
  return hook;
}

void check_hashes(const runtime::CallHook& hook, unsigned char poison) {
  guards().poison = poison;
  Hasher hasher(hooked_solver(hook), [&] { return Pool(hooked_pool({hook}).release()); });
  for (const KeptHash& row : read_kept_hashes(GCDT_TEST_DATA "/hashes.txt")) {
    if (row.n > 1000) continue;  // small ones go every way
    CAPTURE(row.name);
    CAPTURE(row.n);
    CAPTURE(row.how);
    CAPTURE(int(poison));
    CHECK(hasher.hash(row) == row.hash);
    check_guards();
  }
}

}  // namespace

TEST_CASE("the layer is there: it fills buffers, and sees a byte written before or behind one") {
  guards().poison = 0x5C;
  const App app;
  const auto made = guards().buffers.load();
  for (const std::size_t bytes : {1, 7, 4096}) {
    const cl::Buffer buffer = app.buffer(bytes);
    CHECK(app.read<unsigned char>(buffer, bytes) == std::vector<unsigned char>(bytes, 0x5C));
    CHECK(buffer.getInfo<CL_MEM_SIZE>() == bytes);
    CHECK(buffer.getInfo<CL_MEM_ASSOCIATED_MEMOBJECT>()() == nullptr);
  }
  CHECK(guards().buffers == made + 3);
  CHECK(guards().check().empty());
  cl::Program program(app.context, std::string("kernel void put(global uchar* to, int at) { to[at] = 1; }"));
  REQUIRE(program.build({app_device()}) == CL_SUCCESS);
  cl::Kernel put(program, "put");
  for (const int at : {-4096, -1, 0, 9, 10, 4105}) {
    CAPTURE(at);
    const bool inside = at >= 0 && at < 10;
    for (const bool released : {false, true}) {  // when the guards are looked at
      cl::Buffer buffer = app.buffer(10);
      put.setArg(0, buffer);
      put.setArg(1, at);
      REQUIRE(app.queue.enqueueNDRangeKernel(put, cl::NullRange, 1) == CL_SUCCESS);
      std::vector<std::string> wrong = released ? std::vector<std::string>() : guards().check();
      buffer = cl::Buffer();  // which looks at its guards, too
      for (std::string& line : guards().check()) {
        if (released) wrong.push_back(line);
      }
      REQUIRE(wrong.size() == (inside ? 0 : 1));
      if (!inside)
        CHECK(wrong[0].find(at < 0 ? "before a buffer of 10 bytes" : "behind a buffer of 10 bytes") !=
              std::string::npos);
    }
  }
}

TEST_CASE("threads: the kept hashes, whatever fresh buffers hold, and nothing beside a buffer is written") {
  for (const unsigned char poison : {0xA5, 0xFF, 0x00}) check_hashes(fresh(DeviceKind::threads), poison);
}

TEST_CASE("and so on a device treated as a GPU, with usual thresholds and with small ones") {
  check_hashes(fresh(DeviceKind::gpu), 0xA5);
  check_hashes(fresh(DeviceKind::gpu, small_thresholds()), 0xFF);
}

TEST_CASE("and so of tiles, queries and meshes of other programs") {
  const Workload work = random_pslg(150, 1000, 60, 5);
  for (const DeviceKind kind : {DeviceKind::threads, DeviceKind::gpu})
    for (const unsigned char poison : {0xA5, 0xFF}) {
      guards().poison = poison;
      const runtime::CallHook hook = fresh(kind);
      const Triangulation expected = solver().triangulate(work.points, work.constraints);
      Pool pool(hooked_pool({hook, hook}).release());
      Options options;
      options.tiles = 3;
      const BatchResult tiled = pool.triangulate(batch_of({work}), options);
      REQUIRE(!tiled.error(0));
      CHECK(difference(gcdt::detail::triangulation(tiled, 0), expected) == "");
      Solver own = hooked_solver(hook);
      const Result given = solver().solve(work.points, work.constraints),
                   made = own.solve(work.points, work.constraints);
      const std::vector<Point> points = uniform(300, 9).points;
      std::vector<std::array<double, 3>> weights, expected_weights;
      CHECK(made.locate(points, &weights) == given.locate(points, &expected_weights));
      CHECK(weights == expected_weights);
      CHECK(made.hull() == given.hull());
      CHECK(made.vertex_triangles() == given.vertex_triangles());
      CHECK(made.edge_pieces() == given.edge_pieces());
      CHECK(made.quality().least_doubled == given.quality().least_doubled);
      const Result adopted = own.adopt(work.points, expected.triangles, work.constraints);
      CHECK(adopted.download().neighbours == expected.neighbours);
      check_guards();
    }
}

// SPDX-License-Identifier: Apache-2.0
// What is released is gone, to the last object and byte: batches, results, solvers and pools leave as many of the
// host's objects as there were, counted where the library allocates, and no block of device memory in use.
#include <cstdlib>
#include <mutex>
#include <new>
#include <unordered_map>

#include "pool_cases.hpp"

#include "faulty_device.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Plain memory, so that the tally does not count itself.
template <class T>
struct Uncounted {
  using value_type = T;
  Uncounted() = default;
  template <class U>
  Uncounted(const Uncounted<U>&) {}
  T* allocate(std::size_t count);
  void deallocate(T* memory, std::size_t);
  bool operator==(const Uncounted&) const { return true; }
  bool operator!=(const Uncounted&) const { return false; }
};

/// Blocks that live, with their sizes, and what they have together.
struct Tally {
  std::size_t objects = 0, bytes = 0;
  bool operator==(const Tally& other) const { return objects == other.objects && bytes == other.bytes; }
};

class Blocks {
 public:
  void* made(void* block, std::size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (block) sizes_[block] = bytes, ++tally_.objects, tally_.bytes += bytes;
    return block;
  }
  void gone(void* block) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = sizes_.find(block);
    if (found == sizes_.end()) return;  // of somebody who was not counted
    --tally_.objects, tally_.bytes -= found->second;
    sizes_.erase(found);
  }
  Tally tally() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return tally_;
  }

 private:
  std::mutex mutex_;
  std::unordered_map<void*, std::size_t, std::hash<void*>, std::equal_to<>,
                     Uncounted<std::pair<void* const, std::size_t>>>
      sizes_;
  Tally tally_;
};

Blocks& blocks() {
  alignas(Blocks) static unsigned char memory[sizeof(Blocks)];
  static Blocks* const all = new (memory) Blocks;  // for good: others are freed at the very end
  return *all;
}

}  // namespace

// The linker sends the calls of the library and of this test here (tests/CMakeLists.txt).
extern "C" {
void* __real_malloc(std::size_t bytes);
void* __real_aligned_alloc(std::size_t alignment, std::size_t bytes);
void __real_free(void* block);
void* __wrap_malloc(std::size_t bytes);
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t bytes);
void __wrap_free(void* block);

void* __wrap_malloc(std::size_t bytes) { return blocks().made(__real_malloc(bytes), bytes); }
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return blocks().made(__real_aligned_alloc(alignment, bytes), bytes);
}
void __wrap_free(void* block) {
  blocks().gone(block);
  __real_free(block);
}
}

template <class T>
T* Uncounted<T>::allocate(std::size_t count) {
  return static_cast<T*>(__real_malloc(count * sizeof(T)));
}
template <class T>
void Uncounted<T>::deallocate(T* memory, std::size_t) {
  __real_free(memory);
}

// Ends of the program's own code: what others allocate, such as a driver's compiler, is not counted.
extern "C" const char __executable_start, etext;

void* operator new(std::size_t bytes) {
  const auto caller = static_cast<const char*>(__builtin_return_address(0));
  const bool own = caller >= &__executable_start && caller < &etext;
  void* block = own ? __wrap_malloc(bytes ? bytes : 1) : __real_malloc(bytes ? bytes : 1);
  if (!block) throw std::bad_alloc();
  return block;
}
void operator delete(void* block) noexcept { __wrap_free(block); }
void operator delete(void* block, std::size_t) noexcept { __wrap_free(block); }

namespace {

/// Runs `step` again and again. Tables that it fills once and for all grow in the first runs; from then on what lives
/// stays the same, four times over, which comes within twenty runs or not at all.
template <class Step>
void leaves_nothing(Step&& step) {
  std::string history;
  Tally before;
  int same = 0;
  for (int i = 0; i < 20 && same < 4; ++i) {
    step();
    const Tally after = blocks().tally();
    same = after == before ? same + 1 : 0;
    before = after;
    history += std::to_string(after.objects) + " objects of " + std::to_string(after.bytes) + " bytes\n";
  }
  CHECK_MESSAGE(same == 4, history);
}

std::vector<Workload> problems() {
  std::vector<Workload> all(50, workload("random_pslg", 6));
  all.push_back(uniform(3000));
  all.push_back(problem({{0, 0}, {4, 4}, {0, 4}, {4, 0}}, {{0, 1}, {2, 3}}));  // crosses
  return all;
}

}  // namespace

TEST_CASE("the counters count: an object and a block of memory are seen, and seen to go") {
  const Tally before = blocks().tally();
  auto object = std::make_unique<std::array<char, 1000>>();
  HostArray array;
  array.make<char>(std::size_t{5} << 20);
  const Tally with = blocks().tally();
  CHECK(with.objects == before.objects + 2);
  CHECK(with.bytes >= before.bytes + 1000 + (std::size_t{5} << 20));
  object.reset();
  array = {};
  CHECK(blocks().tally() == before);
}

TEST_CASE("a batch that is released leaves no object and no byte, whether its problems fail or are split") {
  const std::string device = test_device();
  gcdt_pool_options pool_options = GCDT_POOL_OPTIONS_INIT;
  pool_options.devices = device.c_str();
  gcdt_pool* pool = nullptr;
  REQUIRE(gcdt_pool_create(&pool_options, &pool) == GCDT_OK);
  const RaggedBatch batch(problems());
  gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
  input.problem_count = batch.view().problems;
  input.vertices = batch.vertices.data(), input.vertex_offsets = batch.vertex_offsets.data();
  input.constraints = batch.constraints.front().data(), input.constraint_offsets = batch.constraint_offsets.data();
  for (const std::int32_t crossing : {GCDT_CROSSING_REJECT, GCDT_CROSSING_SPLIT}) {
    gcdt_options options = GCDT_OPTIONS_INIT;
    options.crossing = crossing;
    leaves_nothing([&] {
      const Tally before = blocks().tally();
      gcdt_batch* made = nullptr;
      REQUIRE(gcdt_pool_triangulate(pool, &input, &options, &made) == GCDT_OK);
      gcdt_batch_statistics statistics = {};
      statistics.struct_size = sizeof statistics;
      REQUIRE(gcdt_batch_get_statistics(made, &statistics) == GCDT_OK);
      CHECK(blocks().tally().bytes >= before.bytes + 25 * statistics.triangles);
      gcdt_batch_release(made);
    });
  }
  gcdt_pool_release(pool);
}

TEST_CASE("a result that is released leaves no object, no byte and no block of device memory") {
  Solver solver = hooked_solver({});
  const std::shared_ptr<api::State> state = solver.handle()->state;
  const Workload work = workload("random_pslg", 60);
  const std::vector<Constraint> wrong = {{0, 1000000}};
  Options options;
  options.domain = Domain::even_odd;
  leaves_nothing([&] {
    const std::uint64_t results = state->results, device = state->runtime.meter().now;
    {
      const Result result = solver.solve(work.points, work.constraints, options);
      CHECK(state->results == results + 1);
      CHECK(state->runtime.meter().now > device);
      CHECK(result.download().triangles.size() > 0);
    }
    CHECK(state->results == results);
    CHECK(state->runtime.meter().now == device);
    CHECK_THROWS_AS(solver.solve(work.points, wrong, options), Error);
    CHECK(state->runtime.meter().now == device);
  });
  CHECK(state->results == 0);
}

TEST_CASE("a solver or a pool that is released leaves no object and no byte") {
  const Workload work = workload("random_pslg", 20);
  leaves_nothing([&] { Solver(test_device()).solve(work.points, work.constraints); });
  Batch batch;
  for (int i = 0; i < 3; ++i) batch.add(work.points, work.constraints);
  leaves_nothing([&] { Pool(test_device()).triangulate(batch); });
}

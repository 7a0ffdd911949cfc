// SPDX-License-Identifier: Apache-2.0
// The disk fills up at each call that spills tiles, or the process is killed there: a clear error, nothing left, and
// the pool gives the right bytes afterwards. GCDT_SPILL_TILES: of how many tiles; `scripts/slow.sh files` takes more.
#include "tiles/spill.hpp"
#include "batch/pipeline.hpp"
#include "file_faults.hpp"
#include "pool_cases.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;
using gcdt::testing::Child;
using gcdt::testing::ScratchFolder;
namespace fs = std::filesystem;

namespace {

/// A folder for spilled files, and what becomes of the calls that write there.
class SpillFolder : public ScratchFolder {
 public:
  SpillFolder() { setenv("GCDT_FILES", fs::canonical(*this / "").parent_path().c_str(), 1); }
  ~SpillFolder() {
    for (const char* name : {"GCDT_FILES", "GCDT_FILE_CALL", "GCDT_FILE_FAULT", "GCDT_FILE_MARK", "GCDT_FILE_NAMED"})
      unsetenv(name);
  }
  void set_named(bool named) const {
    if (named)
      setenv("GCDT_FILE_NAMED", "1", 1);
    else
      unsetenv("GCDT_FILE_NAMED");
  }

  /// Calls `use` while call number `call` ends as `fault` says. Whether it was reached.
  template <class Use>
  bool with_fault(const std::string& fault, unsigned call, const Use& use) const {
    fs::remove(marks_ / "reached");
    setenv("GCDT_FILE_CALL", std::to_string(call).c_str(), 1);
    setenv("GCDT_FILE_FAULT", fault.c_str(), 1);
    setenv("GCDT_FILE_MARK", (marks_ / "reached").c_str(), 1);
    use();
    unsetenv("GCDT_FILE_FAULT");
    return !marks_.names().empty();
  }
  void check_empty() const {
    CHECK(names() == std::vector<std::string>());
    std::error_code gone;                                                   // of the descriptor that lists
    for (const auto& descriptor : fs::directory_iterator("/proc/self/fd"))  // a file without a name takes room, too
      CHECK(fs::read_symlink(descriptor.path(), gone).string().find(*this / "") == std::string::npos);
  }

 private:
  ScratchFolder marks_;
};

std::uint32_t tile_count() {
  const char* given = std::getenv("GCDT_SPILL_TILES");
  return given ? static_cast<std::uint32_t>(std::atoi(given)) : 3;
}

/// A pool whose device has room for little more than one tile of the problem.
struct SmallPool {
  const Workload work = workload("uniform", 10000 * tile_count());
  const RaggedBatch batch{{work}};
  DevicePool pool;
  Options options;

  explicit SmallPool(const std::string& folder) : pool({member()}, {}, {}) {
    pool.spill_to(folder);
    options.tiles = tile_count();
  }
  DevicePool::Member member() const {
    const std::uint64_t n = work.points.size() / tile_count();
    const std::uint64_t tile = forest_bytes(1, n + n / 8, 0);  // some vertices come from beside it
    runtime::CallHook hook = healthy();
    hook.tuning.memory_bytes = tile / 3 * 4;  // of which a pool takes three quarters
    hook.tuning.workers = 1;
    return {cl::Context(), app_device(), hook};
  }
  PoolResult run() { return tiles::triangulate(pool, batch.view(), options); }
};

/// Goes through all calls: how many there are.
unsigned break_each(const SpillFolder& folder, SmallPool& small, const Singles& expected, const std::string& fault) {
  for (unsigned call = 1;; ++call) {
    CAPTURE(fault);
    CAPTURE(call);
    PoolResult made;
    const bool reached = folder.with_fault(fault, call, [&] { made = small.run(); });
    if (made.errors.empty()) {  // of a close, when all has been read, nothing is lost
      expected.check(made);
    } else {
      REQUIRE(reached);
      const Error& error = made.errors.at(0);
      CHECK(error.status() == Status::spill_failed);
      CHECK(std::string(error.what()).find("spilling to " + folder / "") == 0);
      CHECK(std::string(error.what()).find(std::strerror(ENOSPC)) != std::string::npos);
    }
    folder.check_empty();
    if (!reached) return call - 1;
    expected.check(small.run());
    folder.check_empty();
    REQUIRE(call < 10000);
  }
}

}  // namespace

// First, since children cannot use what their parent has started of OpenCL.
TEST_CASE("killed at any call of a spill, a process leaves no file, and where each has a name, an empty one at most") {
  const SpillFolder folder;
  for (const bool named : {false, true}) {
    CAPTURE(named);
    folder.set_named(named);
    unsigned call = 1, left = 0;
    for (bool reached = true; reached; call += reached ? 1 : 0) {
      CAPTURE(call);
      bool killed = false;
      reached =
          folder.with_fault("kill", call, [&] { killed = Child([&] { SmallPool(folder / "").run(); }).wait().killed; });
      CHECK(killed == reached);
      for (const std::string& name : folder.names()) {
        CHECK(named);
        CHECK(fs::file_size(folder / name) == 0);
        fs::remove(folder / name);
        ++left;
      }
    }
    CHECK(call > 5 * (tile_count() - 1));
    MESSAGE("killed at each of " << call - 1 << " calls, " << left << " empty files left");
    CHECK(left <= (named ? tile_count() : 0));
  }
}

TEST_CASE("the disk fills up at any call of a spill: an error that says so, nothing left, and the pool goes on") {
  const SpillFolder folder;
  SmallPool small(folder / "");
  const Singles expected({small.work});
  unsigned calls = 0;
  for (const bool named : {false, true})
    for (const char* fault : {"fail", "full"}) {
      folder.set_named(named);
      const unsigned all = break_each(folder, small, expected, fault);
      CHECK(all >= 5 * (tile_count() - 1));  // of a tile three arrays; its file is made and closed
      calls += all;
    }
  MESSAGE(calls << " calls broken");
}

TEST_CASE("an array of many parts, too, is spilled whole or not") {
  const SpillFolder folder;
  runtime::Runtime runtime(app_device(), healthy());
  std::vector<cl_uint> values(17u << 20);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<cl_uint>(i * 2654435761u);
  const auto buffer = runtime.allocate<cl_uint>("spilled", values.size());
  runtime.write(buffer, values.data(), values.size());
  unsigned call = 1;
  for (bool reached = true; reached; ++call) {
    CAPTURE(call);
    std::optional<Error> failed;
    reached = folder.with_fault("full", call, [&] {
      try {
        tiles::Spill spill(folder / "");
        spill.put(runtime, buffer);
        std::vector<cl_uint> found;
        spill.take<cl_uint>([&](Span<cl_uint> part, std::size_t first) {
          CHECK(first == found.size());
          found.insert(found.end(), part.begin(), part.end());
        });
        CHECK(found == values);
      } catch (const Error& error) {
        failed = error;
      }
    });
    CHECK(failed.has_value() == (reached && call <= 4));  // the fifth closes the file
    if (failed) CHECK(failed->status() == Status::spill_failed);
    folder.check_empty();
  }
  CHECK(call == 7);
}

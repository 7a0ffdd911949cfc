// SPDX-License-Identifier: Apache-2.0
// A plug-in of Oclgrind, the OpenCL device simulator, that counts what each kernel does to global memory
// (bench/README.md, "Bytes moved"). Writes a file of JSON, named by GCDT_TRAFFIC, when the program ends.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <oclgrind/Context.h>
#include <oclgrind/Kernel.h>
#include <oclgrind/KernelInvocation.h>
#include <oclgrind/Memory.h>
#include <oclgrind/Plugin.h>

namespace {

constexpr unsigned sector_bits = 5;                       // GPUs move 32 bytes at once
constexpr std::size_t least_kept = std::size_t{1} << 20;  // accesses before repeated ones are dropped

struct Counts {
  std::uint64_t launches = 0, loaded = 0, stored = 0, atomics = 0;  ///< bytes asked for; atomic operations
  std::uint64_t read = 0, written = 0;                              ///< sectors, each once a launch
};

class CountTraffic : public oclgrind::Plugin {
 public:
  explicit CountTraffic(const oclgrind::Context* context) : Plugin(context) {}
  ~CountTraffic() override { write(); }
  bool isThreadSafe() const override { return false; }

  void kernelBegin(const oclgrind::KernelInvocation* invocation) override {
    now_ = &counts_[invocation->getKernel()->getName()];
    ++now_->launches;
  }
  void kernelEnd(const oclgrind::KernelInvocation*) override {
    now_->read += read_.end_launch();
    now_->written += written_.end_launch();
    now_ = nullptr;
  }
  void memoryLoad(const oclgrind::Memory* memory, const oclgrind::WorkItem*, size_t address, size_t size) override {
    if (!counted(memory)) return;
    now_->loaded += size;
    read_.add(address, size);
  }
  void memoryStore(const oclgrind::Memory* memory, const oclgrind::WorkItem*, size_t address, size_t size,
                   const uint8_t*) override {
    if (!counted(memory)) return;
    now_->stored += size;
    written_.add(address, size);
  }
  void memoryAtomicLoad(const oclgrind::Memory* memory, const oclgrind::WorkItem*, oclgrind::AtomicOp, size_t address,
                        size_t size) override {
    if (!counted(memory)) return;
    ++now_->atomics;
    read_.add(address, size);
  }
  void memoryAtomicStore(const oclgrind::Memory* memory, const oclgrind::WorkItem*, oclgrind::AtomicOp, size_t address,
                         size_t size) override {
    if (counted(memory)) written_.add(address, size);
  }

 private:
  bool counted(const oclgrind::Memory* memory) const {
    return now_ && memory->getAddressSpace() == oclgrind::AddrSpaceGlobal;
  }
  /// Sectors that a launch has touched, some of them several times.
  struct Touched {
    std::vector<std::uint64_t> sectors;
    std::size_t most = least_kept;

    void add(std::uint64_t address, std::uint64_t size) {
      for (std::uint64_t s = address >> sector_bits; s <= (address + size - 1) >> sector_bits; ++s)
        if (sectors.empty() || sectors.back() != s) sectors.push_back(s);
      if (sectors.size() < most) return;
      keep_once();
      most = std::max(least_kept, 2 * sectors.size());
    }
    std::uint64_t end_launch() {
      keep_once();
      const std::uint64_t count = sectors.size();
      sectors.clear();
      return count;
    }
    void keep_once() {
      std::sort(sectors.begin(), sectors.end());
      sectors.erase(std::unique(sectors.begin(), sectors.end()), sectors.end());
    }
  };
  void write() const {
    const char* path = std::getenv("GCDT_TRAFFIC");
    std::FILE* file = path ? std::fopen(path, "w") : nullptr;
    if (!file) {
      std::fprintf(stderr, "count_traffic: GCDT_TRAFFIC names no file that can be written\n");
      return;
    }
    const char* separator = "{\n";
    for (const auto& [name, c] : counts_) {
      std::fprintf(file,
                   "%s  \"%s\": {\"launches\": %llu, \"loaded\": %llu, \"stored\": %llu, \"atomics\": %llu, "
                   "\"read_sectors\": %llu, \"written_sectors\": %llu}",
                   separator, name.c_str(), number(c.launches), number(c.loaded), number(c.stored), number(c.atomics),
                   number(c.read), number(c.written));
      separator = ",\n";
    }
    std::fprintf(file, "\n}\n");
    std::fclose(file);
  }
  static unsigned long long number(std::uint64_t value) { return value; }

  std::map<std::string, Counts> counts_;
  Counts* now_ = nullptr;
  Touched read_, written_;
};

CountTraffic* plugin = nullptr;

}  // namespace

extern "C" void initializePlugins(oclgrind::Context* context) {
  plugin = new CountTraffic(context);
  context->registerPlugin(plugin);
}

extern "C" void releasePlugins(oclgrind::Context* context) {
  context->unregisterPlugin(plugin);
  delete plugin;
}

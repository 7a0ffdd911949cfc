// SPDX-License-Identifier: Apache-2.0
// One OpenCL device in use: context, queue, typed buffers, typed launches. Every OpenCL call that the
// library makes goes through Runtime::call, the one place where tests make the k-th call fail and
// where launches are timed and counted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <gcdt/types.hpp>

#include "device/buffer_pool.hpp"
#include "device/built_programs.hpp"
#include "device/geometry.hpp"
#include "device/host_kernels.hpp"
#include "device/pinned_ranges.hpp"
#include "device/trace.hpp"
#include "device/tuning.hpp"

namespace gcdt::runtime {

/// `size` elements of T in device memory, handed back with the object. Never empty on the device:
/// a size of 0 holds one element, so that kernels always get a valid pointer.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  /// The caller's memory, which is retained, not counted, and nobody's to hand out again.
  Buffer(const cl::Buffer& theirs, std::size_t size) : theirs_(theirs), size_(size) {}
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer moved(std::move(other));
    swap(moved);
    return *this;
  }

  std::size_t size() const { return size_; }
  /// What is behind the first `size` elements, at most size(), is no longer used.
  void shrink(std::size_t size) { size_ = size; }
  std::size_t bytes() const { return std::max<std::size_t>(size_, 1) * sizeof(T); }
  bool allocated() const { return handle() != nullptr; }
  cl_mem handle() const { return block_.handle() ? block_.handle() : theirs_(); }
  Memory memory() const { return {handle(), block_.here()}; }

 private:
  friend class Runtime;
  Buffer(DeviceMemory::Block block, std::size_t size) : block_(std::move(block)), size_(size) {}
  void swap(Buffer& other) {
    std::swap(block_, other.block_);
    std::swap(theirs_, other.theirs_);
    std::swap(size_, other.size_);
  }
  DeviceMemory::Block block_;
  cl::Buffer theirs_;
  std::size_t size_ = 0;
};

constexpr char pocl_platform[] = "Portable Computing Language";

/// Bytes of a buffer, from `offset` on, and where they are to go.
struct HostRead {
  Memory from;
  void* to;
  std::size_t bytes;
  std::size_t offset = 0;
};

/// Watches every OpenCL call. `before` may return an error code to make the call fail unmade.
/// `options` are added when programs are built. `edit` may change a program's text: by that, tests
/// have a device that computes wrongly. `keep_programs`: built programs go into the cache even if the
/// driver keeps them itself.
struct CallHook {
  std::function<cl_int(const char* call, const char* detail)> before;
  std::string options;
  std::function<void(std::string& source)> edit;
  Tuning tuning;
  bool keep_programs = false;
};

using Log = std::function<void(int level, const char* message)>;

class TransferChunks;

class Runtime {
 public:
  /// Makes a context and an in-order queue on `device`, and makes sure that it computes rightly
  /// (lib/device/selftest.cpp): before its first launch, if the calling thread can do without it (can_work_here).
  /// Throws device_failed, naming what is wrong.
  explicit Runtime(const cl::Device& device, CallHook hook = {});
  /// The same on `device` of a context that is there, with a private in-order queue; a null context: a new one.
  /// The queue has profiling if there is a trace.
  Runtime(const cl::Context& context, const cl::Device& device, CallHook hook, Log log, Trace trace = {});
  /// One for another thread, on the same device, with a queue of its own in the same context, and the same programs.
  Runtime(const Runtime& sibling, Log log, Trace trace);
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  const cl::Device& device() const { return device_; }
  const cl::Context& context() const { return context_; }
  const Tuning& tuning() const { return hook_.tuning; }
  /// For tests. The kind of the device, and what follows from it, stays.
  Tuning& tuning() { return hook_.tuning; }
  const DeviceInfo& info() const { return info_; }

  /// A new buffer of `count` elements; contents undefined. `name` is for error messages.
  /// Throws out_of_memory, naming the bytes asked for and the device's limit.
  template <class T>
  Buffer<T> allocate(const char* name, std::size_t count) {
    const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(T);
    return Buffer<T>(memory_->take(*this, name, bytes), count);
  }
  /// Makes `buffer` hold at least `count` elements; contents are lost if it grows.
  template <class T>
  void reserve(Buffer<T>& buffer, const char* name, std::size_t count) {
    if (buffer.allocated() && buffer.size() >= count) return;
    buffer = Buffer<T>();
    buffer = allocate<T>(name, count);
  }

  /// A new buffer that holds these.
  template <class T>
  Buffer<T> upload(const char* name, const T* from, std::size_t count) {
    Buffer<T> buffer = allocate<T>(name, count);
    write(buffer, from, count);
    return buffer;
  }
  template <class T>
  Buffer<T> upload(const char* name, const std::vector<T>& values) {
    return upload(name, values.data(), values.size());
  }
  template <class T>
  Buffer<T> upload_one(const char* name, const T& value) {
    return upload(name, &value, 1);
  }

  /// A new buffer of `count` elements that are all this value.
  template <class T>
  Buffer<T> filled(const char* name, std::size_t count, T value) {
    Buffer<T> buffer = allocate<T>(name, count);
    fill(buffer, value, count);
    return buffer;
  }

  /// Writes from host memory; the host memory may be reused on return. count 0 is fine.
  template <class T>
  void write(const Buffer<T>& to, const T* from, std::size_t count, std::size_t offset = 0) {
    write_bytes(to.memory(), offset * sizeof(T), from, count * sizeof(T));
  }
  /// Reads into host memory and waits for it: the only blocking calls are read() and finish().
  template <class T>
  void read(const Buffer<T>& from, T* to, std::size_t count, std::size_t offset = 0) {
    read_bytes(from.memory(), offset * sizeof(T), to, count * sizeof(T));
  }
  template <class T>
  T read_one(const Buffer<T>& from, std::size_t index = 0) {
    T value;
    read(from, &value, 1, index);
    return value;
  }
  template <class T>
  void fill(const Buffer<T>& buffer, T value, std::size_t count, std::size_t offset = 0) {
    fill_bytes(buffer.memory(), &value, sizeof(T), offset * sizeof(T), count * sizeof(T));
  }
  /// All bytes 0, without waiting.
  template <class T>
  void zero(const Buffer<T>& buffer) {
    static_assert(sizeof(T) % sizeof(cl_uint) == 0, "filled word by word");
    const cl_uint nothing = 0;
    fill_bytes(buffer.memory(), &nothing, sizeof nothing, 0, buffer.size() * sizeof(T));
  }
  template <class T>
  void copy(const Buffer<T>& from, const Buffer<T>& to, std::size_t count, std::size_t from_offset = 0) {
    copy_bytes(from.memory(), from_offset * sizeof(T), to.memory(), 0, count * sizeof(T));
  }

  /// Into element `offset` on of the caller's buffer.
  template <class T>
  void copy_out(const Buffer<T>& from, cl_mem to, std::size_t count, std::size_t offset) {
    copy_bytes(from.memory(), 0, to, offset * sizeof(T), count * sizeof(T));
  }

  /// Enqueues `kernel` of `program`, or runs it here and now (WorkHere). Buffers are passed as they are, scalars
  /// by value with the kernel's exact type (cl_uint, cl_ulong, cl_int ...).
  template <class... Args>
  void launch(const char* program, const char* kernel, Range range, const Args&... args) {
    if (const HostKernel* const here = host_kernel(program, kernel)) {
      HostArguments given;
      (add_argument(given, args), ...);
      if (given.all_here()) return run_here(*here, given);
    }
    Kernel& k = find_kernel(program, kernel);
    cl_uint index = 0;
    (set_argument(k, index++, args), ...);
    enqueue(k, range, index);
  }

  /// Launches throw cancelled as soon as `needless` says so; null: never.
  void give_up_when(std::function<bool()> needless) { needless_ = std::move(needless); }

  void finish();
  /// Waits, unless nobody wants to know how long phases take: other runs use the device meanwhile.
  void end_step() {
    if (times_steps_) finish();
  }
  void time_steps(bool wanted) { times_steps_ = wanted; }
  /// The same as finish(), without an exception.
  cl_int try_finish();
  /// Writes bytes from host memory, which may be reused on return; `at_once`: straight from there.
  void write_bytes(Memory to, std::size_t offset, const void* from, std::size_t bytes);
  void write_at_once(cl_mem to, std::size_t offset, const void* from, std::size_t bytes);
  /// Queues a write: the host memory must not change before wait() for what is returned.
  cl::Event write_later(cl_mem to, std::size_t offset, const void* from, std::size_t bytes);
  /// Queues a read: the host memory holds nothing before wait() for what is returned.
  cl::Event read_later(cl_mem from, std::size_t offset, void* to, std::size_t bytes);
  void wait(const cl::Event& event);
  /// From now on, reads and waits keep no other thread out of the context (download.hpp), nor do small writes. Large
  /// writes that are not write_later() do, and what follows an error.
  void share_context();
  /// From now on, large transfers and small reads go through pinned memory, made by the first, where
  /// prepares_host_memory() says so.
  void use_transfer_chunks();
  /// Those chunks, of pinned memory; null if there are none, or others use the device.
  TransferChunks* pinned_chunks() { return transfers_for_many() ? nullptr : chunks_for(~std::size_t{0}); }
  void release_transfer_chunks();  ///< until the next such transfer
  /// From now on, large transfers to and from what lies there go straight, where others go through chunks.
  void know_pinned(std::shared_ptr<const PinnedRanges> ranges) { pinned_ = std::move(ranges); }
  bool is_pinned(const void* first, std::size_t bytes) const { return pinned_ && pinned_->contains(first, bytes); }
  /// Whether nobody else uses the device for now: then large transfers of a shared context go as if it were not,
  /// through more and larger chunks, and by several threads.
  void set_alone(bool alone) { alone_ = alone; }
  /// Reads bytes into host memory and waits for it.
  void read_bytes(Memory from, std::size_t offset, void* to, std::size_t bytes);
  /// All of them, none of which is empty, and waits once. Whatever happens, none goes on afterwards.
  void read_all(const std::vector<HostRead>& reads);
  void flush();
  /// The host's memory of a new buffer, mapped; null if the driver has none.
  void* map_new(std::size_t bytes, cl::Buffer& buffer);
  void unmap(const cl::Buffer& buffer, void* mapped);

  std::uint64_t launches() const { return launches_; }
  std::uint64_t read_backs() const { return read_backs_; }
  double build_ms() const { return build_ms_; }
  DeviceMemory& memory() { return *memory_; }
  /// Replaces where memory comes from; nothing may be in use.
  void use_memory(std::shared_ptr<DeviceMemory> memory) { memory_ = std::move(memory); }
  MemoryMeter& meter() { return memory_->meter(); }
  /// Sub-buffers begin at multiples of so many bytes.
  std::size_t alignment() const { return alignment_; }
  void log(int level, const std::string& message) const {
    if (log_) log_(level, message.c_str());
  }
  Geometry& geometry() { return geometry_; }
  const Geometry& geometry() const { return geometry_; }
  /// So many work-groups, for kernels of which each takes an item.
  Range over_groups(std::size_t items, Groups groups = Groups::usual) const {
    return {std::max<std::size_t>(items, 1) * group_size(groups), true, groups};
  }
  /// Work-items among which `items` are shared out, for kernels of which each keeps a row of a table.
  std::size_t rows_of(std::size_t items) const;
  /// Work-groups of those, for kernels of which each group keeps a row.
  std::size_t row_groups_of(std::size_t items) const {
    return (rows_of(items) + geometry_.local - 1) / geometry_.local;
  }
  /// Rows to which a launch folds a table of so many; as many: it is to be read. Less than before: a loop ends.
  cl_uint fewer_rows(cl_uint rows) const;
  /// Work-items of a launch at most, whatever it wants.
  cl_uint most_work_items() const {
    return static_cast<cl_uint>(std::max(geometry_.max_groups, widest_) * std::max(geometry_.local, geometry_.single));
  }
  Tracer& tracer() { return tracer_; }
  DeviceKind kind() const { return kind_; }
  /// Whether a work-item is a loop of a thread, and takes a contiguous share of every loop (kernels/common/loops.h).
  bool contiguous() const { return kind_ == DeviceKind::threads; }
  /// Whether the calling thread can be a work-item: these are threads, and the device's memory is the host's
  /// (shared_memory.hpp).
  bool can_work_here() const { return can_work_here_; }
  /// Vertices up to which it is faster than all; 0 if it cannot.
  std::uint64_t most_here() const;
  /// Whether it does so now (WorkHere), while nothing is queued.
  bool works_here() const { return works_here_; }
  /// What the meshes are from now on whose kernels are launched; at first of one triangulation. Each run says it once.
  /// Programs of both kinds that have been built are kept.
  void use_programs(Meshes meshes) { meshes_ = meshes; }
  /// Whether the call under way goes without programs that only save time (SparedPrograms).
  bool spares_programs() const { return spares_; }
  /// Whether built programs go into the library's cache.
  bool keeps_programs() const;
  /// See Tuning::states_one_group.
  bool states_one_group() const {
    return hook_.tuning.states_one_group.value_or(kind_ == DeviceKind::gpu &&
                                                  info_.vendor.find("NVIDIA") != std::string::npos);
  }
  /// Options that a program is built with (device/program_table.cpp); part of the cache key.
  std::string build_options(const char* program) const;

  /// The text of the embedded program. Throws device_failed if there is none of that name.
  std::string source(const char* program) const;
  /// Builds a program, if nobody has, for launches to come: from any thread, as long as neither use_programs() nor the
  /// destructor is called. Throws as a launch does.
  void build(const char* program);
  /// Whether building the program now would compile it: it is not built, nor kept in the cache.
  bool would_compile(const char* program) const;
  /// Programs that may be built at once.
  unsigned most_builds() const;
  /// What a built program depends on: its source, the options, device, driver and library version.
  std::vector<std::string> cache_parts(const char* program) const;

  /// Makes one OpenCL call: asks the hook, runs `f`, throws on an error code.
  template <class F>
  void call(const char* name, const char* detail, F&& f) {
    const cl_int code = attempt(name, detail, f);
    if (code != CL_SUCCESS) fail(name, detail, code);
  }
  /// The same for calls that may fail: returns the code.
  template <class F>
  cl_int attempt(const char* name, const char* detail, F&& f) {
    const cl_int code = hook_.before ? hook_.before(name, detail) : CL_SUCCESS;
    return code == CL_SUCCESS ? f() : code;
  }
  /// Throws for an error code of the OpenCL call `name`.
  [[noreturn]] void fail(const char* name, const char* detail, cl_int code) const;

 private:
  Runtime(const cl::Context& context, const cl::Device& device, CallHook hook, Log log, Trace trace,
          const Runtime* sibling);

  struct Kernel {
    std::string name, program;
    Meshes meshes = Meshes::one;
    cl::Kernel handle;
    cl_uint arguments = 0;
    std::size_t largest_group = 0, stated_group = 0;  ///< stated: by the kernel itself; 0: by none
    bool launched = false;
  };

  friend class SparedPrograms;
  friend class WorkHere;
  Meshes meshes_of(const char* program) const;
  void self_test();
  void test_device();
  void test_before_use();
  void read_large(TransferChunks& chunks, const std::vector<HostRead>& reads);
  void waited();
  cl_int ask_until_done(cl_event event);
  bool transfers_for_many() const { return shares_context_ && !alone_; }
  TransferChunks* chunks_for(std::size_t bytes);
  TransferChunks* page_for(std::size_t bytes);
  void give_chunks_up();
  Kernel& find_kernel(const char* program, const char* kernel);
  Kernel& make_kernel(const char* program, const char* kernel);  ///< or finds it by its name
  BuiltPrograms::Key key_of(const char* program) const { return {program, meshes_of(program)}; }
  const cl::Program& find_program(const char* program);
  void fill_bytes(Memory to, const void* pattern, std::size_t pattern_bytes, std::size_t offset, std::size_t bytes);
  void copy_bytes(Memory from, std::size_t from_offset, Memory to, std::size_t to_offset, std::size_t bytes);
  void set_argument_bytes(Kernel& kernel, cl_uint index, std::size_t bytes, const void* value);
  std::size_t group_size(Groups groups) const {
    const std::size_t size = groups == Groups::item   ? 1
                             : groups == Groups::one  ? geometry_.single
                             : groups == Groups::wide ? geometry_.wide
                                                      : geometry_.local;
    return size > 0 ? size : geometry_.local;
  }
  void enqueue(Kernel& kernel, Range range, cl_uint arguments);
  std::size_t groups_of(Range range, std::size_t local) const;  ///< that a launch wants
  const HostKernel* host_kernel(const char* program, const char* kernel);
  void run_here(const HostKernel& kernel, const HostArguments& given);
  /// Whether the host may read the memory itself; and write to it, which is the device's part where it works.
  bool is_here(const Memory& memory) const { return memory.here && !queued_; }
  bool writes_here(const Memory& memory) const { return works_here_ && is_here(memory); }
  static unsigned char* at(const Memory& memory, std::size_t offset) {
    return static_cast<unsigned char*>(memory.here) + offset;
  }
  Geometry geometry_of(std::size_t compute_units) const;  ///< of launches on so many

  template <class T>
  void set_argument(Kernel& kernel, cl_uint index, const Buffer<T>& buffer) {
    cl_mem memory = buffer.handle();
    set_argument_bytes(kernel, index, sizeof memory, &memory);
  }
  void set_argument(Kernel& kernel, cl_uint index, const LocalMemory& memory) {
    set_argument_bytes(kernel, index, memory.bytes, nullptr);
  }
  template <class T, class = std::enable_if_t<std::is_trivially_copyable_v<T>>>
  void set_argument(Kernel& kernel, cl_uint index, const T& value) {
    set_argument_bytes(kernel, index, sizeof(T), &value);
  }

  template <class T>
  static void add_argument(HostArguments& given, const Buffer<T>& buffer) {
    given.add_array(buffer.memory().here);
  }
  static void add_argument(HostArguments& given, const LocalMemory& memory) { given.add_local(memory.bytes); }
  template <class T, class = std::enable_if_t<std::is_trivially_copyable_v<T>>>
  static void add_argument(HostArguments& given, const T& value) {
    given.add(&value, sizeof value);
  }

  cl::Device device_;
  CallHook hook_;
  DeviceInfo info_;
  DeviceKind kind_;
  cl::Context context_;
  cl::CommandQueue queue_;
  Log log_;
  std::function<bool()> needless_;
  Tracer tracer_;
  std::size_t alignment_ = 0;
  std::shared_ptr<DeviceMemory> memory_ = std::make_shared<BufferPool>(BufferSource{});
  Geometry geometry_;
  std::size_t widest_ = 0;  ///< groups that launches have where the driver needs them to be of one width; 0: nowhere
  std::shared_ptr<void> present_;                      ///< among the runtimes that need it
  std::vector<std::vector<unsigned char>> unwritten_;  ///< what the queue may still have to write; see write_bytes
  std::shared_ptr<BuiltPrograms> programs_;
  std::map<std::tuple<std::string, std::string, Meshes>, Kernel> kernels_;  ///< by program, kernel, and kind of mesh
  std::array<Kernel*, 256> recent_ = {};  ///< of kernels_, launched by a literal at such an address; null: none
  struct RecentHere {
    const char *program, *kernel;  ///< literals
    const HostKernel* found;
  };
  std::array<RecentHere, 256> recent_here_ = {};  ///< the same of those that run here
  bool can_work_here_ = false, works_here_ = false;
  bool tested_ = false;  ///< it computes rightly
  bool queued_ = false;  ///< commands that nobody may have waited for
  std::uint64_t launches_ = 0, read_backs_ = 0;
  double build_ms_ = 0;
  Meshes meshes_ = Meshes::one;
  bool spares_ = false;
  bool times_steps_ = true;
  bool emulate_mul_hi_ = false;                                         ///< the device's own is wrong
  bool shares_context_ = false, wants_chunks_ = false, alone_ = false;  ///< shared: it asks, and does not wait
  std::shared_ptr<const PinnedRanges> pinned_;                          ///< may be null
  std::unique_ptr<TransferChunks> shared_chunks_, chunks_;  ///< if the context is; if a large transfer has been made
  std::unique_ptr<TransferChunks> page_;                    ///< of small reads; null before the first
};

/// While it lives, launches have one work-item, which the calling thread is by itself if it can
/// (Runtime::can_work_here) and has the kernel. For few vertices: to wake other threads takes longer than what they
/// would do.
class WorkHere {
 public:
  WorkHere(Runtime& runtime, bool wanted) : runtime_(runtime) {
    runtime.works_here_ = wanted && runtime.can_work_here_;
  }
  ~WorkHere() { runtime_.works_here_ = false; }
  WorkHere(const WorkHere&) = delete;
  WorkHere& operator=(const WorkHere&) = delete;

 private:
  Runtime& runtime_;
};

/// Builds the embedded program `name` for the runtime's device (device/programs.cpp).
cl::Program build_program(Runtime& runtime, const char* name);

/// What `device` is and has.
DeviceInfo describe(const cl::Device& device, const Tuning& tuning = {});  ///< with the memory that it allows

/// As what such a device is treated.
DeviceKind kind_of(const DeviceInfo& info, const Tuning& tuning);
/// Whether it has a compiler and OpenCL 1.2.
bool usable(const cl::Device& device);
/// All usable devices of all platforms, in the order of gcdt_device_get.
std::vector<cl::Device> all_devices();
/// A sub-device of `device` with all but `left` of its compute units, at least one; `device` itself if it has one or
/// cannot be divided.
cl::Device part_of(const cl::Device& device, std::uint32_t left);

/// Compute units of the device that `device` is a part of, or of itself.
cl_uint compute_units_of_root(const cl::Device& device);

/// See gcdt_device_select; `ambiguous` may be null.
std::size_t choose_device(const std::string& spec, bool* ambiguous);

/// See gcdt_pool_options.devices: ascending.
std::vector<std::size_t> choose_devices(const std::string& spec);

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
#include "device/runtime.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "device/cache.hpp"
#include "device/download.hpp"
#include "device/shared_memory.hpp"
#include "device/step.hpp"
#include "device/told.hpp"
#include "device/upload.hpp"

namespace gcdt::runtime {

namespace {
// llvmpipe may end all loops of a work-item after 65535 rounds in all, and say nothing: a work-item takes so few items
// that each may have some thousands (docs/devices.md).
constexpr std::size_t most_items_of_lanes = 16;
constexpr std::size_t least_alignment = 128;
// After which a command is no longer one that takes its time.
constexpr auto long_time = std::chrono::seconds(1);

// PoCL loads a kernel's code anew for a launch that is wider than those that it was loaded for, and until version 6
// counts down, when a launch ends, whichever of the kernel's was used last. Runs at once with launches of different
// widths (workers of a pool, sub-devices, solvers) end the process that way, by an assertion: two of versions 4 and 5,
// three of those before, which count each up twice. So launches are of one width while there are several runtimes, and
// the first one of each kernel is always, since others may come.
bool loads_code_by_width(const DeviceInfo& info) {
  return info.platform == pocl_platform && std::atoi(info.driver.c_str()) < 6;
}
std::atomic<int> loaded_by_width{0};  // runtimes

// Threads that copy so many bytes to or from chunks. Workers that share a context are threads enough.
unsigned threads_for(const Runtime& runtime, std::size_t bytes, bool for_many) {
  if (for_many) return 1;
  const std::size_t worth = 1 + bytes / runtime.tuning().copied_by_thread;
  const unsigned most = std::min(runtime.tuning().copy_threads, std::max(std::thread::hardware_concurrency(), 1u));
  return static_cast<unsigned>(std::min<std::size_t>(worth, most));
}

// Makes a transfer, through chunks if there are any. After an error nothing of it is left in the queue, nor are its
// events, which the next transfer would wait for.
template <class F>
void settled(Runtime& runtime, TransferChunks* chunks, F&& transfer) {
  try {
    transfer();
  } catch (...) {
    runtime.try_finish();
    if (chunks) chunks->forget();
    throw;
  }
}

}  // namespace

Runtime::Runtime(const cl::Device& device, CallHook hook) : Runtime(cl::Context(), device, std::move(hook), {}) {}

Runtime::Runtime(const cl::Context& context, const cl::Device& device, CallHook hook, Log log, Trace trace)
    : Runtime(context, device, std::move(hook), std::move(log), std::move(trace), nullptr) {}

Runtime::Runtime(const Runtime& sibling, Log log, Trace trace)
    : Runtime(sibling.context_, sibling.device_, sibling.hook_, std::move(log), std::move(trace), &sibling) {}

Runtime::Runtime(const cl::Context& context, const cl::Device& device, CallHook hook, Log log, Trace trace,
                 const Runtime* sibling)
    : device_(device),
      hook_(std::move(hook)),
      info_(describe(device, hook_.tuning)),
      kind_(kind_of(info_, hook_.tuning)),
      context_(context),
      log_(std::move(log)),
      tracer_(std::move(trace), info_.name),
      programs_(sibling ? sibling->programs_ : std::make_shared<BuiltPrograms>()) {
  if (!context_())
    call("clCreateContext", info_.name.c_str(), [&] {
      cl_int code;
      context_ = cl::Context(device_, nullptr, nullptr, nullptr, &code);
      return code;
    });
  call("clCreateCommandQueue", info_.name.c_str(), [&] {
    cl_int code;
    queue_ = cl::CommandQueue(context_, device_,
                              tracer_.on() ? cl::QueueProperties::Profiling : cl::QueueProperties::None, &code);
    return code;
  });
  geometry_ = geometry_of(info_.compute_units);
  // A text that is changed is the device's.
  can_work_here_ = contiguous() && hook_.tuning.works_here.value_or(!hook_.before) && !hook_.edit &&
                   hook_.options.empty() && shares_memory(device_);
  const std::size_t widest = geometry_of(compute_units_of_root(device_)).max_groups;  // parts' runtimes have it, too
  widest_ = hook_.tuning.width.value_or(loads_code_by_width(info_) ? widest : 0);
  if (widest_ > 0) {
    ++loaded_by_width;
    present_ = std::shared_ptr<void>(nullptr, [](void*) { --loaded_by_width; });
  }
  // In bits. Never less than a cache line, which work-groups on distinct buffers should not share.
  alignment_ = std::max<std::size_t>(told<CL_DEVICE_MEM_BASE_ADDR_ALIGN>(device_) / 8, least_alignment);
  if (sibling) tested_ = sibling->tested_, emulate_mul_hi_ = sibling->emulate_mul_hi_;
  // Until a program is built, the calling thread may do all that there is: few vertices wait for no compiler.
  if (!tested_ && !can_work_here_) test_device();
}

void Runtime::test_device() {
  tested_ = true;  // for its own launches
  try {
    self_test();
  } catch (...) {
    try_finish();
    tested_ = false;
    throw;
  }
}

Runtime::~Runtime() {
  if (!unwritten_.empty()) try_finish();
}

void Runtime::fail(const char* name, const char* detail, cl_int code) const {
  const bool memory = code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES ||
                      code == CL_OUT_OF_HOST_MEMORY || code == CL_INVALID_BUFFER_SIZE;
  throw Error(
      memory ? Status::out_of_memory : Status::device_failed,
      std::string(name) + " (" + detail + ") on " + info_.name + " failed with OpenCL code " + std::to_string(code),
      {static_cast<std::uint64_t>(static_cast<std::int64_t>(code))}, 0, code);
}

// By a runtime of its own: nothing of it belongs to the call under way.
void Runtime::test_before_use() {
  Runtime tester(*this, log_, {});
  tester.test_device();
  emulate_mul_hi_ = tester.emulate_mul_hi_;
  tested_ = true;
}

const cl::Program& Runtime::find_program(const char* program) {
  if (!tested_) test_before_use();
  const auto start = std::chrono::steady_clock::now();
  const bool waits = !programs_->has(key_of(program));
  const cl::Program& found =
      programs_->get(key_of(program), most_builds(), [&] { return build_program(*this, program); });
  if (waits)
    log(GCDT_LOG_INFORMATION,
        "built " + std::string(program) + " in " + std::to_string(milliseconds_since(start)) + " ms");
  build_ms_ += milliseconds_since(start);
  return found;
}

void Runtime::build(const char* program) {
  programs_->get(key_of(program), most_builds(), [&] { return build_program(*this, program); });
}

bool Runtime::would_compile(const char* program) const {
  return !programs_->has(key_of(program)) && keeps_programs() &&
         !cache::has(cache::entry("program", cache_parts(program)));
}

unsigned Runtime::most_builds() const {
  // Hooks are the test's own, which is in one thread.
  if (hook_.before || hook_.edit || !keeps_programs()) return 1;
  return tuning().builds_at_once.value_or(kind_ == DeviceKind::gpu ? Tuning::builds_of_gpu : 1);
}

// A search by names costs a launch 0.4 microseconds, a tenth of what the driver takes. Launches name kernels by
// literals, whose addresses choose one of a few slots; where another kernel has it, the names are searched.
Runtime::Kernel& Runtime::find_kernel(const char* program, const char* kernel) {
  Kernel*& recent = recent_[(reinterpret_cast<std::uintptr_t>(kernel) >> 3) % recent_.size()];
  if (!recent || recent->meshes != meshes_ || recent->name != kernel || recent->program != program)
    recent = &make_kernel(program, kernel);
  return *recent;
}

Runtime::Kernel& Runtime::make_kernel(const char* program, const char* kernel) {
  const auto key = std::make_tuple(std::string(program), std::string(kernel), meshes_);
  auto found = kernels_.find(key);
  if (found != kernels_.end()) return found->second;
  const ProgramInfo& info = info_of(program);
  const char* elsewhere = info.bundle_elsewhere ? info.bundle_elsewhere : program;
  const cl::Program& built = find_program(contiguous() ? info.bundle : elsewhere);
  Kernel k;
  k.name = kernel;
  k.program = program;
  k.meshes = meshes_;
  call("clCreateKernel", kernel, [&] {
    cl_int code;
    k.handle = cl::Kernel(built, kernel, &code);
    return code;
  });
  call("clGetKernelInfo", kernel, [&] { return k.handle.getInfo(CL_KERNEL_NUM_ARGS, &k.arguments); });
  call("clGetKernelWorkGroupInfo", kernel,
       [&] { return k.handle.getWorkGroupInfo(device_, CL_KERNEL_WORK_GROUP_SIZE, &k.largest_group); });
  if (states_one_group()) {
    std::array<std::size_t, 3> stated = {};
    call("clGetKernelWorkGroupInfo", kernel,
         [&] { return k.handle.getWorkGroupInfo(device_, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, &stated); });
    k.stated_group = stated[0];
  }
  return kernels_.emplace(key, std::move(k)).first->second;
}

void Runtime::write_bytes(Memory place, std::size_t offset, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  if (writes_here(place)) {
    std::memcpy(at(place, offset), from, bytes);
    return;
  }
  const cl_mem to = place.handle;
  TransferChunks* chunks = transfers_for_many() ? nullptr : chunks_for(bytes);
  if (!chunks) return write_at_once(to, offset, from, bytes);
  if (is_pinned(from, bytes)) return settled(*this, nullptr, [&] { wait(write_later(to, offset, from, bytes)); });
  const unsigned threads = threads_for(*this, bytes, transfers_for_many());
  settled(*this, chunks,
          [&] { write_through(*chunks, threads, to, offset, static_cast<const unsigned char*>(from), bytes); });
}

void Runtime::write_at_once(cl_mem to, std::size_t offset, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  const bool copied = (contiguous() || shares_context_) && bytes <= Tuning::most_copied;
  if (copied) {
    const auto* first = static_cast<const unsigned char*>(from);
    from = unwritten_.emplace_back(first, first + bytes).data();
  }
  queued_ = true;
  call("clEnqueueWriteBuffer", "", [&] {
    return clEnqueueWriteBuffer(queue_(), to, copied ? CL_FALSE : CL_TRUE, offset, bytes, from, 0, nullptr, nullptr);
  });
}

cl::Event Runtime::write_later(cl_mem to, std::size_t offset, const void* from, std::size_t bytes) {
  cl::Event written;
  queued_ = true;
  call("clEnqueueWriteBuffer", "",
       [&] { return clEnqueueWriteBuffer(queue_(), to, CL_FALSE, offset, bytes, from, 0, nullptr, &written()); });
  return written;
}

cl::Event Runtime::read_later(cl_mem from, std::size_t offset, void* to, std::size_t bytes) {
  cl::Event read;
  queued_ = true;
  call("clEnqueueReadBuffer", "",
       [&] { return clEnqueueReadBuffer(queue_(), from, CL_FALSE, offset, bytes, to, 0, nullptr, &read()); });
  return read;
}

void Runtime::wait(const cl::Event& event) {
  if (shares_context_) flush();
  call("clWaitForEvents", "", [&] {
    const cl_int code = shares_context_ ? ask_until_done(event()) : CL_SUCCESS;
    return code == CL_SUCCESS ? clWaitForEvents(1, &event()) : code;  // asking alone does not synchronise memory
  });
}

// Ends as clWaitForEvents does, or with an error of the queue, in case that a device that is lost leaves events as they
// were.
cl_int Runtime::ask_until_done(cl_event event) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (auto asked = start;;) {
    cl_int status = CL_COMPLETE;
    const cl_int code = clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
    if (code != CL_SUCCESS) return code;
    if (status <= CL_COMPLETE) return status;  // errors are negative
    const auto now = Clock::now();
    if (now - start < Tuning::patience) {
      std::this_thread::yield();
      continue;
    }
    std::this_thread::sleep_for(Tuning::nap);
    if (now - asked < long_time) continue;
    asked = now;
    const cl_int lost = clFlush(queue_());
    if (lost != CL_SUCCESS) return lost;
  }
}

void Runtime::share_context() {
  shared_chunks_ = std::make_unique<TransferChunks>(*this, 2, Tuning::download_chunk, true);
  shares_context_ = shared_chunks_->pinned();
  if (shares_context_) return;
  shared_chunks_.reset();
  log(GCDT_LOG_WARNING, info_.name + " has no pinned host memory: its workers wait for one another");
}

void Runtime::use_transfer_chunks() { wants_chunks_ = prepares_host_memory(*this); }

void Runtime::release_transfer_chunks() {
  chunks_.reset();
  page_.reset();
}

void Runtime::give_chunks_up() {
  wants_chunks_ = alone_ = false;
  log(GCDT_LOG_WARNING, info_.name + " has no pinned host memory: transfers are slow");
}

// Null if a transfer of so many bytes does not go through chunks.
TransferChunks* Runtime::chunks_for(std::size_t bytes) {
  if (transfers_for_many()) return shared_chunks_.get();
  if (!(wants_chunks_ || (alone_ && prepares_host_memory(*this))) || bytes < tuning().least_chunked) return nullptr;
  if (!chunks_) {
    chunks_ = std::make_unique<TransferChunks>(*this, tuning().transfer_chunks, tuning().transfer_chunk, true);
    if (!chunks_->pinned()) {
      chunks_.reset();
      give_chunks_up();
    }
  }
  return chunks_ && !chunks_->lent() ? chunks_.get() : nullptr;
}

// Null if a read of so many bytes does not go through the page of pinned memory: NVIDIA's driver takes 3 of 15
// microseconds more for a read that waits and goes elsewhere (bench/NOTES.md).
TransferChunks* Runtime::page_for(std::size_t bytes) {
  if (!wants_chunks_ || shares_context_ || bytes > Tuning::page) return nullptr;
  if (!page_) {
    page_ = std::make_unique<TransferChunks>(*this, 1, Tuning::page, true);
    if (!page_->pinned()) {
      page_.reset();
      give_chunks_up();
    }
  }
  return page_.get();
}

void Runtime::read_bytes(Memory place, std::size_t offset, void* to, std::size_t bytes) {
  if (bytes == 0) return;
  if (is_here(place)) {
    std::memcpy(to, at(place, offset), bytes);
    return;
  }
  const cl_mem from = place.handle;
  ++read_backs_;
  if (TransferChunks* chunks = chunks_for(bytes))
    settled(*this, chunks, [&] { read_large(*chunks, {{from, to, bytes, offset}}); });
  else if (TransferChunks* page = page_for(bytes))
    settled(*this, page, [&] {
      page->read(0, from, offset, bytes);
      page->take(0);
      std::memcpy(to, page->memory(0), bytes);
    });
  else
    call("clEnqueueReadBuffer", "",
         [&] { return clEnqueueReadBuffer(queue_(), from, CL_TRUE, offset, bytes, to, 0, nullptr, nullptr); });
  waited();
}

// What is pinned is queued first, since nobody copies it meanwhile.
void Runtime::read_large(TransferChunks& chunks, const std::vector<HostRead>& reads) {
  std::vector<cl::Event> straight;
  std::vector<HostRead> copied;
  std::size_t bytes = 0;
  for (const HostRead& read : reads)
    if (is_pinned(read.to, read.bytes))
      straight.push_back(read_later(read.from.handle, read.offset, read.to, read.bytes));
    else
      copied.push_back(read), bytes += read.bytes;
  if (!straight.empty()) flush();
  if (!copied.empty()) read_through(chunks, threads_for(*this, bytes, transfers_for_many()), copied);
  if (!straight.empty()) wait(straight.back());  // the queue is in order
}

void Runtime::read_all(const std::vector<HostRead>& reads) {
  if (reads.empty()) return;
  if (std::all_of(reads.begin(), reads.end(), [&](const HostRead& read) { return is_here(read.from); })) {
    for (const HostRead& read : reads) std::memcpy(read.to, at(read.from, read.offset), read.bytes);
    return;
  }
  queued_ = true;
  std::size_t bytes = 0;
  for (const HostRead& read : reads) bytes += read.bytes;
  TransferChunks* const chunks = chunks_for(bytes);
  settled(*this, chunks, [&] {
    if (chunks) {
      ++read_backs_;
      read_large(*chunks, reads);
      return waited();
    }
    for (std::size_t i = 0; i + 1 < reads.size(); ++i)
      call("clEnqueueReadBuffer", "", [&] {
        return clEnqueueReadBuffer(queue_(), reads[i].from.handle, CL_FALSE, reads[i].offset, reads[i].bytes,
                                   reads[i].to, 0, nullptr, nullptr);
      });
    read_bytes(reads.back().from, reads.back().offset, reads.back().to, reads.back().bytes);  // the queue is in order
  });
}

void Runtime::fill_bytes(Memory place, const void* pattern, std::size_t pattern_bytes, std::size_t offset,
                         std::size_t bytes) {
  if (bytes == 0) return;
  if (writes_here(place)) {
    unsigned char* const to = at(place, offset);
    std::memcpy(to, pattern, pattern_bytes);
    for (std::size_t done = pattern_bytes; done < bytes; done *= 2)  // what is filled once is copied behind it
      std::memcpy(to + done, to, std::min(done, bytes - done));
    return;
  }
  const cl_mem to = place.handle;
  queued_ = true;
  call("clEnqueueFillBuffer", "",
       [&] { return clEnqueueFillBuffer(queue_(), to, pattern, pattern_bytes, offset, bytes, 0, nullptr, nullptr); });
}

void Runtime::copy_bytes(Memory source, std::size_t from_offset, Memory target, std::size_t to_offset,
                         std::size_t bytes) {
  if (bytes == 0) return;
  if (writes_here(source) && writes_here(target)) {
    std::memcpy(at(target, to_offset), at(source, from_offset), bytes);
    return;
  }
  const cl_mem from = source.handle, to = target.handle;
  queued_ = true;
  call("clEnqueueCopyBuffer", "",
       [&] { return clEnqueueCopyBuffer(queue_(), from, to, from_offset, to_offset, bytes, 0, nullptr, nullptr); });
}

void Runtime::set_argument_bytes(Kernel& kernel, cl_uint index, std::size_t bytes, const void* value) {
  call("clSetKernelArg", kernel.name.c_str(), [&] { return clSetKernelArg(kernel.handle(), index, bytes, value); });
}

Geometry Runtime::geometry_of(std::size_t units) const {
  units = std::max<std::size_t>(units, 1);
  Geometry geometry;
  switch (kind_) {
    case DeviceKind::gpu:
      geometry = {Tuning::gpu_group, units * Tuning::gpu_groups_per_unit, Tuning::gpu_single_group};
      geometry.single = std::min<std::size_t>(geometry.single, info_.largest_work_group);
      geometry.wide = std::min<std::size_t>(Tuning::gpu_wide_group, info_.largest_work_group);
      geometry.row_groups = units * Tuning::gpu_row_groups_per_unit;
      break;
    case DeviceKind::threads: geometry = {1, units * Tuning::shares_per_unit, 1, Tuning::least_share}; break;
    case DeviceKind::lanes:
      geometry = {Tuning::cpu_group, units * Tuning::cpu_groups_per_unit, Tuning::cpu_group, 0, most_items_of_lanes};
      break;
    case DeviceKind::accelerator:
      geometry = {Tuning::cpu_group, units * Tuning::cpu_groups_per_unit, Tuning::cpu_group};
      break;
  }
  geometry.local = std::min<std::size_t>(geometry.local, info_.largest_work_group);
  return geometry;
}

std::size_t Runtime::groups_of(Range range, std::size_t local) const {
  if (works_here_ || range.groups == Groups::one || range.groups == Groups::item) return 1;
  const std::size_t each = local * (range.large_items ? 1 : std::max<std::size_t>(geometry_.share, 1));
  const std::size_t wanted = (range.items + each - 1) / each;
  std::size_t most = geometry_.max_groups;
  if (geometry_.most_items > 0) {
    const std::size_t items = range.large_items ? 1 : geometry_.most_items;
    most = std::max(most, (wanted + items - 1) / items);
  }
  return std::clamp<std::size_t>(wanted, 1, most);
}

std::uint64_t Runtime::most_here() const {
  if (!can_work_here_ || tuning().one_item_vertices == 0) return 0;
  const std::uint64_t units = std::max<std::uint64_t>(info_.compute_units, 1), here = tuning().here_vertices;
  return units == 1 ? 4 * here : here * units / (units - 1);
}

// Slots as of find_kernel(). Null: enqueue it.
const HostKernel* Runtime::host_kernel(const char* program, const char* kernel) {
  if (!works_here_ || queued_ || meshes_ != Meshes::one) return nullptr;
  RecentHere& recent = recent_here_[(reinterpret_cast<std::uintptr_t>(kernel) >> 3) % recent_here_.size()];
  if (recent.program != program || recent.kernel != kernel)
    recent = {program, kernel, find_host_kernel(info_of(program).bundle, kernel)};
  return recent.found;
}

void Runtime::run_here(const HostKernel& kernel, const HostArguments& given) {
  if (needless_ && needless_()) throw Error(Status::cancelled, std::string("given up before ") + kernel.name);
  if (!given.fit(kernel))
    throw Error(Status::device_failed, std::string(kernel.name) + " takes arguments of other types");
  ++launches_;
  call("host launch", kernel.name, [&] {
    tracer_.launch_here(kernel.name, [&] { kernel.run(given.given()); });
    return CL_SUCCESS;
  });
}

void Runtime::enqueue(Kernel& kernel, Range range, cl_uint arguments) {
  if (needless_ && needless_()) throw Error(Status::cancelled, "given up before " + kernel.name);
  if (arguments != kernel.arguments)
    throw Error(Status::device_failed, kernel.name + " takes " + std::to_string(kernel.arguments) + " arguments, not " +
                                           std::to_string(arguments));
  const bool one_group = range.groups == Groups::one || range.groups == Groups::item;
  const std::size_t local =
      kernel.stated_group > 0 ? kernel.stated_group : std::min(group_size(range.groups), kernel.largest_group);
  const std::size_t usual = groups_of(range, local);
  const bool widest = !one_group && (!kernel.launched || loaded_by_width > 1);
  const std::size_t groups = widest ? std::max(usual, widest_) : usual;
  const std::size_t global = groups * local;
  ++launches_;
  queued_ = true;
  call("clEnqueueNDRangeKernel", kernel.name.c_str(), [&] {
    return tracer_.launch(kernel.name, [&](cl_event* event) {
      return clEnqueueNDRangeKernel(queue_(), kernel.handle(), 1, nullptr, &global, &local, 0, nullptr, event);
    });
  });
  kernel.launched = true;
}

std::size_t Runtime::rows_of(std::size_t items) const {
  if (works_here_) return 1;
  const std::size_t groups = geometry_.row_groups > 0 ? geometry_.row_groups : geometry_.max_groups;
  const std::size_t usual = geometry_.local * groups,
                    least = geometry_.most_items > 0 ? items / geometry_.most_items : 0;
  return std::clamp<std::size_t>(std::max(usual, least), 1, std::max<std::size_t>(items, 1));
}

cl_uint Runtime::fewer_rows(cl_uint rows) const {
  const Tuning& tuning = hook_.tuning;
  return std::min(rows, std::max(tuning.rows_read, rows / tuning.rows_folded));
}

void* Runtime::map_new(std::size_t bytes, cl::Buffer& buffer) {
  void* mapped = nullptr;
  cl_int code = attempt("clCreateBuffer", "host memory", [&] {
    cl_int made;
    buffer = cl::Buffer(context_, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes, nullptr, &made);
    return made;
  });
  if (code == CL_SUCCESS)
    code = attempt("clEnqueueMapBuffer", "host memory", [&] {
      cl_int made;
      mapped = clEnqueueMapBuffer(queue_(), buffer(), CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, 0, nullptr,
                                  nullptr, &made);
      return made;
    });
  if (code == CL_SUCCESS) return mapped;
  buffer = cl::Buffer();
  return nullptr;
}

void Runtime::unmap(const cl::Buffer& buffer, void* mapped) {
  attempt("clEnqueueUnmapMemObject", "host memory",
          [&] { return clEnqueueUnmapMemObject(queue_(), buffer(), mapped, 0, nullptr, nullptr); });
  try_finish();
}

void Runtime::finish() {
  if (can_work_here_ && !queued_) return;
  if (shares_context_) {
    cl::Event reached;
    call("clEnqueueMarkerWithWaitList", "",
         [&] { return clEnqueueMarkerWithWaitList(queue_(), 0, nullptr, &reached()); });
    wait(reached);
  } else {
    call("clFinish", "", [&] { return clFinish(queue_()); });
  }
  unwritten_.clear();
  queued_ = false;
}

cl_int Runtime::try_finish() {
  const cl_int code = clFinish(queue_());
  unwritten_.clear();
  if (code == CL_SUCCESS) queued_ = false;
  return code;
}

void Runtime::waited() {
  unwritten_.clear();
  queued_ = false;
  tracer_.waited();
}

void Runtime::flush() {
  call("clFlush", "", [&] { return clFlush(queue_()); });
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
#include "device/buffer_pool.hpp"

#include "device/runtime.hpp"
#include "device/shared_memory.hpp"

namespace gcdt::runtime {

namespace {
std::size_t rounded_size(std::size_t bytes, std::size_t most) {
  std::size_t step = Tuning::least_bytes;
  while (bytes / step >= 2 * Tuning::steps_per_doubling) step *= 2;
  const std::size_t rounded = (bytes + step - 1) / step * step;
  return rounded <= most ? rounded : bytes;
}

bool is_shortage(cl_int code) {
  return code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES || code == CL_OUT_OF_HOST_MEMORY ||
         code == CL_INVALID_BUFFER_SIZE;
}
}  // namespace

BufferPool::~BufferPool() {
  for (Entry& entry : entries_) drop(entry);
}

void BufferPool::begin_call() {
  ++call_;
  for (auto& [name, served] : served_) served.next = 0;
  for (Entry& entry : entries_)
    if (!entry.used && entry.last_call + Tuning::calls_kept < call_) drop(entry);
}

bool BufferPool::fits(const Entry& entry, std::size_t bytes) const {
  return entry.memory() && !entry.used && entry.bytes >= bytes &&
         (entry.bytes <= Tuning::small_bytes || entry.bytes / 2 <= bytes);
}

DeviceMemory::Place BufferPool::find(Runtime& runtime, const char* name, std::size_t bytes) {
  if (runtime.tuning().fresh_buffers) {
    const std::size_t made = add(runtime, name, bytes);
    entries_[made].used = entries_[made].once = true;
    return {made, 0, bytes, entries_[made].memory, entries_[made].here};
  }
  Served& served = served_[name];
  const std::size_t turn = served.next;
  const std::size_t preferred = turn < served.entries.size() ? served.entries[turn] : entries_.size();
  const std::size_t chosen = choose(runtime, name, preferred, bytes);
  served.entries.resize(std::max(turn + 1, served.entries.size()));
  served.entries[turn] = chosen;
  ++served.next;
  entries_[chosen].used = true;
  entries_[chosen].last_call = call_;
  return {chosen, 0, entries_[chosen].bytes, entries_[chosen].memory, entries_[chosen].here};
}

std::size_t BufferPool::choose(Runtime& runtime, const char* name, std::size_t preferred, std::size_t bytes) {
  if (preferred < entries_.size() && fits(entries_[preferred], bytes)) return preferred;
  std::size_t best = entries_.size();
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (fits(entries_[i], bytes) && (best == entries_.size() || entries_[i].bytes < entries_[best].bytes)) best = i;
  return best < entries_.size() ? best : add(runtime, name, bytes);
}

cl_int BufferPool::try_to_make(Runtime& runtime, const char* name, Entry& entry) {
  const std::size_t bytes = entry.bytes;
  return runtime.attempt("clCreateBuffer", name, [&] {
    if (!source_.allocate && runtime.can_work_here() && bytes <= Tuning::most_shared)
      return make_shared_buffer(runtime.context(), bytes, entry.memory, entry.here);
    cl_int code = CL_SUCCESS;
    cl_mem made = source_.allocate ? source_.allocate(runtime.context()(), CL_MEM_READ_WRITE, bytes, &code)
                                   : clCreateBuffer(runtime.context()(), CL_MEM_READ_WRITE, bytes, nullptr, &code);
    if (made && code == CL_SUCCESS) entry.memory = cl::Buffer(made);
    return made || code != CL_SUCCESS ? code : CL_MEM_OBJECT_ALLOCATION_FAILURE;
  });
}

std::size_t BufferPool::add(Runtime& runtime, const char* name, std::size_t wanted) {
  const DeviceInfo& info = runtime.info();
  const bool rounds = !runtime.tuning().fresh_buffers;
  const std::size_t bytes = rounds ? rounded_size(wanted, info.largest_buffer_bytes) : std::max<std::size_t>(wanted, 1);
  if (meter_.held + bytes > info.memory_bytes) trim();
  if (bytes > info.largest_buffer_bytes || meter_.held + bytes > info.memory_bytes)
    throw Error(Status::out_of_memory, std::string(name) + " needs " + std::to_string(bytes) + " bytes beside " +
                                           std::to_string(meter_.held) + " in use; " + info.name + " has " +
                                           std::to_string(info.memory_bytes) + ", at most " +
                                           std::to_string(info.largest_buffer_bytes) + " in one buffer");
  Entry entry;
  entry.bytes = bytes;
  cl_int code = try_to_make(runtime, name, entry);
  if (is_shortage(code)) {
    const std::uint64_t before = meter_.held;
    trim();
    runtime.try_finish();  // what was trimmed may be in use until then
    if (meter_.held < before) code = try_to_make(runtime, name, entry);
  }
  if (code != CL_SUCCESS) runtime.fail("clCreateBuffer", name, code);
  meter_.hold(bytes);
  runtime.log(GCDT_LOG_INFORMATION, "took " + std::to_string(bytes) + " bytes of device memory for " + name + ", " +
                                        std::to_string(meter_.held) + " held");
  const auto vacant = std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return !e.memory(); });
  if (vacant == entries_.end()) {
    entries_.push_back(std::move(entry));
    return entries_.size() - 1;
  }
  *vacant = std::move(entry);
  return static_cast<std::size_t>(vacant - entries_.begin());
}

void BufferPool::give_back(Place& place) {
  place.memory = cl::Buffer();
  Entry& entry = entries_[place.holder];
  entry.used = false;
  if (entry.once) drop(entry);
}

void BufferPool::drop(Entry& entry) {
  if (!entry.memory()) return;
  meter_.let_go(entry.bytes);
  cl_mem memory = entry.memory();
  if (source_.release) clRetainMemObject(memory);  // the one reference that the hook is to release
  entry.memory = cl::Buffer(), entry.here = nullptr;
  if (source_.release) source_.release(memory);
}

void BufferPool::trim() {
  for (Entry& entry : entries_)
    if (!entry.used) drop(entry);
}

bool BufferPool::is_free(cl_mem memory, std::size_t, std::size_t) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& e) { return e.memory() && e.memory() == memory && !e.used; });
}

bool BufferPool::holds(cl_mem memory) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& e) { return e.memory() && e.memory() == memory; });
}

}  // namespace gcdt::runtime

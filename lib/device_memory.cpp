// SPDX-License-Identifier: Apache-2.0
#include "device_memory.hpp"

#include "opencl.hpp"

namespace gcdt::runtime {

namespace {
// Small buffers without a reservation share slabs of this size.
constexpr std::size_t least_slab = std::size_t{1} << 20;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

bool is_shortage(cl_int code) {
  return code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES || code == CL_OUT_OF_HOST_MEMORY ||
         code == CL_INVALID_BUFFER_SIZE;
}
}  // namespace

DeviceMemory::DeviceMemory(const std::vector<cl::Buffer>& workspace) : workspace_(true) {
  for (const cl::Buffer& buffer : workspace) {
    slabs_.push_back(std::make_unique<Slab>());
    Slab& slab = *slabs_.back();
    slab.memory = buffer;
    slab.bytes = buffer.getInfo<CL_MEM_SIZE>();
    slab.gaps.emplace(0, slab.bytes);
    meter_.hold(slab.bytes);
  }
}

DeviceMemory::~DeviceMemory() {
  for (auto& slab : slabs_) drop(*slab);
}

DeviceMemory::Block DeviceMemory::take(Runtime& runtime, const char* name, std::size_t bytes) {
  const std::size_t length = rounded_up(bytes, runtime.alignment());
  Block block;
  if (!place(block, length)) {
    if (workspace_)
      throw Error(Status::workspace_too_small,
                  std::string("the workspace is too small: ") + name + " needs " + std::to_string(bytes) +
                      " bytes beside " + std::to_string(meter_.now) + " in use; it has " + std::to_string(meter_.held),
                  {std::max(meter_.held, meter_.now) + length});
    add_slab(runtime, name, std::max(length, std::min<std::size_t>(least_slab, runtime.info().largest_buffer_bytes)));
    place(block, length);
  }
  // From here on the destructor of `block` hands the place back.
  block.owner_ = shared_from_this();
  block.asked_ = bytes;
  meter_.add(bytes);
  runtime.call("clCreateSubBuffer", name, [&] {
    const cl_buffer_region region = {block.offset_, bytes};
    cl_int code;
    block.memory_ =
        cl::Buffer(clCreateSubBuffer(block.slab_->memory(), 0, CL_BUFFER_CREATE_TYPE_REGION, &region, &code));
    return code;
  });
  return block;
}

bool DeviceMemory::place(Block& block, std::size_t length) {
  for (auto& slab : slabs_) {
    auto best = slab->gaps.end();
    for (auto gap = slab->gaps.begin(); gap != slab->gaps.end(); ++gap)
      if (gap->second >= length && (best == slab->gaps.end() || gap->second < best->second)) best = gap;
    if (best == slab->gaps.end()) continue;
    const auto [offset, room] = *best;
    slab->gaps.erase(best);
    if (room > length) slab->gaps.emplace(offset + length, room - length);
    slab->used += length;
    block.slab_ = slab.get();
    block.offset_ = offset;
    block.length_ = length;
    return true;
  }
  return false;
}

cl_int DeviceMemory::try_slab(Runtime& runtime, const char* name, std::size_t bytes, cl::Buffer& memory) {
  return runtime.attempt("clCreateBuffer", name, [&] {
    cl_int code = CL_SUCCESS;
    cl_mem made = source_.allocate ? source_.allocate(runtime.context()(), CL_MEM_READ_WRITE, bytes, &code)
                                   : clCreateBuffer(runtime.context()(), CL_MEM_READ_WRITE, bytes, nullptr, &code);
    if (made && code == CL_SUCCESS) memory = cl::Buffer(made);
    return made || code != CL_SUCCESS ? code : CL_MEM_OBJECT_ALLOCATION_FAILURE;
  });
}

DeviceMemory::Slab& DeviceMemory::add_slab(Runtime& runtime, const char* name, std::size_t bytes) {
  const DeviceInfo& info = runtime.info();
  if (meter_.held + bytes > info.memory_bytes) trim();
  if (bytes > info.largest_buffer_bytes || meter_.held + bytes > info.memory_bytes) fail_for_size(runtime, name, bytes);
  auto slab = std::make_unique<Slab>();
  cl_int code = try_slab(runtime, name, bytes, slab->memory);
  if (is_shortage(code)) {
    const std::uint64_t before = meter_.held;
    trim();
    if (meter_.held < before) code = try_slab(runtime, name, bytes, slab->memory);
  }
  if (code != CL_SUCCESS) runtime.fail("clCreateBuffer", name, code);
  slab->bytes = bytes;
  slab->gaps.emplace(0, bytes);
  slabs_.push_back(std::move(slab));
  meter_.hold(bytes);
  runtime.log(GCDT_LOG_INFORMATION, "took " + std::to_string(bytes) + " bytes of device memory for " + name + ", " +
                                        std::to_string(meter_.held) + " held");
  return *slabs_.back();
}

void DeviceMemory::reserve(Runtime& runtime, std::uint64_t bytes) {
  if (workspace_ || meter_.held - meter_.now >= bytes) return;
  trim();
  const std::uint64_t most = runtime.info().largest_buffer_bytes;
  if (meter_.held + bytes > runtime.info().memory_bytes) return;  // an upper bound: it may do with less
  const std::uint64_t parts = (bytes + most - 1) / most;
  const std::uint64_t part = rounded_up((bytes + parts - 1) / parts, runtime.alignment());
  for (std::uint64_t i = 0; i < parts; ++i) add_slab(runtime, "reservation", std::min(part, most));
}

void DeviceMemory::fail_for_size(const Runtime& runtime, const char* name, std::size_t bytes) const {
  throw Error(Status::out_of_memory, std::string(name) + " needs " + std::to_string(bytes) + " bytes beside " +
                                         std::to_string(meter_.held) + " in use; " + runtime.info().name + " has " +
                                         std::to_string(runtime.info().memory_bytes) + ", at most " +
                                         std::to_string(runtime.info().largest_buffer_bytes) + " in one buffer");
}

void DeviceMemory::add_gap(Slab& slab, std::size_t offset, std::size_t length) {
  auto after = slab.gaps.lower_bound(offset);
  if (after != slab.gaps.begin()) {
    const auto before = std::prev(after);
    if (before->first + before->second == offset) {
      offset = before->first;
      length += before->second;
      slab.gaps.erase(before);
    }
  }
  if (after != slab.gaps.end() && offset + length == after->first) {
    length += after->second;
    slab.gaps.erase(after);
  }
  slab.gaps.emplace(offset, length);
}

void DeviceMemory::give_back(Block& block) {
  block.memory_ = cl::Buffer();
  block.slab_->used -= block.length_;
  add_gap(*block.slab_, block.offset_, block.length_);
  meter_.remove(block.asked_);
}

void DeviceMemory::drop(Slab& slab) {
  meter_.let_go(slab.bytes);
  if (workspace_ || !source_.release) return;  // released with the object
  cl_mem memory = slab.memory();
  clRetainMemObject(memory);  // the one reference that the hook is to release
  slab.memory = cl::Buffer();
  source_.release(memory);
}

void DeviceMemory::trim() {
  if (workspace_) return;
  auto first = std::stable_partition(slabs_.begin(), slabs_.end(), [](const auto& slab) { return slab->used != 0; });
  std::for_each(first, slabs_.end(), [&](auto& slab) { drop(*slab); });
  slabs_.erase(first, slabs_.end());
}

bool DeviceMemory::is_free(cl_mem memory, std::size_t begin, std::size_t end) const {
  for (const auto& slab : slabs_)
    if (slab->memory() == memory)
      return std::any_of(slab->gaps.begin(), slab->gaps.end(),
                         [&](const auto& gap) { return begin < gap.first + gap.second && gap.first < end; });
  return false;
}

bool DeviceMemory::holds(cl_mem memory) const {
  return std::any_of(slabs_.begin(), slabs_.end(), [&](const auto& slab) { return slab->memory() == memory; });
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
#include "device/workspace.hpp"

#include "device/runtime.hpp"
#include "device/told.hpp"

namespace gcdt::runtime {

Workspace::Workspace(const std::vector<cl::Buffer>& buffers) {
  for (const cl::Buffer& buffer : buffers) {
    const std::size_t bytes = size_of(buffer);
    slabs_.push_back({buffer, {{0, bytes}}});
    meter_.hold(bytes);
  }
}

DeviceMemory::Place Workspace::reserve(Runtime& runtime, const char* name, std::size_t bytes) {
  const std::size_t unit = runtime.alignment(), length = (bytes + unit - 1) / unit * unit;
  for (Slab& slab : slabs_) {
    auto best = slab.gaps.end();
    for (auto gap = slab.gaps.begin(); gap != slab.gaps.end(); ++gap)
      if (gap->second >= length && (best == slab.gaps.end() || gap->second < best->second)) best = gap;
    if (best == slab.gaps.end()) continue;
    const auto [offset, room] = *best;
    slab.gaps.erase(best);
    if (room > length) slab.gaps.emplace(offset + length, room - length);
    return {static_cast<std::size_t>(&slab - slabs_.data()), offset, length, {}, nullptr};
  }
  throw Error(Status::workspace_too_small,
              std::string("the workspace is too small: ") + name + " needs " + std::to_string(bytes) +
                  " bytes beside " + std::to_string(meter_.now) + " in use; it has " + std::to_string(meter_.held),
              {std::max(meter_.held, meter_.now) + length});
}

DeviceMemory::Place Workspace::find(Runtime& runtime, const char* name, std::size_t bytes) {
  Place place = reserve(runtime, name, bytes);
  const cl_int code = runtime.attempt("clCreateSubBuffer", name, [&] {
    const cl_buffer_region region = {place.offset, bytes};
    cl_int made;
    place.memory =
        cl::Buffer(clCreateSubBuffer(slabs_[place.holder].memory(), 0, CL_BUFFER_CREATE_TYPE_REGION, &region, &made));
    return made;
  });
  if (code != CL_SUCCESS) {
    give_back(place);
    runtime.fail("clCreateSubBuffer", name, code);
  }
  return place;
}

void Workspace::give_back(Place& place) {
  place.memory = cl::Buffer();
  auto& gaps = slabs_[place.holder].gaps;
  std::size_t offset = place.offset, length = place.length;
  auto after = gaps.lower_bound(offset);
  if (after != gaps.begin()) {
    const auto before = std::prev(after);
    if (before->first + before->second == offset) {
      offset = before->first;
      length += before->second;
      gaps.erase(before);
    }
  }
  if (after != gaps.end() && offset + length == after->first) {
    length += after->second;
    gaps.erase(after);
  }
  gaps.emplace(offset, length);
}

bool Workspace::is_free(cl_mem memory, std::size_t begin, std::size_t end) const {
  for (const Slab& slab : slabs_)
    if (slab.memory() == memory)
      return std::any_of(slab.gaps.begin(), slab.gaps.end(),
                         [&](const auto& gap) { return begin < gap.first + gap.second && gap.first < end; });
  return false;
}

bool Workspace::holds(cl_mem memory) const {
  return std::any_of(slabs_.begin(), slabs_.end(), [&](const Slab& slab) { return slab.memory() == memory; });
}

}  // namespace gcdt::runtime

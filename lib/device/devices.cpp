// SPDX-License-Identifier: Apache-2.0
// Lists OpenCL devices and chooses among them.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <set>

#include "device/runtime.hpp"
#include "device/told.hpp"

namespace gcdt::runtime {

// The library needs a compiler and OpenCL 1.2 ("OpenCL 1.2 ..."); a device that cannot even tell is
// left out, and hides no other.
bool usable(const cl::Device& device) {
  cl_bool available = CL_FALSE, compiler = CL_FALSE;
  cl_platform_id platform = nullptr;
  std::string version;
  const bool answered = device.getInfo(CL_DEVICE_AVAILABLE, &available) == CL_SUCCESS &&
                        device.getInfo(CL_DEVICE_COMPILER_AVAILABLE, &compiler) == CL_SUCCESS &&
                        device.getInfo(CL_DEVICE_PLATFORM, &platform) == CL_SUCCESS &&
                        device.getInfo(CL_DEVICE_VERSION, &version) == CL_SUCCESS;
  int major = 0, minor = 0;
  if (!answered || !available || !compiler || !platform ||
      std::sscanf(version.c_str(), "OpenCL %d.%d", &major, &minor) != 2)
    return false;
  return major > 1 || (major == 1 && minor >= 2);
}

cl::Device part_of(const cl::Device& device, std::uint32_t left) {
  const cl_uint units = told<CL_DEVICE_MAX_COMPUTE_UNITS>(device), kept = units > left ? units - left : 1;
  const cl_device_partition_property counts[] = {CL_DEVICE_PARTITION_BY_COUNTS, static_cast<cl_int>(kept),
                                                 CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
  std::vector<cl::Device> parts;
  cl::Device whole = device;
  if (kept >= units || whole.createSubDevices(counts, &parts) != CL_SUCCESS || parts.size() != 1) return device;
  return parts[0];
}

cl_uint compute_units_of_root(const cl::Device& device) {
  cl::Device root = device, parent;
  while (root.getInfo(CL_DEVICE_PARENT_DEVICE, &parent) == CL_SUCCESS && parent()) root = parent;
  return std::max<cl_uint>(1, told<CL_DEVICE_MAX_COMPUTE_UNITS>(root));
}

std::vector<cl::Device> all_devices() {
  // These calls return codes, they do not throw: no driver at all, or a platform that fails, only
  // leaves its list empty.
  std::vector<cl::Platform> platforms;
  cl::Platform::get(&platforms);
  std::vector<cl::Device> all;
  for (const auto& platform : platforms) {
    std::vector<cl::Device> of_platform;
    platform.getDevices(CL_DEVICE_TYPE_ALL, &of_platform);
    std::copy_if(of_platform.begin(), of_platform.end(), std::back_inserter(all), usable);
  }
  return all;
}

DeviceInfo describe(const cl::Device& device, const Tuning& tuning) {
  DeviceInfo info;
  auto text = [](std::string s) {
    s.erase(std::find(s.begin(), s.end(), '\0'), s.end());
    return s;
  };
  info.name = text(told<CL_DEVICE_NAME>(device));
  info.vendor = text(told<CL_DEVICE_VENDOR>(device));
  info.driver = text(told<CL_DRIVER_VERSION>(device));
  info.version = text(told<CL_DEVICE_VERSION>(device));
  info.platform = text(platform_name(device));
  const auto type = told<CL_DEVICE_TYPE>(device);
  info.is_gpu = type & CL_DEVICE_TYPE_GPU;
  info.is_cpu = !info.is_gpu && (type & CL_DEVICE_TYPE_CPU);  // a simulator may say that it is everything
  info.memory_bytes = told<CL_DEVICE_GLOBAL_MEM_SIZE>(device);
  info.largest_buffer_bytes = told<CL_DEVICE_MAX_MEM_ALLOC_SIZE>(device);
  info.local_bytes = told<CL_DEVICE_LOCAL_MEM_SIZE>(device);
  info.compute_units = told<CL_DEVICE_MAX_COMPUTE_UNITS>(device);
  info.largest_work_group = static_cast<std::uint32_t>(told<CL_DEVICE_MAX_WORK_GROUP_SIZE>(device));
  const std::string extensions = told<CL_DEVICE_EXTENSIONS>(device);
  auto has = [&](const char* name) { return extensions.find(name) != std::string::npos; };
  info.atomics64 = has("cl_khr_int64_base_atomics") && has("cl_khr_int64_extended_atomics");
  info.fp64 = has("cl_khr_fp64");
  info.subgroups = has("cl_khr_subgroups");
  if (tuning.memory_bytes) {
    info.memory_bytes = std::min(info.memory_bytes, *tuning.memory_bytes);
    info.largest_buffer_bytes = std::min(info.largest_buffer_bytes, *tuning.memory_bytes);
  }
  return info;
}

DeviceKind kind_of(const DeviceInfo& info, const Tuning& tuning) {
  if (tuning.kind) return *tuning.kind;
  if (info.is_gpu) return DeviceKind::gpu;
  if (!info.is_cpu) return DeviceKind::accelerator;
  return info.platform == "rusticl" || info.platform == "Clover" ? DeviceKind::lanes : DeviceKind::threads;
}

namespace {

std::vector<DeviceInfo> describe_all() {
  std::vector<DeviceInfo> all;
  for (const auto& device : all_devices()) all.push_back(describe(device));
  if (all.empty())
    throw Error(Status::no_device,
                "no OpenCL device found; on a CPU install PoCL (Debian, Ubuntu: apt install pocl-opencl-icd), for a "
                "GPU its vendor's OpenCL driver");
  return all;
}

std::string or_default(const std::string& spec) {
  if (!spec.empty()) return spec;
  const char* variable = std::getenv("GCDT_DEVICE");
  return variable && *variable ? variable : "auto";
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

bool is_number(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
}

bool has_name(const DeviceInfo& d, const std::string& part) {
  return lower(d.name + " " + d.platform).find(lower(part)) != std::string::npos;
}

[[noreturn]] void fail_to_choose(const std::vector<DeviceInfo>& all, const std::string& wanted) {
  std::string list;
  for (std::size_t i = 0; i < all.size(); ++i)
    list += "\n  " + std::to_string(i) + ": " + all[i].name + " (" + all[i].platform + ")";
  throw Error(Status::no_device, "no OpenCL device fits \"" + wanted + "\"; there are:" + list);
}

/// The devices that one word of a choice fits, at least one; of `auto` all GPUs, or one CPU, or whatever there is.
std::vector<std::size_t> fitting(const std::vector<DeviceInfo>& all, const std::string& wanted) {
  std::vector<std::size_t> found;
  const auto add = [&](auto&& fits) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (fits(all[i])) found.push_back(i);
  };
  const auto gpu = [](const DeviceInfo& d) { return d.is_gpu; };
  const auto cpu = [](const DeviceInfo& d) { return d.is_cpu; };
  if (wanted == "gpu" || wanted == "auto") {
    add(gpu);
  } else if (wanted == "cpu") {
    add(cpu);
  } else if (!is_number(wanted)) {
    add([&](const DeviceInfo& d) { return has_name(d, wanted); });
  } else if (!wanted.empty() && wanted.size() <= 9 && std::stoul(wanted) < all.size()) {
    found.push_back(std::stoul(wanted));
  }
  if (wanted == "auto" && found.empty()) {
    add(cpu);
    found.resize(1);
  }
  if (found.empty()) fail_to_choose(all, wanted);
  return found;
}

}  // namespace

std::vector<std::size_t> choose_devices(const std::string& spec) {
  const std::vector<DeviceInfo> all = describe_all();
  const std::string wanted = or_default(spec);
  std::set<std::size_t> chosen;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = wanted.find(',', begin);
    const std::string one = wanted.substr(begin, end == std::string::npos ? end : end - begin);
    std::vector<std::size_t> found(all.size());
    std::iota(found.begin(), found.end(), 0u);
    if (one != "all") found = fitting(all, one);
    chosen.insert(found.begin(), found.end());
  }
  return {chosen.begin(), chosen.end()};
}

std::size_t choose_device(const std::string& spec, bool* ambiguous) {
  const std::string wanted = or_default(spec);
  const std::vector<std::size_t> found = fitting(describe_all(), wanted);
  if (ambiguous) *ambiguous = found.size() > 1 && wanted != "auto" && wanted != "gpu" && wanted != "cpu";
  return found.front();
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
// What a program and the OpenCL layer beside it (call_layer.cpp) tell each other: which call is to fail, and which
// objects there are.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "said_by_layer.hpp"

namespace gcdt::test {

enum class Kind { context, queue, memory, program, kernel, event, count };
constexpr std::size_t kinds = static_cast<std::size_t>(Kind::count);
constexpr const char* kind_names[kinds] = {"contexts", "queues", "buffers", "programs", "kernels", "events"};

/// Objects that somebody holds a reference to.
struct Held {
  std::array<std::int64_t, kinds> objects{};
  std::uint64_t bytes = 0;  ///< of buffers

  std::int64_t of(Kind kind) const { return objects[static_cast<std::size_t>(kind)]; }
  bool operator==(const Held& other) const { return objects == other.objects && bytes == other.bytes; }
  std::string text() const {
    std::string all;
    for (std::size_t k = 0; k < kinds; ++k) all += std::to_string(objects[k]) + " " + kind_names[k] + ", ";
    return all + std::to_string(bytes) + " bytes";
  }
};

/// A function that was called, with how many errors are documented for it.
struct Called {
  const char* function;
  std::uint32_t errors;
};

/// Which call fails: of calls of this function the one of that number, from 1 on, which names the same place whatever
/// other threads call; with the documented error of that number, counted round.
struct Fault {
  std::string function;
  std::uint64_t occurrence = 0;
  std::uint32_t error = 0;
  bool lasting = false;  ///< so do all calls that follow, of every function
};

/// The layer's state. All members are guarded by `mutex`; programs use the functions.
class Calls {
 public:
  /// From now on calls are noted, and this one fails.
  void begin(Fault fault = {}) {
    const std::lock_guard<std::mutex> lock(mutex);
    counting_ = true;
    fault_ = std::move(fault);
    occurred_ = 0;
    called_.clear();
    failed_ = {nullptr, 0};
  }
  /// No call fails any more. Those that there were since begin().
  std::vector<Called> end() {
    const std::lock_guard<std::mutex> lock(mutex);
    counting_ = false;
    return called_;
  }
  /// The function that was made to fail, null if it has not been called so often, and with what.
  std::pair<const char*, std::int32_t> failed() {
    const std::lock_guard<std::mutex> lock(mutex);
    return failed_;
  }
  Held held() {
    const std::lock_guard<std::mutex> lock(mutex);
    return held_;
  }

  /// The layer's: whether this call fails, and with what.
  bool fails(const char* function, const std::int32_t* errors, std::uint32_t count, std::int32_t& code) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!counting_) return false;
    called_.push_back({function, count});
    const bool now = fault_.function == function && ++occurred_ == fault_.occurrence;
    if (!now && !(fault_.lasting && failed_.first)) return false;
    code = errors[fault_.error % count];
    if (now) failed_ = {function, code};
    return true;
  }
  void made(void* object, Kind kind, std::uint64_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex);
    objects_[object] = {kind, 1, bytes};
    ++held_.objects[static_cast<std::size_t>(kind)];
    held_.bytes += bytes;
  }
  /// Of those that are not the driver's own.
  void retained(void* object, int by) {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto found = objects_.find(object);
    if (found == objects_.end() || (found->second.references += by) > 0) return;
    --held_.objects[static_cast<std::size_t>(found->second.kind)];
    held_.bytes -= found->second.bytes;
    objects_.erase(found);
  }

 private:
  struct Object {
    Kind kind;
    int references;
    std::uint64_t bytes;
  };
  std::mutex mutex;
  bool counting_ = false;
  Fault fault_;
  std::uint64_t occurred_ = 0;  ///< calls of the fault's function
  std::vector<Called> called_;
  std::pair<const char*, std::int32_t> failed_{nullptr, 0};
  std::map<void*, Object> objects_;
  Held held_;
};

/// That of the layer in the file `layer`, which the loader must have loaded: call it after the first OpenCL call.
inline Calls& calls_of(const std::string& layer) { return said_by_layer<Calls>(layer, "gcdt_test_calls"); }

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
#include "device/built_programs.hpp"

#include <algorithm>
#include <system_error>

#include "device/runtime.hpp"

namespace gcdt::runtime {

const cl::Program& BuiltPrograms::get(const Key& key, unsigned most, const std::function<cl::Program()>& build) {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {  // ends: builds do
    const auto found = built_.find(key);
    if (found != built_.end()) return found->second;
    if (begun_.count(key) == 0 && begun_.size() < most) break;
    ended_.wait(lock);
  }
  begun_.insert(key);
  lock.unlock();
  cl::Program program;
  std::exception_ptr failed;
  try {
    program = build();
  } catch (...) {
    failed = std::current_exception();
  }
  lock.lock();
  begun_.erase(key);
  ended_.notify_all();
  if (failed) std::rethrow_exception(failed);
  return built_.emplace(key, std::move(program)).first->second;
}

bool BuiltPrograms::has(const Key& key) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return built_.count(key) != 0;
}

void BuiltPrograms::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  built_.clear();
}

SparedPrograms::SparedPrograms(Runtime& runtime, bool may) : runtime_(runtime) {
  // Every call has flips.
  runtime_.spares_ =
      may && runtime.kind() == DeviceKind::gpu && runtime.most_builds() > 1 && runtime.would_compile("flip");
}

SparedPrograms::~SparedPrograms() { runtime_.spares_ = false; }

Builders::Builders(Runtime& runtime, const std::vector<const char*>& programs) {
  if (runtime.most_builds() < 2) return;
  std::copy_if(programs.begin(), programs.end(), std::back_inserter(programs_),
               [&](const char* program) { return runtime.would_compile(program); });
  const std::size_t threads = std::min<std::size_t>(runtime.most_builds() - 1, programs_.size());
  threads_.reserve(threads);
  try {
    for (std::size_t i = 0; i < threads; ++i)
      threads_.emplace_back([this, &runtime] {
        for (std::size_t at; (at = next_++) < programs_.size();) {
          try {
            runtime.build(programs_[at]);
          } catch (...) {  // the launch that needs it says why
          }
        }
      });
  } catch (const std::system_error&) {  // the system has no more threads: those that there are do all
  }
}

Builders::~Builders() {
  next_ = programs_.size();
  for (std::thread& thread : threads_) thread.join();
}

}  // namespace gcdt::runtime

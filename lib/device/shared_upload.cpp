// SPDX-License-Identifier: Apache-2.0
#include "device/shared_upload.hpp"

#include <algorithm>
#include <cstring>
#include <exception>

namespace gcdt::runtime {

SharedUpload::~SharedUpload() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
    waiting_.clear();
  }
  begun_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

// Ends: each of those that are expected comes here, whatever becomes of its device.
std::size_t SharedUpload::join(Runtime& runtime) {
  std::exception_ptr failed;
  TransferChunks* chunks = nullptr;
  try {
    chunks = runtime.pinned_chunks();
    for (std::size_t i = 0; chunks && i < chunks->count(); ++i) chunks->take(i);  // what an earlier transfer has left
  } catch (...) {
    failed = std::current_exception();
  }
  std::unique_lock<std::mutex> lock(mutex_);
  if (chunks && (chunk_bytes_ == 0 || chunk_bytes_ == chunks->chunk_bytes())) {
    chunk_bytes_ = chunks->chunk_bytes();
    threads_ += runtime.tuning().copy_threads;
    for (std::size_t i = 0; i < chunks->count(); ++i) slots_.push_back({chunks->memory(i)});
    lent_.push_back(chunks->lend());
  } else {
    all_have_chunks_ = false;
  }
  if (!failed) ++active_;
  if (++joined_ == expected_) {
    if (!all_have_chunks_ || active_ < 2) slots_.clear();
    if (is_shared())
      begin_helpers();
    else
      give_back();
    ready_ = true;
    changed_.notify_all();
  }
  changed_.wait(lock, [&] { return ready_; });
  if (failed) std::rethrow_exception(failed);
  return slots_.size();
}

// The chunks are their devices' again.
void SharedUpload::give_back() {
  for (const auto& lent : lent_) *lent = false;
  lent_.clear();
}

void SharedUpload::wait_until_left() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return active_ == 0; });
}

// With more than half of the host's cores, threads were in each other's way (bench/NOTES.md, "Tiles").
void SharedUpload::begin_helpers() {
  const std::size_t half = cores_ / 2;
  const std::size_t count = std::max(std::min(threads_, half), active_) - active_;
  try {
    for (std::size_t i = 0; i < count; ++i) helpers_.emplace_back([this] { help(); });
  } catch (const std::exception&) {
    // There is no thread to be had: takers copy while they wait.
  }
}

// What it has not released, nobody waits for. What the last one, after an error, has begun and not sent may be being
// copied yet. Ends: a copy does, and no further one begins.
void SharedUpload::leave(std::size_t released) {
  std::unique_lock<std::mutex> lock(mutex_);
  for (Slot& slot : slots_)
    if (slot.part != none && slot.part >= released) --slot.users;
  if (active_ == 1) {
    waiting_.clear();
    changed_.wait(lock, [&] { return copying_ == 0; });
    give_back();
  }
  --active_;
  changed_.notify_all();
}

void SharedUpload::release(std::size_t part) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (--slots_[part % slots_.size()].users == 0) changed_.notify_all();
}

// Whoever comes first to a part has it copied. Ends: who waits here has released what the slot had; others that have
// not wait for no later part, so they come here, too, or leave.
void SharedUpload::assign(std::size_t part, const unsigned char* from, std::size_t bytes) {
  const std::size_t number = part % slots_.size();
  Slot& slot = slots_[number];
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return slot.part == part || slot.users == 0; });
    if (slot.part == part) return;
    slot.part = part, slot.filled = false, slot.users = active_;
    waiting_.push_back({number, from, bytes});
  }
  begun_.notify_one();
}

// What is not filled while nothing waits is being copied by somebody, who tells when it is done.
unsigned char* SharedUpload::filled(std::size_t part) {
  Slot& slot = slots_[part % slots_.size()];
  std::unique_lock<std::mutex> lock(mutex_);
  while (!slot.filled)
    if (waiting_.empty())
      changed_.wait(lock);
    else
      make_next(lock);
  return slot.memory;
}

void SharedUpload::help() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!over_)
    if (waiting_.empty())
      begun_.wait(lock);
    else
      make_next(lock);
}

void SharedUpload::make_next(std::unique_lock<std::mutex>& lock) {
  const Copy copy = waiting_.front();
  waiting_.pop_front();
  Slot& slot = slots_[copy.slot];
  ++copying_;
  lock.unlock();
  std::memcpy(slot.memory, copy.from, copy.bytes);
  lock.lock();
  --copying_;
  slot.filled = true;
  changed_.notify_all();
}

SharedUpload::Taker::Taker(SharedUpload& shared, Runtime& runtime) : shared_(shared), runtime_(runtime) {
  const std::size_t slots = shared.join(runtime);
  try {
    reads_.resize(slots);
  } catch (...) {
    shared.leave(0);
    throw;
  }
}

SharedUpload::Taker::~Taker() {
  if (straight_ || std::any_of(reads_.begin(), reads_.end(), [](const cl::Event& read) { return read() != nullptr; }))
    runtime_.attempt("clFinish", "shared chunks", [&] { return runtime_.try_finish(); });
  shared_.leave(released_);
}

void SharedUpload::Taker::begin(std::size_t part, const unsigned char* from, std::size_t bytes) {
  const std::size_t slots = reads_.size();
  cl::Event& read = reads_[part % slots];
  if (read()) {
    runtime_.wait(read);
    read = cl::Event();
    shared_.release(part - slots);
    released_ = part - slots + 1;
  }
  shared_.assign(part, from, bytes);
}

// A part is queued when half as many more have been begun as there are slots: threads copy those meanwhile.
void SharedUpload::Taker::write(cl_mem to, const void* from, std::size_t bytes) {
  if (runtime_.is_pinned(from, bytes)) {
    straight_ = true;
    runtime_.write_later(to, 0, from, bytes);
    return runtime_.flush();
  }
  if (!shared_.is_shared()) return runtime_.write_bytes(to, 0, from, bytes);
  const auto* const first = static_cast<const unsigned char*>(from);
  const std::size_t chunk = shared_.chunk_bytes_, parts = (bytes + chunk - 1) / chunk, ahead = reads_.size() / 2;
  const auto size = [&](std::size_t i) { return std::min(chunk, bytes - i * chunk); };
  const std::size_t begin_of_write = next_;
  for (std::size_t i = 0; i < parts + ahead; ++i) {
    if (i < parts) begin(begin_of_write + i, first + i * chunk, size(i)), ++next_;
    if (i < ahead) continue;
    const std::size_t part = begin_of_write + i - ahead;
    unsigned char* const memory = shared_.filled(part);
    reads_[part % reads_.size()] = runtime_.write_later(to, (i - ahead) * chunk, memory, size(i - ahead));
    runtime_.flush();
  }
}

}  // namespace gcdt::runtime

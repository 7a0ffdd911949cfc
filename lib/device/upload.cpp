// SPDX-License-Identifier: Apache-2.0
#include "device/upload.hpp"

#include <cstring>

namespace gcdt::runtime {

UploadChunks::UploadChunks(Runtime& runtime)
    : bytes_(prepares_host_memory(runtime) ? Tuning::gpu_upload_chunk : Tuning::cpu_upload_chunk) {
  if (prepares_host_memory(runtime)) mapped_.emplace(runtime, 2 * bytes_);
  if (mapped_ && !mapped_->get()) mapped_.reset();
  auto* memory = mapped_ ? mapped_->get() : plain_.make<unsigned char>(2 * bytes_);
  chunks_[0].memory = memory, chunks_[1].memory = memory + bytes_;
}

void Upload::append(const unsigned char* from, std::size_t bytes) {
  while (bytes > 0) {
    const auto [to, count] = room<unsigned char>(bytes);
    std::memcpy(to, from, count);
    from += count, bytes -= count;
  }
}

void Upload::send() {
  if (filled_ == 0) return;
  UploadChunks::Chunk& chunk = chunks_.chunks_[current_];
  if (chunks_.mapped_)
    runtime_.write_later(to_, sent_, chunk.memory, filled_, chunk.written);
  else
    runtime_.write_bytes(to_, sent_, chunk.memory, filled_);
  sent_ += filled_;
  filled_ = 0;
  current_ = 1 - current_;
}

// Waits until the current chunk is free. The write that still reads it may be one of an earlier upload.
void Upload::take() {
  const cl::Event written = std::exchange(chunks_.chunks_[current_].written, cl::Event());
  if (written()) runtime_.wait(written);
}

}  // namespace gcdt::runtime

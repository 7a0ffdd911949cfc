// SPDX-License-Identifier: Apache-2.0
#include "device/transfer_chunks.hpp"

#include <utility>

namespace gcdt::runtime {

TransferChunks::TransferChunks(Runtime& runtime, std::size_t count, std::size_t bytes, bool pinned)
    : runtime_(runtime), bytes_(bytes), under_way_(count), crew_(count) {
  if (pinned) mapped_.emplace(runtime, count * bytes);
  if (mapped_ && !mapped_->get()) mapped_.reset();
  memory_ = mapped_ ? mapped_->get() : plain_.make<unsigned char>(count * bytes);
}

void TransferChunks::take(std::size_t chunk) {
  const cl::Event last = std::exchange(under_way_[chunk], cl::Event());
  if (last()) runtime_.wait(last);
}

void TransferChunks::forget() {
  for (cl::Event& event : under_way_) event = cl::Event();
}

void TransferChunks::write(std::size_t chunk, cl_mem to, std::size_t offset, std::size_t bytes) {
  if (pinned())
    under_way_[chunk] = runtime_.write_later(to, offset, memory(chunk), bytes);
  else
    runtime_.write_at_once(to, offset, memory(chunk), bytes);
}

void TransferChunks::read(std::size_t chunk, cl_mem from, std::size_t offset, std::size_t bytes) {
  under_way_[chunk] = runtime_.read_later(from, offset, memory(chunk), bytes);
}

}  // namespace gcdt::runtime

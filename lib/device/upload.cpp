// SPDX-License-Identifier: Apache-2.0
#include "device/upload.hpp"

#include <algorithm>
#include <cstring>

#include "device/copy_crew.hpp"

namespace gcdt::runtime {

void Upload::append(const unsigned char* from, std::size_t bytes) {
  while (bytes > 0) {
    const auto [to, count] = room<unsigned char>(bytes);
    std::memcpy(to, from, count);
    from += count, bytes -= count;
  }
}

void Upload::send() {
  if (filled_ == 0) return;
  chunks_.write(current_, to_, sent_, filled_);
  sent_ += filled_;
  filled_ = 0;
  current_ = (current_ + 1) % chunks_.count();
}

// Part i goes through chunk i modulo their count. It is sent when `ahead` more have been begun, which the crew copies
// meanwhile; there are fewer of those than chunks, so what a chunk held has been sent when its turn comes again.
void write_through(TransferChunks& chunks, unsigned threads, cl_mem to, std::size_t offset, const unsigned char* from,
                   std::size_t bytes) {
  const CrewAtWork work(chunks.crew(), threads);
  CopyCrew& crew = work.crew;
  const std::size_t chunk = chunks.chunk_bytes(), parts = (bytes + chunk - 1) / chunk;
  const std::size_t ahead = crew.has_helpers() ? chunks.count() / 2 : 0;
  const auto size = [&](std::size_t part) { return std::min(chunk, bytes - part * chunk); };
  for (std::size_t i = 0; i < parts + ahead; ++i) {
    if (i < parts) {
      const std::size_t turn = i % chunks.count();
      chunks.take(turn);
      crew.begin(turn, {chunks.memory(turn), from + i * chunk, size(i), false});
    }
    if (i < ahead) continue;
    const std::size_t part = i - ahead, turn = part % chunks.count();
    crew.wait(turn);
    chunks.write(turn, to, offset + part * chunk, size(part));
    chunks.flush();
  }
}

}  // namespace gcdt::runtime

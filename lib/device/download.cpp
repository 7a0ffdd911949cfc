// SPDX-License-Identifier: Apache-2.0
#include "device/download.hpp"

#include <algorithm>
#include <deque>

#include "device/copy_crew.hpp"

namespace gcdt::runtime {

namespace {

/// What a chunk holds or will hold, and where it is to go.
struct Part {
  std::size_t turn;
  unsigned char* to;
  std::size_t bytes;
};

}  // namespace

// Parts go through the chunks by turns. At most `ahead` are left with the device when the next one's turn comes, fewer
// than there are chunks: so what its chunk held is with the crew by then, which the loop waits for.
void read_through(TransferChunks& chunks, unsigned threads, const std::vector<HostRead>& reads) {
  const CrewAtWork work(chunks.crew(), threads);
  CopyCrew& crew = work.crew;
  const std::size_t ahead = chunks.count() / 2;
  std::deque<Part> under_way;
  const auto land = [&] {
    const Part part = under_way.front();
    under_way.pop_front();
    chunks.take(part.turn);
    crew.begin(part.turn, {part.to, chunks.memory(part.turn), part.bytes, true});
    if (!crew.has_helpers()) crew.wait(part.turn);  // while the device goes on with the parts behind it
  };
  std::size_t turn = 0;
  for (const HostRead& read : reads)
    for (std::size_t at = 0; at < read.bytes; at += chunks.chunk_bytes()) {
      const std::size_t bytes = std::min(chunks.chunk_bytes(), read.bytes - at);
      crew.wait(turn);
      chunks.read(turn, read.from.handle, read.offset + at, bytes);
      under_way.push_back({turn, static_cast<unsigned char*>(read.to) + at, bytes});
      if (under_way.size() > ahead) land();
      turn = (turn + 1) % chunks.count();
    }
  while (!under_way.empty()) land();
  for (std::size_t i = 0; i < chunks.count(); ++i) crew.wait(i);
}

}  // namespace gcdt::runtime

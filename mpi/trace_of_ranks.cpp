// SPDX-License-Identifier: Apache-2.0
#include "trace_of_ranks.hpp"

#include <fmt/format.h>

#include <chrono>

namespace gcdt::ranks {

namespace {

void put_text(tiles::Packer& packer, const std::string& text) { packer.put(Span(text.data(), text.size())); }

std::string text_of(tiles::Unpacker& from) {
  std::vector<char> text;
  from.append_to(text);
  return {text.begin(), text.end()};
}

}  // namespace

TraceOfRanks::TraceOfRanks(MpiTeam& team) : team_(team) {
  team_.sum(0);  // no rank gets it before all have come
  origin_ = now();
}

std::uint64_t TraceOfRanks::now() {
  const auto time = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
}

void TraceOfRanks::add(const char* name, std::uint64_t begin) {
  TraceSpan span;
  span.phase = "rank", span.name = name;
  span.begin_ns = begin, span.end_ns = now();
  own_.sink()(span);
}

std::string TraceOfRanks::gathered() const {
  tiles::Packer packer;
  for (const TraceSpan& span : own_.spans()) {
    put_text(packer, span.device), put_text(packer, span.phase), put_text(packer, span.name);
    packer.put_one(span.device_number), packer.put_one(span.on_device);
    packer.put_one(span.begin_ns - origin_), packer.put_one(span.end_ns - origin_);
  }
  const std::vector<tiles::Bytes> messages = team_.gather(packer.take());
  if (!team_.is_first()) return {};
  command::TraceRecord all;
  const Trace sink = all.sink();
  for (std::size_t rank = 0; rank < messages.size(); ++rank) {
    tiles::Unpacker from(messages[rank]);
    std::vector<TraceSpan> spans;
    std::string own;  // the name of the rank's device, which its steps go without
    while (!from.at_end()) {
      TraceSpan span;
      span.device = text_of(from), span.phase = text_of(from), span.name = text_of(from);
      from.get_one(span.device_number), from.get_one(span.on_device);
      from.get_one(span.begin_ns), from.get_one(span.end_ns);
      if (span.device_number == 0 && own.empty()) own = span.device;
      spans.push_back(std::move(span));
    }
    for (TraceSpan& span : spans) {
      span.device = fmt::format("rank {}: {}", rank, span.device.empty() ? own : span.device);
      span.device_number = static_cast<std::uint32_t>(rank + messages.size() * span.device_number);
      sink(span);
    }
  }
  return all.json();
}

}  // namespace gcdt::ranks

// SPDX-License-Identifier: Apache-2.0
#include "tiles/spilled.hpp"

#include <atomic>
#include <cstring>

#include "tiles/indices.hpp"
#include "tiles/tiles.h"

namespace gcdt::tiles {

namespace {

using Key = std::array<std::uint64_t, 2>;

/// Calls use(begin, end, shift) for ranges of the final triangles `begin` to `end` - 1 that have one shift each. Ends:
/// each begins where the last one ended, and has a triangle.
template <class Use>
void for_runs(const Shifts& shifts, std::uint32_t begin, std::uint32_t end, Use&& use) {
  for (std::uint32_t r = begin; r < end;) {
    const std::uint32_t shift = shifts.at(r), next = std::min(end, shifts.end_of(shift));
    use(r, next, shift);
    r = next;
  }
}

/// Writes corners, or flags, to their places behind `to`; `from` begins with final triangle `begin`.
template <class T>
void place(const Shifts& shifts, const T* from, std::uint32_t begin, std::uint32_t end, T* to) {
  for_runs(shifts, begin, end, [&](std::uint32_t first, std::uint32_t next, std::uint32_t shift) {
    std::memcpy(to + first + shift, from + (first - begin), (next - first) * sizeof(T));
  });
}

/// The same of neighbours, which become places, from `first_place` on. Most have the triangle's own shift.
void place_neighbours(const Shifts& shifts, const Neighbours* from, std::uint32_t begin, std::uint32_t end,
                      std::uint32_t first_place, Neighbours* to) {
  for_runs(shifts, begin, end, [&](std::uint32_t first, std::uint32_t next, std::uint32_t shift) {
    const std::uint32_t least = shifts.begin_of(shift), most = shifts.end_of(shift);
    const auto place_of = [&](std::int32_t other) {
      if (other < 0) return -1;
      const auto r = static_cast<std::uint32_t>(other);
      if (r >= least && r < most) return static_cast<std::int32_t>(first_place + r + shift);
      if (r >= shifts.finals()) refuse("a final triangle has a neighbour that is not there");
      return static_cast<std::int32_t>(first_place + r + shifts.at(r));
    };
    for (std::uint32_t r = first; r < next; ++r) {
      const Neighbours& own = from[r - begin];
      to[r + shift] = {place_of(own[0]), place_of(own[1]), place_of(own[2])};
    }
  });
}

/// Finds how many final triangles come before each of the seam's. Both are in the order of their keys.
class BeforeFinder {
 public:
  BeforeFinder(const GridInput& input, const ToWrite& tile)
      : input_(input), tile_(tile), keys_(tile.places.make_keys()) {
    tile.before.assign(keys_.size(), tile.final.count);
  }

  /// For those of the seam's that come before the last triangle of the part, and not before an earlier part.
  void look_at(Span<Triangle> part, std::size_t first) {
    if (part.empty()) return;
    const auto begin = keys_.begin() + static_cast<std::ptrdiff_t>(found_);
    const auto count =
        static_cast<std::size_t>(std::upper_bound(begin, keys_.end(), key_of(part[part.size() - 1])) - begin);
    for_each_in_threads(
        count,
        [&](std::size_t i) {
          const auto [least, most] = range_of(keys_[found_ + i][0]);
          const auto* begin_of_range = part.begin() + (std::clamp(least, first, first + part.size()) - first);
          const auto* end_of_range = part.begin() + (std::clamp(most, first, first + part.size()) - first);
          const auto* at = std::lower_bound(begin_of_range, end_of_range, keys_[found_ + i],
                                            [&](const Triangle& t, const Key& wanted) { return key_of(t) < wanted; });
          tile_.before[found_ + i] = static_cast<std::uint32_t>(first + static_cast<std::size_t>(at - part.begin()));
        },
        256);
    found_ += count;
  }

 private:
  Key key_of(const Triangle& t) const { return {code_of(input_.at(t[0])), code_of(input_.at(t[1]))}; }

  /// Of the final triangles, those before `first` come before what has such a code, and those from `second` on do not:
  /// few are between, whose vertices must be looked up.
  std::pair<std::size_t, std::size_t> range_of(std::uint64_t code) const {
    const Array<cl_ulong>& codes = tile_.final.codes;
    const auto [from, to] = std::equal_range(codes.begin(), codes.end(), code);
    const auto before = static_cast<std::size_t>(from - codes.begin());
    return {before == 0 ? 0 : (before - 1) * GCDT_TILE_STEP + 1,
            std::min<std::size_t>(tile_.final.count, static_cast<std::size_t>(to - codes.begin()) * GCDT_TILE_STEP)};
  }

  const GridInput& input_;
  const ToWrite& tile_;
  const SeamKeys keys_;
  std::size_t found_ = 0;
};

/// Tiles in memory. Those in the result's arrays go up there, block by block: a block is read as a whole, and written
/// when all blocks behind it have been read that lie where it goes.
class Mover {
 public:
  void add(const ToWrite& tile) {
    tiles_.push_back({tile, Shifts(tile.before, tile.final.count)});
    for (std::uint32_t begin = 0; begin < tile.final.count; begin += of_block)
      blocks_.push_back({tiles_.size() - 1, begin, std::min(tile.final.count, begin + of_block)});
  }

  /// Threads take the blocks from the last one on. Ends: a thread waits for blocks behind its own alone, which threads
  /// took earlier, and which are read without waiting for anything.
  void run() {
    const Parts parts(blocks_.size(), 1);
    is_read_ = std::vector<std::atomic<bool>>(blocks_.size());
    std::vector<Buffer> buffers(parts.size());  // nothing is allocated by threads that others wait for
    std::atomic<std::size_t> taken{0};
    parts.run([&](std::size_t part, std::size_t, std::size_t) {
      for (std::size_t i; (i = taken++) < blocks_.size();) move(blocks_.size() - 1 - i, buffers[part]);
    });
  }

 private:
  static constexpr std::uint32_t of_block = 1u << 15;  // triangles: what a core has room for in its cache
  struct Moved {
    ToWrite tile;
    Shifts shifts;
  };
  struct Block {
    std::size_t tile;
    std::uint32_t begin, end;  ///< final triangles
  };
  struct Buffer {
    Array<Triangle> triangles = Array<Triangle>(of_block);
    Array<Neighbours> neighbours = Array<Neighbours>(of_block);
    Array<std::uint8_t> constrained = Array<std::uint8_t>(of_block);
  };

  const Triangle* source_of(const Block& block) const {
    return tiles_[block.tile].tile.final.berth().triangles + block.begin;
  }

  void move(std::size_t number, Buffer& buffer) {
    const Block& block = blocks_[number];
    const auto& [tile, shifts] = tiles_[block.tile];
    const Berth from = tile.final.berth().from(block.begin);
    const std::size_t count = block.end - block.begin;
    std::memcpy(buffer.triangles.data(), from.triangles, count * sizeof(Triangle));
    std::memcpy(buffer.neighbours.data(), from.neighbours, count * sizeof(Neighbours));
    std::memcpy(buffer.constrained.data(), from.constrained, count);
    is_read_[number].store(true, std::memory_order_release);
    const Triangle* const end = tile.to.triangles + block.end + shifts.at(block.end - 1);
    for (std::size_t i = number + 1; i < blocks_.size() && std::less<>()(source_of(blocks_[i]), end); ++i)
      while (!is_read_[i].load(std::memory_order_acquire)) std::this_thread::yield();
    place(shifts, buffer.triangles.data(), block.begin, block.end, tile.to.triangles);
    place_neighbours(shifts, buffer.neighbours.data(), block.begin, block.end, tile.places.first, tile.to.neighbours);
    place(shifts, buffer.constrained.data(), block.begin, block.end, tile.to.constrained);
  }

  std::vector<Moved> tiles_;
  std::vector<Block> blocks_;  ///< of tiles in the result's arrays as they lie there
  std::vector<std::atomic<bool>> is_read_;
};

/// A tile in a file, array by array.
void write_from_file(const GridInput& input, const ToWrite& tile) {
  const auto in_threads = [](std::size_t first, std::size_t count, const auto& use) {
    Parts(count, 1u << 15).run([&](std::size_t, std::size_t from, std::size_t to) {
      use(static_cast<std::uint32_t>(first + from), static_cast<std::uint32_t>(first + to));
    });
  };
  Spill& file = *tile.final.file();
  BeforeFinder finder(input, tile);
  file.take<Triangle>([&](Span<Triangle> part, std::size_t first) {
    finder.look_at(part, first);
    const Shifts shifts(tile.before, tile.final.count);  // as far as the part goes
    in_threads(first, part.size(), [&](std::uint32_t begin, std::uint32_t end) {
      place(shifts, part.data() + (begin - first), begin, end, tile.to.triangles);
    });
  });
  const Shifts shifts(tile.before, tile.final.count);
  file.take<Neighbours>([&](Span<Neighbours> part, std::size_t first) {
    in_threads(first, part.size(), [&](std::uint32_t begin, std::uint32_t end) {
      place_neighbours(shifts, part.data() + (begin - first), begin, end, tile.places.first, tile.to.neighbours);
    });
  });
  file.take<std::uint8_t>([&](Span<std::uint8_t> part, std::size_t first) {
    in_threads(first, part.size(), [&](std::uint32_t begin, std::uint32_t end) {
      place(shifts, part.data() + (begin - first), begin, end, tile.to.constrained);
    });
  });
}

}  // namespace

Shifts::Shifts(const std::vector<std::uint32_t>& before, std::uint32_t finals) : before_(before), finals_(finals) {
  check_before(before, finals);
  const std::size_t buckets = finals / of_bucket + 1;
  firsts_.reserve(buckets + 1);
  std::size_t i = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    while (i < before.size() && before[i] < bucket * of_bucket) ++i;
    firsts_.push_back(static_cast<std::uint32_t>(i));
  }
  firsts_.push_back(static_cast<std::uint32_t>(before.size()));
}

void write_spilled(const GridInput& input, const std::vector<ToWrite>& tiles) {
  Mover in_result, others;
  for (const ToWrite& tile : tiles) {
    if (tile.final.file()) continue;
    BeforeFinder(input, tile).look_at({tile.final.berth().triangles, tile.final.count}, 0);
    (tile.final.is_in_result() ? in_result : others).add(tile);
  }
  // What is elsewhere may go to where others wait.
  in_result.run();
  others.run();
  for (const ToWrite& tile : tiles) {
    if (tile.final.file()) write_from_file(input, tile);
    tile.final.release();
  }
}

}  // namespace gcdt::tiles

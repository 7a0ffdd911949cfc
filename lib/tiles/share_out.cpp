// SPDX-License-Identifier: Apache-2.0
#include "tiles/share_out.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "device/step.hpp"
#include "phases/clean.hpp"
#include "phases/triangulation.hpp"
#include "tiles/indices.hpp"
#include "tiles/read_back.hpp"

namespace gcdt::tiles {

using runtime::Buffer;
using runtime::over;

namespace {

/// What a device needs at once for a constraint of a block, while it looks for open ones: ends, codes, and a flag.
constexpr std::uint64_t bytes_looked_at = 8 + 16 + 4;
/// The part of a device's memory that this may take.
constexpr std::uint64_t part_for_blocks = 4;
constexpr std::uint32_t no_vertex = ~std::uint32_t{0};

/// Constraints of a block at least that are looked at by themselves, where there is no room for more.
constexpr std::size_t least_looked_at = 1024;

using BlockPart = StagedConstraints::Part;

/// Of parts of blocks, by one device.
class OpenFinder {
 public:
  OpenFinder(DevicePool::Lent& lent, Staged& staged, StagedConstraints& constraints, const GridInput& input,
             const Cuts& cuts)
      : lent_(lent), runtime_(lent.runtime), staged_(staged), constraints_(constraints), input_(input), cuts_(cuts) {}

  /// Appends to `found` those of each part, which follow each other. The vertices go by chunk by chunk, once for all of
  /// the parts. Where there is no room for all at once, they are halved: first the list, then what it has. Ends: down
  /// to least_looked_at there are fewer constraints each time; below, what is thrown is.
  void find(const std::vector<BlockPart>& parts, std::vector<std::vector<OpenConstraint>>& found) {
    try {
      look(parts, found);
    } catch (const Error& error) {
      if (error.status() != Status::out_of_memory) throw;
      forget();
      const auto [first, rest] = halves_of(parts);
      if (rest.empty()) throw;
      runtime_.memory().trim();
      find(first, found);
      find(rest, found);
    }
  }
  void forget() { looked_.clear(); }

 private:
  struct Looked {
    std::shared_ptr<const StagedConstraints::Block> block;
    Buffer<cl_ulong2> codes;
  };

  /// The second one is empty if there is nothing to be halved.
  static std::array<std::vector<BlockPart>, 2> halves_of(const std::vector<BlockPart>& parts) {
    const auto middle = parts.begin() + static_cast<std::ptrdiff_t>((parts.size() + 1) / 2);
    if (parts.size() > 1) return {std::vector<BlockPart>(parts.begin(), middle), {middle, parts.end()}};
    const auto [block, first, count] = parts.front();
    if (count <= least_looked_at) return {parts, {}};
    return {std::vector<BlockPart>{{block, first, count / 2}}, {{block, first + count / 2, count - count / 2}}};
  }

  /// All or nothing is appended.
  void look(const std::vector<BlockPart>& parts, std::vector<std::vector<OpenConstraint>>& found) {
    forget();
    if (!first_codes_.allocated()) first_codes_ = runtime_.upload("first codes of tiles", cuts_.first_codes());
    for (const BlockPart& part : parts) {
      const auto block = constraints_.part(lent_, part);
      looked_.push_back({block, runtime_.allocate<cl_ulong2>("codes of ends", block->count)});
    }
    staged_.for_chunks(
        lent_, [&](const InputPoints& points, std::size_t number) { take_codes(points, input_.chosen, number); });
    if (!input_.added.empty())
      take_codes(stage(runtime_, Points::pairs(input_.added[0].data(), input_.added.size())),
                 fixed_grid(FixedGrid{0, 0, "1"}), input_.given.count);
    std::vector<std::vector<OpenConstraint>> open;
    for (const Looked& one : looked_) open.push_back(open_of(one));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      std::vector<OpenConstraint>& all = found[parts[i].block];
      all.insert(all.end(), open[i].begin(), open[i].end());
    }
    forget();
  }

  void take_codes(const InputPoints& points, const ChosenGrid& chosen, std::size_t number) {
    const Codes codes = codes_on(runtime_, points, chosen);
    for (const Looked& one : looked_)
      runtime_.launch("tiles", "share_codes", over(2 * std::size_t{one.block->count}), 2 * one.block->count,
                      static_cast<cl_uint>(number), points.n, one.block->ends, codes.codes, one.codes);
  }

  std::vector<OpenConstraint> open_of(const Looked& one) {
    const cl_uint count = one.block->count;
    const auto before = runtime_.allocate<cl_uint>("open constraints before", std::size_t{count} + 1);
    runtime_.launch("tiles", "share_open", over(count), count, static_cast<cl_uint>(input_.n()),
                    static_cast<cl_uint>(cuts_.first_codes().size()), first_codes_, one.block->ends, one.codes, before);
    const cl_uint open = lent_.primitives.scan_total(before, count);
    if (open > count) refuse("a device has counted more open constraints than there are");
    if (open == 0) return {};
    const auto places = runtime_.allocate<cl_uint>("open constraints", open);
    const auto where = runtime_.allocate<cl_int4>("points of open constraints", open);
    const auto begin = static_cast<cl_uint>(one.block->first);
    runtime_.launch("tiles", "share_list_open", over(count), count, begin, before, one.codes, places, where);
    const auto numbers = read_all_of<std::uint32_t>(runtime_, places, open);
    const auto points = read_all_of<std::array<GridPoint, 2>>(runtime_, where, open);
    check_each(open, "an open constraint is none of the input", [&](std::size_t i) {
      return numbers[i] >= begin && numbers[i] - begin < count && (i == 0 || numbers[i - 1] < numbers[i]) &&
             points[i][0][0] >= 0 && points[i][0][1] >= 0 && points[i][1][0] >= 0 && points[i][1][1] >= 0;
    });
    std::vector<OpenConstraint> made(open);
    for (std::size_t i = 0; i < open; ++i) made[i] = {numbers[i], input_.constraints.ends[numbers[i]], points[i]};
    return made;
  }

  DevicePool::Lent& lent_;
  runtime::Runtime& runtime_;
  Staged& staged_;
  StagedConstraints& constraints_;
  const GridInput& input_;
  const Cuts& cuts_;
  Buffer<cl_ulong> first_codes_;
  std::vector<Looked> looked_;
};

/// Takes blocks until there are none, and as many at once as there is room for where the vertices must be sent again
/// for each time. Ends: each time there are fewer.
void find_some(DevicePool::Lent& lent, Staged& staged, StagedConstraints& constraints, const GridInput& input,
               const Cuts& cuts, const std::vector<std::size_t>& wanted, std::atomic<std::size_t>& next,
               std::vector<std::vector<OpenConstraint>>& found, std::vector<char>& is_found) {
  Step looking(lent.runtime, "share");
  const auto blocks_at_once = [&]() -> std::size_t {
    if (staged.keeps(lent.device)) return 1;
    const std::uint64_t bytes = bytes_looked_at * constraints.of_block();
    return static_cast<std::size_t>(std::max<std::uint64_t>(1, lent.capacity / part_for_blocks / bytes));
  };
  OpenFinder finder(lent, staged, constraints, input, cuts);
  for (;;) {
    const std::size_t at_once = blocks_at_once(), first = next.fetch_add(at_once);
    if (first >= wanted.size()) break;
    std::vector<BlockPart> parts;
    for (std::size_t i = first; i < std::min(first + at_once, wanted.size()); ++i) {
      parts.push_back(constraints.all_of(wanted[i]));
      found[wanted[i]].clear();  // what a device that was lost has left
    }
    try {
      finder.find(parts, found);
    } catch (const Error& error) {
      if (error.status() != Status::out_of_memory || !staged.keeps(lent.device)) throw;
      staged.leave(lent.device);
      constraints.leave(lent.device);
      finder.forget();
      lent.runtime.memory().trim();
      for (const BlockPart& part : parts) found[part.block].clear();
      finder.find(parts, found);
    }
    for (const BlockPart& part : parts) is_found[part.block] = 1;
  }
  looking.end();
}

}  // namespace

StagedConstraints::StagedConstraints(const DevicePool& pool, const Staged& staged, const GridInput& input,
                                     const std::vector<Role>& roles, std::size_t tiles, std::size_t most)
    : staged_(staged),
      ends_(input.constraints.ends),
      roles_(roles),
      count_(input.constraints.size()),
      keeps_(pool.size(), 0),
      blocks_(pool.size()) {
  const std::uint64_t capacity = pool.least_capacity(), m = count_, n = input.n();
  of_block_ =
      std::min(most, std::max<std::size_t>(capacity / Tuning::part_of_constraint_block, Tuning::least_tile_chunk));
  // As many for each device.
  of_block_ = std::min(of_block_, std::max(count_ / pool.size() + 1, Tuning::least_tile_chunk));
  const std::uint64_t all = 16 * n + 8 * m;
  for (std::size_t device = 0; device < keeps_.size(); ++device)
    keeps_[device] = staged.keeps(device) && all + forest_bytes(1, n / tiles, m / tiles) < capacity;
  for (auto& own : blocks_) own.resize(blocks());
}

std::shared_ptr<const StagedConstraints::Block> StagedConstraints::block(DevicePool::Lent& lent, std::size_t number) {
  std::shared_ptr<const Block>& kept = blocks_[lent.device][number];
  if (kept) return kept;
  const auto block = made(lent, all_of(number));
  if (keeps(lent.device)) kept = block;
  return block;
}

std::shared_ptr<const StagedConstraints::Block> StagedConstraints::part(DevicePool::Lent& lent, const Part& part) {
  return part.count == all_of(part.block).count ? block(lent, part.block) : made(lent, part);
}

void StagedConstraints::send(DevicePool::Lent& lent, runtime::SharedUpload::Taker& taker) {
  if (!roles_.empty() || !keeps(lent.device)) return;
  Step sending(lent.runtime, "share");
  try {
    for (std::size_t i = 0; i < blocks(); ++i) {
      const Part all = all_of(i);
      auto block = std::make_shared<Block>();
      block->first = all.first, block->count = static_cast<cl_uint>(all.count);
      block->ends = lent.runtime.allocate<cl_uint2>("constraints", all.count);
      taker.write(block->ends.handle(), ends_.data() + all.first, all.count * sizeof(Constraint));
      blocks_[lent.device][i] = std::move(block);
    }
  } catch (const Error& error) {
    if (error.status() != Status::out_of_memory) throw;
    lent.runtime.attempt("clFinish", "after an error", [&] { return lent.runtime.try_finish(); });
    leave(lent.device);
  }
  sending.end();
}

std::shared_ptr<const StagedConstraints::Block> StagedConstraints::made(DevicePool::Lent& lent,
                                                                        const Part& part) const {
  auto made = std::make_shared<Block>();
  made->first = part.first, made->count = static_cast<cl_uint>(part.count);
  if (roles_.empty()) {
    made->ends = stage(lent.runtime, Constraints(ends_.data() + part.first, part.count));
  } else {
    Array<Constraint> some(part.count);
    for_each_in_threads(part.count, [&](std::size_t i) {
      some[i] = roles_[part.first + i] == Role::any ? ends_[part.first + i] : Constraint{no_vertex, no_vertex};
    });
    made->ends = stage(lent.runtime, Constraints(some.data(), part.count));
  }
  return made;
}

void StagedConstraints::leave(std::size_t device) {
  for (auto& block : blocks_[device]) block.reset();
  keeps_[device] = 0;
}

std::uint64_t StagedConstraints::bytes_to_come(std::size_t device) const {
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; keeps(device) && i < blocks(); ++i)
    if (!blocks_[device][i]) bytes += all_of(i).count * sizeof(Constraint);
  return bytes;
}

std::vector<OpenConstraint> find_open(DevicePool& pool, Staged& staged, StagedConstraints& constraints,
                                      const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles) {
  std::vector<std::vector<OpenConstraint>> found(constraints.blocks());
  std::vector<char> is_found(found.size(), 0);  // each by the thread that finds it
  // Ends: each time that some have not been found, a device is lost.
  for (;;) {
    std::vector<std::size_t> wanted;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (!is_found[i]) wanted.push_back(i);
    if (wanted.empty()) break;
    std::atomic<std::size_t> next{0};
    pool.on_each(DevicePool::Who::gpus, [&](DevicePool::Lent& lent) {
      find_some(lent, staged, constraints, input, cuts, wanted, next, found, is_found);
    });
  }
  std::vector<OpenConstraint> open;
  for (const auto& some : found) open.insert(open.end(), some.begin(), some.end());
  const std::size_t by_box = open.size();
  for (std::size_t c = 0; c < roles.size(); ++c)
    if (roles[c] == Role::wide)
      open.push_back(
          {static_cast<std::uint32_t>(c), input.constraints.ends[c], {input.end_of(c, 0), input.end_of(c, 1)}});
  std::inplace_merge(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(by_box), open.end(),
                     [](const OpenConstraint& a, const OpenConstraint& b) { return a.number < b.number; });
  return open;
}

}  // namespace gcdt::tiles

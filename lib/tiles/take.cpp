// SPDX-License-Identifier: Apache-2.0
#include "tiles/take.hpp"

#include "phases/maxima.hpp"
#include "tiles/indices.hpp"

namespace gcdt::tiles {

using runtime::over;
using runtime::Runtime;

namespace {

class Taker {
 public:
  Taker(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile)
      : lent_(lent),
        runtime_(lent.runtime),
        primitives_(lent.primitives),
        input_(task.input),
        staged_(task.staged),
        constraints_(task.constraints),
        share_(share),
        codes_(task.cuts.codes_of(tile)),
        box_(task.cuts.box_of(tile)) {
    const std::size_t n = input_.n(), expected = n / task.cuts.tiles();
    taken_.points.coordinates = runtime_.allocate<cl_ulong>("coordinates of a tile", 0);
    taken_.ids = runtime_.allocate<cl_uint>("input numbers of a tile", 0);
    reserve(std::min(n, expected + expected / 8 + Tuning::least_tile_chunk));
  }

  Taken take() {
    staged_.for_chunks(lent_,
                       [&](const InputPoints& points, std::size_t first) { take_chunk(points, input_.chosen, first); });
    number();
    if (!input_.added.empty()) {
      take_chunk(stage(runtime_, Points::pairs(input_.added[0].data(), input_.added.size())),
                 fixed_grid(FixedGrid{0, 0, "1"}), input_.given.count);
    }
    taken_.own = taken_.all;
    if (constraints_ && taken_.own > 0) take_constraints();
    add_foreign();
    taken_.points.n = taken_.all;
    taken_.points.type = GCDT_COORDINATES_INT32;
    taken_.points.coordinates.shrink(taken_.all);
    taken_.ids.shrink(taken_.all);
    return std::move(taken_);
  }

 private:
  void take_chunk(const InputPoints& points, const ChosenGrid& chosen, std::size_t first_id) {
    if (!box_) return;
    const cl_uint count = points.n;
    const auto before = runtime_.allocate<cl_uint>("own vertices before", std::size_t{count} + 1);
    const auto codes = runtime_.allocate<cl_ulong>("codes of own vertices", count);
    code_own(points, chosen, before, codes);
    const cl_uint found = primitives_.scan_total(before, count);
    if (found > count) refuse("a device has counted more vertices of a tile than there are");
    if (found == 0) return;
    const std::size_t needed = std::size_t{taken_.all} + found;
    if (needed > taken_.ids.size()) reserve(std::min<std::size_t>(input_.n(), std::max(needed, 2 * taken_.ids.size())));
    runtime_.launch("take", "take_own", over(count), count, static_cast<cl_uint>(first_id), taken_.all, codes, before,
                    taken_.points.coordinates, taken_.ids);
    taken_.all += found;
  }

  /// Flags of the tile's own among the points, and their codes; the tile has a box.
  void code_own(const InputPoints& points, const ChosenGrid& chosen, const runtime::Buffer<cl_uint>& flags,
                const runtime::Buffer<cl_ulong>& codes) {
    const KeyBox keys = keys_of(chosen, *box_);
    const cl_ulong4 near = {{keys.least[0], keys.most[0], keys.least[1], keys.most[1]}};
    if (chosen.decimals) {
      const auto decimals = runtime_.upload_one("decimals", *chosen.decimals);
      return runtime_.launch("take", "take_decimals", over(points.n), points.n, points.type, points.coordinates,
                             decimals, near, cl_ulong{codes_[0]}, cl_ulong{codes_[1]}, flags, codes);
    }
    const auto scale = runtime_.upload_one("scale", chosen.scale);
    Maxima moves(runtime_, points.n, 1);
    runtime_.launch("take", "take_codes", moves.groups, points.n, points.type, points.coordinates, scale, near,
                    cl_ulong{codes_[0]}, cl_ulong{codes_[1]}, moves.rows, flags, codes, moves.table, moves.memory);
    taken_.move_key = std::max<std::uint64_t>(taken_.move_key, moves.read(runtime_)[0]);
  }

  /// Vertices have their places among those that the process has as numbers, and get those of the input.
  void number() {
    const Span<std::uint32_t> numbers = input_.given.numbers;
    if (numbers.empty() || taken_.all == 0) return;
    taken_.ids.shrink(taken_.all);
    taken_.ids = numbers_at(runtime_, taken_.ids, numbers, staged_.of_chunk());
  }

  void take_constraints() {
    const auto m = static_cast<std::size_t>(input_.constraints.size());
    reserve_constraints(std::min<std::size_t>(m, share_.expected + share_.expected / 8 + Tuning::least_tile_chunk));
    for (std::size_t number = 0; number < constraints_->blocks(); ++number) {
      const auto block = constraints_->block(lent_, number);
      const cl_uint count = block->count;
      const auto ends = runtime_.allocate<cl_uint2>("ends as vertices of a tile", count);
      const auto before = runtime_.allocate<cl_uint>("constraints of a tile before", std::size_t{count} + 1);
      runtime_.launch("tiles", "share_own", over(count), count, taken_.own, cl_ulong{codes_[0]}, cl_ulong{codes_[1]},
                      taken_.ids, taken_.points.coordinates, block->ends, ends, before);
      const cl_uint found = primitives_.scan_total(before, count);
      if (found > count) refuse("a device has counted more constraints of a tile than there are");
      const std::size_t needed = std::size_t{taken_.constraint_count} + found;
      if (needed > taken_.constraints.size())
        reserve_constraints(std::min(m, std::max(needed, 2 * taken_.constraints.size())));
      runtime_.launch("tiles", "share_take", over(count), count, static_cast<cl_uint>(block->first),
                      taken_.constraint_count, before, ends, taken_.constraints, taken_.constraint_places);
      taken_.constraint_count += found;
    }
    taken_.constraints.shrink(taken_.constraint_count);
    taken_.constraint_places.shrink(taken_.constraint_count);
  }

  /// Room for so many of the tile's constraints; what is there stays.
  void reserve_constraints(std::size_t room) {
    auto constraints = runtime_.allocate<cl_uint2>("constraints of a tile", room);
    auto places = runtime_.allocate<cl_uint>("places of a tile's constraints", room);
    if (taken_.constraint_count > 0) {
      runtime_.copy(taken_.constraints, constraints, taken_.constraint_count);
      runtime_.copy(taken_.constraint_places, places, taken_.constraint_count);
    }
    taken_.constraints = std::move(constraints);
    taken_.constraint_places = std::move(places);
  }

  /// Room for so many of its own vertices, and all foreign ones; what is there stays.
  void reserve(std::size_t own) {
    const std::size_t room = own + share_.foreign.size();
    auto coordinates = runtime_.allocate<cl_ulong>("coordinates of a tile", room);
    auto ids = runtime_.allocate<cl_uint>("input numbers of a tile", room);
    runtime_.copy(taken_.points.coordinates, coordinates, taken_.all);
    runtime_.copy(taken_.ids, ids, taken_.all);
    taken_.points.coordinates = std::move(coordinates);
    taken_.ids = std::move(ids);
  }

  void add_foreign() {
    if (share_.foreign.empty() || taken_.own == 0) return;
    std::vector<cl_ulong> points;
    std::vector<std::uint32_t> numbers;
    for (const auto& [vertex, p] : share_.foreign) {
      points.push_back(static_cast<std::uint32_t>(p[0]) | std::uint64_t{static_cast<std::uint32_t>(p[1])} << 32);
      numbers.push_back(vertex);
    }
    if (taken_.all + points.size() > taken_.ids.size()) reserve(taken_.all);
    runtime_.write(taken_.points.coordinates, points.data(), points.size(), taken_.all);
    runtime_.write(taken_.ids, numbers.data(), points.size(), taken_.all);
    taken_.all += static_cast<cl_uint>(points.size());
  }

  DevicePool::Lent& lent_;
  Runtime& runtime_;
  Primitives& primitives_;
  const GridInput& input_;
  Staged& staged_;
  StagedConstraints* const constraints_;
  const Share& share_;
  const std::array<std::uint64_t, 2> codes_;
  const std::optional<Box> box_;  ///< around all that may be the tile's
  Taken taken_;
};

}  // namespace

runtime::Buffer<cl_uint> numbers_at(Runtime& runtime, const runtime::Buffer<cl_uint>& places,
                                    Span<std::uint32_t> numbers, std::size_t at_once) {
  const auto count = static_cast<cl_uint>(places.size());
  auto found = runtime.filled<cl_uint>("numbers of places", count, ~cl_uint{0});
  for (std::size_t first = 0; first < numbers.size() && count > 0; first += at_once) {
    const std::size_t some = std::min(at_once, numbers.size() - first);
    const auto part = runtime.upload("numbers in turn", numbers.data() + first, some);
    runtime.launch("tiles", "share_numbers", over(count), count, static_cast<cl_uint>(first),
                   static_cast<cl_uint>(some), places, part, found);
  }
  return found;
}

Taken take(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile) {
  return Taker(lent, task, share, tile).take();
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/staged.hpp"

#include <algorithm>
#include <mutex>

#include "device/parts.hpp"
#include "device/step.hpp"
#include "phases/triangulation.hpp"
#include "tiles/placed.hpp"

namespace gcdt::tiles {

namespace {

using Surveyed = std::array<cl_ulong, GCDT_SURVEY_COLUMNS>;

template <std::size_t N>
void raise(std::array<cl_ulong, N>& most, const std::array<cl_ulong, N>& found) {
  for (std::size_t i = 0; i < N; ++i) most[i] = std::max(most[i], found[i]);
}

}  // namespace

Staged::Staged(DevicePool& pool, Points points, std::size_t tiles)
    : pool_(pool), points_(points), keeps_(pool.size(), 0), chunks_(pool.size()) {
  const std::uint64_t capacity = pool.least_capacity(), n = points.size();
  vertices_of_chunk_ =
      std::clamp<std::size_t>(capacity / Tuning::part_of_tile_chunk, Tuning::least_tile_chunk, Tuning::most_tile_chunk);
  const std::uint64_t all = 8 * n * words_per_vertex(points.type());
  for (std::size_t device = 0; device < keeps_.size(); ++device)
    keeps_[device] = all + forest_bytes(1, n / std::max<std::size_t>(tiles, 1), 0) < capacity;
}

void Staged::for_chunks(DevicePool::Lent& lent,
                        const std::function<void(const InputPoints& points, std::size_t first)>& use) {
  use_chunks(lent, nullptr, use);
}

void Staged::use_chunks(DevicePool::Lent& lent, Taker* taker,
                        const std::function<void(const InputPoints& points, std::size_t first)>& use) {
  std::vector<InputPoints>& kept = chunks_[lent.device];
  const auto n = static_cast<std::size_t>(points_.size());
  if (keeps_[lent.device] && kept.empty()) {  // all before any is used, which would be waited for with the link idle
    std::vector<InputPoints> sent;
    for (std::size_t first = 0; first < n; first += vertices_of_chunk_) sent.push_back(send(lent, taker, first));
    kept = std::move(sent);
  }
  for (std::size_t first = 0, i = 0; first < n; first += vertices_of_chunk_, ++i)
    if (i < kept.size())
      use(kept[i], first);
    else
      use(send(lent, taker, first), first);
}

InputPoints Staged::send(DevicePool::Lent& lent, Taker* taker, std::size_t first) const {
  const auto n = static_cast<std::size_t>(points_.size());
  const Points points = part_of(points_.type(), points_.data(), first, std::min(vertices_of_chunk_, n - first));
  if (!taker) return stage(lent.runtime, points);
  InputPoints chunk;
  chunk.n = static_cast<cl_uint>(points.size());
  chunk.type = coordinates_type(points.type());
  chunk.coordinates = lent.runtime.allocate<cl_ulong>("coordinates", points.size() * words_per_vertex(points.type()));
  taker->write(chunk.coordinates.handle(), points.data(), chunk.coordinates.bytes());
  return chunk;
}

std::uint64_t Staged::bytes_to_come(std::size_t device) const {
  return keeps_[device] && chunks_[device].empty() ? 8 * points_.size() * words_per_vertex(points_.type()) : 0;
}

void Staged::leave(std::size_t device) {
  chunks_[device].clear();
  keeps_[device] = 0;
}

// Ends: every time that no device has looked at all chunks, one is lost. Devices that look at the same time are sent
// the chunks from one copy; one that has to begin again is sent them by itself. Returns as soon as one has looked.
template <class Columns, class Look>
Columns Staged::look(Team& team, const Behind& behind, Look&& look_at_chunk) {
  struct Found {
    std::mutex mutex;
    std::promise<Columns> promise;
    bool told = false;
    void tell(const Columns& columns) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!told) promise.set_value(columns);
      told = true;
    }
  };
  const auto found = std::make_shared<Found>();
  std::future<Columns> columns = found->promise.get_future();
  const auto one = [this, found, look_at_chunk](DevicePool::Lent& lent, runtime::SharedUpload& shared,
                                                std::optional<Taker>& taker) {
    Step looking(lent.runtime, "survey");
    Columns most{};
    const auto all_chunks = [&] {
      use_chunks(lent, taker ? &*taker : nullptr, [&](const InputPoints& points, std::size_t first) {
        raise(most, look_at_chunk(lent.runtime, points, first));
      });
    };
    try {
      all_chunks();
    } catch (const Error& error) {
      if (error.status() != Status::out_of_memory || !keeps(lent.device)) throw;
      taker.reset();
      shared.wait_until_left();  // until then others use the device's chunks
      leave(lent.device);
      lent.runtime.memory().trim();
      all_chunks();
    }
    looking.end();
    found->tell(most);
  };
  settle();
  sending_ = begin_in_thread([this, found, one, behind] {
    try {
      while (!found->told) {
        runtime::SharedUpload shared(pool_.count_of(DevicePool::Who::gpus));
        pool_.on_each(DevicePool::Who::gpus, [&](DevicePool::Lent& lent) {
          std::optional<Taker> taker(std::in_place, shared, lent.runtime);
          one(lent, shared, taker);
          if (behind && taker) behind(lent, *taker);
        });
      }
    } catch (...) {
      if (found->told) throw;
      found->promise.set_exception(std::current_exception());
    }
  });
  if (!behind || sending_.wait_for(std::chrono::seconds(0)) == std::future_status::deferred) settle();
  Columns all = columns.get();
  team.raise(all.data(), all.size());
  return all;
}

void Staged::rest() const {
  if (sending_.valid()) sending_.wait();
}

void Staged::settle() {
  if (sending_.valid()) sending_.get();
}

ChosenGrid Staged::choose(const std::optional<FixedGrid>& fixed, Survey& surveyed, std::uint64_t first_of_rank,
                          Team& team, const Behind& behind) {
  std::optional<ChosenGrid> given;
  if (fixed) given = fixed_grid(*fixed);
  if (team.sum(points_.size()) == 0) return given ? *given : ChosenGrid();
  const Surveyed found = look<Surveyed>(
      team, behind, [first_of_rank](runtime::Runtime& runtime, const InputPoints& points, std::size_t first) {
        Surveyed columns = survey_maxima(runtime, points);
        // Complements: the least is greatest.
        if (columns[GCDT_SURVEY_BAD] != 0) columns[GCDT_SURVEY_BAD] -= 2 * (first_of_rank + first);
        return columns;
      });
  if (found[GCDT_SURVEY_BAD] != 0) throw survey_error(coordinates_type(points_.type()), ~found[GCDT_SURVEY_BAD]);
  surveyed = survey_of(found.data());
  if (given) return *given;
  const GridChoice choice = choose_grid(surveyed);
  const int limit = choice.decimals_limit;
  if (limit < 0) return choice.grid;
  if (team.sum(some_need_more(points_, limit) ? 1 : 0) > 0) return choice.with_decimals(limit + 1);
  using Digits = std::array<cl_ulong, 1>;
  const Digits digits =
      look<Digits>(team, {}, [limit](runtime::Runtime& runtime, const InputPoints& points, std::size_t) {
        return Digits{static_cast<cl_ulong>(count_decimals(runtime, points, limit))};
      });
  return choice.with_decimals(static_cast<int>(digits[0]));
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/input_exchange.hpp"

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

// Vertices and constraints that a rank sends at once, so that messages do not take as much memory as the input.
constexpr std::size_t of_round = std::size_t{1} << 22;

using Point = std::array<double, 2>;

/// Things for each rank, in their order: a counting sort by parts. A part's thread counts in an array of its own
/// making, since one beside another thread's would go to and fro between caches.
class ByRank {
 public:
  /// Thing i is for rank_of(i).
  template <class RankOf>
  ByRank(std::size_t count, std::size_t ranks, RankOf&& rank_of)
      : parts_(count), before_(parts_.size()), counts_(ranks, 0) {
    parts_.run([&](std::size_t part, std::size_t first, std::size_t end) {
      std::vector<std::size_t> own(ranks, 0);
      for (std::size_t i = first; i < end; ++i) ++own[rank_of(i)];
      before_[part] = std::move(own);
    });
    for (std::vector<std::size_t>& part : before_)
      for (std::size_t rank = 0; rank < ranks; ++rank) {
        const std::size_t some = part[rank];
        part[rank] = counts_[rank];
        counts_[rank] += some;
      }
  }
  /// How many are for each rank.
  const std::vector<std::size_t>& counts() const { return counts_; }
  /// Calls use(i, rank, place) for each thing, in threads; `place` is among those of its rank.
  template <class RankOf, class Use>
  void for_each(RankOf&& rank_of, Use&& use) const {
    parts_.run([&](std::size_t part, std::size_t first, std::size_t end) {
      std::vector<std::size_t> next = before_[part];
      for (std::size_t i = first; i < end; ++i) {
        const std::size_t rank = rank_of(i);
        use(i, rank, next[rank]++);
      }
    });
  }

 private:
  const Parts parts_;
  std::vector<std::vector<std::size_t>> before_;  ///< by part and rank
  std::vector<std::size_t> counts_;
};

template <class T>
void put_at(Bytes& bytes, std::size_t place, const T& value) {
  std::memcpy(bytes.data() + place * sizeof(T), &value, sizeof(T));
}
template <class T>
T get_at(const Bytes& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place * sizeof(T), sizeof(T));
  return value;
}

/// Some of a rank's vertices for each rank, in their order: points, then numbers.
class VertexMessages {
 public:
  VertexMessages(const GridInput& block, const Array<std::uint16_t>& rank_of, std::size_t ranks)
      : block_(block), rank_of_(rank_of), ranks_(ranks) {}

  std::vector<Bytes> of(std::size_t first, std::size_t end) const {
    const auto rank_of = [&](std::size_t i) { return std::size_t{rank_of_[first + i]}; };
    const ByRank by_rank(end - first, ranks_, rank_of);
    const std::vector<std::size_t>& counts = by_rank.counts();
    std::vector<Bytes> messages(ranks_);
    for (std::size_t rank = 0; rank < ranks_; ++rank) messages[rank].resize(counts[rank] * bytes_of_vertex);
    const auto* given = static_cast<const Point*>(block_.given.points.data());
    by_rank.for_each(rank_of, [&](std::size_t i, std::size_t rank, std::size_t place) {
      const auto number = static_cast<std::uint32_t>(block_.given.first + first + i);
      std::memcpy(messages[rank].data() + place * sizeof(Point), given + first + i, sizeof(Point));
      std::memcpy(messages[rank].data() + counts[rank] * sizeof(Point) + place * sizeof number, &number, sizeof number);
    });
    return messages;
  }

  static constexpr std::size_t bytes_of_vertex = sizeof(Point) + sizeof(std::uint32_t);

 private:
  const GridInput& block_;
  const Array<std::uint16_t>& rank_of_;
  const std::size_t ranks_;
};

std::uint64_t rounds_of(Team& team, std::size_t own) { return team.greatest((own + of_round - 1) / of_round); }

/// Asks other ranks for a value of each of `count` numbers: rank_of(i) has that of number_of(i), and answers with
/// answer(number); the value goes to take(i, value).
template <class T, class NumberOf, class RankOf, class Answer, class Take>
void ask(Team& team, std::size_t count, NumberOf&& number_of, RankOf&& rank_of, Answer&& answer, Take&& take) {
  const ByRank by_rank(count, team.size(), rank_of);
  std::vector<Bytes> messages(team.size());
  for (std::size_t rank = 0; rank < team.size(); ++rank)
    messages[rank].resize(by_rank.counts()[rank] * sizeof(std::uint32_t));
  by_rank.for_each(rank_of, [&](std::size_t i, std::size_t rank, std::size_t place) {
    put_at<std::uint32_t>(messages[rank], place, number_of(i));
  });
  std::vector<Bytes> answers;
  for (const Bytes& message : team.exchange(std::move(messages))) {
    const std::size_t wanted = message.size() / sizeof(std::uint32_t);
    Bytes values(wanted * sizeof(T));
    for_each_in_threads(wanted,
                        [&](std::size_t i) { put_at<T>(values, i, answer(get_at<std::uint32_t>(message, i))); });
    answers.push_back(std::move(values));
  }
  answers = team.exchange(std::move(answers));
  for (std::size_t rank = 0; rank < team.size(); ++rank)
    if (answers[rank].size() != by_rank.counts()[rank] * sizeof(T))
      throw Error(Status::check_failed, "tiles: a rank has not answered all that it was asked for");
  by_rank.for_each(
      rank_of, [&](std::size_t i, std::size_t rank, std::size_t place) { take(i, get_at<T>(answers[rank], place)); });
}

}  // namespace

OwnVertices exchange_vertices(Team& team, const GridInput& block, const Cuts& cuts) {
  const std::size_t count = block.given.points.size(), each = cuts.tiles() / team.size();
  Array<std::uint16_t> rank_of(count);
  for_each_in_threads(count, [&](std::size_t i) {
    rank_of[i] = static_cast<std::uint16_t>(cuts.tile_of(code_of(block.at_place(i))) / each);
  });
  // How many come from each rank: those of a rank follow each other, as its numbers do.
  std::vector<std::uint64_t> counts(team.size() * team.size(), 0);
  const ByRank by_rank(count, team.size(), [&](std::size_t i) { return std::size_t{rank_of[i]}; });
  for (std::size_t rank = 0; rank < team.size(); ++rank)
    counts[rank * team.size() + team.rank()] = by_rank.counts()[rank];
  team.raise(counts.data(), counts.size());
  std::vector<std::size_t> place(team.size() + 1, 0);
  for (std::size_t rank = 0; rank < team.size(); ++rank)
    place[rank + 1] = place[rank] + static_cast<std::size_t>(counts[team.rank() * team.size() + rank]);
  OwnVertices own;
  own.vertices.resize(place.back());
  own.numbers.resize(place.back());
  const VertexMessages messages(block, rank_of, team.size());
  const std::uint64_t rounds = rounds_of(team, count);
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const std::size_t first = std::min(count, static_cast<std::size_t>(round) * of_round),
                      end = std::min(count, first + of_round);
    const std::vector<Bytes> got = team.exchange(messages.of(first, end));
    for_each_in_threads(
        got.size(),
        [&](std::size_t rank) {
          const std::size_t some = got[rank].size() / VertexMessages::bytes_of_vertex;
          if (some == 0) return;
          std::memcpy(&own.vertices[place[rank]], got[rank].data(), some * sizeof(Point));
          std::memcpy(&own.numbers[place[rank]], got[rank].data() + some * sizeof(Point), some * sizeof(std::uint32_t));
          place[rank] += some;
        },
        1);
  }
  return own;
}

Array<std::array<GridPoint, 2>> end_points(Team& team, const GridInput& block) {
  const Constraints constraints = block.constraints.ends;
  Array<std::array<GridPoint, 2>> points(constraints.size());
  const std::uint64_t rounds = rounds_of(team, constraints.size());
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const std::size_t first = std::min(constraints.size(), static_cast<std::size_t>(round) * of_round),
                      end = std::min(constraints.size(), first + of_round);
    const auto end_at = [&](std::size_t i) { return constraints[first + i / 2][i % 2]; };
    ask<GridPoint>(
        team, 2 * (end - first), end_at,
        [&](std::size_t i) { return rank_of_part(block.given.count, end_at(i), team.size()); },
        [&](std::uint32_t v) { return block.at(v); },
        [&](std::size_t i, const GridPoint& point) { points[first + i / 2][i % 2] = point; });
  }
  return points;
}

Array<std::array<double, 2>> coordinates_of(Team& team, const RankResult& rank, const std::vector<Wanted>& wanted) {
  const std::size_t each = rank.cuts.tiles() / team.size();
  const GivenVertices given{Points(rank.own.vertices), 0, rank.own.numbers, 0};
  Array<Point> found(wanted.size());
  ask<Point>(
      team, wanted.size(), [&](std::size_t i) { return wanted[i].number; },
      [&](std::size_t i) { return rank.cuts.tile_of(code_of(wanted[i].point)) / each; },
      [&](std::uint32_t v) { return rank.own.vertices[given.place_of(v)]; },
      [&](std::size_t i, const Point& point) { found[i] = point; });
  return found;
}

}  // namespace gcdt::tiles

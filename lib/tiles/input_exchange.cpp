// SPDX-License-Identifier: Apache-2.0
#include "tiles/input_exchange.hpp"

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

// Vertices and constraints that a rank sends at once, so that messages do not take as much memory as the input.
constexpr std::size_t of_round = std::size_t{1} << 22;

using Point = std::array<double, 2>;

/// Some of a rank's vertices for each rank, in their order: a counting sort by parts.
class VertexMessages {
 public:
  VertexMessages(const GridInput& block, const Array<std::uint16_t>& rank_of, std::size_t ranks)
      : block_(block), rank_of_(rank_of), ranks_(ranks) {}

  std::vector<Bytes> of(std::size_t first, std::size_t end) const {
    const Parts parts(end - first);
    std::vector<std::vector<std::size_t>> at(parts.size(), std::vector<std::size_t>(ranks_, 0));
    parts.run([&](std::size_t part, std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) ++at[part][rank_of_[first + i]];
    });
    std::vector<Bytes> messages(ranks_);
    std::vector<std::size_t> counts(ranks_, 0);
    for (std::size_t rank = 0; rank < ranks_; ++rank) {
      for (std::vector<std::size_t>& part : at) {
        const std::size_t count = part[rank];
        part[rank] = counts[rank];
        counts[rank] += count;
      }
      messages[rank].resize(counts[rank] * bytes_of_vertex);
    }
    const auto* given = static_cast<const Point*>(block_.given.points.data());
    parts.run([&](std::size_t part, std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const std::size_t rank = rank_of_[first + i], place = at[part][rank]++;
        const auto number = static_cast<std::uint32_t>(block_.given.first + first + i);
        std::memcpy(messages[rank].data() + place * sizeof(Point), given + first + i, sizeof(Point));
        std::memcpy(messages[rank].data() + counts[rank] * sizeof(Point) + place * sizeof number, &number,
                    sizeof number);
      }
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

/// Asks other ranks for a value of each number: `rank_of(i)` has that of numbers[i], and answers with answer(number).
template <class T, class RankOf, class Answer>
std::vector<T> ask(Team& team, const std::vector<std::uint32_t>& numbers, RankOf&& rank_of, Answer&& answer) {
  std::vector<std::vector<std::uint32_t>> asked(team.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) asked[rank_of(i)].push_back(numbers[i]);
  std::vector<Bytes> messages;
  for (const std::vector<std::uint32_t>& some : asked) {
    Packer packer;
    packer.put(some);
    messages.push_back(packer.take());
  }
  std::vector<Bytes> answers;
  for (const Bytes& message : team.exchange(std::move(messages))) {
    std::vector<std::uint32_t> wanted;
    Unpacker(message).append_to(wanted);
    std::vector<T> values(wanted.size());
    for_each_in_threads(wanted.size(), [&](std::size_t i) { values[i] = answer(wanted[i]); });
    Packer packer;
    packer.put(values);
    answers.push_back(packer.take());
  }
  std::vector<std::vector<T>> got(team.size());
  answers = team.exchange(std::move(answers));
  for (std::size_t rank = 0; rank < team.size(); ++rank) Unpacker(answers[rank]).append_to(got[rank]);
  std::vector<T> values(numbers.size());
  std::vector<std::size_t> next(team.size(), 0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t rank = rank_of(i);
    values[i] = got[rank].at(next[rank]++);
  }
  return values;
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
  for (const std::uint16_t rank : rank_of) ++counts[rank * team.size() + team.rank()];
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
    std::vector<std::uint32_t> ends;
    for (std::size_t c = first; c < end; ++c) ends.insert(ends.end(), constraints[c].begin(), constraints[c].end());
    const std::vector<GridPoint> found = ask<GridPoint>(
        team, ends, [&](std::size_t i) { return rank_of_part(block.given.count, ends[i], team.size()); },
        [&](std::uint32_t v) { return block.at(v); });
    for (std::size_t i = 0; i < found.size(); ++i) points[first + i / 2][i % 2] = found[i];
  }
  return points;
}

Array<std::array<double, 2>> coordinates_of(Team& team, const RankResult& rank, const std::vector<Wanted>& wanted) {
  std::vector<std::uint32_t> numbers;
  for (const Wanted& one : wanted) numbers.push_back(one.number);
  const std::size_t each = rank.cuts.tiles() / team.size();
  const GivenVertices given{Points(rank.own.vertices), 0, rank.own.numbers, 0};
  const std::vector<Point> found = ask<Point>(
      team, numbers, [&](std::size_t i) { return rank.cuts.tile_of(code_of(wanted[i].point)) / each; },
      [&](std::uint32_t v) { return rank.own.vertices[given.place_of(v)]; });
  return {found.begin(), found.end()};
}

}  // namespace gcdt::tiles

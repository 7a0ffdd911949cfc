// SPDX-License-Identifier: Apache-2.0
// The processes that share one problem, and what they say to each other.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include <gcdt/types.hpp>

namespace gcdt::tiles {

using Bytes = Array<unsigned char>;

/// Processes, called ranks, which call the same functions in the same order. The first one has the seam. This class is
/// a process by itself, which has nothing to say; other classes carry messages.
class Team {
 public:
  Team() = default;
  Team(const Team&) = delete;
  virtual ~Team() = default;

  virtual std::size_t rank() const { return 0; }
  virtual std::size_t size() const { return 1; }
  bool is_first() const { return rank() == 0; }
  bool is_alone() const { return size() == 1; }

  /// Takes what this rank has for each; returns what each has for this one.
  virtual std::vector<Bytes> exchange(std::vector<Bytes> for_each) { return for_each; }
  /// At the first rank what each has; at others nothing.
  virtual std::vector<Bytes> gather(Bytes own) {
    std::vector<Bytes> all(1);
    all[0] = std::move(own);
    return all;
  }
  /// What the first rank has for this one; it alone has something to give.
  virtual Bytes scatter(std::vector<Bytes> for_each) { return std::move(for_each.at(0)); }
  /// What the first rank has.
  virtual Bytes broadcast(Bytes of_first) { return of_first; }
  /// Makes each number the greatest that a rank has there.
  virtual void raise(std::uint64_t*, std::size_t) {}
  /// Makes each number the sum of all ranks'.
  virtual void add(std::uint64_t*, std::size_t) {}

  std::uint64_t greatest(std::uint64_t own) {
    raise(&own, 1);
    return own;
  }
  std::uint64_t sum(std::uint64_t own) {
    add(&own, 1);
    return own;
  }
};

/// Where a rank's part of so many things begins, if they are shared out evenly.
inline std::uint64_t begin_of_part(std::uint64_t count, std::size_t rank, std::size_t ranks) {
  return count / ranks * rank + std::min<std::uint64_t>(count % ranks, rank);
}
/// Whose part one of them is.
inline std::size_t rank_of_part(std::uint64_t count, std::uint64_t number, std::size_t ranks) {
  const std::uint64_t each = count / ranks, longer = count % ranks;  // these many parts have one more
  if (number < longer * (each + 1)) return static_cast<std::size_t>(number / (each + 1));
  return static_cast<std::size_t>(longer + (number - longer * (each + 1)) / each);
}

/// Puts arrays into a message, one after the other.
class Packer {
 public:
  template <class T>
  void put(Span<T> values) {
    const std::uint64_t count = values.size();
    append(&count, sizeof count);
    append(values.data(), count * sizeof(T));
  }
  template <class T, class Allocator>
  void put(const std::vector<T, Allocator>& values) {
    put(Span<T>(values));
  }
  template <class T>
  void put_one(const T& value) {
    append(&value, sizeof value);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count);
    if (count > 0) std::memcpy(bytes_.data() + at, data, count);
  }
  Bytes bytes_;
};

/// Takes them out again. A message that is too short throws check_failed.
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes) {}
  template <class T>
  void get_one(T& value) {
    copy(&value, sizeof value);
  }
  /// Behind what `values` has.
  template <class T, class Allocator>
  void append_to(std::vector<T, Allocator>& values) {
    std::uint64_t count = 0;
    get_one(count);
    if (count > (bytes_.size() - at_) / sizeof(T)) fail();
    const std::size_t before = values.size();
    values.resize(before + count);
    copy(values.data() + before, count * sizeof(T));
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  [[noreturn]] static void fail() { throw Error(Status::check_failed, "tiles: a message between ranks is too short"); }
  void copy(void* to, std::size_t count) {
    if (count > bytes_.size() - at_) fail();
    if (count > 0) std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
  }
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Makes `values` those of the first rank.
template <class T, class Allocator>
void broadcast(Team& team, std::vector<T, Allocator>& values) {
  if (team.is_alone()) return;
  Packer packer;
  if (team.is_first()) packer.put(values);
  const Bytes bytes = team.broadcast(packer.take());
  values.clear();
  Unpacker(bytes).append_to(values);
}

/// At the first rank the values of all, rank after rank; at others nothing.
template <class T, class Allocator>
void gather(Team& team, std::vector<T, Allocator>& values) {
  if (team.is_alone()) return;
  Packer packer;
  packer.put(values);
  values.clear();
  for (const Bytes& bytes : team.gather(packer.take())) Unpacker(bytes).append_to(values);
}

}  // namespace gcdt::tiles

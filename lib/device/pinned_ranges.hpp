// SPDX-License-Identifier: Apache-2.0
// Which host memory a driver has pinned.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

namespace gcdt::runtime {

/// Host memory that devices read and write by themselves, as far as is known. All functions may be called by any
/// thread.
class PinnedRanges {
 public:
  void add(const void* first, std::size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ranges_.push_back({static_cast<const unsigned char*>(first), bytes});
  }
  /// Takes back one add() of these bytes.
  void remove(const void* first, std::size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(ranges_.begin(), ranges_.end(),
                                    [&](const Range& range) { return range.first == first && range.bytes == bytes; });
    if (found != ranges_.end()) ranges_.erase(found);
  }
  /// Whether all of the bytes lie in one range.
  bool contains(const void* first, std::size_t bytes) const {
    const auto* const wanted = static_cast<const unsigned char*>(first);
    const std::less_equal<const unsigned char*> not_after;
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::any_of(ranges_.begin(), ranges_.end(), [&](const Range& range) {
      return bytes <= range.bytes && not_after(range.first, wanted) &&
             not_after(wanted, range.first + (range.bytes - bytes));
    });
  }

 private:
  struct Range {
    const unsigned char* first;
    std::size_t bytes;
  };
  mutable std::mutex mutex_;
  std::vector<Range> ranges_;  ///< few
};

/// A range that is known as long as the object lives.
class KnownPinned {
 public:
  KnownPinned(PinnedRanges& ranges, const void* first, std::size_t bytes)
      : ranges_(ranges), first_(first), bytes_(bytes) {
    ranges_.add(first_, bytes_);
  }
  KnownPinned(const KnownPinned&) = delete;
  KnownPinned& operator=(const KnownPinned&) = delete;
  ~KnownPinned() { ranges_.remove(first_, bytes_); }

 private:
  PinnedRanges& ranges_;
  const void* first_;
  std::size_t bytes_;
};

}  // namespace gcdt::runtime

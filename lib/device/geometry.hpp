// SPDX-License-Identifier: Apache-2.0
// How many work-items a launch wants, and in which groups it gets them.
#pragma once

#include <cstddef>

namespace gcdt::runtime {

enum class Groups {
  usual,
  wide,  ///< for kernels whose groups share much local memory
  one,   ///< exactly one, for kernels that loop with barriers
  item,  ///< exactly one, of one work-item
};

/// How many work-items a launch wants. Kernels loop with the global size as stride, so any launch
/// is right for any count; this only chooses the parallelism.
struct Range {
  std::size_t items = 1;
  bool large_items = false;  ///< each is worth a work-item of its own, even where these are contiguous shares
  Groups groups = Groups::usual;
};
inline Range over(std::size_t items) { return {items}; }
inline Range over_large(std::size_t items) { return {items, true}; }
inline Range one_group() { return {1, false, Groups::one}; }
inline Range one_item() { return {1, false, Groups::item}; }

/// Launch geometry; tests change it to shake the schedule.
struct Geometry {
  std::size_t local = 0;       ///< work-items of a group
  std::size_t max_groups = 0;  ///< groups of a launch at most
  std::size_t single = 0;      ///< work-items of a group that is alone (Groups::one); 0: as `local`
  std::size_t share = 0;       ///< items that are worth a work-item; 0: one (Range::large_items)
  /// Items of a work-item at most, of large ones one, however many groups that takes; 0: any number.
  std::size_t most_items = 0;
  std::size_t wide = 0;        ///< work-items of a wide group (Groups::wide); 0: as `local`
  std::size_t row_groups = 0;  ///< groups of kernels that keep tables of rows; 0: as `max_groups`
};

/// An argument of a kernel: local memory of each work-group.
struct LocalMemory {
  std::size_t bytes = 0;
};

}  // namespace gcdt::runtime

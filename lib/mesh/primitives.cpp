// SPDX-License-Identifier: Apache-2.0
// Launches the kernels of primitives*.cl, sort*.cl and buckets.cl.
#include "mesh/primitives.hpp"

#include <algorithm>

#include "sort/sizes.h"

namespace gcdt {

using runtime::Buffer;

namespace {
// Elements of a part at least: of a GPU's sort one tile.
constexpr std::size_t sort_span_group = GCDT_SORT_LANES * GCDT_SORT_WIDTH;
// On lanes a work-item may have 65535 rounds in all, and end without a word: it walks so many elements at most, and
// adds up the sums of so many parts (scan_serial).
constexpr std::size_t longest_walk = 60000, most_parts_of_lanes = 5000;
constexpr std::size_t most_elements = std::size_t{1} << 31;

// Scratch that is exchanged with a caller's buffer must leave the caller its capacity, not more.
template <class T>
void match(runtime::Runtime& runtime, Buffer<T>& scratch, const char* name, std::size_t size) {
  if (scratch.allocated() && scratch.size() == size) return;
  scratch = Buffer<T>();
  scratch = runtime.allocate<T>(name, size);
}
}  // namespace

Primitives::Partition Primitives::partition(std::size_t count, std::size_t least_span) const {
  if (count > most_elements) throw Error(Status::invalid_argument, "scan and sort take at most 2^31 elements");
  const std::size_t units = std::max<std::size_t>(runtime_.info().compute_units, 1);
  const std::size_t most_parts =
      units * (walk_ == Walk::serial ? Tuning::cpu_scan_parts_per_unit : Tuning::gpu_scan_parts_per_unit);
  const std::size_t even_span = std::max(least_span, (count + most_parts - 1) / most_parts);
  const std::size_t span = walk_ == Walk::serial ? std::min(even_span, longest_walk) : even_span;
  const std::size_t parts = std::max<std::size_t>((count + span - 1) / span, 1);
  if (runtime_.kind() == DeviceKind::lanes && walk_ == Walk::serial && parts > most_parts_of_lanes)
    throw Error(Status::device_failed,
                runtime_.info().name + " may end loops after 65535 rounds: it scans and sorts at most " +
                    std::to_string(longest_walk * most_parts_of_lanes) + " elements, not " + std::to_string(count));
  return {static_cast<cl_uint>(count), static_cast<cl_uint>(span), static_cast<cl_uint>(parts),
          runtime_.over_groups(parts)};
}

std::size_t Primitives::most_merged() const {
  return runtime_.spares_programs() ? most_elements : runtime_.tuning().most_merged;
}

void Primitives::exclusive_scan(const Buffer<cl_uint>& in, const Buffer<cl_uint>& out, std::size_t count) {
  const Partition cut = partition(count, walk_ == Walk::serial ? Tuning::scan_span_serial : Tuning::scan_span_group);
  const bool serial = walk_ == Walk::serial;
  const char* program = serial ? "primitives" : "primitives_group";
  runtime_.reserve(part_sums_, "sums of parts", cut.parts);
  if (cut.parts > 1)
    runtime_.launch(program, serial ? "scan_sum_serial" : "scan_sum_group", cut.range, cut.count, cut.span, cut.parts,
                    in, part_sums_);
  runtime_.launch(program, serial ? "scan_serial" : "scan_group", cut.range, cut.count, cut.span, cut.parts, in,
                  part_sums_, out);
}

void Primitives::compact_indices(const Buffer<cl_uint>& offsets, const Buffer<cl_uint>& out, std::size_t count) {
  if (count == 0) return;
  runtime_.launch(walk_ == Walk::serial ? "primitives" : "primitives_group", "compact_indices", runtime::over(count),
                  static_cast<cl_uint>(count), offsets, out);
}

template <class Key>
void Primitives::sort_pairs(const char* program, Buffer<Key>& keys, Buffer<cl_uint>& values, std::size_t count,
                            unsigned low, unsigned bits, Buffer<Key>& other_keys) {
  if (count < 2) return;
  const bool serial = walk_ == Walk::serial;
  const unsigned digit_bits = serial ? GCDT_SERIAL_DIGIT_BITS : GCDT_GROUP_DIGIT_BITS;
  const Partition cut = partition(count, serial ? Tuning::sort_span_serial : sort_span_group);
  match(runtime_, other_keys, "other half of the keys", keys.size());
  match(runtime_, other_values_, "other half of the values", values.size());
  runtime_.reserve(digit_table_, "digit counts", (std::size_t{1} << digit_bits) * cut.parts + 1);
  // Ends after ceil((bits - low) / digit_bits) passes; each leaves the pairs in order of the bits seen so far.
  for (cl_uint shift = low; shift < bits; shift += digit_bits) {
    const cl_uint mask = (1u << std::min(digit_bits, bits - shift)) - 1u;
    runtime_.launch(program, serial ? "sort_count_serial" : "sort_count_group", cut.range, cut.count, cut.span,
                    cut.parts, shift, mask, keys, digit_table_);
    exclusive_scan(digit_table_, digit_table_, std::size_t{mask + 1u} * cut.parts);
    runtime_.launch(program, serial ? "sort_move_serial" : "sort_move_group", cut.range, cut.count, cut.span, cut.parts,
                    shift, mask, keys, values, digit_table_, other_keys, other_values_);
    std::swap(keys, other_keys);
    std::swap(values, other_values_);
  }
}

void Primitives::sort(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned bits) {
  bits = std::min(bits, 64u);
  const std::size_t most = by_one_item()           ? Tuning::least_by_prefix - 1
                           : walk_ == Walk::serial ? GCDT_SORT_SMALL
                                                   : most_merged();
  const bool by_digit =
      walk_ == Walk::group && bits <= GCDT_MOST_BITS_BY_DIGIT && count > GCDT_SORT_SMALL && !runtime_.spares_programs();
  if (count <= most && !by_digit)
    sort_few(keys, values, count, bits);
  else
    sort_pairs(sort64(), keys, values, count, 0, bits, other_keys64_);
}

void Primitives::sort_few(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned bits) {
  if (count < 2 || bits == 0) return;
  const auto n = static_cast<cl_uint>(count);
  const bool by_blocks = !by_one_item();
  if (!by_blocks || count > GCDT_SORT_SMALL) {
    match(runtime_, other_keys64_, "other half of the keys", keys.size());
    match(runtime_, other_values_, "other half of the values", values.size());
  }
  if (by_blocks) {
    const cl_ulong mask = ~cl_ulong{0} >> (64 - bits);
    runtime_.launch("sort_merge", "sort_blocks",
                    runtime_.over_groups((count - 1) / GCDT_SORT_SMALL + 1, runtime::Groups::wide), n, mask, keys,
                    values);
    for (cl_uint width = GCDT_SORT_SMALL; width < n; width *= 4) {
      runtime_.launch("sort_merge", "merge_runs", runtime::over(count), n, width, mask, keys, values, other_keys64_,
                      other_values_);
      std::swap(keys, other_keys64_);
      std::swap(values, other_values_);
    }
    return;
  }
  runtime_.launch("by_one_item", "sort_by_one_item", runtime::one_item(), n, cl_uint{bits}, keys, values, other_keys64_,
                  other_values_);
  const unsigned digit_bits = GCDT_ONE_ITEM_DIGIT_BITS(count);
  if ((bits + digit_bits - 1) / digit_bits % 2 == 0) return;
  std::swap(keys, other_keys64_);
  std::swap(values, other_values_);
}

void Primitives::sort_high(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned bits,
                           unsigned highest) {
  if (highest > 0) sort_pairs(sort64(), keys, values, count, bits - highest, bits, other_keys64_);
}

void Primitives::sort_by_prefix(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned bits,
                                unsigned prefix) {
  const unsigned digit = walk_ == Walk::serial ? GCDT_SERIAL_DIGIT_BITS : GCDT_GROUP_DIGIT_BITS;
  prefix = (prefix + digit - 1) / digit * digit;
  const bool few = walk_ == Walk::serial ? count < Tuning::least_by_prefix : count <= most_merged();
  if (few || prefix + digit >= bits) return sort(keys, values, count, bits);
  const unsigned low = bits - prefix;
  sort_pairs(sort64(), keys, values, count, low, bits, other_keys64_);
  sort_runs(keys, values, count, low, bits);
}

void Primitives::order_by_buckets(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, std::size_t kept,
                                  unsigned bits, unsigned low, std::size_t buckets) {
  if (count < Tuning::least_by_prefix || runtime_.spares_programs())
    return sort_by_prefix(keys, values, count, bits, bits - low);
  const bool by_groups = walk_ == Walk::group;
  const cl_uint most = by_groups ? GCDT_SORT_SMALL : Tuning::longest_bucket;
  match(runtime_, other_keys64_, "other half of the keys", keys.size());
  const auto n = static_cast<cl_uint>(count), number = static_cast<cl_uint>(buckets);
  runtime_.reserve(buckets_, "buckets", buckets + 1);
  runtime_.reserve(slots_, "places in buckets", count);
  runtime_.reserve(long_runs_, "long buckets", 2 + kept / GCDT_SORT_IN_BUCKET);
  runtime_.fill<cl_uint>(buckets_, 0, buckets);
  runtime_.fill<cl_uint>(long_runs_, 0, 2);
  runtime_.launch("buckets", "bucket_count", runtime::over(count), n, cl_uint{low}, number, keys, buckets_, slots_);
  exclusive_scan(buckets_, buckets_, buckets);
  runtime_.launch("buckets", "bucket_move", runtime::over(count), n, cl_uint{low}, number, keys, values, buckets_,
                  slots_, other_keys64_);
  runtime_.launch("buckets", "bucket_order", runtime::over(buckets), number, most, buckets_, other_keys64_, values,
                  long_runs_);
  if (by_groups)
    runtime_.launch("buckets", "bucket_sort_long", runtime_.over_groups(kept / GCDT_SORT_SMALL, runtime::Groups::wide),
                    long_runs_, buckets_, other_keys64_, values);
  cl_uint found[2];  // buckets longer than `most`; and all that are listed
  runtime_.read(long_runs_, found, 2);
  if (!by_groups && found[1] > found[0])
    runtime_.launch(sort64(), "bucket_sort_each", runtime::over(found[1]), cl_uint{low}, most, long_runs_, buckets_,
                    other_keys64_, keys, values);
  if (found[0] != 0) order_left_buckets(keys, values, kept, bits, low, number, most);
}

void Primitives::order_left_buckets(Buffer<cl_ulong>& keys, const Buffer<cl_uint>& values, std::size_t kept,
                                    unsigned bits, unsigned low, cl_uint buckets, cl_uint most) {
  runtime_.reserve(marks_, "pairs left", kept + 1);
  runtime_.fill<cl_uint>(marks_, 0, kept);
  runtime_.launch("sort_left", "bucket_mark_left", runtime_.over_groups(kept / most), most, long_runs_, buckets_,
                  marks_);
  const cl_uint left = scan_total(marks_, kept);
  auto places = runtime_.allocate<cl_uint>("places of pairs left", left);
  compact_indices(marks_, places, kept);
  // All pairs are entries now: these go where keys and slots were.
  runtime_.launch("sort_left", "bucket_take", runtime::over(left), left, cl_uint{low}, buckets, places, buckets_,
                  other_keys64_, keys, slots_);
  sort(keys, slots_, left, bits);
  runtime_.launch("sort_left", "bucket_put", runtime::over(left), left, places, slots_, values);
}

void Primitives::sort_runs(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned low,
                           unsigned bits) {
  const auto n = static_cast<cl_uint>(count);
  runtime_.reserve(unordered_, "order of keys", 1);
  runtime_.reserve(long_runs_, "long runs", 1 + count / Tuning::longest_run);
  runtime_.fill<cl_uint>(unordered_, 0, 1);
  runtime_.fill<cl_uint>(long_runs_, 0, 1);
  if (walk_ == Walk::serial) {
    runtime_.launch(sort64(), "sort_runs", runtime::over(count), n, cl_uint{low}, Tuning::longest_run, keys, values,
                    long_runs_);
  } else {
    runtime_.launch("sort64_group", "rank_runs", runtime::over(count), n, cl_uint{low}, cl_uint{GCDT_SORT_RANKED}, keys,
                    values, long_runs_, other_keys64_, other_values_);
    std::swap(keys, other_keys64_);
    std::swap(values, other_values_);
    runtime_.launch("sort64_group", "sort_long_runs",
                    runtime_.over_groups(count / GCDT_SORT_SMALL, runtime::Groups::wide), n, cl_uint{low}, long_runs_,
                    keys, values);
  }
  runtime_.launch(sort64(), "sort_verify", runtime::over(count), n, keys, unordered_);
  if (runtime_.read_one(unordered_) != 0) sort_left_runs(keys, values, count, low, bits);
}

void Primitives::sort_left_runs(Buffer<cl_ulong>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned low,
                                unsigned bits) {
  const auto n = static_cast<cl_uint>(count);
  const cl_uint most = walk_ == Walk::serial ? Tuning::longest_run : GCDT_SORT_SMALL;
  runtime_.reserve(marks_, "pairs left", count + 1);
  runtime_.fill<cl_uint>(marks_, 0, count);
  runtime_.launch("sort_left", "mark_left_runs", runtime_.over_groups(count / most), n, cl_uint{low}, most, long_runs_,
                  keys, marks_);
  const cl_uint left = scan_total(marks_, count);
  if (left > count / 2) return sort_pairs(sort64(), keys, values, count, 0, bits, other_keys64_);
  auto places = runtime_.allocate<cl_uint>("places of pairs left", left);
  auto left_keys = runtime_.allocate<cl_ulong>("keys left", left);
  auto left_values = runtime_.allocate<cl_uint>("values left", left);
  compact_indices(marks_, places, count);
  runtime_.launch("sort_left", "take_pairs", runtime::over(left), left, places, keys, values, left_keys, left_values);
  // Runs are in order of their high bits, so each run's pairs come to its own places.
  sort(left_keys, left_values, left, bits);
  runtime_.launch("sort_left", "put_pairs", runtime::over(left), left, places, left_keys, left_values, keys, values);
}

void Primitives::sort_segments(const Buffer<cl_ulong>& keys, const Buffer<cl_uint>& values,
                               const Buffer<cl_uint>& first, std::size_t segments) {
  runtime_.launch("sort_segments", "sort_segments", runtime_.over_groups(segments), static_cast<cl_uint>(segments),
                  first, keys, values);
}

void Primitives::sort(Buffer<cl_uint>& keys, Buffer<cl_uint>& values, std::size_t count, unsigned bits) {
  sort_pairs(walk_ == Walk::serial ? "sort32_serial" : "sort32_group", keys, values, count, 0, std::min(bits, 32u),
             other_keys32_);
}

void Primitives::release() {
  for (auto* scratch : {&part_sums_, &digit_table_, &other_values_, &other_keys32_, &unordered_, &buckets_, &slots_,
                        &long_runs_, &marks_})
    *scratch = {};
  other_keys64_ = {};
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Device-wide scan, compaction and radix sort, without waiting between work-groups.
#pragma once

#include "device/runtime.hpp"

namespace gcdt {

/// Keeps the scratch buffers; one object per Runtime. Nothing here blocks the host but scan_total, sort_by_prefix and
/// order_by_buckets.
class Primitives {
 public:
  /// How a part of the input is walked (kernels/sort/primitives.cl): `serial` by one work-item, which suits
  /// CPUs; `group` by a whole work-group, which suits GPUs. Results are the same.
  enum class Walk { serial, group };

  explicit Primitives(runtime::Runtime& runtime) : Primitives(runtime, walk_of(runtime.kind())) {}
  static Walk walk_of(DeviceKind kind) { return is_cpu(kind) ? Walk::serial : Walk::group; }
  Primitives(runtime::Runtime& runtime, Walk walk) : runtime_(runtime), walk_(walk) {}

  /// out[i] = in[0] + ... + in[i-1] for 0 <= i <= count, modulo 2^32; out[count] is the total, so out
  /// holds count + 1 elements. `in` and `out` may be the same buffer. count may be 0.
  /// Example: in = {3, 0, 2}, out = {0, 3, 3, 5}.
  void exclusive_scan(const runtime::Buffer<cl_uint>& in, const runtime::Buffer<cl_uint>& out, std::size_t count);

  /// The same in place. Blocks, and returns the total.
  cl_uint scan_total(const runtime::Buffer<cl_uint>& words, std::size_t count) {
    exclusive_scan(words, words, count);
    return runtime_.read_one(words, count);
  }

  /// Given offsets = exclusive_scan(flags) of flags 0 or 1: out[offsets[i]] = i for every i with
  /// offsets[i + 1] > offsets[i]. Ascending. out holds offsets[count] elements.
  void compact_indices(const runtime::Buffer<cl_uint>& offsets, const runtime::Buffer<cl_uint>& out, std::size_t count);

  /// Sorts pairs by bits [0, bits) of the key, ascending and stable, least significant digit first.
  /// The buffers are exchanged with scratch of the same capacity, so their handles may change, and
  /// what they hold from `count` on is undefined afterwards.
  void sort(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count, unsigned bits = 64);
  void sort(runtime::Buffer<cl_uint>& keys, runtime::Buffer<cl_uint>& values, std::size_t count, unsigned bits = 32);

  /// Puts pairs in order by the highest `highest` of the lowest `bits` of their keys alone, for as many passes.
  void sort_high(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count, unsigned bits,
                 unsigned highest);

  /// The same order as by sort(), by other work: sorts by the highest `prefix` of the `bits`, then mends the runs of
  /// keys that agree in them. Keys have no bit from `bits` on. Cheaper if such runs are short: pairs of runs longer
  /// than some tens
  /// (`serial`) or thousands (`group`) are sorted once more. May block.
  void sort_by_prefix(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count,
                      unsigned bits, unsigned prefix);

  /// Puts the values in order whose keys are below buckets * 2^low, of which there are `kept`, and leaves the others
  /// out: what `values` holds from `kept` on is undefined afterwards, and so are the keys. Keys kept are distinct, and
  /// none has a bit from `bits` on; low <= 32. Each of many pairs goes to its bucket, its key from bit `low` on, in one
  /// pass, which is cheapest if buckets are about as many as keys, and a pair's is near its place; pairs of buckets of
  /// more than some thousands are sorted once more (kernels/sort/buckets.cl). Blocks.
  void order_by_buckets(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count,
                        std::size_t kept, unsigned bits, unsigned low, std::size_t buckets);

  /// Sorts each segment [first[s], first[s + 1]), of at most GCDT_SORT_SMALL pairs, where it stands, ascending by the
  /// whole key and stable: by groups, in local memory.
  void sort_segments(const runtime::Buffer<cl_ulong>& keys, const runtime::Buffer<cl_uint>& values,
                     const runtime::Buffer<cl_uint>& first, std::size_t segments);

  /// Releases the scratch.
  void release();

 private:
  /// `count` elements in `parts` ranges of `span`, and the launch that gives each part a work-group.
  struct Partition {
    cl_uint count, span, parts;
    runtime::Range range;
  };
  Partition partition(std::size_t count, std::size_t least_span) const;
  template <class Key>
  void sort_pairs(const char* program, runtime::Buffer<Key>& keys, runtime::Buffer<cl_uint>& values, std::size_t count,
                  unsigned low, unsigned bits, runtime::Buffer<Key>& other_keys);
  /// By one work-item, or blocks by groups, which are merged.
  void sort_few(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count, unsigned bits);
  /// Orders pairs that are in order of their keys' bits from `low` on.
  void sort_runs(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count, unsigned low,
                 unsigned bits);
  /// Of pairs in such order, sorts the runs that are too long to be sorted where they stand, by themselves; or all, if
  /// they are most.
  void sort_left_runs(runtime::Buffer<cl_ulong>& keys, runtime::Buffer<cl_uint>& values, std::size_t count,
                      unsigned low, unsigned bits);
  /// Puts the values of buckets in order that have more than `most`.
  void order_left_buckets(runtime::Buffer<cl_ulong>& keys, const runtime::Buffer<cl_uint>& values, std::size_t kept,
                          unsigned bits, unsigned low, cl_uint buckets, cl_uint most);
  /// Whether one work-item sorts few keys.
  bool by_one_item() const { return walk_ == Walk::serial && runtime_.contiguous(); }
  /// Keys that groups merge at most.
  std::size_t most_merged() const;
  const char* sort64() const { return walk_ == Walk::serial ? "sort64_serial" : "sort64_group"; }

  runtime::Runtime& runtime_;
  Walk walk_;
  runtime::Buffer<cl_uint> part_sums_, digit_table_, other_values_, other_keys32_, unordered_, buckets_, slots_,
      long_runs_, marks_;
  runtime::Buffer<cl_ulong> other_keys64_;
};

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Choices that results do not depend on, only speed. Everybody has the defaults; bench/ablation.cpp varies them, and
// tests take by them, on any device and with few vertices, the ways that others take (docs/testing.md).
#pragma once

#include <cstdint>
#include <optional>

namespace gcdt {

/// What the work-items of a device are: everything that is done in one way here and in another way there goes by it.
enum class DeviceKind {
  gpu,
  threads,      ///< of a CPU: each a loop of a thread, which takes contiguous shares (kernels/common/loops.h)
  lanes,        ///< of a CPU: lanes of vectors, in Mesa's llvmpipe; there loops end early (docs/devices.md)
  accelerator,  ///< nobody knows
};

inline bool is_cpu(DeviceKind kind) { return kind == DeviceKind::threads || kind == DeviceKind::lanes; }

struct Tuning {
  /// As what the device is to be treated; none: as what it is.
  std::optional<DeviceKind> kind;
  /// Vertices of the coarsest level at most, which goes into the symbolic triangle at once. Small enough for one
  /// work-group, large enough that the levels below it would cost more launches than they save flips. (Four levels of
  /// a million vertices are 7 % faster where they are random, and 45 % slower on a grid.)
  std::uint32_t coarsest_level = 256;
  /// Rounds of insertion and of flips between two blocking reads: reads cost about as much as one or two rounds. (More
  /// on a pool's GPUs: device_pool.cpp.)
  std::uint32_t rounds_per_read = 4;
  /// Rounds that one work-group does by itself in a launch at most, which bounds the launch.
  std::uint32_t rounds_of_group = 1024;
  /// Up to so many vertices are inserted by one work-group that loops by itself: a round there costs about a
  /// microsecond, two launches cost ten times that.
  std::uint32_t one_group_vertices = 1024;
  /// The same of edges that are tested: the tail of small rounds needs no launch and no read.
  std::uint32_t one_group_edges = 2048;
  /// From so many edges on, rounds of flips sweep over the marks of all edges, for as long as a round has at least one
  /// in `sweep_share` of them illegal: a sweep reads 4 bytes an edge, a list loses the order of the edges.
  std::uint32_t least_sweep = 1u << 17, sweep_share = 128;
  /// Stamps of tickets that are given out at most before the claim words are cleared, at least 2; no more than fit.
  std::uint32_t most_stamps = 0xFFFFFFFFu;
  /// Parts of constraints beyond one each, at most; none: by the device (walk.cpp). 0: one work-item a constraint.
  std::optional<std::uint32_t> part_pool;
  /// Crossed faces of a part, about: enough to be worth finding its first face.
  std::uint32_t crossings_per_part = 8;
  /// Whether constraints are cleaned in the order of the curve; none: where a work-item is a thread.
  std::optional<bool> walk_along_curve;
  /// Up to so many vertices, where a work-item is a thread, one orders, puts out and checks all of them
  /// (kernels/programs/few.cl): in less time than the launches and blocking reads take that other threads would need to
  /// help it, each of which wakes all of them (bench/NOTES.md).
  std::uint32_t few_vertices = 2048;
  /// Work-groups of launches, but for those of one group, while there are several runtimes; 0: as many as they want;
  /// none: where the driver needs them to be of one width, as many as the widest has (opencl.cpp).
  std::optional<std::uint32_t> width;
  /// Whether a pool's runs write through memory of the driver's own, and have the room for their results made while the
  /// device works (upload.hpp, forest_copy.hpp); none: where the device's threads are not the host's, on GPUs.
  std::optional<bool> prepares_host_memory;
  /// Runs at once on a device of a pool; none: by the kind of device (device_pool.cpp).
  std::optional<std::uint32_t> lanes;
  /// Milliseconds that a run of a pool takes whatever is in it; none: by the kind of device.
  std::optional<double> pack_overhead;
  /// Whether these runs share a context, so that the device does not go from one to another whenever one waits; none:
  /// on GPUs. (A context that the application brings is shared in any case.)
  std::optional<bool> shares_context;
  /// Whether a pool has all the device's kernels launched once in the first batch (rehearsal.hpp), while others work on
  /// it; none: of a CPU beside GPUs.
  std::optional<bool> rehearses;
};

}  // namespace gcdt

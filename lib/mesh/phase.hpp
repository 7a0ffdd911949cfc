// SPDX-License-Identifier: Apache-2.0
// What the host loops of the phases share: work lists, counters, stamps, progress.
#pragma once

#include "mesh/mesh.hpp"
#include "mesh/plan.hpp"

namespace gcdt {

/// Allocates a mesh for n vertices; contents undefined.
Mesh make_mesh(runtime::Runtime& runtime, std::uint32_t n, std::uint32_t roots = 1);

/// Sets the claim words of the first `faces` faces to 0.
void clear_claims(runtime::Runtime& runtime, Mesh& mesh, std::uint32_t faces);

/// Two lists of one word per edge of the complete mesh, used by one phase at a time.
struct WorkLists {
  runtime::Buffer<cl_uint> first, second;
};
WorkLists make_work_lists(runtime::Runtime& runtime, std::uint32_t n, std::uint32_t roots = 1);

/// Calls launch(begin, end) for the problems of each launch, which must not last for seconds on a slow device.
template <class Launch>
void for_launches(const Plan& plan, cl_uint problems, Launch&& launch) {
  const cl_uint most = plan.problems_of_launch;
  for (cl_uint begin = 0; begin < problems; begin += most) launch(begin, std::min(begin + most, problems));
}

/// Bits that hold `value`; 0 for 0.
unsigned bit_width(std::uint64_t value);

/// Hands out the stamps of tickets (kernels/common/mesh.h, "Claims"): 1, 2, ... up to what the bits above
/// the candidates' numbers hold, then the claim words must be cleared.
class Stamps {
 public:
  /// For candidates numbered below `numbers`, at most 2^31; see also Tuning::most_stamps.
  Stamps(const runtime::Runtime& runtime, std::uint32_t numbers);
  cl_uint bits() const { return bits_; }
  /// Stamps left before the next clearing.
  std::uint32_t left() const { return last_ - used_; }
  cl_uint current() const { return used_; }
  /// Takes `count` stamps, at most left(), and returns the first.
  cl_uint take(std::uint32_t count = 1) {
    used_ += count;
    return used_ - count + 1;
  }
  void restart() { used_ = 0; }
  /// Goes on with stamps whose tickets are all greater than words below `claims`, if there are any.
  void go_on_above(std::uint64_t claims) {
    const std::uint64_t spent = bits_ >= 32 ? 0 : (claims + (std::uint64_t{1} << bits_) - 1) >> bits_;
    used_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(last_, spent == 0 ? 0 : spent - 1));
  }
  /// Tickets given out so far are below this.
  std::uint64_t claims_below() const { return (std::uint64_t{used_} + 1) << bits_; }

 private:
  cl_uint bits_;
  std::uint32_t last_, used_ = 0;
};

/// The counters struct on the device and its last copy on the host, undefined until zero(). read() blocks.
class PhaseCounters {
 public:
  explicit PhaseCounters(runtime::Runtime& runtime)
      : runtime_(runtime), buffer_(runtime.allocate<device::Counters>("counters", 1)) {}
  /// Zeroes both copies.
  void zero();
  /// A kernel has zeroed them.
  void are_zero() { host_ = {}; }
  const device::Counters& read();
  const device::Counters& last() const { return host_; }
  const runtime::Buffer<device::Counters>& buffer() const { return buffer_; }

 private:
  runtime::Runtime& runtime_;
  runtime::Buffer<device::Counters> buffer_;
  device::Counters host_ = {};
};

/// Tells the caller between rounds how far the whole call has come, and throws Status::cancelled if it
/// wants to stop. Each step has a window of the whole; the share told never falls.
class Ticker {
 public:
  Ticker() = default;
  explicit Ticker(const Progress& progress) : progress_(&progress) {}
  /// The step's ticks go from `begin` to `end` of the whole from now on.
  void enter(double begin, double end) { begin_ = begin, end_ = end; }
  /// `done`: the share of the step, in [0, 1].
  void tick(const char* phase, double done) {
    told_ = std::max(told_, begin_ + (end_ - begin_) * std::min(done, 1.0));
    if (progress_ && *progress_ && !(*progress_)(phase, told_))
      throw Error(Status::cancelled, std::string("cancelled during ") + phase);
  }

 private:
  const Progress* progress_ = nullptr;
  double begin_ = 0, end_ = 1, told_ = 0;
};

inline std::uint64_t wide(std::uint32_t low, std::uint32_t high) { return low | std::uint64_t(high) << 32; }

}  // namespace gcdt

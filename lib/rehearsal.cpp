// SPDX-License-Identifier: Apache-2.0
#include "rehearsal.hpp"

namespace gcdt {

RehearsalBatch::RehearsalBatch(std::uint32_t problems) {
  constexpr std::uint32_t vertices = 40;
  for (std::uint32_t p = 0; p < problems; ++p) {
    // Ends, the middle between them, one end again; the others anywhere in [0, 1000)^2 with sides of their own.
    vertices_.insert(vertices_.end(), {{0, 0}, {1000, 600}, {500, 300}, {0, 0}});
    for (std::uint32_t i = 4; i < vertices; ++i)
      vertices_.push_back({double((i * 389 + p * 7) % 997), double((i * 571 + p * 13) % 991)});
    constraints_.insert(constraints_.end(), {{0, 1}, {3, 2}, {5, 5}});
    if (p % 4 == 3) {  // a cross
      vertices_.push_back({400, 900});
      vertices_.push_back({600, 100});
      constraints_.push_back({vertices, vertices + 1});
    }
    vertex_offsets_.push_back(vertices_.size());
    constraint_offsets_.push_back(constraints_.size());
  }
}

BatchInput RehearsalBatch::view() const {
  BatchInput batch;
  batch.problems = vertex_offsets_.size() - 1;
  batch.vertices = vertices_.data();
  batch.vertex_offsets = vertex_offsets_.data();
  batch.constraints = constraints_.data();
  batch.constraint_offsets = constraint_offsets_.data();
  return batch;
}

void Rehearsal::start(const Options& options, const Run& run) {
  const std::array<int, 3> kind = {static_cast<int>(options.crossing), options.domain != Domain::hull, options.regions};
  if (run_.valid() || made_.count(kind) > 0) return;
  made_.insert(kind);
  Options own;
  own.crossing = options.crossing;
  own.domain = options.domain;
  own.regions = options.regions;
  stop_ = false;
  run_ = std::async(std::launch::async, [this, own, run] { run(own, stop_); });
}

bool Rehearsal::wait(std::chrono::milliseconds most) {
  if (!run_.valid()) return true;
  if (run_.wait_for(most) != std::future_status::ready) return false;
  run_.get();
  return true;
}

void Rehearsal::end() {
  stop_ = true;
  if (run_.valid()) run_.wait();
  run_ = {};
}

}  // namespace gcdt

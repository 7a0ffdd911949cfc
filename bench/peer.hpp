// SPDX-License-Identifier: Apache-2.0
// A peer in a process of its own. It says "NAME points" or "NAME constraints" (what it can do) on a line, then
// answers each line "FILE RUNS SECONDS" (a PSLGBIN1 file; at least 3 and at most RUNS runs, no new one after SECONDS)
// with "ok TRIANGLES MS MS ..." or "error WHAT". One that refines adds "mesh VERTICES DEGREES", the least angle.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace gcdt::bench {

struct PeerTimes {
  std::string error;  ///< why there are no times
  unsigned long long triangles = 0;
  std::vector<double> ms;
  unsigned long long vertices = 0;  ///< 0: not said
  double least_angle = 0;
};

class Peer {
 public:
  /// Starts `command` by the shell. If it does not start, name() is empty.
  explicit Peer(std::string command);
  Peer(Peer&& other) noexcept;
  Peer& operator=(Peer&&) = delete;
  ~Peer();

  const std::string& name() const { return name_; }
  bool takes_constraints() const { return constraints_; }
  PeerTimes time(const std::string& file, int runs, double seconds);

 private:
  void start();
  void stop();
  /// The next line, without its end; false if none came within `seconds`.
  bool read_line(std::string& line, double seconds);

  std::string command_, name_, rest_;
  bool constraints_ = false;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
};

}  // namespace gcdt::bench

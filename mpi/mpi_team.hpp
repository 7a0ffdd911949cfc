// SPDX-License-Identifier: Apache-2.0
// Ranks that talk by MPI.
#pragma once

#include <mpi.h>

#include "tiles/team.hpp"

namespace gcdt::ranks {

/// The ranks of a communicator, which has to outlive this. One thread calls. What MPI cannot do ends all ranks
/// (MPI_ERRORS_ARE_FATAL).
class MpiTeam : public tiles::Team {
 public:
  explicit MpiTeam(MPI_Comm communicator);
  ~MpiTeam() override;

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }
  std::vector<tiles::Bytes> exchange(std::vector<tiles::Bytes> for_each) override;
  /// In a binomial tree: of R ranks the first one receives from log2 R.
  std::vector<tiles::Bytes> gather(tiles::Bytes own) override;
  tiles::Bytes scatter(std::vector<tiles::Bytes> for_each) override;
  tiles::Bytes broadcast(tiles::Bytes of_first) override;
  void raise(std::uint64_t* numbers, std::size_t count) override;
  void add(std::uint64_t* numbers, std::size_t count) override;

  /// Bytes sent to other ranks and received from them so far by the messages above, without padding; what is broadcast
  /// counts once.
  std::uint64_t sent() const { return sent_; }
  std::uint64_t received() const { return received_; }

 private:
  struct Joined;
  Joined join(const std::vector<tiles::Bytes>& messages) const;
  int units(std::uint64_t bytes) const;
  void send(const tiles::Bytes& bytes, std::size_t to);
  tiles::Bytes receive(std::uint64_t bytes, std::size_t from);

  MPI_Comm communicator_;
  MPI_Datatype unit_;
  std::size_t rank_ = 0, size_ = 1;
  std::uint64_t sent_ = 0, received_ = 0;
};

}  // namespace gcdt::ranks

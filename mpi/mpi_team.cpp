// SPDX-License-Identifier: Apache-2.0
#include "mpi_team.hpp"

#include <algorithm>
#include <limits>

namespace gcdt::ranks {

using tiles::Bytes;

namespace {

// MPI counts in int, so a message goes in units of so many bytes, the last one padded: 128 GB to and from a rank at
// once.
constexpr std::uint64_t unit_bytes = 64;

std::uint64_t padded(std::uint64_t bytes) { return (bytes + unit_bytes - 1) / unit_bytes * unit_bytes; }

}  // namespace

/// Messages one after the other, each padded.
struct MpiTeam::Joined {
  Bytes bytes;
  std::vector<int> counts, displacements;  ///< in units
};

MpiTeam::MpiTeam(MPI_Comm communicator) : communicator_(communicator) {
  int rank = 0, size = 1;
  MPI_Comm_rank(communicator_, &rank);
  MPI_Comm_size(communicator_, &size);
  rank_ = static_cast<std::size_t>(rank), size_ = static_cast<std::size_t>(size);
  MPI_Type_contiguous(static_cast<int>(unit_bytes), MPI_BYTE, &unit_);
  MPI_Type_commit(&unit_);
}

MpiTeam::~MpiTeam() { MPI_Type_free(&unit_); }

int MpiTeam::units(std::uint64_t bytes) const {
  const std::uint64_t count = padded(bytes) / unit_bytes;
  if (count > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw Error(Status::out_of_memory, "a message between ranks of " + std::to_string(bytes) + " bytes is too long");
  return static_cast<int>(count);
}

MpiTeam::Joined MpiTeam::join(const std::vector<Bytes>& messages) const {
  Joined joined;
  std::uint64_t all = 0;
  for (const Bytes& message : messages) {
    joined.displacements.push_back(units(all));
    joined.counts.push_back(units(message.size()));
    all += padded(message.size());
  }
  units(all);
  joined.bytes.resize(static_cast<std::size_t>(all));
  for (std::size_t i = 0; i < messages.size(); ++i)
    std::copy(messages[i].begin(), messages[i].end(),
              joined.bytes.begin() + static_cast<std::ptrdiff_t>(joined.displacements[i] * unit_bytes));
  return joined;
}

// What a rank has for itself stays where it is.
std::vector<Bytes> MpiTeam::exchange(std::vector<Bytes> for_each) {
  Bytes own = std::move(for_each[rank_]);
  for_each[rank_] = {};
  std::vector<std::uint64_t> sizes(size_), got(size_);
  for (std::size_t i = 0; i < size_; ++i) sent_ += sizes[i] = for_each[i].size();
  MPI_Alltoall(sizes.data(), 1, MPI_UINT64_T, got.data(), 1, MPI_UINT64_T, communicator_);
  const Joined to = join(for_each);
  for_each.clear();
  std::vector<int> counts, displacements;
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    displacements.push_back(units(all));
    counts.push_back(units(got[i]));
    all += padded(got[i]);
    received_ += got[i];
  }
  units(all);
  Bytes from;
  from.resize(static_cast<std::size_t>(all));
  MPI_Alltoallv(to.bytes.data(), to.counts.data(), to.displacements.data(), unit_, from.data(), counts.data(),
                displacements.data(), unit_, communicator_);
  std::vector<Bytes> messages(size_);
  for (std::size_t i = 0; i < size_; ++i) {
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(displacements[i] * unit_bytes);
    messages[i].assign(first, first + static_cast<std::ptrdiff_t>(got[i]));
  }
  messages[rank_] = std::move(own);
  return messages;
}

void MpiTeam::send(const Bytes& bytes, std::size_t to) {
  Bytes whole = bytes;
  whole.resize(static_cast<std::size_t>(padded(bytes.size())));
  MPI_Send(whole.data(), units(bytes.size()), unit_, static_cast<int>(to), 0, communicator_);
  sent_ += bytes.size();
}

Bytes MpiTeam::receive(std::uint64_t bytes, std::size_t from) {
  Bytes got;
  got.resize(static_cast<std::size_t>(padded(bytes)));
  MPI_Recv(got.data(), units(bytes), unit_, static_cast<int>(from), 0, communicator_, MPI_STATUS_IGNORE);
  got.resize(static_cast<std::size_t>(bytes));
  received_ += bytes;
  return got;
}

// Before the round of `step` a rank that is a multiple of it holds the messages of the `step` ranks from itself on.
// Ends: the step doubles.
std::vector<Bytes> MpiTeam::gather(Bytes own) {
  std::vector<Bytes> held(1);
  held[0] = std::move(own);
  for (std::size_t step = 1; step < size_; step *= 2) {
    if (rank_ & step) {
      std::vector<std::uint64_t> sizes;
      for (const Bytes& one : held) sizes.push_back(one.size());
      const auto count = static_cast<int>(sizes.size()), to = static_cast<int>(rank_ - step);
      MPI_Send(sizes.data(), count, MPI_UINT64_T, to, 0, communicator_);
      for (const Bytes& one : held) send(one, rank_ - step);
      return {};
    }
    if (rank_ + step >= size_) continue;
    std::vector<std::uint64_t> sizes(std::min(step, size_ - rank_ - step));
    MPI_Recv(sizes.data(), static_cast<int>(sizes.size()), MPI_UINT64_T, static_cast<int>(rank_ + step), 0,
             communicator_, MPI_STATUS_IGNORE);
    for (const std::uint64_t bytes : sizes) held.push_back(receive(bytes, rank_ + step));
  }
  return held;
}

Bytes MpiTeam::scatter(std::vector<Bytes> for_each) {
  std::vector<std::uint64_t> sizes;
  for (const Bytes& message : for_each) sizes.push_back(message.size());
  for (std::size_t i = 1; i < sizes.size(); ++i) sent_ += sizes[i];
  std::uint64_t size = 0;
  MPI_Scatter(sizes.data(), 1, MPI_UINT64_T, &size, 1, MPI_UINT64_T, 0, communicator_);
  const Joined to = join(for_each);
  Bytes own;
  own.resize(static_cast<std::size_t>(padded(size)));
  MPI_Scatterv(to.bytes.data(), to.counts.data(), to.displacements.data(), unit_, own.data(), units(size), unit_, 0,
               communicator_);
  own.resize(static_cast<std::size_t>(size));
  if (!is_first()) received_ += size;
  return own;
}

Bytes MpiTeam::broadcast(Bytes of_first) {
  std::uint64_t size = of_first.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, communicator_);
  (is_first() ? sent_ : received_) += size;
  of_first.resize(static_cast<std::size_t>(padded(size)));
  MPI_Bcast(of_first.data(), units(size), unit_, 0, communicator_);
  of_first.resize(static_cast<std::size_t>(size));
  return of_first;
}

void MpiTeam::raise(std::uint64_t* numbers, std::size_t count) {
  MPI_Allreduce(MPI_IN_PLACE, numbers, static_cast<int>(count), MPI_UINT64_T, MPI_MAX, communicator_);
}

void MpiTeam::add(std::uint64_t* numbers, std::size_t count) {
  MPI_Allreduce(MPI_IN_PLACE, numbers, static_cast<int>(count), MPI_UINT64_T, MPI_SUM, communicator_);
}

}  // namespace gcdt::ranks

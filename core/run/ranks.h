#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace flatspeckle {

/// Position of this process among the processes that an MPI launcher (mpirun) has started together.
/// If the program was built without MPI or started without a launcher, there is one process, with
/// rank 0. Only core/run/ranks.cpp uses MPI.
struct Ranks {
  int rank = 0, size = 1;
  /// Number of processes that run on the same processor cores as this one, including this one.
  int sharers = 1;
};

/// Returns rank and number of processes from environment variables of the launcher; can be called
/// before initialize_ranks().
Ranks launched_ranks();

/// Initialises MPI if the launcher has started several processes. Throws InputError if the program
/// was built without MPI.
void initialize_ranks();
/// Finalises MPI; all processes must call this function.
void leave_ranks();
/// Ends all processes at once with this exit status. If there is only one process, does nothing.
void abort_ranks(int status);

/// Returns the rank of this process and the number of processes, once initialize_ranks() was
/// called.
const Ranks& ranks();

using Bytes = std::vector<std::byte>;

/// Message that another rank has sent to rank 0. On rank 0, next_message() returns the next message
/// that has arrived, if any, and answer() replies to it; neither is thread-safe.
struct Message {
  int from = 0;
  Bytes bytes;
};
std::optional<Message> next_message();
void answer(int rank, std::span<const std::byte> bytes);

/// Sends a message to rank 0, waits for the answer and returns it; to be called on other ranks.
/// Thread-safe.
Bytes query_rank_0(std::span<const std::byte> bytes);

}  // namespace flatspeckle

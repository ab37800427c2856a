#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace flatspeckle {

/// The processes that a launcher of MPI (mpirun) has started together, of which this is one. Only
/// core/run/ranks.cpp knows MPI; without it, or started alone, there is one rank.
struct Ranks {
  int rank = 0, size = 1;
  int sharers = 1;  ///< of the cores that this process may use, itself included
};

/// What the launcher's environment says of this process, before it has joined the others.
Ranks launched_ranks();

/// Joins the others. Throws InputError where there are others but this program knows no MPI.
void join_ranks();
/// All leave together.
void leave_ranks();
/// Ends all processes at once with this exit status, where there are several.
void abort_ranks(int status);

/// This process among those that it has joined.
const Ranks& ranks();

using Bytes = std::vector<std::byte>;

/// Of rank 0: a message that has come in, if there is one, and the answer to it. One thread at a
/// time.
struct Message {
  int from = 0;
  Bytes bytes;
};
std::optional<Message> next_message();
void answer(int rank, std::span<const std::byte> bytes);

/// Of any other rank: sends a message to rank 0 and waits for the answer. For any thread.
Bytes ask(std::span<const std::byte> bytes);

}  // namespace flatspeckle

#include "core/run/ranks.h"

#include <cstdlib>
#include <string>

#ifdef FLATSPECKLE_MPI
#include <algorithm>
#include <mpi.h>
#include <mutex>
#include <sched.h>
#endif

#include "core/error.h"

namespace flatspeckle {

namespace {

Ranks world;

int number_in_environment(const char* first, const char* second, int otherwise) {
  for (const char* name : {first, second})
    if (const char* text = std::getenv(name)) return std::atoi(text);
  return otherwise;
}

}  // namespace

Ranks launched_ranks() {
  // environment variables that Open MPI sets, and those of launchers that use PMI (MPICH, srun)
  return {.rank = number_in_environment("OMPI_COMM_WORLD_RANK", "PMI_RANK", 0),
          .size = number_in_environment("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", 1)};
}

const Ranks& ranks() {
  return world;
}

#ifdef FLATSPECKLE_MPI

namespace {

/// Returns the number of MPI processes on this machine that may run on a core on which this process
/// may run.
int count_sharers() {
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int size = 1;
  MPI_Comm_size(machine, &size);
  cpu_set_t own;
  CPU_ZERO(&own);
  sched_getaffinity(0, sizeof own, &own);
  std::vector<cpu_set_t> all(static_cast<std::size_t>(size));
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, machine);
  MPI_Comm_free(&machine);
  const auto sharers = std::count_if(all.begin(), all.end(), [&](const cpu_set_t& other) {
    cpu_set_t both;
    CPU_AND(&both, &own, &other);
    return CPU_COUNT(&both) > 0;
  });
  return std::max(1, static_cast<int>(sharers));
}

Bytes receive(int from, MPI_Status status) {
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  Bytes bytes(static_cast<std::size_t>(count));
  MPI_Recv(bytes.data(), count, MPI_BYTE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return bytes;
}

void send(int to, std::span<const std::byte> bytes) {
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, 0, MPI_COMM_WORLD);
}

}  // namespace

void initialize_ranks() {
  // A single process must not initialise MPI, which would start a launcher.
  if (launched_ranks().size < 2) return;
  int threads = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads);
  MPI_Comm_rank(MPI_COMM_WORLD, &world.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &world.size);
  world.sharers = count_sharers();
}

void leave_ranks() {
  if (world.size > 1) MPI_Finalize();
}

void abort_ranks(int status) {
  int left = 0;
  MPI_Finalized(&left);
  if (world.size > 1 && left == 0) MPI_Abort(MPI_COMM_WORLD, status);
}

std::optional<Message> next_message() {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &status);
  if (there == 0) return std::nullopt;
  return Message{status.MPI_SOURCE, receive(status.MPI_SOURCE, status)};
}

void answer(int rank, std::span<const std::byte> bytes) {
  send(rank, bytes);
}

Bytes query_rank_0(std::span<const std::byte> bytes) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  send(0, bytes);
  MPI_Status status;
  MPI_Probe(0, 0, MPI_COMM_WORLD, &status);
  return receive(0, status);
}

#else

void initialize_ranks() {
  if (launched_ranks().size > 1)
    throw InputError("started as " + std::to_string(launched_ranks().size) +
                     " processes, but this program was built without MPI "
                     "(-DFLATSPECKLE_MPI=ON); --shard i/n works without MPI");
}

void leave_ranks() {}
void abort_ranks(int) {}
std::optional<Message> next_message() {
  return std::nullopt;
}
void answer(int, std::span<const std::byte>) {}
Bytes query_rank_0(std::span<const std::byte>) {
  return {};
}

#endif

}  // namespace flatspeckle

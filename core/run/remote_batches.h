#pragma once

#include "core/run/batch_pool.h"

namespace flatspeckle {

/// Rank 0's side of a pool that all ranks work on: it alone opens runs, merges and writes; the
/// others only compute the batches that it hands out.
class RankServer {
 public:
  /// Hands batches of the pool to the threads of the other ranks until it is over and each of them
  /// has been told so. For a thread of its own, beside those that work here.
  void serve(BatchPool& pool) { serve(&pool); }
  /// Tells all that it is over, where no pool comes (any more).
  void dismiss() { serve(nullptr); }

 private:
  void serve(BatchPool* pool);
  void take_in(BatchPool* pool, int rank, const std::vector<std::byte>& message);

  int threads_ = 0;        ///< of other ranks that have not been told
  int silent_ranks_ = -1;  ///< that have not said how many threads they have; -1: not counted
};

/// On every other rank: works on batches that rank 0 hands out, until all is over.
void work_for_rank_0(const RunList& runs, int threads);

}  // namespace flatspeckle

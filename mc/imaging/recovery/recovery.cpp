#include "mc/imaging/recovery/recovery.h"

namespace flatspeckle::mc {

Recovered recovered(std::span<const std::vector<double>> frames, const RecoveryTask& task) {
  Recovered found;
  found.statistics = frame_statistics(frames, task.lags, task.noise);
  if (task.points == 0 || found.statistics.grain == 0) return found;
  const double resolution = task.resolution_grains * found.statistics.peaks.width;
  SparseTask search{task.points, resolution};
  search.memory_range = task.memory_range;
  found.fit = sparse_search(found.statistics.peaks, search);
  return found;
}

}  // namespace flatspeckle::mc

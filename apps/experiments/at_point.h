#pragma once

#include <utility>

#include "apps/command/experiment.h"
#include "apps/sweep/sweep_points.h"
#include "core/error.h"

namespace flatspeckle::apps {

/// What is done for one of the points, which an InputError then names.
template <class Work>
decltype(auto) at_point(const SweepPoints& points, std::size_t point, const Work& work) try {
  return work();
} catch (const InputError& error) {
  throw InputError("point " + points.name(point) + ": " + error.what());
}

/// The plan of its experiment, with batches and a result that name it too. The points stay.
inline PlannedExperiment plan_at(const SweepPoints& points, std::size_t point,
                                 const Experiment& experiment) {
  return at_point(points, point, [&] {
    PlannedExperiment planned = experiment.plan();
    planned.batches.run = [&points, point, run = std::move(planned.batches.run)](
                              std::uint64_t batch, std::span<Complex> sums) {
      at_point(points, point, [&] { run(batch, sums); });
    };
    planned.write = [&points, point, write = std::move(planned.write)](ResultFile& file,
                                                                       const GroupedSums& sums) {
      at_point(points, point, [&] { write(file, sums); });
    };
    return planned;
  });
}

}  // namespace flatspeckle::apps

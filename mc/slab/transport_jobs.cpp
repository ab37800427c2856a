#include "mc/slab/transport_jobs.h"

#include "mc/transport/bulk_slope.h"

namespace flatspeckle::mc {

PathJob change_job(std::size_t entries, const std::vector<FieldChange>& changes,
                   const std::function<Refined(const FieldChange&)>& solve) {
  const auto solve_all = [=] {
    Refined all = solve({});
    for (const FieldChange& change : changes) all.append(solve(change));
    return all;
  };
  return two_batch_job(entries, 1 + changes.size(), solve_all);
}

GradientJob slope_job(const Scene& scene, const std::function<Refined(BulkParameter)>& solve) {
  const auto parameters = slab_parameters(scene);
  const std::size_t entries = scene.request.entries.size();
  const auto solve_all = [=] {
    Refined all = solve(parameters.front());
    for (std::size_t p = 1; p < parameters.size(); ++p) {
      Refined one = solve(parameters[p]);
      for (auto* list : {&one.value, &one.difference})
        list->erase(list->begin(), list->begin() + static_cast<std::ptrdiff_t>(entries));
      all.append(one);
    }
    return all;
  };
  return gradient_job(two_batch_job(entries, 1 + parameters.size(), solve_all), parameters, scene);
}

}  // namespace flatspeckle::mc

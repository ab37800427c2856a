#include "grin/connections/trials_datasets.h"

#include "core/result/result_group.h"

namespace flatspeckle::grin {

const DatasetTable trials_table{
    "trials",
    {{"trials/converged", Data::count, "", "1", "trials that ended so"},
     {"trials/no_approach", Data::count, "", "1", "trials that ended so"},
     {"trials/not_converged", Data::count, "", "1", "trials that ended so"},
     {"trials/left_region", Data::count, "", "1", "trials that ended so"},
     {"trials/too_long", Data::count, "", "1", "trials that ended so"},
     {"trials/degenerate", Data::count, "", "1", "trials that ended so"},
     {"trials/iterations", Data::count, "", "1", "Gauss-Newton steps of all trials"},
     {"trials/pairs", Data::count, "", "1", "pairs of points that a curve was sought between"},
     {"trials/found", Data::count, "", "1", "pairs whose first trial found one"},
     {"trials/further", Data::count, "", "1", "further trials until a curve was found again"},
     {"trials/roulette_ends", Data::count, "", "1", "searches that roulette ended"}}};

void write_trials(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  for (std::size_t i = 0; i < trial_outcomes; ++i)  // the first rows
    root.put(trials_table.rows[i].path, statistics.outcomes[i]);
  root.put("trials/iterations", statistics.iterations);
}

void write_pairs(ResultFile& file, const ConnectionStatistics& statistics) {
  const ResultGroup root(file, trials_table);
  root.put("trials/pairs", statistics.pairs);
  root.put("trials/found", statistics.found);
  root.put("trials/further", statistics.refind);
  root.put("trials/roulette_ends", statistics.roulette_ends);
}

}  // namespace flatspeckle::grin

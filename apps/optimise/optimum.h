#pragma once

#include <optional>

#include "apps/optimise/evaluations.h"
#include "core/keys/keys.h"
#include "core/result/result_file.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::apps {

/// What a search has ended in.
struct Optimum {
  Winner winner;
  SweepPoints best, runner_up;         ///< the keys there
  std::optional<SweepPoints> against;  ///< with some keys at other values
  std::optional<Measured> there = {};
  std::vector<std::string> at_bounds = {};  ///< keys of the best that a wider range may better
  bool finished = true;
};

/// All that was evaluated, the best and what it is better than. keys: of what was searched.
void write_optimum(ResultFile& file, const Optimum& optimum, const Evaluations& evaluations,
                   const EvaluationSettings& settings, const Keys& keys);
/// On standard output.
void print_optimum(const Optimum& optimum, const EvaluationSettings& settings);

}  // namespace flatspeckle::apps

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "mc/walk/walk_setup.h"

namespace flatspeckle::mc {

/// Numbered batches of the same walks as path_batches(), whose paths carry a tally that starts as
/// `tally`. make_scorer(scene, scattering, reversed, phases, sums) gives the scorer of a batch;
/// reversed and phases are std::true_type or std::false_type.
template <typename Tally, typename MakeScorer>
SummedBatches tallied_walks(const Scene& scene, const Plan& plan, std::uint64_t seed, Tally tally,
                            MakeScorer make_scorer) {
  if (scene.medium.mu_s == 0) return [](std::uint64_t, std::span<Complex>) {};
  SummedBatches chosen;
  with_scattering(scene, plan.phase, [&]<typename Scattering>(const Scattering& scattering) {
    with_flag(plan.weighted, [&](auto weighted) {
      const auto choose = [&](auto reversed, auto phases) {
        using Setup =
            WalkSetup<Scattering, decltype(reversed)::value, decltype(weighted)::value, Tally>;
        const auto setup = std::make_shared<const Setup>(scene, plan, scattering, tally);
        chosen = [=](std::uint64_t number, std::span<Complex> sums) {
          auto scorer = make_scorer(setup->scene, setup->scattering, reversed, phases, sums);
          setup->walk_batch(seed, number, scorer);
        };
      };
      if (plan.reversed)
        choose(std::true_type{}, std::true_type{});
      else
        with_flag(plan.phases, [&](auto phases) { choose(std::false_type{}, phases); });
    });
  });
  return chosen;
}

}  // namespace flatspeckle::mc

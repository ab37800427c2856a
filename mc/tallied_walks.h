#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "core/complex.h"
#include "core/random.h"
#include "mc/walk_setup.h"

namespace flatspeckle::mc {

/// Adds batch `number` to zeroed sums.
using SummedBatches = std::function<void(std::uint64_t number, std::span<Complex> sums)>;

/// Numbered batches of the same walks as path_batches(), whose paths carry a tally that starts as
/// `tally`. make_scorer(scene, scattering, reversed, phases, sums) gives the scorer of a batch;
/// reversed and phases are std::true_type or std::false_type.
template <typename Tally, typename MakeScorer>
SummedBatches tallied_walks(const Scene& scene, const Plan& plan, std::uint64_t seed, Tally tally,
                            MakeScorer make_scorer) {
  if (scene.medium.mu_s == 0) return [](std::uint64_t, std::span<Complex>) {};
  SummedBatches chosen;
  with_scattering(scene, plan, [&]<typename Scattering>(const Scattering& scattering) {
    with_flag(plan.weighted, [&](auto weighted) {
      const auto choose = [&](auto reversed, auto phases) {
        using Setup =
            WalkSetup<Scattering, decltype(reversed)::value, decltype(weighted)::value, Tally>;
        const auto setup = std::make_shared<const Setup>(scene, plan, scattering, tally);
        chosen = [=](std::uint64_t number, std::span<Complex> sums) {
          RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
          auto walk = setup->walk;
          auto scorer = make_scorer(setup->scene, setup->scattering, reversed, phases, sums);
          walk.begin(random);
          for (std::uint64_t path = 0; path < setup->plan.paths_per_batch; ++path)
            walk.walk(random, scorer);
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

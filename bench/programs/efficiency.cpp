// Efficiency 1 / (relative error^2 x CPU seconds) of our Monte Carlo estimator against the
// published one (bench/oracles/textbook.h), on the standard scenes with 64 tilts, taken in turn on
// one thread. The relative error is RMS over the entries, relative to their RMS magnitude. Both
// must agree within 4 standard errors, or the exit status is 1. With `choices`: what each choice of
// ours is worth, as the ratio of the planned estimator's efficiency to that without it.
//
//   bench_efficiency [choices] [rounds [seconds per estimator and round]]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <omp.h>

#include "bench/measure/contest.h"
#include "bench/measure/median.h"
#include "bench/oracles/textbook.h"
#include "bench/scenes/standard_scenes.h"
#include "core/run/stopwatch.h"
#include "mc/paths/estimators/covariance_estimator.h"

using namespace flatspeckle;
using namespace flatspeckle::bench;

namespace {

constexpr std::uint64_t seed = 1;

struct Duration {
  int rounds = 9;
  double seconds = 1;
};

mc::Plan plan_of(const StandardScene& standard) {
  return mc::make_plan(standard.scene,
                       standard.reversed ? mc::ReversedPaths::yes : mc::ReversedPaths::no);
}

/// What compete() left, summed up over the scenes of a table.
struct Table {
  double log_sum = 0;
  bool agree = true;

  Outcome add(const Contender& ours, const Contender& theirs) {
    const Outcome outcome = compare(ours, theirs);
    log_sum += std::log(outcome.median);
    agree = agree && outcome.most_sigma < 4;
    return outcome;
  }
};

void race(const StandardScene& standard, Duration duration, Table& table) {
  const double start = process_cpu_seconds();
  const FieldJob job = mc::covariance_job(standard.scene, plan_of(standard), seed);
  const double setup = process_cpu_seconds() - start;
  std::vector<Contender> both = {
      {"textbook", oracles::textbook_job(standard.scene, standard.reversed, 200, seed)},
      {"ours", job}};
  compete(both, duration.rounds, duration.seconds);
  const Contender &textbook = both[0], &ours = both[1];
  const Outcome outcome = table.add(ours, textbook);
  std::printf("%-28s %9.3g %9.3g | %7.2f x/ %.2f %9.2f | %6.3f%% %6.3f%% %6.2f | %.0f ms %s\n",
              standard.name.c_str(), median(textbook.slice_efficiency),
              median(ours.slice_efficiency), outcome.median, std::exp(outcome.log_error),
              outcome.together, 100 * relative_error(textbook.estimate()),
              100 * relative_error(ours.estimate()), outcome.most_sigma, 1e3 * setup,
              outcome.most_sigma < 4 ? "" : "DIFFERENT");
  std::fflush(stdout);
}

bool against_textbook(const std::vector<StandardScene>& scenes, Duration duration) {
  std::printf("%-28s %9s %9s | %7s %6s %9s | %7s %7s %6s | %s\n", "efficiency, 1/(error^2 s)",
              "textbook", "ours", "ratio", "error", "together", "textbk", "ours", "sigma",
              "ours, set-up");
  Table table, absorbing;
  for (const StandardScene& standard : scenes) race(standard, duration, table);
  std::printf("geometric mean of the ratios: %.2f\n",
              std::exp(table.log_sum / static_cast<double>(scenes.size())));
  for (const StandardScene& standard : absorbing_scenes()) race(standard, duration, absorbing);
  return table.agree && absorbing.agree;
}

struct Choice {
  const char* name;
  void (*leave_out)(mc::Plan&);
};

bool choices(const std::vector<StandardScene>& scenes, Duration duration) {
  const std::vector<Choice> all = {
      {"roulette of scores", [](mc::Plan& plan) { plan.score_level = 0; }},
      {"closed single", [](mc::Plan& plan) { plan.sampled_single = true; }},
  };
  std::printf("%-28s", "planned over without");
  for (const Choice& choice : all) std::printf(" %24s", choice.name);
  std::vector<Table> tables(all.size());
  for (const StandardScene& standard : scenes) {
    std::vector<Contender> contenders = {
        {"planned", mc::covariance_job(standard.scene, plan_of(standard), seed)}};
    for (std::size_t c = 0; c < all.size(); ++c) {
      mc::Plan plan = plan_of(standard);
      all[c].leave_out(plan);
      contenders.push_back({all[c].name, mc::covariance_job(standard.scene, plan, seed + 1 + c)});
    }
    compete(contenders, duration.rounds, duration.seconds);
    std::printf("\n%-28s", standard.name.c_str());
    for (std::size_t c = 0; c < all.size(); ++c) {
      const Outcome outcome = tables[c].add(contenders[0], contenders[c + 1]);
      std::printf(" %10.2f x/ %.2f %s", outcome.median, std::exp(outcome.log_error),
                  outcome.most_sigma < 4 ? "       " : "DIFFERS");
    }
    std::fflush(stdout);
  }
  bool agree = true;
  std::printf("\n%-28s", "geometric mean");
  for (const Table& table : tables) {
    std::printf(" %10.2f %13s", std::exp(table.log_sum / static_cast<double>(scenes.size())), "");
    agree = agree && table.agree;
  }
  std::printf("\n");
  return agree;
}

}  // namespace

int main(int argc, char** argv) {
  omp_set_num_threads(1);  // also while an estimator is set up
  const bool of_choices = argc > 1 && std::strcmp(argv[1], "choices") == 0;
  char** rest = argv + (of_choices ? 1 : 0);
  const int left = argc - (of_choices ? 1 : 0);
  Duration duration;
  if (left > 1) duration.rounds = std::atoi(rest[1]);
  if (left > 2) duration.seconds = std::atof(rest[2]);
  std::printf("memory effect, 64 tilts, one thread, %d rounds of %g s each\n", duration.rounds,
              duration.seconds);
  const auto scenes = standard_scenes();
  return (of_choices ? choices : against_textbook)(scenes, duration) ? 0 : 1;
}

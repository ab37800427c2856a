#pragma once

#include "core/run/interrupt.h"
#include "grin/rays/connections/connection_trial.h"

namespace flatspeckle::grin {

/// Survives each doubling of the number of trials with this probability. Below 1/2, the expected
/// number of trials is finite even for a curve that is never found again; and the weight grows as
/// a power of the number of trials only, so that its variance is finite for every curve.
inline constexpr double refind_survival = 0.25;

/// Independent trials until a curve is found again, failures counted: K of C26, unbiased for one
/// over the curve's chance. After roulette_after trials the search goes on by Russian roulette: K
/// is the sum over j of [not found in j trials], and each term is divided by the chance to get
/// there. refinds() makes a trial and says whether it found the curve.
template <class Refinds>
double trials_to_refind(const Refinds& refinds, std::uint64_t roulette_after, RandomStream& random,
                        ConnectionStatistics& statistics) {
  double expected = 0, weight = 1;
  std::uint64_t roulette_at = roulette_after;
  std::uint64_t tried = 0;
  for (bool again = false; !again; ++tried) {
    if (tried >= roulette_at) {
      if (random.uniform() > refind_survival) {
        ++statistics.roulette_ends;
        break;
      }
      weight /= refind_survival;
      roulette_at *= 2;
    }
    expected += weight;
    again = refinds();
  }
  statistics.record_refind(tried);
  return expected;
}

namespace connection_parts {

template <IndexField F, Region R, class Step, class Draw>
ConnectionEstimate connect_by(const Draw& draw, const ConnectionTrial<F, R, Step>& trial,
                              RandomStream& random, ConnectionStatistics& statistics) {
  ++statistics.pairs;
  const auto first = draw();
  if (first.outcome != TrialOutcome::converged) return {first.outcome, std::nullopt, 0};
  ++statistics.found;
  const auto refinds = [&] {
    const auto again = draw();
    return again.outcome == TrialOutcome::converged &&
           same_curve(first.curve, again.curve, trial.options().same);
  };
  const double multiplicity =
      trials_to_refind(refinds, trial.options().roulette_after, random, statistics);
  return {
      first.outcome,
      trial.options().count_caustics ? trial.with_caustics(first.curve, statistics) : first.curve,
      multiplicity};
}

}  // namespace connection_parts

/// One random curve with its multiplicity (C26).
template <IndexField F, Region R, class Step>
ConnectionEstimate connect(const ConnectionTrial<F, R, Step>& trial, RandomStream& random,
                           ConnectionStatistics& statistics) {
  const auto draw = [&] { return trial.run(random, statistics); };
  return connection_parts::connect_by(draw, trial, random, statistics);
}

/// The same at half the cost where most pairs of points have one curve. Each trial starts along the
/// chord with a chance that depends on the pair alone, and at random otherwise; where the chord
/// leads is computed once. The rarer a random start is, the less often a second curve is found, and
/// the more it weighs.
template <IndexField F, Region R, class Step>
ConnectionEstimate connect_chord_first(const ConnectionTrial<F, R, Step>& trial,
                                       RandomStream& random, ConnectionStatistics& statistics) {
  const auto chord = trial.along_chord(statistics);
  const double chance = chord.outcome != TrialOutcome::converged ? 0
                        : trial.is_nearly_straight(chord.curve)  ? 0.95
                                                                 : 0.6;
  const auto draw = [&] {
    return random.uniform() < chance ? chord : trial.run(random, statistics);
  };
  return connection_parts::connect_by(draw, trial, random, statistics);
}

/// In a homogeneous field the curve is the straight line, and no trial runs.
template <IndexField F, Region R, class Step>
requires HomogeneousField<F> ConnectionEstimate connect(const ConnectionTrial<F, R, Step>& trial,
                                                        RandomStream&, ConnectionStatistics&) {
  const auto [outcome, line] = trial.straight();
  if (outcome != TrialOutcome::converged) return {outcome, std::nullopt, 0};
  return {outcome, line, 1};
}

/// Every curve that so many trials find, by optical path, caustics counted. A curve of chance p is
/// missed with probability (1-p)^trials. Trials that end on caustics are in the statistics only.
template <IndexField F, Region R, class Step>
std::vector<FoundConnection> all_connections(const ConnectionTrial<F, R, Step>& trial,
                                             std::uint64_t trials, RandomStream& random,
                                             ConnectionStatistics& statistics) {
  std::vector<FoundConnection> all;
  for (std::uint64_t i = 0; i < trials; ++i) {
    stop_if_interrupted();
    const auto result = trial.run(random, statistics);
    if (result.outcome != TrialOutcome::converged) continue;
    const auto known = std::find_if(all.begin(), all.end(), [&](const FoundConnection& one) {
      return same_curve(one.curve, result.curve, trial.options().same);
    });
    if (known == all.end())
      all.push_back({trial.with_caustics(result.curve, statistics), 1});
    else
      ++known->found;
  }
  std::sort(all.begin(), all.end(), [](const FoundConnection& a, const FoundConnection& b) {
    return a.curve.optical_path < b.curve.optical_path;
  });
  return all;
}

template <IndexField F, Region R, class Step>
requires HomogeneousField<F> std::vector<FoundConnection> all_connections(
    const ConnectionTrial<F, R, Step>& trial, std::uint64_t trials, RandomStream&,
    ConnectionStatistics&) {
  const auto [outcome, line] = trial.straight();
  if (outcome != TrialOutcome::converged) return {};
  return {{line, trials}};
}

}  // namespace flatspeckle::grin

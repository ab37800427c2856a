#pragma once

#include "core/run/interrupt.h"
#include "grin/rays/connections/connection_trial.h"

namespace flatspeckle::grin {

/// A search is repeated until it finds the same curve again (C26). This is the probability that it
/// survives each doubling of its number of trials. Because this
/// probability is below 1/2, the expected number of trials is finite even for a curve that is never
/// found again. The weight of a search grows only as a power of the number of trials, so that its
/// variance is finite for every curve.
inline constexpr double bernoulli_survival = 0.25;

/// Returns the number of independent Bernoulli trials until a curve is found again: K of C26, an
/// unbiased estimate of the reciprocal probability of the curve. After roulette_after trials the
/// search continues by Russian roulette: K is a sum over j = 0, 1, ...; term j is 1 if the first j
/// trials have not found the curve, otherwise 0. Each term is divided by the probability that the
/// search continues up to it. finds_again() makes a trial and returns whether it found the curve.
template <class FindsAgain>
double reciprocal_probability(const FindsAgain& finds_again, std::uint64_t roulette_after,
                              RandomStream& random, ConnectionStatistics& statistics) {
  double expected = 0, weight = 1;
  std::uint64_t roulette_at = roulette_after;
  std::uint64_t tried = 0;
  for (bool again = false; !again; ++tried) {
    if (tried >= roulette_at) {
      if (random.uniform() > bernoulli_survival) {
        ++statistics.roulette_terminations;
        break;
      }
      weight /= bernoulli_survival;
      roulette_at *= 2;
    }
    expected += weight;
    again = finds_again();
  }
  statistics.record_trials(tried);
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
  const auto finds_again = [&] {
    const auto again = draw();
    return again.outcome == TrialOutcome::converged &&
           same_curve(first.curve, again.curve, trial.options().same);
  };
  const double multiplicity =
      reciprocal_probability(finds_again, trial.options().roulette_after, random, statistics);
  return {
      first.outcome,
      trial.options().count_caustics ? trial.with_caustics(first.curve, statistics) : first.curve,
      multiplicity};
}

}  // namespace connection_parts

/// Returns a random curve from P to Q and its multiplicity, an unbiased estimate of the reciprocal
/// probability of finding the curve (C26).
template <IndexField F, Region R, class Step>
ConnectionEstimate connect(const ConnectionTrial<F, R, Step>& trial, RandomStream& random,
                           ConnectionStatistics& statistics) {
  const auto draw = [&] { return trial.run(random, statistics); };
  return connection_parts::connect_by(draw, trial, random, statistics);
}

/// Computes the estimate of connect() at half the cost if most pairs of points have one curve. Each
/// trial starts along the chord, the straight line from P to Q, with a probability that depends
/// only on P and Q, otherwise in a random direction. The trial along the chord always has the same
/// result and is computed once. If random starts are rare, a second curve is rarely found and then
/// has a large weight.
template <IndexField F, Region R, class Step>
ConnectionEstimate connect_chord_first(const ConnectionTrial<F, R, Step>& trial,
                                       RandomStream& random, ConnectionStatistics& statistics) {
  const auto chord = trial.along_chord(statistics);
  const double chord_probability = chord.outcome != TrialOutcome::converged ? 0
                                   : trial.is_nearly_straight(chord.curve)  ? 0.95
                                                                            : 0.6;
  const auto draw = [&] {
    return random.uniform() < chord_probability ? chord : trial.run(random, statistics);
  };
  return connection_parts::connect_by(draw, trial, random, statistics);
}

/// Returns the straight line from P to Q, which is the only connection in a homogeneous field. No
/// trial runs.
template <IndexField F, Region R, class Step>
requires HomogeneousField<F> ConnectionEstimate connect(const ConnectionTrial<F, R, Step>& trial,
                                                        RandomStream&, ConnectionStatistics&) {
  const auto [outcome, line] = trial.straight();
  if (outcome != TrialOutcome::converged) return {outcome, std::nullopt, 0};
  return {outcome, line, 1};
}

/// Returns every curve from P to Q found by `trials` trials, sorted by optical path, with its
/// caustics counted. A curve that a trial finds with probability p is missed with probability
/// (1-p)^trials. Trials that end on caustics find no curve, but are counted in the statistics.
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

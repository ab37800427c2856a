#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/result/dataset_row.h"
#include "grin/media/geometry/vec3.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

/// A predicate region(x) that is true in the region in which a curve between two points must stay.
/// The two end points of the curve are not tested.
template <class R>
concept Region = std::predicate<const R&, const Vec3&>;

struct WholeSpace {
  bool operator()(const Vec3&) const { return true; }
};

/// The inside of a surface: surface.distance(x) <= 0.
template <class S>
struct Inside {
  S surface;
  bool operator()(const Vec3& x) const { return surface.distance(x) <= 0; }
};

/// A ray that connects two points P and Q.
struct Connection {
  /// Unit tangents at P and Q, both in the direction from P to Q.
  Vec3 start_direction = Vec3::Zero(), end_direction = Vec3::Zero();
  double sigma;  ///< ray parameter at Q (conventions, C23)
  double arc_length, optical_path;
  double spreading;   ///< geometric spreading |J_PQ|: area at Q per solid angle at P (C25)
  int orientation;    ///< sign of J_PQ: -1 after an odd number of caustics, otherwise 1
  int steps;          ///< number of equal integration steps from P to Q
  int caustics = -1;  ///< number of caustics between P and Q (Maslov index); -1: not counted
};

struct ConnectionOptions {
  double step;        ///< largest integration step in sigma (C23), equal to its length at index 1
  double max_length;  ///< largest arc length of a curve; longer curves are rejected
  StartDirections start = {};  ///< distribution of the start directions of trials
  int max_iterations = 40;     ///< number of iterations after which a trial fails
  double tolerance = 1e-10;  ///< largest distance from Q at which a curve may end, in units of |PQ|
  /// If a trial ends closer to Q than this, in units of |PQ|, its last correction is computed from
  /// derivatives instead of tracing; arc length and |J| then have an error of this size.
  double carry = 0;
  /// Two curves count as equal if their start directions (in rad) and their relative lengths agree
  /// within this.
  double same = 1e-5;
  /// Q counts as lying on a caustic if a beam from P is narrower at Q than this times its largest
  /// width.
  double caustic = 1e-5;
  std::uint64_t roulette_after = 512;  ///< number of trials after which Russian roulette begins
  /// Whether the caustics of a found curve are counted, by tracing the curve once more.
  bool count_caustics = true;
};

/// Outcome of a trial of the search for curves from P to Q. `degenerate`: no curve is isolated,
/// because Q lies on a caustic, where curves merge, at a focus of infinitely many curves, or at P.
/// |J| is then 0 within the tolerance.
enum class TrialOutcome {
  converged,
  no_approach,
  not_converged,
  left_region,
  too_long,
  degenerate
};
inline constexpr int trial_outcomes = 6;

/// Cost of the search for connections. All counts are integers, so that their sums do not depend on
/// the order of summation.
struct ConnectionStatistics {
  /// Number of trials with each TrialOutcome.
  std::array<std::uint64_t, trial_outcomes> outcomes{};
  std::uint64_t iterations = 0;   ///< total number of Gauss-Newton steps tried
  std::uint64_t guess_steps = 0;  ///< Leapfrog steps in the search for points of rays closest to Q
  /// Leapfrog steps with a tangent map, for rays that end far from Q.
  std::uint64_t rough_steps = 0;
  std::uint64_t tangent_steps = 0;  ///< steps of the accurate integrator, with a tangent map
  std::uint64_t pairs = 0;          ///< number of calls of connect() that ran a trial
  std::uint64_t found = 0;          ///< number of pairs of points whose first trial converged
  /// Number of trials after the first one, summed over the pairs whose first trial converged.
  /// Without roulette, this is the sum of K (C26).
  std::uint64_t further = 0;
  std::uint64_t most_trials_of_one = 0;     ///< largest number of further trials of one pair
  std::uint64_t roulette_terminations = 0;  ///< number of searches terminated by Russian roulette

  void add(TrialOutcome outcome) { ++outcomes[static_cast<int>(outcome)]; }
  /// Records a pair of points whose connecting curve is known in closed form.
  void add_pair(TrialOutcome outcome) {
    ++pairs;
    add(outcome);
    found += outcome == TrialOutcome::converged;
  }
  std::uint64_t trials() const;
  std::uint64_t count(TrialOutcome outcome) const { return outcomes[static_cast<int>(outcome)]; }
  double success_rate() const;
  double iterations_per_trial() const;
  double mean_trials() const;
  void record_trials(std::uint64_t further_trials);
  ConnectionStatistics& operator+=(const ConnectionStatistics& other);
};

extern const DatasetTable trials_table;
/// Writes the number of trials with each outcome, and the number of iterations.
void write_trials(ResultFile& file, const ConnectionStatistics& statistics);
/// Writes the number of pairs of points for which curves were searched, and the cost of computing
/// K, the number of trials until a curve is found again (C26).
void write_pairs(ResultFile& file, const ConnectionStatistics& statistics);

/// A random curve from P to Q and its weight (multiplicity). f(curve) * multiplicity is an unbiased
/// estimate of the sum of f over all curves (C26). The same estimator is used for specular paths
/// [zeltner2020] and curved rays [pediredla2020]. If no curve is found, the estimate is 0.
struct ConnectionEstimate {
  TrialOutcome outcome = TrialOutcome::no_approach;  ///< outcome of the first trial
  std::optional<Connection> curve;
  double multiplicity = 0;
};

/// A curve and the number of trials that converged to it.
struct FoundConnection {
  Connection curve;
  std::uint64_t found;
};

bool same_curve(const Connection& a, const Connection& b, double tolerance);

}  // namespace flatspeckle::grin

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

/// Where a curve may run: region(x) -> bool. The two end points are not asked about.
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

/// A ray that joins P and Q.
struct Connection {
  /// Unit tangents, both along the way from P to Q.
  Vec3 start_direction = Vec3::Zero(), end_direction = Vec3::Zero();
  double sigma;  ///< ray parameter at Q (conventions, C23)
  double arc_length, optical_path;
  double spreading;   ///< |J_PQ|, area per solid angle (C25)
  int orientation;    ///< sign of the determinant in J
  int steps;          ///< equal steps of the integrator
  int caustics = -1;  ///< passed on the way (Maslov index); -1: not counted
};

struct ConnectionOptions {
  double step;                 ///< largest step in sigma: length at index 1
  double max_length;           ///< longer curves do not count; arc length
  StartDirections start = {};  ///< of the trials
  int max_iterations = 40;     ///< after that a trial has failed
  double tolerance = 1e-10;    ///< distance from Q at the end, in units of |PQ|
  double carry = 0;       ///< from so near, in the same units, the last move to Q is not traced
                          ///< but follows from derivatives; arc length and |J| err by as much
  double same = 1e-5;     ///< two curves are one if they start and last alike to this; rad
  double caustic = 1e-5;  ///< Q is on one where a beam from P is narrower than this times
                          ///< its widest
  std::uint64_t roulette_after = 512;  ///< trials in search of a curve before roulette begins
  bool count_caustics = true;          ///< of a curve found: one more trace along it
};

/// How a trial ended. `degenerate`: Q lies on a caustic, where curves merge, or on the focus of a
/// continuum of them (or on P): |J| = 0 to tolerance, and no curve stands for itself.
enum class TrialOutcome {
  converged,
  no_approach,
  not_converged,
  left_region,
  too_long,
  degenerate
};
inline constexpr int trial_outcomes = 6;

/// What the search cost. Integers, so that sums do not depend on the order.
struct ConnectionStatistics {
  std::array<std::uint64_t, trial_outcomes> outcomes{};  ///< trials, by TrialOutcome
  std::uint64_t iterations = 0;                          ///< Gauss-Newton steps tried, all trials
  std::uint64_t guess_steps = 0;    ///< of Leapfrog, in search of closest approaches
  std::uint64_t rough_steps = 0;    ///< of Leapfrog with a tangent map, far from Q
  std::uint64_t tangent_steps = 0;  ///< of the integrator proper with a tangent map
  std::uint64_t pairs = 0;          ///< calls of connect that ran a trial
  std::uint64_t found = 0;          ///< of these, those whose first trial converged
  std::uint64_t refind = 0;         ///< further trials of these (the sum of K where no roulette)
  std::uint64_t refind_max = 0;     ///< the largest number of further trials of one pair
  std::uint64_t roulette_ends = 0;  ///< searches that roulette ended

  void add(TrialOutcome outcome) { ++outcomes[static_cast<int>(outcome)]; }
  /// A pair of points of which a closed form tells the curve.
  void add_pair(TrialOutcome outcome) {
    ++pairs;
    add(outcome);
    found += outcome == TrialOutcome::converged;
  }
  std::uint64_t trials() const;
  std::uint64_t count(TrialOutcome outcome) const { return outcomes[static_cast<int>(outcome)]; }
  double success_rate() const;
  double iterations_per_trial() const;
  double mean_refind() const;
  void record_refind(std::uint64_t further_trials);
  ConnectionStatistics& operator+=(const ConnectionStatistics& other);
};

extern const DatasetTable trials_table;
/// How the trials of curves ended, and their iterations.
void write_trials(ResultFile& file, const ConnectionStatistics& statistics);
/// The pairs of points that curves were sought between, and what K cost (C26).
void write_pairs(ResultFile& file, const ConnectionStatistics& statistics);

/// One random curve from P to Q and its weight: f(curve) multiplicity is unbiased for the sum of f
/// over all curves (C26). Without a curve the estimate is 0.
struct ConnectionEstimate {
  TrialOutcome outcome = TrialOutcome::no_approach;  ///< of the first trial
  std::optional<Connection> curve;
  double multiplicity = 0;
};

/// A curve and how many of the trials ended on it.
struct FoundConnection {
  Connection curve;
  std::uint64_t found;
};

bool same_curve(const Connection& a, const Connection& b, double tolerance);

}  // namespace flatspeckle::grin

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Sums of numbered batches, kept in a fixed number of groups so that the error of *any* function
/// of the sums (a mean, a covariance with its mean removed, a ratio, a half-width) follows from
/// leaving one group out at a time. Batch b belongs to group b mod groups.
class GroupedSums {
 public:
  GroupedSums() = default;
  /// size: complex sums per batch. The number of groups is 256, or less where memory asks for it.
  explicit GroupedSums(std::size_t size);

  /// Adds batch number batches(): numbers must come in order, which makes the sums reproducible.
  void add(double samples, std::span<const Complex> sums);

  std::size_t size() const { return size_; }
  std::uint64_t batches() const { return batches_; }
  /// Groups that hold at least one batch.
  std::size_t groups() const { return samples_.size(); }
  double group_samples(std::size_t group) const { return samples_[group]; }
  std::span<const Complex> group_sums(std::size_t group) const;
  double total_samples() const;
  std::vector<Complex> total() const;

  /// The whole state, for checkpoints: sums are [group][entry] over groups().
  struct State {
    std::uint64_t batches = 0;
    std::vector<double> samples;
    std::vector<Complex> sums;
  };
  State state() const { return {batches_, samples_, sums_}; }
  /// Throws InputError if the shapes do not belong to a GroupedSums of this size, or the samples
  /// not to the batches.
  void restore(State state);

 private:
  std::size_t size_ = 0, most_groups_ = 1;
  std::uint64_t batches_ = 0;
  std::vector<double> samples_;
  std::vector<Complex> sums_;
};

/// An estimate per entry: value and standard error. For complex values the error is that of the
/// distance in the complex plane, sqrt(var Re + var Im).
struct Estimate {
  std::vector<Complex> value;
  std::vector<double> error;
  /// 1 where a few of the batches carry the error, so that it is likely too small (jackknife).
  /// Empty: nowhere.
  std::vector<std::uint64_t> rare = {};
};

/// Standard errors beyond which a normal value lies with a probability of about 1e-5, where its
/// error is taken from this number of groups, two or more: Student's quantile, within a fifth.
double outlier_errors(std::size_t groups);

std::vector<double> real_parts(std::span<const Complex> values);
/// Entries [first, first + count).
Estimate part(const Estimate& all, std::size_t first, std::size_t count);
/// Adds the entries of `more` at the end.
void append(Estimate& all, const Estimate& more);

/// What is estimated, as a function of summed samples: theta(samples, sums) -> values.
using Estimator =
    std::function<std::vector<Complex>(double samples, std::span<const Complex> sums)>;

/// The simplest of them: sums / samples.
std::vector<Complex> sample_mean(double samples, std::span<const Complex> sums);

/// Value of theta on all groups and its delete-one-group jackknife error for groups of unequal size
/// (Busing, Meijer and van der Leeden 1999, eqs. 6-7). With fewer than two groups the error is
/// infinite.
///
/// Rare: with d the deviations of the groups, (sum d^2)^2 / sum d^4 says how many of them make up
/// the error. It is a third of the groups where they are normal, and 1 where one outweighs all
/// others; rare is less than 24, and less than a ninth of the groups.
Estimate jackknife(const GroupedSums& sums, const Estimator& theta);

/// Whether the mean of any sum differs between groups by more than rounding. Where none does, no
/// standard error can be taken from them: nothing that varies was sampled.
bool varies(const GroupedSums& sums);

/// RMS error relative to the RMS magnitude; 0 where every value and error is 0.
double relative_error(const Estimate& estimate);

/// Means of sums of entries: that of number i adds up `parts` entries from i stride on.
struct EntrySums {
  std::size_t count, stride = 1, parts = 1;
};

/// An error that fewer of 256 groups than this make up is carried by a few of them
/// (Estimate::rare); of fewer groups in all so many fewer.
constexpr double few_groups = 24;

/// jackknife() that marks what fewer than `few` groups of 256 make up.
Estimate jackknife(const GroupedSums& sums, const Estimator& theta, double few);

/// jackknife() of these sums / samples. They are linear: leaving a group out moves them in
/// proportion to how far the group's own mean is off, so that nothing is left out one at a time.
Estimate jackknife(const GroupedSums& sums, const EntrySums& of, double few = few_groups);

/// jackknife() of a theta that is linear in the sums, from which what it shares with the sum number
/// `control`, known to be 0 on average, is taken away (control variate, by regression over the
/// groups). The regression's own bias is of the order of one over the samples. Only where it is
/// worth it: where groups are many, and the control tells clearly of the variance.
Estimate controlled_jackknife(const GroupedSums& sums, const Estimator& theta, std::size_t control,
                              double few = few_groups);

}  // namespace flatspeckle

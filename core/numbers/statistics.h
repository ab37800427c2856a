#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Sums over numbered batches of samples. Batch b is added to group b mod (number of groups). From
/// the sums of the groups, jackknife() estimates the standard error of any function of the total
/// sums, such as a ratio or a half-width, by leaving out one group at a time.
class GroupedSums {
 public:
  GroupedSums() = default;
  /// size: number of complex sums of a batch. There are 256 groups, or fewer if the size is so
  /// large that memory must be limited.
  explicit GroupedSums(std::size_t size);

  /// Adds the sums of the next batch, whose number is batches(). Batches are added in the order of
  /// their numbers, so that rounding errors are reproducible.
  void add(double samples, std::span<const Complex> sums);

  std::size_t size() const { return size_; }
  std::uint64_t batches() const { return batches_; }
  /// Returns the number of groups that contain at least one batch.
  std::size_t groups() const { return samples_.size(); }
  double group_samples(std::size_t group) const { return samples_[group]; }
  std::span<const Complex> group_sums(std::size_t group) const;
  double total_samples() const;
  std::vector<Complex> total() const;

  /// Complete content of a GroupedSums, for checkpoints. samples has one value per group; sums is
  /// [group][entry].
  struct State {
    std::uint64_t batches = 0;
    std::vector<double> samples;
    std::vector<Complex> sums;
  };
  State state() const { return {batches_, samples_, sums_}; }
  /// Replaces the content by a stored state. Throws InputError if the state has another number of
  /// sums per batch, or if its numbers of samples and batches contradict each other.
  void restore(State state);

 private:
  std::size_t size_ = 0, most_groups_ = 1;
  std::uint64_t batches_ = 0;
  std::vector<double> samples_;
  std::vector<Complex> sums_;
};

/// Estimates of several quantities (entries): values and standard errors. The error of a complex
/// value is sqrt(var Re + var Im), the RMS distance in the complex plane.
struct Estimate {
  std::vector<Complex> value;
  std::vector<double> error;
  /// 1 for each entry that is undersampled: a few batches dominate its standard error, which is
  /// probably too small (see jackknife()). Empty if no entry is undersampled.
  std::vector<std::uint64_t> rare = {};
};

/// Returns the deviation, in standard errors, that a normally distributed value exceeds with a
/// probability of about 1e-5 if its standard error is estimated from this number of groups (at
/// least 2). This is the quantile of Student's distribution, approximated to within 20 %.
double outlier_errors(std::size_t groups);

std::vector<double> real_parts(std::span<const Complex> values);
/// Returns the entries first .. first + count - 1.
Estimate part(const Estimate& all, std::size_t first, std::size_t count);
/// Appends the entries of `more` to `all`.
void append(Estimate& all, const Estimate& more);

/// Function theta(samples, sums) that computes the quantities to be estimated from the number of
/// samples and the sums over them.
using Estimator =
    std::function<std::vector<Complex>(double samples, std::span<const Complex> sums)>;

/// Estimator of the means: returns sums / samples.
std::vector<Complex> sample_mean(double samples, std::span<const Complex> sums);

/// Returns theta for the sums over all groups, and its standard error by the delete-one-group
/// jackknife for groups of unequal size (Busing, Meijer and van der Leeden [busing1999], eqs. 6-7).
/// With fewer than two groups the error is infinite.
///
/// Marks undersampled entries (Estimate::rare) by an effective number of groups that dominate the
/// error: (sum d^2)^2 / sum d^4, where d are the deviations of the groups from their mean. It is a
/// third of the number of groups for normally distributed d, and 1 if one group outweighs all
/// others. An entry is marked if it is below 24 and below a ninth of the number of groups.
Estimate jackknife(const GroupedSums& sums, const Estimator& theta);

/// Whether the mean of at least one of the sums differs between groups by more than rounding
/// errors. Otherwise no standard error can be estimated, because the samples have no variance.
bool varies(const GroupedSums& sums);

/// Returns the RMS of the errors of all entries divided by the RMS of their magnitudes; 0 if all
/// errors are 0.
double relative_error(const Estimate& estimate);

/// The entries first .. first + count - 1.
struct EntryRange {
  std::size_t first, count;
};

/// Effective number of groups, defined at jackknife(), below which an entry counts as undersampled
/// (Estimate::rare). If there are fewer than 216 groups, this limit is reduced in proportion.
constexpr double few_groups = 24;

/// Returns theta and its jackknife error, with `few` instead of few_groups as the limit for
/// undersampled entries.
Estimate jackknife(const GroupedSums& sums, const Estimator& theta, double few);

/// Returns by how much the mean of theta exceeds the theta of infinitely many samples, estimated by
/// the same jackknife; 0 with fewer than two groups.
std::vector<Complex> jackknife_bias(const GroupedSums& sums, const Estimator& theta);

/// Computes the jackknife of the means of these entries. This is faster than with an Estimator,
/// because means are linear in the sums: their errors follow directly from the means of the groups.
Estimate jackknife(const GroupedSums& sums, const EntryRange& of, double few = few_groups);

/// Computes the jackknife of a theta that is linear in the sums, with control variates: the sums of
/// indices `controls`, whose expectations are 0, one after the other. Their coefficients follow
/// from regressions over the groups, whose bias is of the order of 1 / samples. A control variate
/// is used only if there are at least 32 groups and it clearly reduces the variance.
Estimate controlled_jackknife(const GroupedSums& sums, Estimator theta,
                              std::span<const std::size_t> controls, double few = few_groups);

}  // namespace flatspeckle

#include "core/numbers/statistics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/contract.h"
#include "core/error.h"

namespace flatspeckle {

namespace {

/// A linear combination of control variates that is orthogonal to others over the groups.
struct OrthogonalControl {
  std::vector<double> factors;     ///< by control
  std::vector<double> deviations;  ///< of the means of the groups from the mean of all
};

/// Returns the sum of products over the groups, weighted by their numbers of samples.
double product(const GroupedSums& sums, std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t group = 0; group < sums.groups(); ++group)
    sum += sums.group_samples(group) * a[group] * b[group];
  return sum;
}

/// Orthogonalises control variates in their order (modified Gram-Schmidt). Those that are constant,
/// or are a linear combination of earlier ones to rounding, are left out, as are those whose mean
/// is not 0 within its error: samples of high values are missing.
std::vector<OrthogonalControl> orthogonal(const GroupedSums& sums,
                                          std::span<const std::size_t> controls) {
  constexpr double smallest = 1e-20;  // of the sum of squares that may be left
  const std::vector<Complex> total = sums.total();
  std::vector<OrthogonalControl> found;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    OrthogonalControl control{std::vector<double>(controls.size()), {}};
    control.factors[i] = 1;
    const double mean = total[controls[i]].real() / sums.total_samples();
    for (std::size_t group = 0; group < sums.groups(); ++group)
      control.deviations.push_back(
          sums.group_sums(group)[controls[i]].real() / sums.group_samples(group) - mean);
    const double whole = product(sums, control.deviations, control.deviations);
    const double error =
        std::sqrt(whole / static_cast<double>(sums.groups()) / sums.total_samples());
    if (std::abs(mean) > outlier_errors(sums.groups()) * error) continue;
    for (const OrthogonalControl& other : found) {
      const double share = product(sums, control.deviations, other.deviations) /
                           product(sums, other.deviations, other.deviations);
      for (std::size_t k = 0; k < controls.size(); ++k)
        control.factors[k] -= share * other.factors[k];
      for (std::size_t group = 0; group < sums.groups(); ++group)
        control.deviations[group] -= share * other.deviations[group];
    }
    if (product(sums, control.deviations, control.deviations) > smallest * whole)
      found.push_back(std::move(control));
  }
  return found;
}

/// Returns the factors by which the means of the control variates are subtracted from the entries
/// of theta, by [control][entry]; 0 for those that are not used.
std::vector<std::vector<double>> control_factors(const GroupedSums& sums, const Estimator& theta,
                                                 std::span<const std::size_t> controls) {
  // Least fraction of the variance that a control variate must explain: ten times the mean fraction
  // for a variable that is independent of theta.
  const double least_fraction = 10 / static_cast<double>(sums.groups());
  const std::vector<Complex> mean = theta(sums.total_samples(), sums.total());
  const std::vector<OrthogonalControl> found = orthogonal(sums, controls);
  std::vector<std::vector<double>> shared(found.size(), std::vector<double>(mean.size()));
  std::vector<double> left(mean.size());
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const double size = sums.group_samples(group);
    const auto value = theta(size, sums.group_sums(group));
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const double deviation = (value[i] - mean[i]).real();
      left[i] += size * deviation * deviation;
      for (std::size_t k = 0; k < found.size(); ++k)
        shared[k][i] += size * deviation * found[k].deviations[group];
    }
  }
  std::vector<std::vector<double>> factors(controls.size(), std::vector<double>(mean.size()));
  std::vector<double> square;
  for (const OrthogonalControl& control : found)
    square.push_back(product(sums, control.deviations, control.deviations));
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const auto explained = [&](std::size_t k) { return shared[k][i] * shared[k][i] / square[k]; };
    // those that explain little may be clear once the others have reduced the variance
    std::ranges::sort(order, std::greater(), explained);
    for (const std::size_t k : order) {
      if (!(explained(k) > least_fraction * left[i])) break;
      left[i] -= explained(k);
      for (std::size_t c = 0; c < controls.size(); ++c)
        factors[c][i] += shared[k][i] / square[k] * found[k].factors[c];
    }
  }
  return factors;
}

std::size_t most_groups(std::size_t size) {
  constexpr std::size_t most = 256, fewest = 16, most_bytes = std::size_t{1} << 28;
  return std::clamp(most_bytes / (sizeof(Complex) * std::max<std::size_t>(size, 1)), fewest, most);
}

/// Relative size below which deviations are regarded as rounding errors.
constexpr double rounding = 1e-13;

bool is_rare(double sum_dd, double sum_d4, std::size_t groups, double few) {
  constexpr double many = 216;
  const double least = few * std::min(1.0, static_cast<double>(groups) / many);
  return sum_dd * sum_dd < least * sum_d4;
}

std::uint64_t is_carried_by_few(const Estimate& estimate, std::size_t i, double sum_dd,
                                double sum_d4, std::size_t groups, double few) {
  const bool rounded = estimate.error[i] < rounding * std::abs(estimate.value[i]);
  return !rounded && is_rare(sum_dd, sum_d4, groups, few) ? 1 : 0;
}

/// Returns a power of two by which values of this size are multiplied before they are squared, so
/// that squares of small values do not underflow; 1 for other sizes.
double lift(double size) {
  constexpr double small = 1e-100;
  constexpr int most = 1000;
  return size > 0 && size < small ? std::ldexp(1.0, std::min(-std::ilogb(size), most)) : 1;
}

/// Calls use(group, theta without this group) for each group.
template <class Use>
void leave_out_each(const GroupedSums& sums, const Estimator& theta, const Use& use) {
  const double samples = sums.total_samples();
  const std::vector<Complex> total = sums.total();
  std::vector<Complex> without(total.size());
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto left_out = sums.group_sums(group);
    for (std::size_t i = 0; i < total.size(); ++i) without[i] = total[i] - left_out[i];
    use(group, theta(samples - sums.group_samples(group), without));
  }
}

}  // namespace

Estimate controlled_jackknife(const GroupedSums& sums, Estimator theta,
                              std::span<const std::size_t> controls, double few) {
  constexpr std::size_t many = 32;
  if (sums.groups() < many) return jackknife(sums, theta, few);
  const auto factors = control_factors(sums, theta, controls);
  const auto controlled = [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> value = theta(samples, all);
    for (std::size_t k = 0; k < controls.size(); ++k)
      for (std::size_t i = 0; i < value.size(); ++i)
        value[i] -= factors[k][i] * all[controls[k]] / samples;
    return value;
  };
  return jackknife(sums, controlled, few);
}

GroupedSums::GroupedSums(std::size_t size) : size_(size), most_groups_(most_groups(size)) {
  sums_.reserve(most_groups_ * size);
}

void GroupedSums::add(double samples, std::span<const Complex> sums) {
  FS_EXPECT(sums.size() == size_);
  if (batches_ < most_groups_) {
    samples_.push_back(samples);
    sums_.insert(sums_.end(), sums.begin(), sums.end());
  } else {
    const std::size_t group = batches_ % most_groups_;
    samples_[group] += samples;
    const auto row = sums_.begin() + static_cast<std::ptrdiff_t>(group * size_);
    std::transform(sums.begin(), sums.end(), row, row,
                   [](Complex x, Complex sum) { return sum + x; });
  }
  ++batches_;
}

std::span<const Complex> GroupedSums::group_sums(std::size_t group) const {
  return {sums_.data() + group * size_, size_};
}

double GroupedSums::total_samples() const {
  double total = 0;
  for (double samples : samples_) total += samples;
  return total;
}

std::vector<Complex> GroupedSums::total() const {
  std::vector<Complex> total(size_);
  for (std::size_t group = 0; group < groups(); ++group) {
    const auto sums = group_sums(group);
    for (std::size_t i = 0; i < size_; ++i) total[i] += sums[i];
  }
  return total;
}

void GroupedSums::restore(State state) {
  constexpr std::uint64_t most_batches = std::uint64_t{1}
                                         << 53;  // largest count that a double holds exactly
  const std::size_t groups = std::min<std::uint64_t>(state.batches, most_groups_);
  if (state.samples.size() != groups || state.sums.size() != groups * size_)
    throw InputError("the checkpoint's sums have another shape than this scene's");
  if (state.batches > most_batches ||
      !std::ranges::all_of(state.samples, [](double samples) { return samples > 0; }))
    throw InputError("the checkpoint's samples do not match its batches");
  batches_ = state.batches;
  samples_ = std::move(state.samples);
  sums_.assign(state.sums.begin(), state.sums.end());
}

std::vector<Complex> sample_mean(double samples, std::span<const Complex> sums) {
  std::vector<Complex> mean(sums.begin(), sums.end());
  for (Complex& value : mean) value /= samples;
  return mean;
}

double outlier_errors(std::size_t groups) {
  const double freedom = static_cast<double>(groups) - 1;
  return 4.42 * std::exp((5.4 + 4.2 / freedom) / freedom);
}

std::vector<double> real_parts(std::span<const Complex> values) {
  std::vector<double> real;
  for (const Complex value : values) real.push_back(value.real());
  return real;
}

Estimate part(const Estimate& all, std::size_t first, std::size_t count) {
  const auto from = static_cast<std::ptrdiff_t>(first),
             to = from + static_cast<std::ptrdiff_t>(count);
  Estimate found{{all.value.begin() + from, all.value.begin() + to},
                 {all.error.begin() + from, all.error.begin() + to}};
  if (!all.rare.empty()) found.rare.assign(all.rare.begin() + from, all.rare.begin() + to);
  return found;
}

void append(Estimate& all, const Estimate& more) {
  all.value.insert(all.value.end(), more.value.begin(), more.value.end());
  all.error.insert(all.error.end(), more.error.begin(), more.error.end());
  all.rare.insert(all.rare.end(), more.rare.begin(), more.rare.end());
}

Estimate jackknife(const GroupedSums& sums, const Estimator& theta) {
  return jackknife(sums, theta, few_groups);
}

Estimate jackknife(const GroupedSums& sums, const Estimator& theta, double few) {
  const double samples = sums.total_samples();
  Estimate estimate{theta(samples, sums.total()), {}};
  const std::size_t size = estimate.value.size(), groups = sums.groups();
  estimate.rare.resize(size);
  if (groups < 2) {
    estimate.error.assign(size, std::numeric_limits<double>::infinity());
    return estimate;
  }
  // With h = samples / group_samples, the pseudo-value of a group is theta + (h-1)(theta -
  // theta_without), and its weight is 1/(h-1). Only sums over the deviations d of the pseudo-values
  // from theta are needed.
  double sum_w = 0;
  std::vector<Complex> sum_d(size), sum_mean(size);
  std::vector<double> sum_dd(size), sum_d4(size), lifted(size);
  for (std::size_t i = 0; i < size; ++i) lifted[i] = lift(std::abs(estimate.value[i]));
  leave_out_each(sums, theta, [&](std::size_t group, const std::vector<Complex>& value) {
    const double h_minus_1 = samples / sums.group_samples(group) - 1;
    sum_w += 1 / h_minus_1;
    for (std::size_t i = 0; i < size; ++i) {
      const Complex difference = lifted[i] * (estimate.value[i] - value[i]);
      sum_d[i] += difference;
      const double dd = h_minus_1 * std::norm(difference);
      sum_dd[i] += dd;
      sum_d4[i] += dd * dd;
      sum_mean[i] += h_minus_1 / (h_minus_1 + 1) * difference;
    }
  });
  estimate.error.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const Complex mean = sum_mean[i];  // jackknife estimate minus theta
    const double spread =
        sum_dd[i] - 2 * (std::conj(mean) * sum_d[i]).real() + sum_w * std::norm(mean);
    estimate.error[i] = std::sqrt(std::max(0.0, spread) / static_cast<double>(groups)) / lifted[i];
    estimate.rare[i] = is_carried_by_few(estimate, i, sum_dd[i], sum_d4[i], groups, few);
  }
  return estimate;
}

std::vector<Complex> jackknife_bias(const GroupedSums& sums, const Estimator& theta) {
  const double samples = sums.total_samples();
  const std::vector<Complex> all = theta(samples, sums.total());
  std::vector<Complex> bias(all.size());
  if (sums.groups() < 2) return bias;
  leave_out_each(sums, theta, [&](std::size_t group, const std::vector<Complex>& value) {
    const double share = 1 - sums.group_samples(group) / samples;
    for (std::size_t i = 0; i < all.size(); ++i) bias[i] += share * (value[i] - all[i]);
  });
  return bias;
}

Estimate jackknife(const GroupedSums& sums, const EntryRange& of, double few) {
  const double samples = sums.total_samples();
  const std::size_t groups = sums.groups();
  std::vector<Complex> total(of.count);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto own = sums.group_sums(group).subspan(of.first, of.count);
    for (std::size_t i = 0; i < of.count; ++i) total[i] += own[i];
  }
  Estimate estimate{sample_mean(samples, total), {}};
  estimate.rare.resize(of.count);
  if (groups < 2) {
    estimate.error.assign(of.count, std::numeric_limits<double>::infinity());
    return estimate;
  }
  // for means, the pseudo-value of a group in jackknife() is the mean of the group, and the mean of
  // all pseudo-values is theta
  std::vector<double> lifted(of.count), sum_dd(of.count), sum_d4(of.count);
  for (std::size_t i = 0; i < of.count; ++i) lifted[i] = lift(std::abs(estimate.value[i]));
  for (std::size_t group = 0; group < groups; ++group) {
    const double own = sums.group_samples(group), weight = own / (samples - own);
    const auto values = sums.group_sums(group).subspan(of.first, of.count);
    for (std::size_t i = 0; i < of.count; ++i) {
      const double re = lifted[i] * (values[i].real() / own - estimate.value[i].real());
      const double im = lifted[i] * (values[i].imag() / own - estimate.value[i].imag());
      const double dd = weight * (re * re + im * im);
      sum_dd[i] += dd;
      sum_d4[i] += dd * dd;
    }
  }
  estimate.error.resize(of.count);
  for (std::size_t i = 0; i < of.count; ++i) {
    estimate.error[i] = std::sqrt(sum_dd[i] / static_cast<double>(groups)) / lifted[i];
    estimate.rare[i] = is_carried_by_few(estimate, i, sum_dd[i], sum_d4[i], groups, few);
  }
  return estimate;
}

bool varies(const GroupedSums& sums) {
  // bound on the relative rounding error of sums of many equal numbers
  constexpr double same = 1e-11;
  if (sums.groups() < 2) return false;
  const auto first = sums.group_sums(0);
  for (std::size_t group = 1; group < sums.groups(); ++group) {
    const double size = sums.group_samples(group) / sums.group_samples(0);
    const auto here = sums.group_sums(group);
    for (std::size_t i = 0; i < first.size(); ++i)
      if (std::abs(here[i] - size * first[i]) > same * std::abs(here[i])) return true;
  }
  return false;
}

double relative_error(const Estimate& estimate) {
  double error2 = 0, value2 = 0, largest = 0;
  for (Complex value : estimate.value) largest = std::max(largest, std::abs(value));
  const double lifted = lift(largest);
  for (double error : estimate.error) error2 += lifted * error * (lifted * error);
  for (Complex value : estimate.value) value2 += std::norm(lifted * value);
  return error2 == 0 ? 0 : std::sqrt(error2 / value2);
}

}  // namespace flatspeckle

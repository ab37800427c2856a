#include "mc/fit/task/correlated_errors.h"

#include <cmath>

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd real_values(const std::vector<Complex>& values) {
  const auto parts = real_parts(values);
  return Eigen::Map<const VectorXd>(parts.data(), std::ssize(parts));
}

}  // namespace

MatrixXd deviations(const GroupedSums& sums, const Estimator& theta) {
  const double samples = sums.total_samples();
  const auto total = sums.total();
  const VectorXd all = real_values(theta(samples, total));
  const auto groups = static_cast<Index>(sums.groups());
  // Pseudo-values and weights as those of jackknife().
  VectorXd mean = VectorXd::Zero(all.size()), rest(groups);
  MatrixXd found(all.size(), groups);
  auto without = total;
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto g = static_cast<Index>(group);
    const auto left_out = sums.group_sums(group);
    for (std::size_t i = 0; i < total.size(); ++i) without[i] = total[i] - left_out[i];
    rest[g] = samples / sums.group_samples(group) - 1;
    found.col(g) = all - real_values(theta(samples - sums.group_samples(group), without));
    mean += rest[g] / (rest[g] + 1) * found.col(g);
  }
  for (Index g = 0; g < groups; ++g)
    found.col(g) = std::sqrt(rest[g]) * found.col(g) - mean / std::sqrt(rest[g]);
  return found / std::sqrt(static_cast<double>(groups));
}

MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta) {
  const auto size = static_cast<Index>(theta(sums.total_samples(), sums.total()).size()),
             groups = static_cast<Index>(sums.groups());
  constexpr Index more = 10;
  if (groups < size + more) return {};
  const MatrixXd found = deviations(sums, theta);
  const double of_inverse =
      static_cast<double>(groups - 1) / static_cast<double>(groups - size - 2);
  MatrixXd covariance = of_inverse * found * found.transpose();
  const double shrinkage = 1 / static_cast<double>(groups);
  const VectorXd variance = covariance.diagonal();
  covariance *= 1 - shrinkage;
  covariance.diagonal() += shrinkage * variance;
  return covariance;
}

}  // namespace flatspeckle::mc

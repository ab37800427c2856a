#include "mc/fit/correlated_errors.h"

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

MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta) {
  const double samples = sums.total_samples();
  const auto total = sums.total();
  const VectorXd all = real_values(theta(samples, total));
  const auto size = all.size(), groups = static_cast<Index>(sums.groups());
  constexpr Index more = 10;
  if (groups < size + more) return {};
  // Pseudo-values and weights as those of jackknife().
  double sum_w = 0;
  VectorXd sum_d = VectorXd::Zero(size), mean = sum_d;
  MatrixXd sum_dd = MatrixXd::Zero(size, size);
  auto without = total;
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto left_out = sums.group_sums(group);
    for (std::size_t i = 0; i < total.size(); ++i) without[i] = total[i] - left_out[i];
    const double h_minus_1 = samples / sums.group_samples(group) - 1;
    const VectorXd d = all - real_values(theta(samples - sums.group_samples(group), without));
    sum_w += 1 / h_minus_1;
    sum_d += d;
    sum_dd += h_minus_1 * d * d.transpose();
    mean += h_minus_1 / (h_minus_1 + 1) * d;
  }
  const MatrixXd spread = sum_dd - mean * sum_d.transpose() - sum_d * mean.transpose() +
                          sum_w * mean * mean.transpose();
  const double of_inverse =
      static_cast<double>(groups - 1) / static_cast<double>(groups - size - 2);
  return of_inverse / static_cast<double>(groups) * spread;
}

}  // namespace flatspeckle::mc

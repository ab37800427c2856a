#include "mc/jobs/decay_curve.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace flatspeckle::mc {

DecayCurve::DecayCurve(const std::vector<double>& x, const std::vector<double>& values) {
  constexpr double least = 1e-300;
  std::map<double, double> curve{{0, 0}};
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i] > 0) curve[std::sqrt(x[i])] = std::log(std::max(values[i], least));
  for (const auto& [root, log] : curve) {
    root_.push_back(root);
    log_.push_back(log);
  }
}

double DecayCurve::operator()(double x) const {
  constexpr std::size_t stencil = 4;  // number of points that determine a cubic polynomial
  const std::size_t size = root_.size();
  if (size < 2) return 1;
  const double root = std::sqrt(x);
  const auto above = std::upper_bound(root_.begin() + 1, root_.end() - 1, root);
  const auto interval = static_cast<std::size_t>(above - root_.begin()) - 1;
  const std::size_t count = std::min(stencil, size),
                    first = std::min(interval == 0 ? 0 : interval - 1, size - count);
  double sum = 0;
  for (std::size_t i = first; i < first + count; ++i) {
    double basis = log_[i];
    for (std::size_t j = first; j < first + count; ++j)
      if (j != i) basis *= (root - root_[j]) / (root_[i] - root_[j]);
    sum += basis;
  }
  return std::exp(std::min(sum, std::max(log_[interval], log_[interval + 1])));
}

double DecayCurve::last() const {
  return root_.back() * root_.back();
}

Range DecayCurve::crossing(double level) const {
  for (std::size_t i = 1; i < root_.size(); ++i) {
    if (std::exp(log_[i]) > level) continue;
    if (i == 1) return {root_[1] * root_[1], Range::Censoring::below_value};
    double above = root_[i - 1], below = root_[i];
    for (int step = 0; step < 60; ++step) {
      const double middle = (above + below) / 2;
      ((*this)(middle * middle) > level ? above : below) = middle;
    }
    return {above * below, Range::Censoring::none};
  }
  return {last(), Range::Censoring::above_value};
}

DecayCurve DecayCurve::coarser() const {
  DecayCurve curve;
  for (std::size_t i = 0; i < root_.size(); ++i) {
    if (i % 2 == 1 && i + 1 < root_.size()) continue;
    curve.root_.push_back(root_[i]);
    curve.log_.push_back(log_[i]);
  }
  return curve;
}

}  // namespace flatspeckle::mc

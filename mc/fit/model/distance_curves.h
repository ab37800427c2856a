#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mc/fit/task/curve_values.h"

namespace flatspeckle::mc {

/// Reflectances, or field correlations, at distances from a beam on one slab. Their values are
/// smooth functions of the medium, because the degree of the harmonics changes only in refine().
/// They follow from one solution with all detectors and delays.
class DistanceCurves {
 public:
  /// Adds a curve. first: index of its first value among those of all curves of the model.
  void add(const Curve& curve, Eigen::Index first);

  int degree() const { return degree_; }
  /// Increases the degree until a further increase changes no value by more than `share` of its
  /// error, of errors[value]. Returns the largest change by that further increase, in units of the
  /// errors. solved: called after each solution.
  double refine(const Medium& medium, const Eigen::VectorXd& errors, double share,
                const std::function<void()>& solved);

  /// Puts the values of the curves among those of all curves.
  void solve(const Medium& medium, Eigen::VectorXd& all) const;

 private:
  /// A value: its index among all values, detector, and delay (0: none) of the request.
  struct Place {
    Eigen::Index value;
    Observable observable;
    std::size_t detector, delay;
  };
  int degree_ = 5;
  DistanceRequest request_;
  std::vector<Place> places_;
};

}  // namespace flatspeckle::mc

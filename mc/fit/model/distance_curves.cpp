#include "mc/fit/model/distance_curves.h"

#include <algorithm>

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Returns the index of `one` in a list. If it is missing, it is appended.
template <typename One>
std::size_t index_in(std::vector<One>& list, const One& one) {
  const auto found = std::ranges::find(list, one);
  const auto index = static_cast<std::size_t>(found - list.begin());
  if (found == list.end()) list.push_back(one);
  return index;
}

}  // namespace

void DistanceCurves::add(const Curve& curve, Index first) {
  request_.source_radius = curve.distances->source_radius;
  request_.numerical_aperture = curve.distances->numerical_aperture;
  for (const std::size_t entry : curve.entries) {
    const std::size_t detector = index_in(request_.detectors, curve.distances->detectors[entry]);
    const std::size_t delay = curve.moving() && curve.delays[entry] > 0
                                  ? 1 + index_in(request_.dynamics.delays, curve.delays[entry])
                                  : 0;
    places_.push_back({first++, curve.observable, detector, delay});
  }
}

double DistanceCurves::refine(const Medium& medium, const VectorXd& errors, double share,
                              const std::function<void()>& solved) {
  constexpr int step = 2, most = 17;
  VectorXd found = VectorXd::Zero(errors.size());
  solve(medium, found);
  while (true) {
    solved();
    VectorXd finer = found;
    degree_ += step;
    solve(medium, finer);
    const double change = (finer - found).cwiseQuotient(errors).cwiseAbs().maxCoeff();
    if (change < share || degree_ >= most) {
      degree_ -= step;
      return change;
    }
    found = std::move(finer);
  }
}

void DistanceCurves::solve(const Medium& medium, VectorXd& all) const {
  DistanceRequest request = request_;
  request.dynamics.motion.diffusion = medium.spec.diffusion;
  const auto values = distance_values(medium.scene, request, degree_);
  const DistanceLayout at(request, values.size());
  for (const Place& place : places_) {
    const double power = values[at(0, 0, place.detector)].real(),
                 g1 = values[at(0, place.delay, place.detector)].real() / power;
    if (place.observable == Observable::reflectance)
      all[place.value] =
          medium.spec.detector_scale * power / request.detectors[place.detector].area();
    else
      all[place.value] =
          place.observable == Observable::field_correlation ? g1 : medium.spec.beta * g1 * g1;
  }
}

}  // namespace flatspeckle::mc

#pragma once

#include <cstdint>
#include <vector>

#include "flatland/sensor.h"

namespace flatspeckle {

/// One recorded field u: a light seen in a view, by their numbers in the scene.
struct Channel {
  std::uint32_t light = 0, view = 0;
  bool operator==(const Channel&) const = default;
};

/// One covariance entry E[u_a conj(u_b)] - E[u_a] conj(E[u_b]), by channel numbers.
struct Entry {
  std::uint32_t a = 0, b = 0;
};

/// Which lights, views and entries a run is asked for. The order of `entries` is that of the
/// result:
///  intensity      [light][view], a = b
///  full           the lower triangle of channels [light][view], row by row, b <= a
///  pairs          [pair]
///  memory_effect  [tilt][view] reference against tilted; then the reference's [view] and the
///  tilted
///                 [tilt][view] intensities
struct CovarianceRequest {
  enum class Kind { intensity, pairs, memory_effect, full };
  Kind kind = Kind::intensity;
  std::vector<double> lights;  ///< angles
  std::vector<View> views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
  // memory_effect only
  std::vector<double> tilts;   ///< rotation of the light, radians
  std::vector<double> tilt_q;  ///< k (sin tilted - sin reference), per tilt (C19)
  std::size_t reference_views = 0;

  std::size_t tilted_entry(std::size_t tilt, std::size_t view) const {
    return tilt * reference_views + view;
  }
  std::size_t reference_intensity(std::size_t view) const {
    return tilts.size() * reference_views + view;
  }
  std::size_t tilted_intensity(std::size_t tilt, std::size_t view) const {
    return (tilts.size() + 1 + tilt) * reference_views + view;
  }
};

CovarianceRequest intensity_request(std::vector<double> lights, std::vector<View> views);
CovarianceRequest full_request(std::vector<double> lights, std::vector<View> views);
/// pairs: angles (light 1, view 1, light 2, view 2) of each.
struct AnglePair {
  double light1, view1, light2, view2;
};
CovarianceRequest pairs_request(const std::vector<AnglePair>& pairs);
/// Matched views keep k sin v - k sin i and the side of the medium (C19). Throws InputError for a
/// tilt that takes the light or a matched view past the horizon.
CovarianceRequest memory_effect_request(double k, double light, std::vector<double> views,
                                        std::vector<double> tilts);

}  // namespace flatspeckle

#include "mc/distance/detector_keys.h"

#include "core/error.h"

namespace flatspeckle::mc {

void add_keys(Keys& keys, DetectorValues& values) {
  keys.add("detector_radius", values.detector_radius, "Radius of the detectors, which are disks")
      .positive()
      .unit("length")
      .only_of("detectors at distances without ring_width");
  keys.add("ring_width", values.ring_width,
           "Width of the detectors, which are rings around the beam; distances are to its middle")
      .positive()
      .unit("length")
      .only_of("detectors at distances without detector_radius");
  keys.add("numerical_aperture", values.numerical_aperture,
           "Numerical aperture of the detectors: sine of the largest angle of detected light, "
           "times the index outside")
      .positive();
  keys.add("source_radius", values.source_radius,
           "Radius of the beam, which is uniform (0: a beam without extent)")
      .not_negative()
      .unit("length");
}

DistanceRequest make_detectors(const Keys& keys, const DetectorValues& values,
                               const std::string& key, const std::vector<double>& distances) {
  using Detector = DistanceDetector;
  const auto radius = keys.read(values.detector_radius), width = keys.read(values.ring_width);
  if (radius.has_value() == width.has_value())
    throw InputError("detector_radius, ring_width: give exactly one of them");
  DistanceRequest request;
  request.source_radius = keys.read(values.source_radius);
  request.numerical_aperture = keys.read(values.numerical_aperture);
  for (const double distance : distances) {
    request.detectors.push_back({radius ? Detector::Kind::disk : Detector::Kind::ring, distance,
                                 radius ? *radius : *width});
    if (!(request.detectors.back().nearest() > request.source_radius))
      throw InputError(key, distance,
                       "the detector must not overlap the beam: it requires a larger distance, "
                       "or a smaller detector or source_radius");
  }
  return request;
}

}  // namespace flatspeckle::mc

#pragma once

#include <vector>

#include "mc/paths/endpoint_factors/endpoint_factors.h"

namespace flatspeckle::mc {

/// Waves of the lights and of the views of a path: how often each was reflected at faces.
struct FaceWaves {
  int light = 0, view = 0;
};

/// A combination of waves, and the probability with which paths are scored for it.
struct ScoredWaves {
  FaceWaves waves;
  double probability = 1;
};

/// Returns the combinations into which reflections at the faces divide the far lights and views.
/// The probability is at most 1 and otherwise in proportion to the largest power of the waves,
/// because scoring is expensive. Combinations of less than 1e-6 of the power are omitted. Without
/// faces only unreflected waves exist.
std::vector<ScoredWaves> scored_waves(const Scene& scene);

/// Returns the scene with the directions that its lights and views have inside the faces.
Scene inside_faces(Scene scene);

/// Endpoint factors of far lights and views behind faces (C46, C47, C49), for one wave at a time
/// (choose()). A wave reaches a place after several crossings of the medium, which are unfolded:
/// attenuation and phase grow over all of them. Products of fields that were reflected differently
/// oscillate with depth and are not computed.
class FacedEndpoints : public EndpointFactors {
 public:
  /// endpoints: far endpoints, with directions outside.
  FacedEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints, bool phases);

  void choose(int wave) override;
  void attenuate(Vec x, std::span<Complex> out) override;

 private:
  Domain domain_;
  double k_, mu_t_;
  bool phases_;
  int wave_ = -1;
  struct Far {
    Vec towards;        ///< direction inside, from the medium to the endpoint
    double amplitude;   ///< of the field inside, before reflections
    double reflection;  ///< amplitude of reflection at a face
    double phase;       ///< at the face where light enters or leaves
  };
  std::vector<Far> far_;
  std::vector<double> phase_, magnitude_, factor_;
};

}  // namespace flatspeckle::mc

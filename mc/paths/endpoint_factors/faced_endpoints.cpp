#include "mc/paths/endpoint_factors/faced_endpoints.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/phasor.h"

namespace flatspeckle::mc {

namespace {

/// Largest power of waves that were reflected r times, relative to that of unreflected waves, over
/// all places of the medium: reflectance^r exp(-(r - 1) depth) for the most reflected ray.
class WavePower {
 public:
  /// Adds a ray with this angle outside.
  void add(const Scene& scene, double angle) {
    const Faces& faces = *scene.faces;
    const double cosine = std::abs(faces.entering().refracted(direction(angle)).z);
    rays_.push_back({faces.leaving().reflectance(cosine),
                     std::exp(-scene.medium.mu_t * scene.domain.depth / cosine)});
  }
  double operator()(int reflections) const {
    if (reflections == 0) return 1;
    double largest = 0;
    for (const auto& [reflectance, through] : rays_)
      largest = std::max(largest, reflectance * std::pow(reflectance * through, reflections - 1));
    return largest;
  }

 private:
  struct Ray {
    double reflectance, through;
  };
  std::vector<Ray> rays_;
};

}  // namespace

std::vector<ScoredWaves> scored_waves(const Scene& scene) {
  if (!scene.faces) return {{}};
  constexpr double least = 1e-6, paths_per_power = 4;
  constexpr int most = 64;
  WavePower lights, views;
  for (const Light& light : scene.request.lights) lights.add(scene, light.angle);
  for (const View& view : scene.request.views) views.add(scene, view.angle);
  std::vector<ScoredWaves> all;
  for (int light = 0; light < most && lights(light) >= least; ++light)
    for (int view = 0; view < most; ++view) {
      const double power = lights(light) * views(view);
      if (power < least) break;
      all.push_back({{light, view}, std::min(1.0, paths_per_power * power)});
    }
  return all;
}

Scene inside_faces(Scene scene) {
  if (!scene.faces) return scene;
  const auto turn = [&](double& angle) {
    angle = angle_of(scene.faces->entering().refracted(direction(angle)));
  };
  for (Light& light : scene.request.lights) turn(light.angle);
  for (View& view : scene.request.views) turn(view.angle);
  return scene;
}

/// The field of a far view outside contains, beside the transmission of a wave that enters from its
/// direction, the square root of the ratio of the radiances for equal power (see
/// Geometry::radiance_scale of mc/slab): it is divided equally between lights and views.
FacedEndpoints::FacedEndpoints(const Scene& scene, const std::vector<Endpoint>& endpoints,
                               bool phases)
    : EndpointFactors(endpoints.size()),
      domain_(scene.domain),
      k_(scene.k),
      mu_t_(scene.medium.mu_t),
      phases_(phases),
      phase_(endpoints.size()),
      magnitude_(endpoints.size()),
      factor_(endpoints.size()) {
  const Faces& faces = *scene.faces;
  const Face entering = faces.entering();
  const double index = faces.inside / faces.outside,
               scale = scene.medium.dimension == 3              ? 1
                       : faces.polarisation == Polarisation::te ? std::pow(index, -0.75)
                                                                : std::pow(index, 0.25);
  for (const Endpoint& endpoint : endpoints) {
    const double outside = endpoint.towards.z, reflected = entering.reflected(std::abs(outside));
    far_.push_back({entering.refracted(endpoint.towards), scale * (1 + reflected), -reflected,
                    outside > 0 ? -scene.outside_k() * outside * domain_.depth : 0});
  }
  choose(0);
}

void FacedEndpoints::choose(int wave) {
  if (wave == wave_) return;
  wave_ = wave;
  for (std::size_t j = 0; j < size(); ++j) {
    Vec w = far_[j].towards;
    if (wave % 2 == 1) w.z = -w.z;
    directions_.set(j, w);
    factor_[j] = far_[j].amplitude * std::pow(far_[j].reflection, wave);
  }
}

void FacedEndpoints::attenuate(Vec x, std::span<Complex> out) {
  for (std::size_t j = 0; j < size(); ++j) {
    const Vec w = directions_[j];
    // Depth to be crossed to the face of the endpoint, over all reflections
    const double crossed = wave_ * domain_.depth + (w.z > 0 ? domain_.depth - x.z : x.z);
    double inside = crossed / std::abs(w.z);
    if (domain_.kind == Domain::Kind::box)
      inside = std::min(inside, domain_.distance_to_side(x, w));
    constexpr double log_of_nothing = -1e4;  // finite, for the vectorised exp
    log_attenuation_[j] = std::max(-mu_t_ * inside / 2, log_of_nothing);
    phase_[j] = far_[j].phase + k_ * (std::abs(w.z) * crossed - w.x * x.x - w.y * x.y);
  }
  if (phases_) {
    damped_phasors(phase_, log_attenuation_, out);
  } else {
    damping(log_attenuation_, magnitude_);
    std::copy(magnitude_.begin(), magnitude_.end(), out.begin());
  }
  for (std::size_t j = 0; j < size(); ++j) out[j] *= factor_[j];
}

}  // namespace flatspeckle::mc

#include "mc/paths/estimators/flux.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <sstream>

#include "grin/media/scattering/diffusion_rate.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/endpoint_factors/faced_endpoints.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/estimators/flux_walk.h"
#include "mc/paths/walk/plan.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

namespace {

constexpr std::uint64_t walks_per_batch = 200;

/// Samples walks of light through a medium that varies, as FluxWalk does in a homogeneous medium.
/// The first collision is forced to lie in the medium. Flights are not biased; absorption reduces
/// the weight, with Russian roulette.
class VaryingFluxWalk {
 public:
  VaryingFluxWalk(const Scene& scene, const VaryingScattering& scattering, const LightEntry& entry,
                  RandomStream& random, std::span<Complex> sums)
      : domain_(scene.domain),
        profile_(*scene.profile),
        scattering_(scattering),
        entry_(entry),
        random_(random),
        tally_(scene, sums) {}

  /// Samples one walk. u: number in (0, 1), uniformly distributed, that selects the depth of the
  /// first collision.
  void walk(double u) {
    const Vec start = entry_.sample(random_);
    Vec w = entry_.light();
    const ProfileFlight first(profile_, start, w, domain_.distance_to_edge(start, w));
    double power = first.probability();
    if (power == 0) return;
    Vec x = start + first.sample(u) * w;
    while (collide(x, power)) {
      w = scattering_.at(x).sample(w, random_);
      const double edge = domain_.distance_to_edge(x, w),
                   flight = profile_.reach(x, w, -std::log(random_.uniform()), edge);
      x = x + flight * w;
      if (flight >= edge) return tally_.leave(x, w, power);
    }
  }

 private:
  /// Absorbs a fraction of the power; returns false if the walk is terminated.
  bool collide(Vec x, double& power) {
    constexpr std::uint64_t between_checks = 4096;
    if (++collisions_ % between_checks == 0) stop_if_interrupted();
    const double albedo = profile_.albedo(x);
    tally_.absorb(power * (1 - albedo));
    power *= albedo;
    constexpr double little = 0.1;
    if (power >= little) return true;
    const bool survives = random_.uniform() * little < power;
    power = little;
    return survives;
  }

  Domain domain_;
  const MediumProfile& profile_;
  const VaryingScattering& scattering_;
  const LightEntry& entry_;
  RandomStream& random_;
  FluxTally tally_;
  std::uint64_t collisions_ = 0;
};

template <typename Walk, typename Scattering>
SummedBatches walks(const std::shared_ptr<const Scene>& scene, const Scattering& scattering,
                    double kappa, std::uint64_t seed) {
  // The attribute `flatten` inlines all calls, whatever else the file contains. Without it,
  // function calls and walk data kept in memory instead of registers would cost 10 % of the time.
  return [=](std::uint64_t number, std::span<Complex> sums) __attribute__((flatten)) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    const Lights& lights = scene->request.lights;
    const std::size_t size = sums.size() / lights.size();
    for (std::size_t light = 0; light < lights.size(); ++light) {
      const LightEntry entry(scene->domain, lights[light].direction(), kappa);
      Walk walk(*scene, scattering, entry, random, sums.subspan(light * size, size));
      // The depths of the first collision are stratified, which reduces errors by a tenth.
      for (std::uint64_t path = 0; path < walks_per_batch; ++path)
        walk.walk((static_cast<double>(path) + random.uniform()) / walks_per_batch);
    }
  };
}

/// Makes the batches for a medium that does not scatter, where all light that collides is absorbed.
SummedBatches absorption(const std::shared_ptr<const Scene>& scene) {
  return [scene](std::uint64_t, std::span<Complex> sums) {
    const Lights& lights = scene->request.lights;
    for (std::size_t light = 0; light < lights.size(); ++light)
      sums[light * (sums.size() / lights.size()) + absorbed] =
          walks_per_batch * (1 - direct_transmittance(*scene, lights[light]) -
                             specular_reflectance(*scene, lights[light].angle));
  };
}

SummedBatches batches(const std::shared_ptr<const Scene>& scene, double kappa, std::uint64_t seed) {
  if (scene->medium.mu_s == 0) return absorption(scene);
  const auto inside = std::make_shared<const Scene>(inside_faces(*scene));
  SummedBatches chosen;
  if (scene->profile) return walks<VaryingFluxWalk>(scene, varying_scattering(*scene), kappa, seed);
  with_scattering(*scene, phase_of(*scene), [&]<typename Scattering>(const Scattering& scattering) {
    chosen = walks<FluxWalk<Scattering>>(inside, scattering, kappa, seed);
  });
  return chosen;
}

std::string describe(const Scene& scene, double kappa) {
  std::ostringstream text;
  text << "intensity without phases; ";
  if (scene.profile)
    text << scene.profile->describe();
  else if (scene.medium.mu_s == 0)
    text << "nothing scatters";
  else if (kappa > 0)
    text << "absorbing, decay length of diffuse light " << 1 / kappa;
  else
    text << "lossless";
  text << "; " << walks_per_batch << " paths per batch and light";
  return text.str();
}

/// Returns the largest relative error of the shares of all lights. It is infinite if no path has
/// contributed to a share that cannot be 0.
double worst_relative_error(const FluxJob& job, const Scene& scene, double kappa,
                            const GroupedSums& sums) {
  constexpr double deepest = 700;  // in decay lengths; light from beyond is 0 in double precision
  const FluxEstimates flux = flux_estimates(job, sums);
  const bool scatters = scene.medium.mu_s > 0;
  double worst = 0;
  const auto add_share = [&](const Estimate& share, bool is_open) {
    for (std::size_t light = 0; light < job.lights; ++light) {
      const double value = std::abs(share.value[light]);
      if (value > 0)
        worst = std::max(worst, share.error[light] / value);
      else if (is_open)
        worst = std::numeric_limits<double>::infinity();
    }
  };
  add_share(flux.reflectance, scatters);
  add_share(flux.transmittance, scatters && kappa * scene.domain.depth < deepest);
  add_share(flux.side_loss, scatters && scene.domain.kind == Domain::Kind::box);
  add_share(flux.absorptance, false);
  return worst;
}

}  // namespace

FluxJob flux_job(const Scene& original, std::size_t angle_bins, std::uint64_t seed) {
  require_walks(original, false);
  const auto scene = std::make_shared<const Scene>(original);
  const BulkMedium& medium = scene->medium;
  const double kappa =
      medium.mu_s > 0 && !scene->profile
          ? medium.mu_t * grin::diffusion_rate(medium.albedo, medium.g, medium.dimension)
          : 0;
  FluxJob job{{}, scene->request.lights.size(), angle_bins, describe(*scene, kappa)};
  if (medium.dimension == 3) job.angles = std::numbers::pi;
  job.batches.size = job.lights * (flux_shares + angle_bins);
  job.batches.samples_per_batch = static_cast<double>(walks_per_batch);
  job.batches.relative_error = [shape = job, scene, kappa](const GroupedSums& sums) {
    return worst_relative_error(shape, *scene, kappa, sums);
  };
  job.batches.deterministic = medium.mu_s == 0;
  job.batches.run = batches(scene, kappa, seed);
  return job;
}

}  // namespace flatspeckle::mc

#include "mc/paths/estimators/path_power.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/run/runner.h"
#include "mc/jobs/flux_job.h"
#include "mc/paths/estimators/path_endpoints.h"

namespace flatspeckle::mc {

namespace {

/// Number of views around the medium. They are rotated from batch to batch, so that on average no
/// peak of the scattered light is missed between them.
constexpr int view_count = 64;
constexpr double view_step = 2 * std::numbers::pi / view_count;

std::vector<View> views_around(double offset) {
  std::vector<double> angles;
  for (int v = 0; v < view_count; ++v) angles.push_back((v + offset) * view_step);
  return far_views(angles);
}

struct ScattererCount {
  int inner = 0;

  void flight(Vec, Vec, double) {}
  void scattering(Vec, Vec, Vec) { ++inner; }
};

/// Returns the width of the medium perpendicular to the light.
double cross_section(const Scene& scene) {
  const LightAperture aperture(scene.domain, scene.request.lights.front().direction());
  return aperture.all();
}

enum PowerSum : std::size_t { by_first, by_second, by_later, power_sums };

/// Adds the power of paths at their last scatterers, divided by the power that the incident ray
/// through the first scatterer loses in the medium. For paths of one scatterer this quotient is the
/// same wherever the scatterer lies. Because |A|^2 is a density over directions, the power that
/// arrives at a scatterer and is not absorbed is the squared endpoint factor of the light times the
/// weight.
class PowerScorer : public TallyScorer<ScattererCount> {
 public:
  PowerScorer(const PathWalks& walks, const Scene& turned, std::span<Complex> sums)
      : TallyScorer({}),
        walks_(walks),
        scene_(walks.scene()),
        extinction_(scene_),
        endpoints_(walks, turned, false,
                   [](std::size_t endpoints) { return std::vector<Complex>(endpoints); }),
        light_(scene_.request.lights.front().direction()),
        cross_section_(cross_section(scene_)),
        sums_(sums) {}

  void single(Vec x, double weight, FaceWaves waves) override {
    endpoints_.choose(waves);
    endpoints_.lights().attenuate(x, endpoints_.light_last);
    sums_[by_first] += weight * share_of(endpoints_.light_last.front(), x) / albedo(x);
  }

  void multiple(const Path& path) override {
    endpoints_.find(path, [this](EndpointFactors& endpoints, Vec x, Vec arrival, auto& out) {
      endpoints.attenuate(x, out);
      walks_.towards(x, arrival, endpoints.directions(), out);
    });
    const double scattered = path.weight * share_of(endpoints_.light_first.front(), path.first),
                 received = scattered / albedo(path.last),
                 leaves = escaping_fraction(endpoints_.view_last);
    if (tally().inner == 0)
      sums_[by_second] += received / albedo(path.first) / stays_inside(path.first, path.start);
    else
      sums_[by_later] += received;
    sums_[by_later] -= scattered * (1 - leaves);
  }

 private:
  double share_of(Complex factor, Vec first) const {
    const double back = scene_.domain.distance_to_edge(first, -light_);
    return std::norm(factor) / (cross_section_ * stays_inside(first - back * light_, light_));
  }
  static double escaping_fraction(const std::vector<Complex>& views) {
    double sum = 0;
    for (const Complex view : views) sum += std::norm(view);
    return view_step * sum;
  }
  double albedo(Vec x) const {
    return scene_.profile ? scene_.profile->albedo(x) : scene_.medium.albedo;
  }
  double stays_inside(Vec x, Vec w) const {
    return -std::expm1(-extinction_.optical_depth(x, w, scene_.domain.distance_to_edge(x, w)));
  }

  const PathWalks& walks_;
  const Scene& scene_;
  const Extinction extinction_;
  PathEndpoints<std::vector<Complex>> endpoints_;
  Vec light_;
  double cross_section_;
  std::span<Complex> sums_;
};

BatchJob power_job(const std::shared_ptr<const PathWalks>& walks) {
  // First batch number, so large that no other use of a seed has the same batch numbers
  constexpr std::uint64_t apart = std::uint64_t{1} << 61;
  BatchJob job;
  job.size = power_sums;
  job.samples_per_batch = static_cast<double>(walks->plan().paths_per_batch);
  job.run = [walks](std::uint64_t number, std::span<Complex> sums) {
    Scene turned = walks->scene();
    const double offset = std::fmod(static_cast<double>(number) * std::numbers::phi, 1);
    turned.request = intensity_request(turned.request.lights, views_around(offset));
    PowerScorer scorer(*walks, turned, sums);
    walks->batch(apart + number, scorer);
  };
  return job;
}

/// Whether a material absorbs without scattering. No path has a scatterer in it, so the power that
/// it absorbs would be missing.
bool has_absorber(const Scene& scene) {
  return scene.profile && std::ranges::any_of(scene.profile->materials(), [](const Material& one) {
           return one.medium.mu_t > 0 && one.medium.mu_s == 0;
         });
}

}  // namespace

std::shared_ptr<const PathWalks> power_walks(const Scene& scene, std::uint64_t seed) {
  const auto light = std::ranges::find(scene.request.lights, Light::Kind::plane, &Light::kind);
  if (light == scene.request.lights.end() || scene.medium.mu_s == 0 || scene.index || scene.faces ||
      has_absorber(scene))
    return nullptr;
  Scene lit = scene;
  lit.request = intensity_request({*light}, views_around(0.5));
  Plan plan = make_plan(lit, ReversedPaths::no);
  constexpr double all = 1e-200;
  plan.score_level = all;
  plan.phases = false;
  plan.sampled_single = true;
  plan.paths_per_batch = std::min<std::uint64_t>(plan.paths_per_batch, 100);
  return path_walks(lit, plan, seed);
}

PathPower path_power(const std::shared_ptr<const PathWalks>& walks, std::uint64_t paths) {
  constexpr double systematic = 1e-3, errors = 5;
  const BatchJob job = power_job(walks);
  GroupedSums sums(job.size);
  while (sums.batches() < 2 || sums.total_samples() < static_cast<double>(paths)) {
    std::vector<Complex> batch(job.size);
    job.run(sums.batches(), batch);
    sums.add(job.samples_per_batch, batch);
  }
  const Estimate found = jackknife(sums, sample_mean);
  const auto balance = [&](PowerSum sum, double should) {
    return Invariant{std::abs(found.value[sum].real() - should),
                     systematic + errors * found.error[sum]};
  };
  PathPower power{balance(by_first, 1), balance(by_second, 1), {}};
  if (walks->scene().medium.dimension == 2) power.later = balance(by_later, 0);
  return power;
}

}  // namespace flatspeckle::mc

#include "mc/paths/estimators/path_power.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/run/runner.h"
#include "mc/jobs/flux_job.h"
#include "mc/paths/estimators/path_ends.h"

namespace flatspeckle::mc {

namespace {

/// Around the medium; turned in each batch, so that no peak lies between them in the mean.
constexpr int view_count = 64;
constexpr double view_step = 2 * std::numbers::pi / view_count;

std::vector<View> views_around(double offset) {
  std::vector<double> angles;
  for (int v = 0; v < view_count; ++v) angles.push_back((v + offset) * view_step);
  return far_views(angles);
}

struct ScattererCount {
  int inner = 0;

  void flight(Vec2, const SpaceDirection&, double) {}
  void scattering(Vec2, const SpaceDirection&, const SpaceDirection&) { ++inner; }
};

/// Across the light, what of it meets the medium.
double met_power(const Scene& scene) {
  const LightAperture aperture(scene.domain, direction(scene.request.lights.front().angle));
  return aperture.face() + aperture.side();
}

enum PowerSum : std::size_t { by_first, by_second, by_later, power_sums };

/// Adds the power of paths at their last scatterers, over what the ray to the first one loses in
/// the medium: the same for all first scatterers. |A|^2 is a density over directions: all that
/// arrives there and is not absorbed is the light's factor times the weight.
class PowerScorer : public TallyScorer<ScattererCount> {
 public:
  PowerScorer(const PathWalks& walks, const Scene& turned, std::span<Complex> sums)
      : TallyScorer({}),
        walks_(walks),
        scene_(walks.scene()),
        extinction_(scene_),
        ends_(walks, turned, false, [](std::size_t ends) { return std::vector<Complex>(ends); }),
        light_(direction(scene_.request.lights.front().angle)),
        met_(met_power(scene_)),
        sums_(sums) {}

  void single(Vec2 x, double weight) override {
    ends_.lights().attenuate(x, ends_.light_last);
    sums_[by_first] += weight * share_of(ends_.light_last.front(), x) / albedo(x);
  }

  void multiple(const Path& path) override {
    ends_.find(path, [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival, auto& out) {
      ends.attenuate(x, out);
      walks_.towards(x, arrival, ends.directions(), out);
    });
    const double scattered = path.weight * share_of(ends_.light_first.front(), path.first),
                 received = scattered / albedo(path.last),
                 leaves = share_that_leaves(ends_.view_last);
    if (tally().inner == 0)
      sums_[by_second] += received / albedo(path.first) / stays_inside(path.first, path.start);
    else
      sums_[by_later] += received;
    sums_[by_later] -= scattered * (1 - leaves);
  }

 private:
  double share_of(Complex factor, Vec2 first) const {
    const double back = scene_.domain.distance_to_edge(first, -light_);
    return std::norm(factor) / (met_ * stays_inside(first - back * light_, light_));
  }
  static double share_that_leaves(const std::vector<Complex>& views) {
    double sum = 0;
    for (const Complex view : views) sum += std::norm(view);
    return view_step * sum;
  }
  double albedo(Vec2 x) const {
    return scene_.profile ? scene_.profile->albedo(x) : scene_.medium.albedo;
  }
  double stays_inside(Vec2 x, Vec2 w) const {
    return -std::expm1(-extinction_.optical_depth(x, w, scene_.domain.distance_to_edge(x, w)));
  }

  const PathWalks& walks_;
  const Scene& scene_;
  const Extinction extinction_;
  PathEnds<std::vector<Complex>> ends_;
  Vec2 light_;
  double met_;
  std::span<Complex> sums_;
};

BatchJob power_job(const std::shared_ptr<const PathWalks>& walks) {
  constexpr std::uint64_t apart = std::uint64_t{1} << 61;  // from batches of other uses of a seed
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

/// A material that absorbs all: no path has its last scatterer there.
bool has_absorber(const Scene& scene) {
  return scene.profile && std::ranges::any_of(scene.profile->materials(), [](const Material& one) {
           return one.medium.mu_t > 0 && one.medium.mu_s == 0;
         });
}

}  // namespace

std::shared_ptr<const PathWalks> power_walks(const Scene& scene, std::uint64_t seed) {
  const auto light = std::ranges::find(scene.request.lights, Light::Kind::plane, &Light::kind);
  if (light == scene.request.lights.end() || scene.medium.mu_s == 0 || scene.index ||
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

#include "apps/results/view_power.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <new>
#include <numbers>
#include <optional>
#include <vector>

#include "core/numbers/gauss.h"
#include "core/numbers/random.h"
#include "core/result/invariant.h"
#include "core/result/result_group.h"
#include "core/run/parallel.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/flux.h"
#include "mc/paths/estimators/path_power.h"
#include "mc/slab/slab_flux.h"
#include "mc/slab/slab_jobs.h"
#include "wave_solver/solutions/ensemble.h"
#include "wave_solver/solutions/space_checks.h"

namespace flatspeckle::apps {

const DatasetTable power_table{
    .name = "power",
    .rows = {
        {"invariants/power", Data::invariant, "", "1",
         "relative difference between the power scattered into all directions and the power "
         "neither transmitted directly nor absorbed"},
        {"invariants/path_power", Data::invariant, "", "1",
         "relative difference between the power received by scatterers along the paths and the "
         "power lost by the light: largest of the first, the second and the later scatterers"}}};

namespace {

/// Returns the scene with another request: intensities for its first light, as a plane wave, in
/// these far-field views.
Scene seen_from(const Scene& scene, std::vector<View> views) {
  const Light& first = scene.request.lights.front();
  Scene lit = scene;
  lit.request = intensity_request(Lights{first.kind == Light::Kind::plane ? first : plane_wave(0)},
                                  std::move(views));
  return lit;
}

GroupedSums sums_of(const BatchJob& job, double samples) {
  GroupedSums sums(job.size);
  const double batches = std::max(1.0, std::round(samples / job.samples_per_batch));
  for (std::uint64_t number = 0; static_cast<double>(number) < batches; ++number) {
    std::vector<Complex> batch(job.size);
    job.run(number, batch);
    sums.add(job.samples_per_batch, batch);
  }
  return sums;
}

/// Returns the width of the incident beam, transverse to its direction, that meets the medium. For
/// a slab, it is divided by the illuminated length.
double aperture(const Scene& scene) {
  return mc::LightAperture(scene.domain, scene.request.lights.front().direction()).all();
}

struct Share {
  double value = 0, error = 0;
};

/// Returns the fraction of the incident power that is scattered and leaves the medium. If the
/// medium does not absorb, the fraction is exact and its error is 0.
Share scattered_out(const Scene& lit, double samples, std::uint64_t seed) {
  const double scattered = 1 - mc::unscattered_shares(lit).front();
  const bool absorbs = lit.profile || lit.medium.albedo < 1;
  if (!absorbs) return {scattered, 0};
  const auto job = mc::flux_job(lit, 1, seed);
  const Estimate absorbed =
      mc::flux_estimates(job,
                         sums_of(job.batches, std::max(samples, 2 * job.batches.samples_per_batch)))
          .absorptance;
  return {scattered - absorbed.value[0].real(), absorbed.error[0]};
}

constexpr int views = 48;

/// Returns far-field views that sample all directions: in the plane equidistant ones, of which the
/// first has a random angle; in space one at random in each of equal parts of the sphere.
std::vector<View> all_around(int dimension, RandomStream& random) {
  std::vector<View> list;
  if (dimension == 2) {
    const double first = random.uniform();
    for (int view = 0; view < views; ++view)
      list.push_back(far_view(2 * std::numbers::pi * (view + first) / views - std::numbers::pi));
    return list;
  }
  constexpr int rings = 6, in_ring = views / rings;
  for (int ring = 0; ring < rings; ++ring)
    for (int view = 0; view < in_ring; ++view) {
      const double cosine = 2 * (ring + random.uniform()) / rings - 1;
      list.push_back(
          far_view(std::acos(cosine), 2 * std::numbers::pi * (view + random.uniform()) / in_ring));
    }
  return list;
}

/// Returns the fraction of the incident power that is scattered into all directions, by the
/// intensity in the views of all_around().
double seen_share(const Scene& scene, double samples, std::uint64_t seed, std::uint64_t group) {
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), group);
  const Scene lit = seen_from(scene, all_around(scene.medium.dimension, random));
  const FieldJob job =
      mc::covariance_job(lit, mc::make_plan(lit, mc::ReversedPaths::no), seed + group);
  const GroupedSums sums = sums_of(job.batches, samples);
  const double all = scene.medium.dimension == 3 ? 4 * std::numbers::pi : 2 * std::numbers::pi;
  double power = 0;
  for (const Complex intensity : job.covariance(sums.total_samples(), sums.total()))
    power += intensity.real() * all / views;
  return power / aperture(lit);
}

/// Checks the scattered power that Monte Carlo gives. It is computed in several groups of paths
/// with different far-field views, whose spread gives the error. samples: number of paths in all
/// groups together. Returns nullopt if there is less than one batch for each group, or if the check
/// is not possible for the medium.
std::optional<Invariant> paths_power(const Scene& scene, double samples, std::uint64_t seed) {
  constexpr std::size_t groups = 16;
  constexpr double most_samples = 1 << 22, rounding = 1e-9;
  if (scene.index || !(scene.medium.mu_s > 0)) return std::nullopt;
  // The layer around a box with faces guides a part of the light away from all views.
  if (scene.faces && scene.domain.kind == Domain::Kind::box) return std::nullopt;
  const mc::Plan plan =
      mc::make_plan(seen_from(scene, std::vector<View>(views)), mc::ReversedPaths::no);
  if (samples < static_cast<double>(groups * plan.paths_per_batch)) return std::nullopt;
  const double used = std::min(samples, most_samples);
  const std::uint64_t apart = ~seed;  // seed of random numbers that the result does not use
  std::array<double, groups> shares{};
  parallel_for(groups, [&](std::size_t group) {
    shares[group] = seen_share(scene, used / groups, apart, group);
  });
  double mean = 0, square = 0;
  for (const double share : shares) mean += share / groups;
  for (const double share : shares) square += std::pow(share - mean, 2);
  const double error = std::sqrt(square / (groups * (groups - 1)));
  const Share expected = scattered_out(seen_from(scene, {far_view(0)}), used, apart);
  if (!(expected.value > 0)) return std::nullopt;
  return Invariant{
      std::abs(mean / expected.value - 1),
      outlier_errors(groups) * std::hypot(error, expected.error) / expected.value + rounding};
}

/// Returns the power balance of the slab: reflected, transmitted and absorbed power, each computed
/// separately, must add up to the incident power.
Invariant flux_balance(const Scene& slab, double tolerance) {
  const Scene lit = seen_from(slab, {far_view(0)});
  const auto job = mc::slab_flux_job(lit, 1, {tolerance});
  return mc::power_balance(job, sums_of(job.batches, 2), mc::unscattered_shares(lit)).front();
}

/// Checks the scattered power that transport gives for a slab, against reflectance plus
/// transmittance. The limit is the sum of the errors of both and of the quadrature over views. In
/// three dimensions and for layers, the power balance of the fluxes is checked instead
/// (mc::power_balance).
std::optional<Invariant> transport_power(const Scene& slab, double tolerance) {
  constexpr int nodes = 32;  // nodes per quadrant
  constexpr int most_ordinates = 200;
  if (!(slab.medium.mu_s > 0)) return std::nullopt;
  if (slab.profile || slab.medium.dimension == 3) return flux_balance(slab, tolerance);
  const mc::Refinement refinement{.tolerance = tolerance, .most_ordinates = most_ordinates};
  Scene lit = seen_from(slab, {far_view(0)});
  const auto power = [&](int count) -> Share {
    const QuadratureRule rule = gauss_legendre(count);
    std::vector<double> angles;
    for (const double quadrant :
         {-std::numbers::pi, -std::numbers::pi / 2, 0.0, std::numbers::pi / 2})
      for (const double node : rule.node) angles.push_back(quadrant + node * std::numbers::pi / 2);
    lit = seen_from(slab, far_views(angles));
    const FieldJob job = mc::slab_covariance_job(lit, false, refinement);
    const Estimate found = jackknife(sums_of(job.batches, 2), job.covariance);
    Share share;
    for (std::size_t view = 0; view < angles.size(); ++view) {
      const double weight =
          rule.weight[view % rule.weight.size()] * std::numbers::pi / 2 / aperture(lit);
      share.value += weight * found.value[view].real();
      share.error += weight * found.error[view];
    }
    return share;
  };
  const Share coarse = power(nodes / 2), fine = power(nodes);
  const auto job = mc::slab_flux_job(lit, 1, refinement);
  const auto flux = mc::flux_estimates(job, sums_of(job.batches, 2));
  const double left = flux.reflectance.value[0].real() + flux.transmittance.value[0].real(),
               error = flux.reflectance.error[0] + flux.transmittance.error[0];
  if (!(left > 0)) return std::nullopt;
  constexpr double rounding = 1e-9;
  return Invariant{std::abs(fine.value - left) / left,
                   (std::abs(fine.value - coarse.value) + fine.error + error) / left + rounding};
}

/// Directions and weights of an integral over all directions, in the plane or in space. The first
/// view is forward, along the light; its weight in space is 0.
struct AllViews {
  std::vector<View> views;
  std::vector<double> weights;
};

AllViews all_views(const Scene& scene) {
  const Domain& box = scene.domain;
  const double size =
      scene.k * (std::hypot(box.width, box.depth, box.height) / 2 + scene.scatterer.disk_radius());
  const Light light = seen_from(scene, {far_view(0)}).request.lights.front();
  if (scene.medium.dimension == 3) {
    const wave::SphereRule rule = wave::sphere_rule(size);
    AllViews all{{far_view(light.angle, light.azimuth)}, {0}};
    all.views.insert(all.views.end(), rule.views.begin(), rule.views.end());
    all.weights.insert(all.weights.end(), rule.weights.begin(), rule.weights.end());
    return all;
  }
  const int count = 2 * static_cast<int>(size + 10 * std::cbrt(size) + 20);
  AllViews all;
  for (int i = 0; i < count; ++i) {
    all.views.push_back(far_view(
        std::remainder(light.angle + 2 * std::numbers::pi * i / count, 2 * std::numbers::pi)));
    all.weights.push_back(2 * std::numbers::pi / count);
  }
  return all;
}

/// Checks the optical theorem (C9, C57) for the exact fields of two placements, with views over all
/// directions. The mean intensity is computed from covariance and mean field, by the estimators for
/// many placements. The limit follows from the tolerance of the fields. Returns nullopt if
/// scatterers absorb, if there are many scatterers in a large box, if the index varies in space,
/// or if the faces reflect, because the layer then guides a part of the power.
std::optional<Invariant> waves_power(const Scene& scene, double tolerance, std::uint64_t seed) {
  constexpr double placements = 2, rounding = 1e-10, most = 2e6;
  const bool is_graded = scene.index && scene.index->is_around();
  if (scene.medium.mu_s == 0 || scene.medium.albedo < 1 || is_graded || scene.faces)
    return std::nullopt;
  const AllViews all = all_views(scene);
  if (scene.placement.mean_count * static_cast<double>(all.views.size()) > most)
    return std::nullopt;
  const FieldJob job = wave::wave_job(seen_from(scene, all.views), seed, tolerance);
  const GroupedSums sums = sums_of(job.batches, placements);
  const auto mean = job.mean(placements, sums.total());
  const auto covariance = job.covariance(placements, sums.total());
  double scattered = 0;
  for (std::size_t i = 0; i < all.views.size(); ++i)
    scattered += all.weights[i] *
                 (covariance[i].real() * (placements - 1) / placements + std::norm(mean[i]));
  const Complex extinction = scene.medium.dimension == 3
                                 ? Complex(0, -4 * std::numbers::pi / scene.k) * mean[0]
                                 : -std::sqrt(8 * std::numbers::pi / scene.k) *
                                       std::polar(1.0, std::numbers::pi / 4) * mean[0];
  if (scattered == 0) return std::nullopt;
  return Invariant{std::abs(extinction.real() / scattered - 1),
                   tolerance * (1 + std::abs(extinction) / scattered) + rounding};
}

// number of paths of each check, as a fraction of that of the run
constexpr double part = 1.0 / 64;

/// Returns the relative imbalance of the power scattered into all directions, with its limit;
/// nullopt if it cannot be checked.
std::optional<Invariant> view_power(const Scene& scene, const DoneWork& work) {
  if (work.method == "mc") return paths_power(scene, part * work.samples, work.seed);
  if (work.method == "transport") return transport_power(scene, work.tolerance);
  return waves_power(scene, work.tolerance, work.seed);
}

/// Returns the worst relative difference between the power that scatterers receive along light
/// paths and the power that the light loses, with its limit. Returns nullopt for methods other than
/// Monte Carlo.
std::optional<Invariant> received_power(const Scene& scene, const DoneWork& work) {
  constexpr double least = 2000, most = 20000;
  if (work.method != "mc" || part * work.samples < least) return std::nullopt;
  const auto walks = mc::power_walks(seen_from(scene, {far_view(0)}), work.seed);
  if (!walks) return std::nullopt;
  const auto paths = static_cast<std::uint64_t>(std::min(part * work.samples, most));
  const auto [first, second, later] = mc::path_power(walks, paths);
  Invariant worst = first;
  for (const Invariant& each : {second, later})
    if (each.is_worse_than(worst)) worst = each;
  return worst;
}

}  // namespace

void check_power(ResultFile& file, const std::string& group, const Scene& scene,
                 const DoneWork& work) {
  std::optional<Invariant> power, path_power;
  try {
    power = view_power(scene, work);
    path_power = received_power(scene, work);
  } catch (const std::bad_alloc&) {
    std::fputs("note: the power balance is not checked for lack of memory\n", stderr);
  }
  const ResultGroup checks(file, power_table, group);
  if (power) checks.check("invariants/power", *power);
  if (path_power) checks.check("invariants/path_power", *path_power);
}

}  // namespace flatspeckle::apps

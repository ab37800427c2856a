#include "mc/paths/walk/plan.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/error.h"
#include "mc/paths/endpoint_factors/faced_endpoints.h"
#include "mc/paths/walk/importance.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

/// Whether views can detect coherent backscattering. More than a right angle away from the
/// direction of backscattering, reversed paths only add oscillating terms of order 1/(k mean free
/// path), which the method neglects anyway.
bool can_detect_backscattering(const CovarianceRequest& request, const Domain& domain) {
  return std::any_of(request.views.begin(), request.views.end(), [&](const View& view) {
    if (domain.kind == Domain::Kind::slab && has_near_endpoints(request))
      return view.near ? view.point.z < 0 : std::cos(view.angle) < 0;
    if (view.near) return true;
    return std::any_of(request.lights.begin(), request.lights.end(), [&](const Light& light) {
      return light.kind == Light::Kind::point || dot(light.direction(), view.direction()) <= 0;
    });
  });
}

/// Returns the score level of a scene. In a thin medium every path contributes little, so the level
/// is reduced in proportion to the fraction of free flights that end inside the medium; otherwise
/// no path would be scored.
double level_of(const Scene& scene) {
  constexpr double thin = 1e-3;
  const Domain& domain = scene.domain;
  double across = domain.depth;
  if (domain.kind == Domain::Kind::box) across = std::min(across, domain.width);
  if (domain.height > 0) across = std::min(across, domain.height);
  return score_level(scene.medium.g, scene.medium.dimension) *
         std::min(1.0, scene.medium.mu_t * across / thin);
}

/// Whether a box loses so much light through its sides that, even without absorption, little light
/// reaches the views.
bool loses_light_by_sides(const Scene& scene) {
  if (scene.domain.kind != Domain::Kind::box || scene.medium.mu_s == 0) return false;
  const DiffusionImportance importance(scene);
  return importance.steep() && importance.is_attenuated();
}

/// Largest mean number of scatterings of a batch. They take tens of milliseconds.
constexpr double most_scatterings = 1e6;
/// Largest mean number of scatterings of the longest paths; such a path takes seconds.
constexpr double longest_path = 1e8;

/// Returns the number of paths per batch. It is large enough that merging the sums of a batch costs
/// less than computing them. If walkers split into many, the number is reduced so that a batch does
/// not take long.
std::uint64_t paths_per_batch(const Scene& scene, const Plan& plan) {
  const std::uint64_t most = plan.rank_k && scene.request.channels.size() > 100 ? 2000 : 400;
  if (!plan.weighted || scene.medium.mu_s == 0) return most;
  const double paths = most_scatterings / DiffusionImportance(scene).scatterings();
  return paths < static_cast<double>(most) ? std::max<std::uint64_t>(1, std::llround(paths)) : most;
}

}  // namespace

Plan::Phase phase_of(const Scene& scene) {
  const Scatterer& scatterer = scene.scatterer;
  const bool hg = scatterer.kind == Scatterer::Kind::hg;
  const bool isotropic = scatterer.kind == Scatterer::Kind::point || (hg && scatterer.g == 0);
  if (scene.medium.dimension == 3) {
    if (isotropic) return Plan::Phase::isotropic_in_space;
    // Spheres have complex amplitudes, or a phase function that is slow to compute.
    if (scene.medium.has_scatterers || scatterer.kind == Scatterer::Kind::mie)
      return Plan::Phase::tabulated_in_space;
    return hg ? Plan::Phase::henyey_greenstein_in_space : Plan::Phase::space;
  }
  if (isotropic) return Plan::Phase::isotropic;
  return hg ? Plan::Phase::henyey_greenstein : Plan::Phase::tabulated;
}

Plan make_plan(const Scene& scene, ReversedPaths reversed) {
  const auto& request = scene.request;
  Plan plan;
  plan.domain = scene.domain.kind;
  plan.phase = scene.index     ? Plan::Phase::graded
               : scene.profile ? Plan::Phase::varying
                               : phase_of(scene);
  plan.reversed =
      reversed == ReversedPaths::yes ||
      (reversed == ReversedPaths::automatic && can_detect_backscattering(request, scene.domain));
  plan.near = has_near_endpoints(request);
  plan.rank_k = request.kind == CovarianceRequest::Kind::full;
  plan.score_level = level_of(scene);
  plan.phases = plan.reversed || request.kind != CovarianceRequest::Kind::intensity;
  plan.weighted = scene.medium.albedo < 1 - 1e-12 || loses_light_by_sides(scene);
  constexpr std::size_t few = 20000;  // entries; quadrature takes at most 1 ms for each
  plan.waves = scored_waves(scene);
  plan.sampled_single = scene.faces || scene.index || scene.profile || plan.near || plan.rank_k ||
                        request.entries.size() > few;
  plan.paths_per_batch = paths_per_batch(scene, plan);
  return plan;
}

void require_walks(const Scene& scene, bool weighted) {
  if (scene.domain.kind == Domain::Kind::slab && has_near_endpoints(scene.request))
    throw InputError(
        "method: beams, near sources and near sensors beside a slab require method = "
        "transport, or a box");
  if (scene.faces && scene.profile)
    throw InputError("medium_index", scene.faces->inside,
                     "Monte Carlo requires a homogeneous medium; use method = transport");
  if (scene.medium.mu_s == 0) return;
  const auto require = [&](double scatterings, double most, const std::string& what) {
    if (scatterings < most) return;
    std::ostringstream text;
    text << what << " about " << std::setprecision(2) << scatterings << " times, but at most "
         << most
         << " are allowed; take a thinner medium, or a slab with method = transport, which samples "
            "no paths";
    throw InputError("optical_depth", scene.medium.mu_t * scene.domain.depth, text.str());
  };
  require(scatterings_of_slowest_mode(scene.medium, scene.domain), longest_path,
          "the longest light paths scatter");
  if (weighted)
    require(DiffusionImportance(scene).scatterings(), most_scatterings,
            "light paths and all that they split into scatter");
}

std::string Plan::describe() const {
  std::ostringstream text;
  text << (domain == Domain::Kind::box ? "box" : "slab, transverse position integrated") << "; ";
  switch (phase) {
    case Phase::isotropic:
      text << "isotropic scattering";
      break;
    case Phase::henyey_greenstein:
      text << "Henyey-Greenstein scattering";
      break;
    case Phase::tabulated:
      text << "tabulated amplitude";
      break;
    case Phase::isotropic_in_space:
      text << "isotropic scattering in space";
      break;
    case Phase::space:
      text << "phase function in space";
      break;
    case Phase::henyey_greenstein_in_space:
      text << "Henyey-Greenstein scattering in space";
      break;
    case Phase::tabulated_in_space:
      text << "tabulated amplitude in space";
      break;
    case Phase::varying:
      text << "varying scattering";
      break;
    case Phase::graded:
      text << "curved rays";
      break;
  }
  text << "; " << (weighted ? "splitting and Russian roulette" : "walkers of equal weight") << "; "
       << (sampled_single ? "" : "single scattering in closed form; ")
       << (phases ? "" : "no phases; ") << (reversed ? "reversed paths" : "no reversed paths")
       << "; " << (waves.size() > 1 ? "reflecting faces; " : "")
       << (near ? "near field" : "far field only") << "; "
       << (rank_k ? "full covariance by rank-k updates" : "listed entries only")
       << "; Russian roulette for expected scores below " << score_level << "; " << paths_per_batch
       << " paths per batch";
  return text.str();
}

}  // namespace flatspeckle::mc

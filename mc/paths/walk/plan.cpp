#include "mc/paths/walk/plan.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/error.h"
#include "mc/paths/walk/importance.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

/// More than a right angle away from exact backscattering the reversed paths only add terms that
/// oscillate away, of the order of the 1/(k mean free path) that the method neglects anyway.
bool can_see_backscattering(const CovarianceRequest& request, const Domain& domain) {
  return std::any_of(request.views.begin(), request.views.end(), [&](const View& view) {
    if (domain.kind == Domain::Kind::slab && has_near_ends(request))
      return view.near ? view.point.z < 0 : std::cos(view.angle) < 0;
    if (view.near) return true;
    return std::any_of(request.lights.begin(), request.lights.end(), [&](const Light& light) {
      return light.kind == Light::Kind::point ||
             dot(direction(light.angle), direction(view.angle)) <= 0;
    });
  });
}

/// Twice the mean square of the phase function over the square of its mean: measured to be about
/// best in the plane, and flat around it.
double score_level(double g, int dimension) {
  const double square = std::min(g * g, 0.9);
  return 2 * (1 + square) / std::pow(1 - square, dimension - 1);
}

/// Paths of thin media promise little each: the level falls with the share of flights that end
/// inside, or none of them would be scored.
double level_of(const Scene& scene) {
  constexpr double thin = 1e-3;
  const double across = scene.domain.kind == Domain::Kind::box
                            ? std::min(scene.domain.depth, scene.domain.width)
                            : scene.domain.depth;
  return score_level(scene.medium.g, scene.medium.dimension) *
         std::min(1.0, scene.medium.mu_t * across / thin);
}

/// Whether a box is so narrow that little reaches the views without absorption either.
bool loses_by_the_sides(const Scene& scene) {
  if (scene.domain.kind != Domain::Kind::box || scene.medium.mu_s == 0) return false;
  const DiffusionImportance importance(scene);
  return importance.steep() && importance.dies_out();
}

/// Scatterings of a batch, on the mean: tens of milliseconds.
constexpr double most_scatterings = 1e6;
/// Scatterings of one path that is among the longest: seconds.
constexpr double longest_path = 1e8;

/// So many that the sums of a batch cost less to merge than to make; where walkers split into many,
/// so few that a batch does not take long.
std::uint64_t paths_per_batch(const Scene& scene, const Plan& plan) {
  const std::uint64_t most = plan.rank_k && scene.request.channels.size() > 100 ? 2000 : 400;
  if (!plan.weighted || scene.medium.mu_s == 0) return most;
  const double paths = most_scatterings / DiffusionImportance(scene).scatterings();
  return paths < static_cast<double>(most) ? std::max<std::uint64_t>(1, std::llround(paths)) : most;
}

}  // namespace

Plan::Phase phase_of(const Scatterer& scatterer) {
  if (scatterer.kind == Scatterer::Kind::point) return Plan::Phase::isotropic;
  if (scatterer.kind != Scatterer::Kind::hg) return Plan::Phase::tabulated;
  return scatterer.g == 0 ? Plan::Phase::isotropic : Plan::Phase::henyey_greenstein;
}

Plan make_plan(const Scene& scene, ReversedPaths reversed) {
  const auto& request = scene.request;
  Plan plan;
  plan.domain = scene.domain.kind;
  plan.phase = scene.index                   ? Plan::Phase::graded
               : scene.profile               ? Plan::Phase::varying
               : scene.medium.dimension == 3 ? Plan::Phase::space
                                             : phase_of(scene.scatterer);
  plan.reversed = reversed == ReversedPaths::yes || (reversed == ReversedPaths::automatic &&
                                                     can_see_backscattering(request, scene.domain));
  plan.near = has_near_ends(request);
  plan.rank_k = request.kind == CovarianceRequest::Kind::full;
  plan.score_level = level_of(scene);
  plan.phases = plan.reversed || request.kind != CovarianceRequest::Kind::intensity;
  plan.weighted = scene.medium.albedo < 1 - 1e-12 || loses_by_the_sides(scene);
  constexpr std::size_t few = 20000;  // entries; a millisecond each at the most
  plan.sampled_single =
      scene.index || scene.profile || plan.near || plan.rank_k || request.entries.size() > few;
  plan.paths_per_batch = paths_per_batch(scene, plan);
  return plan;
}

void require_walks(const Scene& scene, bool weighted) {
  if (scene.domain.kind == Domain::Kind::slab && has_near_ends(scene.request))
    throw InputError(
        "method: beams, near sources and near sensors beside a slab are of transport "
        "alone; or take a box");
  if (scene.medium.mu_s == 0) return;
  const auto require = [&](double scatterings, double most, const std::string& what) {
    if (scatterings < most) return;
    std::ostringstream text;
    text << what << " about " << std::setprecision(2) << scatterings << " times, at most " << most
         << "; take a thinner medium, or a slab by method = transport, which needs no paths";
    throw InputError("optical_depth", scene.medium.mu_t * scene.domain.depth, text.str());
  };
  require(scatterings_of_slowest_mode(scene.medium, scene.domain), longest_path,
          "its longest light paths scatter");
  if (weighted)
    require(DiffusionImportance(scene).scatterings(), most_scatterings,
            "light paths with all that they split into scatter");
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
    case Phase::space:
      text << "phase function in space";
      break;
    case Phase::varying:
      text << "scattering that varies";
      break;
    case Phase::graded:
      text << "curved rays";
      break;
  }
  text << "; " << (weighted ? "walkers split and play roulette" : "walkers of equal weight") << "; "
       << (sampled_single ? "" : "single scattering in closed form; ")
       << (phases ? "" : "no phases; ") << (reversed ? "reversed paths" : "no reversed paths")
       << "; " << (near ? "near field" : "far field only") << "; "
       << (rank_k ? "full covariance by rank-k updates" : "listed entries only")
       << "; scores promising less than " << score_level << " play roulette; " << paths_per_batch
       << " paths per batch";
  return text.str();
}

}  // namespace flatspeckle::mc

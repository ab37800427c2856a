#include "mc/paths/walk/importance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/numbers/log_sinh.h"
#include "grin/media/scattering/diffusion_rate.h"
#include "grin/media/scattering/phase_function.h"
#include "mc/paths/endpoint_factors/scattering.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

/// Whether the plane waves along `others` represent (see reached()) the ray that enters along w.
/// Tests four places on the ray, from just behind the entry to ten mean free paths from it.
bool ray_reached(const Scene& scene, Vec w, Vec entry, const std::vector<Vec>& others) {
  const double mfp = scene.medium.mean_free_path(), chord = scene.domain.distance_to_edge(entry, w);
  constexpr double tolerated = 1.5;  // additional path in the medium, in mean free paths
  for (const double deep : {0.01, 1.0, 3.0, 10.0}) {
    const double s = std::min(deep * mfp, 0.99 * chord);
    const Vec x = entry + s * w;
    const bool lit = std::any_of(others.begin(), others.end(), [&](Vec other) {
      return scene.domain.distance_to_edge(x, -other) <= s + tolerated * mfp;
    });
    if (!lit) return false;
  }
  return true;
}

using std::numbers::pi;

constexpr int nodes = 512;  ///< number of intervals of the importance table

/// Returns log [sinh(a) / sinh(b)], 0 < a <= b.
double log_sinh_ratio(double a, double b) {
  return a - b + std::log(std::expm1(-2 * a) / std::expm1(-2 * b));
}

/// Approximates exp(-x) in a third of the time of std::exp.
double about_exp(double x) {
  const double square = (1 + x / 8) * (1 + x / 8), fourth = square * square;
  return 1 / (fourth * fourth);
}

/// Returns the phase function for scattering between two directions, relative to the isotropic one.
template <int dimension>
double relative_lobe(double g, Vec from, Vec to) {
  return grin::HenyeyGreenstein<dimension>{g}.density_beside(one_minus_cosine(from, to)) /
         grin::Isotropic<dimension>::value;
}

/// Returns typical depths at which the lights are first scattered.
std::set<double> first_depths(const Scene& scene) {
  const double depth = scene.domain.depth,
               shallow = std::min(scene.medium.mean_free_path(), depth / 2);
  std::set<double> depths;
  for (const Light& light : scene.request.lights) {
    if (light.kind == Light::Kind::point)
      depths.insert(std::clamp(light.point.z, shallow, depth - shallow));
    else
      depths.insert(std::cos(light.angle) > 0 ? shallow : depth - shallow);
  }
  return depths;
}

/// Returns the depths that light must reach to be detected by the views.
std::set<double> view_depths(const Scene& scene) {
  std::set<double> depths;
  const double depth = scene.domain.depth;
  for (const View& view : scene.request.views) {
    const double there = std::cos(view.angle) > 0 ? depth : 0;
    depths.insert(view.near ? std::clamp(view.point.z, 0.0, depth) : there);
  }
  return depths;
}

}  // namespace

bool reached(const Scene& scene, Vec w, const std::vector<Vec>& others, double spacing) {
  const auto& domain = scene.domain;
  const double cosine = std::cos(std::min(spacing, 3.0)) - 1e-12;
  std::vector<Vec> close;
  for (Vec other : others)
    if (dot(w, other) >= cosine) close.push_back(other);
  if (close.empty()) return false;
  const double face = w.z > 0 ? 0 : domain.depth;
  if (domain.kind == Domain::Kind::slab) return ray_reached(scene, w, {0, face}, close);
  const int points = domain.height > 0 ? 64 : 16;
  const double side = w.x > 0 ? -domain.width / 2 : domain.width / 2,
               other_side = w.y > 0 ? -domain.height / 2 : domain.height / 2;
  for (int i = 0; i < points; ++i) {
    const double share = (i + 0.5) / points, x = (share - 0.5) * domain.width,
                 second = (i + 0.5) * std::numbers::phi,
                 y = (second - std::floor(second) - 0.5) * domain.height;
    if (w.z != 0 && !ray_reached(scene, w, {x, face, y}, close)) return false;
    if (w.x != 0 && !ray_reached(scene, w, {side, share * domain.depth, y}, close)) return false;
    if (w.y != 0 &&
        !ray_reached(scene, w, {x, (y / domain.height + 0.5) * domain.depth, other_side}, close))
      return false;
  }
  return true;
}

DiffusionImportance::DiffusionImportance(const Scene& scene) : step_(scene.domain.depth / nodes) {
  const double depth = scene.domain.depth;
  const auto& medium = scene.medium;
  const double beyond = extrapolation_length(medium);
  double rate = grin::diffusion_rate(medium.albedo, medium.g, medium.dimension) * medium.mu_t;
  if (scene.domain.kind == Domain::Kind::box)  // light that leaves through the sides is also lost
    for (const double across : {scene.domain.width, scene.domain.height})
      if (across > 0) rate = std::hypot(rate, pi / (across + 2 * beyond));
  rate = std::max(rate, 1e-8 / depth);
  // Log of the fraction of the light at depth z that reaches the depth `there` before it leaves
  // through the face on the other side.
  const auto log_reaching = [&](double z, double there) {
    const double distance = z < there ? z : depth - z, whole = z < there ? there : depth - there;
    return log_sinh_ratio(rate * (distance + beyond), rate * (whole + beyond));
  };
  const auto firsts = first_depths(scene);
  const auto log_usual = [&](double there) {  // from the first depth that sends most light there
    double best = -std::numeric_limits<double>::infinity();
    for (double first : firsts) best = std::max(best, log_reaching(first, there));
    return best;
  };
  const auto destinations = view_depths(scene);
  for (int i = 0; i <= nodes; ++i) {
    std::vector<double> logs;
    for (double there : destinations)
      logs.push_back(log_reaching(depth * i / nodes, there) - log_usual(there));
    const double largest = *std::max_element(logs.begin(), logs.end());
    double sum = 0;
    for (double log : logs) sum += std::exp(log - largest);
    log_importance_.push_back(largest + std::log(sum / static_cast<double>(logs.size())));
  }
  // Log of the mean number of scatterings in the table interval at depth z, of light that is first
  // scattered at depth `first`: the Green's function of diffusion in the slab. The faces are moved
  // outwards by the extrapolation length; the diffusion constant is the transport mean free path
  // divided by the dimension.
  const auto log_scatterings = [&](double first, double z) {
    const double low = std::min(first, z), high = depth - std::max(first, z);
    return log_sinh(rate * (low + beyond)) + log_sinh(rate * (high + beyond)) -
           log_sinh(rate * (depth + 2 * beyond)) +
           std::log(medium.dimension * medium.mu_s * step_ /
                    (rate * medium.transport_mean_free_path()));
  };
  for (double first : firsts)
    for (int i = 0; i < nodes; ++i) {
      const double z = depth * (i + 0.5) / nodes,
                   growth = log_importance(z) - std::max(log_importance(first), 0.0);
      scatterings_ +=
          std::exp(log_scatterings(first, z) + growth) / static_cast<double>(firsts.size());
    }
  constexpr double steep = 5, decay_lengths = 3.5;  // measured values above which splitting pays
  is_attenuated_ = rate * (depth + 2 * beyond) > decay_lengths;
  steep_ = *std::max_element(log_importance_.begin(), log_importance_.end()) > steep;
}

double DiffusionImportance::log_importance(double z) const {
  const double position = z / step_;
  const std::size_t i = interval(z);
  const double t = position - static_cast<double>(i);
  return (1 - t) * log_importance_[i] + t * log_importance_[i + 1];
}

double DiffusionImportance::derivative(double z) const {
  if (!steep_) return 0;
  const std::size_t i = interval(z);
  return (log_importance_[i + 1] - log_importance_[i]) / step_;
}

double DiffusionImportance::mean_derivative() const {
  constexpr double least_growth = 1;
  const double whole = log_importance_.back() - log_importance_.front();
  return std::abs(whole) > least_growth ? whole / (step_ * nodes) : 0;
}

std::size_t DiffusionImportance::interval(double z) const {
  return std::min(static_cast<std::size_t>(z / step_), log_importance_.size() - 2);
}

double score_level(double g, int dimension) {
  const double square = std::min(g * g, 0.9);
  return 2 * (1 + square) / std::pow(1 - square, dimension - 1);
}

ExpectedContribution::ExpectedContribution(const Scene& scene,
                                           const std::vector<Endpoint>& endpoints)
    : domain_(scene.domain),
      extinction_(scene),
      dimension_(scene.medium.dimension),
      g_(scene.medium.g) {
  always_ =
      std::any_of(endpoints.begin(), endpoints.end(), [](const Endpoint& end) { return end.near; });
  if (always_) return;
  constexpr std::size_t few = 16;
  double spacing = std::max(0.5 * (1 - std::abs(g_)), 0.05);
  const auto choose = [&] {
    std::vector<Vec> chosen;  // exit directions of the selected endpoints, reversed
    for (const Endpoint& end : endpoints)
      if (chosen.size() <= few && !reached(scene, -end.towards, chosen, spacing))
        chosen.push_back(-end.towards);
    return chosen;
  };
  auto chosen = choose();
  for (; chosen.size() > few && spacing < pi; chosen = choose()) spacing *= 1.5;
  // The lobe of the phase function is made no narrower than the angle between the representative
  // endpoints.
  g_ = std::copysign(std::min(std::abs(g_), std::max(0.0, 1 - spacing)), g_);
  level_ = score_level(scene.medium.g, dimension_) / score_level(g_, dimension_);
  for (Vec w : chosen) towards_.push_back(-w);
}

double ExpectedContribution::operator()(Vec x, Vec arrival) const {
  if (always_) return 1;
  double largest = 0.01;  // bound for directions far from all representative endpoints
  for (Vec w : towards_) {
    double value = about_exp(extinction_.optical_depth(x, w, domain_.distance_to_edge(x, w)));
    if (g_ != 0)
      value *=
          dimension_ == 2 ? relative_lobe<2>(g_, arrival, w) : relative_lobe<3>(g_, arrival, w);
    largest = std::max(largest, level_ * value);
  }
  return largest;
}

}  // namespace flatspeckle::mc

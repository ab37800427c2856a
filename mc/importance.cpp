#include "mc/importance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/phase_function.h"
#include "mc/first_scatterer.h"

namespace flatspeckle::mc {

namespace {

constexpr double pi = std::numbers::pi;

/// Whether a rate lies below the smallest root of the dispersion relation
///   h_0 = 2 s / (h_1 - s / (h_2 - s / ...)),  h_n = 1 - albedo g^n,  s = rate^2 / 4,
/// the condition that the Fourier moments of the angle decay.
bool below_root(double albedo, double g, double rate) {
  const double s = rate * rate / 4;
  double tail = 1;  // of high moments, which scattering does not feed
  for (int n = 1000; n >= 1; --n) {
    tail = 1 - albedo * std::pow(g, n) - s / tail;
    if (tail <= 0) return false;
  }
  return 1 - albedo > 2 * s / tail;
}

/// log [sinh(a) / sinh(b)], 0 < a <= b.
double log_sinh_ratio(double a, double b) {
  return a - b + std::log(std::expm1(-2 * a) / std::expm1(-2 * b));
}

/// exp(-x), more or less and in a third of the time.
double about_exp(double x) {
  const double square = (1 + x / 8) * (1 + x / 8), fourth = square * square;
  return 1 / (fourth * fourth);
}

}  // namespace

double diffusion_rate(double albedo, double g) {
  if (albedo >= 1) return 0;
  double low = 0, high = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (below_root(albedo, g, middle) ? low : high) = middle;
  }
  return low;
}

std::vector<double> representatives(const std::vector<double>& angles, double spacing) {
  std::vector<double> chosen;
  for (double angle : angles) {
    const bool known = std::any_of(chosen.begin(), chosen.end(), [&](double other) {
      return std::abs(std::remainder(angle - other, 2 * pi)) <= spacing;
    });
    if (!known) chosen.push_back(angle);
  }
  return chosen;
}

std::vector<double> representative_lights(const Scene& scene) {
  return representatives(scene.request.lights,
                         std::max(0.5 * (1 - std::abs(scene.medium.g)), 0.01));
}

DepthImportance::DepthImportance(const Scene& scene) : depth_(scene.domain.depth) {
  const auto& medium = scene.medium;
  const double beyond = 0.818 * medium.transport_mean_free_path();
  double rate = diffusion_rate(medium.albedo, medium.g) * medium.mu_t;
  if (scene.domain.kind == Domain::Kind::box)  // what leaves by the sides is lost as well
    rate = std::hypot(rate, pi / (scene.domain.width + 2 * beyond));
  rate = std::max(rate, 1e-8 / depth_);
  double transmitted = 0, reflected = 0;
  for (const View& view : scene.request.views)
    (view.near || std::cos(view.angle) > 0 ? transmitted : reflected) = 1;
  const auto leaving = [&](double to_edge) {
    return log_sinh_ratio(rate * (to_edge + beyond), rate * (depth_ + 2 * beyond));
  };
  const double first = std::min(medium.mean_free_path(), depth_ / 2);
  constexpr int nodes = 512;
  for (int i = 0; i <= nodes; ++i) {
    const double z = depth_ * i / nodes;
    const double forward = leaving(z) - leaving(first),
                 backward = leaving(depth_ - z) - leaving(depth_ - first);
    const double larger = transmitted == 0 ? backward
                          : reflected == 0 ? forward
                                           : std::max(forward, backward);
    log_worth_.push_back(larger + std::log((transmitted * std::exp(forward - larger) +
                                            reflected * std::exp(backward - larger)) /
                                           (transmitted + reflected)));
  }
}

double DepthImportance::log_worth(double z) const {
  const double position = z / depth_ * static_cast<double>(log_worth_.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(position), log_worth_.size() - 2);
  const double t = position - static_cast<double>(i);
  return (1 - t) * log_worth_[i] + t * log_worth_[i + 1];
}

ExpectedContribution::ExpectedContribution(const Scene& scene, const std::vector<End>& ends)
    : domain_(scene.domain), mu_t_(scene.medium.mu_t), g_(scene.medium.g) {
  always_ = std::any_of(ends.begin(), ends.end(), [](const End& end) { return end.near; });
  if (always_) return;
  constexpr std::size_t few = 8;
  std::vector<double> angles;
  for (const End& end : ends) angles.push_back(angle_of(end.towards));
  double spacing = std::max(0.5 * (1 - std::abs(g_)), 0.05);
  auto chosen = representatives(angles, spacing);
  for (; chosen.size() > few; spacing *= 1.5) chosen = representatives(angles, 1.5 * spacing);
  // No sharper than the representatives are spaced.
  g_ = std::copysign(std::min(std::abs(g_), std::max(0.0, 1 - spacing)), g_);
  for (double angle : chosen) towards_.push_back(flatspeckle::direction(angle));
}

double ExpectedContribution::operator()(Vec2 x, Vec2 arrival) const {
  if (always_) return 1;
  const grin::HenyeyGreenstein<2> lobe{g_};
  double largest = 0;
  for (Vec2 w : towards_) {
    double value = about_exp(mu_t_ * domain_.distance_to_edge(x, w));
    if (g_ != 0) {
      const Vec2 step = w - arrival;
      value *= 2 * pi * lobe.density_at(1 - dot(step, step) / 2);
    }
    largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace flatspeckle::mc

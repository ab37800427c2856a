#include "mc/slab/adding/space_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/gauss.h"
#include "mc/jobs/bulk_parameter.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

constexpr int moments_per_panel = 4;  // 16 nodes see two periods of P_l to rounding

/// int p P_l over the sphere, l = 0 .. 4 panels - 1.
std::vector<double> legendre_moments(const std::function<double(double)>& p, int panels) {
  static const QuadratureRule rule = gauss_legendre(16);
  std::vector<double> moments(static_cast<std::size_t>(moments_per_panel) * panels);
  for (int panel = 0; panel < panels; ++panel)
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double angle = pi * (panel + rule.node[i]) / panels, cosine = std::cos(angle),
                   share = 2 * pi * pi / panels * rule.weight[i] * std::sin(angle) * p(cosine);
      double before = 0, legendre = 1;
      for (std::size_t l = 0; l < moments.size(); ++l) {
        moments[l] += share * legendre;
        const double n = static_cast<double>(l);
        before = std::exchange(legendre, ((2 * n + 1) * cosine * legendre - n * before) / (n + 1));
      }
    }
  return moments;
}

std::vector<double> significant_moments(const std::function<double(double)>& p) {
  constexpr double rounding = 1e-13;
  constexpr int most_panels = 512;
  for (int panels = 16;; panels *= 2) {
    auto moments = legendre_moments(p, panels);
    const auto small = [&](double m) { return std::abs(m) < rounding * moments.front(); };
    const auto end = std::find_if_not(moments.rbegin(), moments.rend(), small).base();
    moments.erase(end, moments.end());
    const bool all = moments.size() <= static_cast<std::size_t>(moments_per_panel / 2 * panels);
    if (all || panels == most_panels) return moments;
  }
}

}  // namespace

SpaceLaw::SpaceLaw(std::function<double(double)> density, double delay)
    : density_(std::move(density)), total_(significant_moments(density_).front()), delay_(delay) {
  moments_ = significant_moments(
      [this](double cosine) { return decay(cosine) * density_(cosine) / total_; });
  constexpr double moments_per_width = 30;  // g^l of Henyey-Greenstein is then 1e-13
  width_ = std::min(pi, moments_per_width / static_cast<double>(moments_.size()));
}

double SpaceLaw::pair_slope(double g, double first, double second) const {
  const auto by_g = [g](double cosine) { return henyey_greenstein_slope(g, 1 - cosine, 3); };
  return (by_g(first) + by_g(second)) / 2;
}

double SpaceLaw::decay(double cosine) const {
  return std::exp(-2 * delay_ * (1 - cosine));
}

double SpaceLaw::amplitude(double cosine) const {
  return std::sqrt(density_(std::clamp(cosine, -1.0, 1.0)) / total_);
}

}  // namespace flatspeckle::mc

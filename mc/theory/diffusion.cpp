#include "mc/theory/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/numbers/gauss.h"
#include "core/numbers/log_sinh.h"
#include "core/result/result_group.h"

namespace flatspeckle::mc {

namespace {

/// Returns the integrals of R cos^n over the directions towards a face, n = 1, 2, 3, relative to
/// their values for R = 1. Above the critical angle R is 1; below it the substitution angle =
/// critical (1 - u^2) removes the infinite per_depth of R at the critical angle.
std::array<double, 3> reflectance_moments(const Faces& faces, int dimension) {
  const double ratio = faces.outside / faces.inside,
               critical = ratio < 1 ? std::asin(ratio) : std::numbers::pi / 2;
  const QuadratureRule rule = gauss_legendre(48);
  std::array<double, 3> all{}, lost{};
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const auto add = [&](std::array<double, 3>& sums, double angle, double weight) {
      double value = dimension == 3 ? weight * std::sin(angle) : weight;
      for (double& sum : sums) sum += value *= std::cos(angle);
    };
    const double u = rule.node[i], angle = critical * (1 - u * u);
    add(all, std::numbers::pi / 2 * u, std::numbers::pi / 2 * rule.weight[i]);
    add(lost, angle,
        (1 - faces.leaving().reflectance(std::cos(angle))) * 2 * critical * u * rule.weight[i]);
  }
  for (std::size_t n = 0; n < 3; ++n) lost[n] = 1 - lost[n] / all[n];
  return lost;
}

}  // namespace

double extrapolation_length(const BulkMedium& medium) {
  return (medium.dimension == 3 ? 0.7104 : 0.818) * medium.transport_mean_free_path();
}

double extrapolation_length(const Scene& scene) {
  const double matched = extrapolation_length(scene.medium);
  if (!scene.faces || scene.faces->inside == scene.faces->outside) return matched;
  const int dimension = scene.medium.dimension;
  const auto [k1, k2, k3] = reflectance_moments(*scene.faces, dimension);
  // Mean values of cos^2 and cos^3, relative to that of cos.
  const double m2 = dimension == 3 ? 2.0 / 3 : std::numbers::pi / 4,
               m3 = dimension == 3 ? 1.0 / 2 : 2.0 / 3;
  const double length =
      (m2 * k2 + std::sqrt(m2 * m2 * k2 * k2 + (1 - k1) * m3 * (1 + k3))) / (1 - k1);
  return matched * length / std::sqrt(m3);
}

const DatasetTable diffusion_table{
    .name = "diffusion theory",
    .rows = {},
    .attributes = {{"", "extrapolation_length", "float64",
                    "extrapolation length of a slab in diffusion theory, with the reflection by "
                    "its faces"}}};

void write_extrapolation_length(ResultFile& file, const Scene& scene) {
  if (scene.domain.kind == Domain::Kind::slab && scene.medium.mu_t > 0 && !scene.profile)
    ResultGroup(file, diffusion_table)
        .attribute("extrapolation_length", extrapolation_length(scene));
}

DiffusingSlab::DiffusingSlab(const BulkMedium& medium, double thickness)
    : dimension(medium.dimension),
      thickness(thickness),
      mu_s(medium.mu_s),
      mu_a(medium.mu_t - medium.mu_s),
      g(medium.g),
      transport_length(medium.transport_mean_free_path()),
      extrapolation(extrapolation_length(medium)) {}

DiffusingSlab::DiffusingSlab(const Scene& slab) : DiffusingSlab(slab.medium, slab.domain.depth) {
  extrapolation = extrapolation_length(slab);
}

Complex diffusion_loss_correlation(const DiffusingSlab& slab, Complex loss) {
  const double source = std::min(slab.transport_length, slab.thickness), z0 = slab.extrapolation;
  const double kappa2 = slab.loss(slab.mu_a);
  // Returns log f of C20. Q is set to at least 1e-5 / thickness; below this value f equals its
  // limit at Q = 0 to rounding.
  const auto log_f = [&](Complex q2) {
    const Complex root = std::sqrt(q2), least = 1e-5 / slab.thickness,
                  rate = std::abs(root) > least.real() ? root : least;
    return log_sinh(rate * z0) + log_sinh(rate * (source + z0)) - std::log(rate) -
           log_sinh(rate * (slab.thickness + 2 * z0));
  };
  return std::exp(log_f(loss + kappa2) - log_f(kappa2));
}

double diffusion_field_correlation(const DiffusingSlab& slab, double q) {
  return diffusion_loss_correlation(slab, q * q).real();
}

double diffusion_frequency_correlation(const DiffusingSlab& slab, double k, double shift) {
  return std::abs(diffusion_loss_correlation(slab, slab.loss(Complex(0, k * shift))));
}

double diffusion_range(const DiffusingSlab& slab) {
  const auto above = [&](double q) {
    return std::pow(diffusion_field_correlation(slab, q), 2) > 0.5;
  };
  double low = 0, high = 1 / slab.thickness;
  while (above(high)) high *= 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (above(middle) ? low : high) = middle;
  }
  return (low + high) / 2;
}

double scatterings_of_slowest_mode(const BulkMedium& medium, const Domain& domain) {
  const double beyond = 2 * extrapolation_length(medium),
               diffusion = medium.transport_mean_free_path() / medium.dimension;
  // Rate, per length of path, at which light leaves through two opposite edges
  const auto leaving = [&](double extent) {
    const double wavenumber = std::numbers::pi / (extent + beyond);
    return diffusion * wavenumber * wavenumber;
  };
  const double sides = domain.kind == Domain::Kind::box ? leaving(domain.width) : 0;
  return medium.mu_s / (medium.mu_t - medium.mu_s + leaving(domain.depth) + sides);
}

double single_scattering_correlation(const Light& light, const std::vector<View>& views,
                                     double thickness, double q, double tilt_azimuth) {
  // Transverse distance along q that a ray covers per unit of depth
  const auto per_depth = [&](const auto& ray) {
    return std::tan(ray.angle) * std::cos(ray.azimuth - tilt_azimuth);
  };
  double sum = 0;
  for (const View& view : views) {
    const double phase = q * thickness * (per_depth(view) - per_depth(light)) / 2;
    sum += phase == 0 ? 1 : std::pow(std::sin(phase) / phase, 2);
  }
  return std::sqrt(sum / static_cast<double>(views.size()));
}

}  // namespace flatspeckle::mc

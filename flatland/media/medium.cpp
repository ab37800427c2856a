#include "flatland/media/medium.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace flatspeckle {

namespace {

/// sqrt(S) at the momentum transfer of a scattering angle.
double structure_amplitude(const StructureTable& structure, double k, double theta) {
  return std::sqrt(structure(2 * k * std::abs(std::sin(theta / 2))));
}

}  // namespace

bool is_physical(const BulkMedium& medium) {
  constexpr double rounding = 1e-9;
  return std::isfinite(medium.mu_t) && medium.mu_s >= 0 &&
         medium.mu_s <= (1 + rounding) * medium.mu_t && std::abs(medium.g) <= 1 + rounding;
}

BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density) {
  constexpr double tolerance = 1e-13;
  BulkMedium medium;
  medium.has_scatterers = true;
  medium.t_matrix = t_matrix(scatterer, k, isolated_order(scatterer, k, tolerance));
  medium.cross_sections = cross_sections(medium.t_matrix, k);
  medium.g = medium.cross_sections.g;
  medium.albedo = medium.cross_sections.extinction == 0
                      ? 0
                      : medium.cross_sections.scattering / medium.cross_sections.extinction;
  set_density(medium, scatterer, k, density);
  return medium;
}

void set_density(BulkMedium& medium, const Scatterer& scatterer, double k, double density) {
  medium.density = density;
  medium.mu_s = density * medium.cross_sections.scattering;
  medium.mu_t = density * medium.cross_sections.extinction;
  if (scatterer.is_disk())
    medium.packing_fraction = density * std::numbers::pi * scatterer.radius * scatterer.radius;
  // k_eff - k = (2 rho / (i k)) sum_n T_n (C15)
  long double sum_imag = medium.t_matrix[0].imag();
  for (std::size_t n = 1; n < medium.t_matrix.size(); ++n)
    sum_imag += 2 * medium.t_matrix[n].imag();
  medium.k_shift = 2 * density / k * static_cast<double>(sum_imag);
}

BulkMedium bulk_medium(const Scatterer& bulk, const BulkPhase& phase, double mu_t) {
  BulkMedium medium;
  medium.mu_t = mu_t;
  medium.albedo = bulk.albedo;
  medium.mu_s = medium.albedo * mu_t;
  medium.g = phase.density ? phase.g : bulk.g;
  medium.phase = phase;
  return medium;
}

BulkMedium correlated_medium(BulkMedium medium, double k, StructureTable structure) {
  medium.structure = std::move(structure);
  // The trapezoidal rule is spectrally accurate where S is smooth, and fine enough for a table.
  const std::size_t intervals = 256 * (medium.t_matrix.size() + 1);
  const auto alone = amplitudes(medium.t_matrix, k, intervals);
  const double step = std::numbers::pi / static_cast<double>(intervals);
  double sum = 0, cosine = 0;
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double theta = static_cast<double>(i) * step;
    const double weight = i == 0 || i == intervals ? step : 2 * step;
    const double root = structure_amplitude(medium.structure, k, theta);
    const double scattered = weight * std::norm(root * alone[i]);
    sum += scattered;
    cosine += scattered * std::cos(theta);
  }
  const double absorption = medium.mu_t - medium.mu_s;
  medium.mu_s = medium.density * sum;
  medium.mu_t = medium.mu_s + absorption;
  medium.g = sum > 0 ? cosine / sum : 0;
  medium.albedo = medium.mu_t == 0 ? 0 : medium.mu_s / medium.mu_t;
  return medium;
}

std::vector<Complex> normalised_amplitudes(const BulkMedium& medium, double k,
                                           std::size_t intervals) {
  const double step = std::numbers::pi / static_cast<double>(intervals);
  if (medium.phase.density) {
    std::vector<Complex> roots;
    for (std::size_t i = 0; i <= intervals; ++i)
      roots.emplace_back(std::sqrt(medium.phase.density(static_cast<double>(i) * step)));
    return roots;
  }
  auto values = amplitudes(medium.t_matrix, k, intervals);
  const double scale = std::sqrt(medium.density / medium.mu_s);
  for (std::size_t i = 0; i <= intervals; ++i)
    values[i] *= scale * structure_amplitude(medium.structure, k, static_cast<double>(i) * step);
  return values;
}

BulkMedium mean_medium(const std::vector<std::pair<const BulkMedium*, double>>& shares) {
  BulkMedium mean;
  double cosine = 0;
  for (const auto& [medium, share] : shares) {
    mean.has_scatterers = medium->has_scatterers;
    mean.mu_t += share * medium->mu_t;
    mean.mu_s += share * medium->mu_s;
    mean.density += share * medium->density;
    mean.packing_fraction += share * medium->packing_fraction;
    mean.k_shift += share * medium->k_shift;
    cosine += share * medium->mu_s * medium->g;
  }
  mean.albedo = mean.mu_t > 0 ? mean.mu_s / mean.mu_t : 0;
  mean.g = mean.mu_s > 0 ? cosine / mean.mu_s : 0;
  return mean;
}

}  // namespace flatspeckle

#include "flatland/medium.h"

#include <cmath>
#include <numbers>

namespace flatspeckle {

BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density) {
  constexpr double tolerance = 1e-13;
  BulkMedium medium;
  medium.has_scatterers = true;
  medium.density = density;
  medium.t_matrix = t_matrix(scatterer, k, isolated_order(scatterer, k, tolerance));
  medium.cross_sections = cross_sections(medium.t_matrix, k);
  medium.mu_s = density * medium.cross_sections.scattering;
  medium.mu_t = density * medium.cross_sections.extinction;
  medium.g = medium.cross_sections.g;
  medium.albedo = medium.cross_sections.extinction == 0
                      ? 0
                      : medium.cross_sections.scattering / medium.cross_sections.extinction;
  if (scatterer.is_disk())
    medium.packing_fraction = density * std::numbers::pi * scatterer.radius * scatterer.radius;
  // k_eff - k = (2 rho / (i k)) sum_n T_n (C15)
  long double sum_imag = medium.t_matrix[0].imag();
  for (std::size_t n = 1; n < medium.t_matrix.size(); ++n)
    sum_imag += 2 * medium.t_matrix[n].imag();
  medium.k_shift = 2 * density / k * static_cast<double>(sum_imag);
  return medium;
}

BulkMedium bulk_medium(const Scatterer& henyey_greenstein, double mu_t) {
  BulkMedium medium;
  medium.mu_t = mu_t;
  medium.albedo = henyey_greenstein.albedo;
  medium.mu_s = medium.albedo * mu_t;
  medium.g = henyey_greenstein.g;
  return medium;
}

}  // namespace flatspeckle

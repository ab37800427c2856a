#pragma once

#include <vector>

#include "core/complex.h"
#include "flatland/scatterer.h"

namespace flatspeckle {

/// Bulk optical properties (C5). Lengths in the scene's unit.
struct BulkMedium {
  double mu_s = 0, mu_t = 0;
  double g = 0, albedo = 1;
  double k_shift = 0;           ///< Re k_eff - k (C15); not defined (0) for hg
  bool has_scatterers = false;  ///< the next four exist: false for hg
  double density = 0;           ///< scatterers per area
  double packing_fraction = 0;
  CrossSections cross_sections;
  std::vector<ExtendedComplex> t_matrix;

  double mean_free_path() const { return 1 / mu_t; }
  double transport_mean_free_path() const { return 1 / (mu_t - mu_s * g); }
};

/// A medium of scatterers with a T-matrix, at a number per area.
BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density);
/// A Henyey-Greenstein medium of given extinction.
BulkMedium bulk_medium(const Scatterer& henyey_greenstein, double mu_t);

}  // namespace flatspeckle

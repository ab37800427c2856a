#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers/bessel.h"
#include "flatland/scatterers/bulk_phases.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// Values of the keys that describe scatterers. Each kind reads only the keys that it uses.
struct ScattererValues {
  double wavelength = 1;
  std::string scatterer = "point";
  std::optional<double> radius, diameter, g, albedo, phase_shift;
  std::optional<double> mu_s, mu_a;           ///< instead of albedo and an extinction
  std::optional<std::string> index;           ///< relative to the medium around the scatterers
  std::optional<std::string> particle_index;  ///< absolute; requires medium_index
  std::optional<double> medium_index;
  BulkPhases bulk{};
};

/// One kind of scatterer, defined in its own file and listed in scatterer_kinds.cpp. Phase
/// functions that have their own keys are listed in bulk_phases.h instead.
struct ScattererKind {
  const char* word;
  Scatterer::Kind kind;
  /// Reads the keys of this kind into `made`. Throws InputError.
  void (*read)(const Keys& keys, const ScattererValues& values, Scatterer& made);
  /// Returns T_n for n = 0 .. order, with x = k radius. Null for kinds without a T-matrix
  /// (Scatterer::is_bulk()).
  std::vector<ScaledComplex> (*t_matrix)(const Scatterer& scatterer, double x, int order,
                                         Radial kind);
};
extern const ScattererKind point_kind, soft_kind, hard_kind, tm_kind, penetrable_kind, te_kind,
    hg_kind, mie_kind;

// These functions read keys that several kinds of scatterers share.
/// Throws InputError unless the radius or the diameter is given.
void require_radius(const ScattererValues& values);
void read_radius(const Keys& keys, const ScattererValues& values, Scatterer& made);
void read_radius_and_index(const Keys& keys, const ScattererValues& values, Scatterer& made);
void read_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made);
/// Reads the albedo of a phase function, or mu_s and mu_a instead.
void read_bulk_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made);

/// Returns the kind of a scatterer, which must not be other_bulk.
const ScattererKind& kind_of(const Scatterer& scatterer);

/// Returns the accepted values of the key `scatterer`.
std::vector<std::string> scatterer_words();

/// Creates a scatterer. Throws InputError naming key, value and what is accepted.
Scatterer make_scatterer(const Keys& keys, const ScattererValues& values);

}  // namespace flatspeckle

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flatland/scatterers/bulk_phases.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// What scatterers are told; each kind reads what it has a use for.
struct ScattererValues {
  double wavelength = 1;
  std::string scatterer = "point";
  std::optional<double> radius, g, albedo, phase_shift;
  std::optional<std::string> index;
  BulkPhases bulk{};
};

/// One kind of scatterer, in a file of its own. Their list is that of scatterer_kinds.cpp; phase
/// functions of the bulk with keys of their own have another (bulk_phases.h).
struct ScattererKind {
  const char* word;
  Scatterer::Kind kind;
  /// Reads the keys. Throws InputError.
  void (*read)(const Keys& keys, const ScattererValues& values, Scatterer& made);
  /// T_n for n = 0 .. order at k radius = x; none of the bulk.
  std::vector<ScaledComplex> (*t_matrix)(const Scatterer& scatterer, double x, int order);
};
extern const ScattererKind point_kind, soft_kind, hard_kind, tm_kind, te_kind, hg_kind, mie_kind;

// What several kinds read.
void read_radius(const Keys& keys, const ScattererValues& values, Scatterer& made);
void read_radius_and_index(const Keys& keys, const ScattererValues& values, Scatterer& made);
void read_albedo(const Keys& keys, const ScattererValues& values, Scatterer& made);

/// That of a scatterer with a T-matrix.
const ScattererKind& kind_of(const Scatterer& scatterer);

/// What `scatterer` may be.
std::vector<std::string> scatterer_words();

/// Throws InputError naming key, value and what is accepted.
Scatterer make_scatterer(const Keys& keys, const ScattererValues& values);

}  // namespace flatspeckle

#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"

namespace flatspeckle {

/// One scatterer. hg and the other phase functions of the bulk (bulk_phases.h) have no T-matrix,
/// and the wave solver refuses them; so it does spheres (mie), which are of space alone.
struct Scatterer {
  enum class Kind { point, soft, hard, tm, te, hg, mie, other_bulk };
  Kind kind = Kind::point;
  double radius = 0;                          ///< of soft, hard, tm, te, mie
  Complex index = 1.5;                        ///< of tm, te, mie, relative to the surroundings
  double g = 0;                               ///< of hg
  double albedo = 1;                          ///< of the bulk and of resonant points (C8)
  double phase_shift = std::numbers::pi / 2;  ///< of lossless points; pi/2 is resonance

  /// A disk of nonzero radius, which others must not overlap.
  bool is_disk() const { return kind != Kind::point && !is_bulk(); }
  /// A cylinder that light enters.
  bool is_penetrable() const { return kind == Kind::tm || kind == Kind::te; }
  bool is_bulk() const { return kind == Kind::hg || kind == Kind::mie || kind == Kind::other_bulk; }

  double disk_radius() const { return is_disk() ? radius : 0; }

  bool operator==(const Scatterer&) const = default;
};

/// Why no cylinder may have this index, empty if it may.
std::string index_fault(Complex index);

/// T_n for n = 0 .. order; T_{-n} = T_n. (conventions, C7 and C8)
/// k: wavenumber outside. A bulk phase function is a precondition violation.
std::vector<ScaledComplex> scaled_t_matrix(const Scatterer& scatterer, double k, int order);
/// The same; 0 where T_n is below the range of long double.
std::vector<ExtendedComplex> t_matrix(const Scatterer& scatterer, double k, int order);

/// The order up to which T_n may oscillate or resonate; beyond it |T_n| falls. Throws InputError
/// where it is above 10000.
int oscillating_order(const Scatterer& scatterer, double k);

/// The order beyond which no |T_n| exceeds tolerance times the largest one.
int isolated_order(const Scatterer& scatterer, double k, double tolerance);

/// Cross-sections are lengths in flatland (C4, C5, C9).
struct CrossSections {
  double scattering = 0, extinction = 0;
  double g = 0;  ///< mean cosine
};
CrossSections cross_sections(const std::vector<ExtendedComplex>& t_matrix, double k);

/// Far-field amplitude of one scatterer at the origin for light along +z (C6), at scattering angle
/// theta.
Complex amplitude(const std::vector<ExtendedComplex>& t_matrix, double k, double theta);
/// The same at theta = 0 .. pi in equal intervals, a node in a nanosecond per order.
std::vector<Complex> amplitudes(const std::vector<ExtendedComplex>& t_matrix, double k,
                                std::size_t intervals);

}  // namespace flatspeckle

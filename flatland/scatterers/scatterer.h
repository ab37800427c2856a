#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "core/numbers/bessel.h"
#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"

namespace flatspeckle {

/// One scatterer, or the phase function of a medium without scatterers (the bulk). The wave solver
/// rejects phase functions (hg and those of bulk_phases.h), which have no T-matrix, and spheres
/// (mie), which exist only in three dimensions.
struct Scatterer {
  enum class Kind { point, soft, hard, tm, te, hg, mie, other_bulk };
  Kind kind = Kind::point;
  double radius = 0;    ///< radius of a cylinder (soft, hard, tm, te) or sphere (mie)
  Complex index = 1.5;  ///< for tm, te, mie: index relative to the surroundings
  double g = 0;         ///< for hg: mean cosine
  double albedo = 1;    ///< for phase functions of the bulk and for points (C8)
  double phase_shift = std::numbers::pi / 2;  ///< for lossless points; pi/2 is resonance

  /// Whether it is a disk of nonzero radius, which must not overlap other scatterers.
  bool is_disk() const { return kind != Kind::point && !is_bulk(); }
  /// Whether it is a cylinder that light enters.
  bool is_penetrable() const { return kind == Kind::tm || kind == Kind::te; }
  bool is_bulk() const { return kind == Kind::hg || kind == Kind::mie || kind == Kind::other_bulk; }

  double disk_radius() const { return is_disk() ? radius : 0; }
  /// Returns the area of a cylinder's cross-section or, in space, the volume of a sphere.
  double content(int dimension) const {
    const double square = std::numbers::pi * radius * radius;
    return dimension == 3 ? 4 * square * radius / 3 : square;
  }

  bool operator==(const Scatterer&) const = default;
};

/// Returns the reason why a cylinder cannot have this index, for error messages; empty if it can.
std::string index_fault(Complex index);

/// Returns T_n for n = 0 .. order (conventions, C7 and C8, where T_{-n} = T_n; in space C57).
/// k: wavenumber outside.
/// Precondition: the scatterer has a T-matrix (not is_bulk()).
std::vector<ScaledComplex> scaled_t_matrix(const Scatterer& scatterer, double k, int order,
                                           Radial kind = Radial::cylindrical);
/// Returns the T_n of scaled_t_matrix() in long double; values below the range of long double
/// become 0.
std::vector<ExtendedComplex> t_matrix(const Scatterer& scatterer, double k, int order,
                                      Radial kind = Radial::cylindrical);

/// Returns the order up to which T_n may oscillate or resonate; beyond it |T_n| falls. Throws
/// InputError if it is above 10000.
int oscillating_order(const Scatterer& scatterer, double k);

/// Returns the order beyond which no |T_n| exceeds tolerance times the largest one.
int isolated_order(const Scatterer& scatterer, double k, double tolerance,
                   Radial kind = Radial::cylindrical);

/// Cross-sections of a scatterer; in flatland they are lengths (C4, C5, C9).
struct CrossSections {
  double scattering = 0, extinction = 0;
  double g = 0;  ///< mean cosine
};
CrossSections cross_sections(const std::vector<ExtendedComplex>& t_matrix, double k);
/// Returns the cross-sections of a sphere or point in space, which are areas (C57).
CrossSections cross_sections_in_space(const std::vector<ExtendedComplex>& t_matrix, double k);
/// Returns the far-field amplitude f of a sphere or point in space (C57). cosine: that of the
/// scattering angle.
Complex amplitude_in_space(const std::vector<ExtendedComplex>& t_matrix, double k, double cosine);
/// Returns these amplitudes at equal steps of the angle from 0 to pi, fine enough for linear
/// interpolation to 1e-6.
std::vector<Complex> amplitudes_in_space(const std::vector<ExtendedComplex>& t_matrix, double k);

/// Returns the far-field amplitude of one scatterer at the origin for light along +z (C6), at
/// scattering angle theta.
Complex amplitude(const std::vector<ExtendedComplex>& t_matrix, double k, double theta);
/// Returns the amplitudes at theta = 0 .. pi in equal intervals. Takes about one nanosecond per
/// angle and order.
std::vector<Complex> amplitudes(const std::vector<ExtendedComplex>& t_matrix, double k,
                                std::size_t intervals);

}  // namespace flatspeckle

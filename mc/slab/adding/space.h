#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "flatland/scene/scene.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/layer.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/phase_moments.h"

namespace flatspeckle::mc {

/// Completes a scene in space: the phase function of the medium is per steradian, and its
/// `dimension` is 3. Throws InputError for phase functions that exist only in the plane. For mie
/// the albedo follows from the spheres, and so does the
/// extinction if the scene gives their density; the phase function includes the structure factor.
Scene in_space(Scene scene, const ScattererValues& values);

/// Scattering of field pairs in space, with scalar amplitudes A = sqrt(p). The Legendre moments of
/// the phase function p are defined by
///   p = sum_l (2 l + 1) / (4 pi) moments[l] P_l(cos).
/// For fields at two times, between which the scatterers diffuse, the second field of a pair is the
/// later one. Each scattering then multiplies the pair, and therefore p, by the decay exp(-2 delay
/// (1 - cos)), with delay = k^2 D tau (C39). cos: cosine of the scattering angle.
class SpaceLaw {
 public:
  /// density: p as a function of the cosine of the scattering angle. It need not be normalised,
  /// except if `moments` are given.
  explicit SpaceLaw(std::function<double(double)> density, double delay = 0,
                    FirstMoments moments = {});

  /// Returns the product of the amplitudes at two scattering angles and of the decay at the second
  /// angle. first, second: cosines of the angles.
  double pair(double first, double second) const {
    return amplitude(first) * amplitude(second) * decay(second);
  }
  /// Returns the derivative by g of log(pair()), for the Henyey-Greenstein function and delay 0.
  double pair_derivative(double g, double first, double second) const;
  /// Kept moments (KeptMoments::list), without the contribution of the forward peak.
  const std::vector<double>& moments() const { return moments_.kept().list; }
  double peak() const { return moments_.kept().peak; }
  const KeptMoments& kept() const { return moments_.kept(); }
  bool has_sharp_peak() const { return moments_.kept().is_sharp(); }
  /// Returns the law with at most the first `count` moments, and with the width that follows from
  /// these moments.
  SpaceLaw truncated(int count) const;
  /// Smallest angle over which p varies.
  double width() const { return width_; }
  int least_order() const { return 0; }  ///< least number of nodes per panel; 0: none required

 private:
  double amplitude(double cosine) const;
  double decay(double cosine) const;

  std::function<double(double)> density_;
  PhaseMoments moments_;
  double total_ = 1, delay_, width_;
};

template <typename Geometry, typename Real>
class OrdinatesOf;

/// Parts of the solution that are specific to slabs in space (slab.h), for scalar waves (C41).
/// Directions are unit vectors, z into the slab; functions of direction are Fourier modes cos(m
/// phi) and sin(m phi) of the azimuth phi about z, measured from the direction of the transverse
/// momentum.
struct SpaceGeometry {
  using Direction = Eigen::Vector3d;
  using Law = SpaceLaw;
  using Momentum = std::array<double, 2>;  ///< transverse momentum in units of k

  static Direction direction(double angle, double azimuth) {
    const Vec w = flatspeckle::direction(angle, azimuth);
    return {w.x, w.y, w.z};
  }
  /// Returns the direction of the second view for which the views have the same transverse momentum
  /// as the lights (C39).
  static Direction matched(const SpacePair& lights, const SpacePair& views, double shift);
  /// Returns the transverse momentum of a pair of illuminations. shift: Departure::shift.
  static Momentum momentum(const SpacePair& lights, double, double, double shift);
  static double size(const Momentum& momentum, double k) {
    return k * Eigen::Vector2d(momentum[0], momentum[1]).norm();
  }

  static Law law(const Scene& scene, double delay = 0);
  /// Returns the scene with other spheres at the same number density and independent positions.
  static Scene with_scatterer(Scene scene, const Scatterer& scatterer);
  /// Returns Law::pair() for a single scattering from the illuminations to the views.
  template <typename L>
  static auto turned(const L& law, const SpacePair& lights, const SpacePair& views) {
    return law.pair(lights.first.dot(views.first), lights.second.dot(views.second));
  }

  /// Foci of pairs of illuminations. The angles of the foci are rounded to multiples of half the
  /// width of the phase function, so that close illuminations share one angular grid.
  class Foci {
   public:
    Foci(const std::vector<SpacePair>&, double, double width) : width_(width) {}
    std::vector<Focus> of(const SpacePair& lights, const Momentum&) const;

   private:
    double width_;
  };

  /// Returns the factor of pairs of lights and of pairs of views in a layer (C47). index: its
  /// refractive index relative to that outside. With this factor, radiance times
  /// OrdinatesOf::root() is transmitted through a face between two layers as the power is (C50).
  static double radiance_scale(double, Polarisation) { return 1; }

  /// Returns the number by which the radiance of power in a layer is divided. Radiance times
  /// OrdinatesOf::root() is then transmitted through a face between two layers as the power is.
  static double power_scale(double index) { return index; }

  static constexpr int function_kinds = 2;  ///< kinds of functions of direction: cosines and sines
  /// Highest mode of the first solution; it is increased by refinement, like the number of
  /// ordinates.
  static constexpr int first_modes = 2;
  static constexpr bool refines_modes = true;
  static constexpr int flux_modes = 0;  ///< highest mode that slab_flux() requires
  /// Coefficient by which the transverse momentum couples modes m and m + 1.
  static double coupling(int m);
  /// Number of unknowns, downward and upward, per ordinate of the grid.
  static int ordinates(std::size_t functions) { return 2 * static_cast<int>(functions); }

  /// Returns sin(angle) P_l^m(cos(angle)) for l = m .. last, [angle][l - m]. The associated
  /// Legendre functions P_l^m are positive towards the forward direction and normalised to int
  /// P_l^m(c)^2 dc = 1 over [-1, 1].
  static Matrix functions(const Eigen::VectorXd& angle, int m, int last);
  /// Factor of a moment of the phase function in its expansion in functions().
  static double weight(int) { return 2; }
  /// Returns the integrals of the polynomials l_j (AngularGrid) over cos(theta).
  static Eigen::VectorXd weights(const AngularGrid& grid);
  /// Returns the coefficients of a beam at the angle `light` in functions() of mode m = 0, for the
  /// degrees 0 .. last (used by OrdinatesOf::of_beam()).
  static std::vector<Complex> beam(double light, int m, int last);
  /// Factor of the radiance of mode 0 in the integral of radiance over all directions.
  static double all_directions() { return std::sqrt(2 * std::numbers::pi); }
  /// Returns the radiance that the scattering of pairs of illuminations adds, downwards and
  /// upwards, one row per pair. A row contains the values at all ordinates for the first function
  /// of direction, then those for the next.
  template <typename Number>
  static PairWavesOf<Number> fed(const OrdinatesOf<SpaceGeometry, RealOf<Number>>& ordinates,
                                 const Momentum& momentum, int highest,
                                 const std::vector<SpacePair>& pairs);

  static constexpr bool has_double_scattering = false;
};

}  // namespace flatspeckle::mc

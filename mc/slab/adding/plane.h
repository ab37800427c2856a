#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/bulk_derivative.h"
#include "mc/slab/adding/layer.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/phase_moments.h"

namespace flatspeckle::mc {

/// Scattering of field pairs by one scatterer of a medium in the plane. The amplitude A is that of
/// C14 divided by sqrt(sigma_s), so that |A|^2 is the phase function p. The Fourier moments of p
/// are defined by
///   p(theta) = (moments[0] + 2 sum_m moments[m] cos(m theta)) / (2 pi).
/// For fields at two times, between which the scatterers diffuse, the second field of a pair is the
/// later one. Each scattering by an angle theta then multiplies the pair by the decay exp(-2 delay
/// (1 - cos theta)), with delay = k^2 D tau (C39).
class ScatteringLaw {
 public:
  /// The medium must scatter.
  explicit ScatteringLaw(const Scene& scene, double delay = 0);

  /// Returns A(theta - a) conj(A(theta - b)) decay(theta - b): the scattering of a pair of
  /// illuminations or views with the directions a and b into the direction theta.
  Complex pair(double a, double b, double theta) const {
    return decay(theta - b) *
           (a == b ? Complex(std::norm(amplitude(theta - a)))
                   : product_with_conjugate(amplitude(theta - a), amplitude(theta - b)));
  }
  double decay(double angle) const {
    return delay_ == 0 ? 1 : std::exp(-2 * delay_ * (1 - std::cos(angle)));
  }
  Complex amplitude(double angle) const;

  /// Returns the derivative by g of log(pair()), for the Henyey-Greenstein function and delay 0.
  double pair_derivative(double g, double a, double b, double theta) const;

  /// Kept moments (KeptMoments::list), without the contribution of the forward peak.
  const std::vector<double>& moments() const { return moments_.kept().list; }
  double peak() const { return moments_.kept().peak; }
  const KeptMoments& kept() const { return moments_.kept(); }
  bool has_sharp_peak() const { return moments_.kept().is_sharp(); }
  /// Returns the law with at most the first `count` moments, and with the width that follows from
  /// these moments.
  ScatteringLaw truncated(int count) const;
  /// Smallest angle over which p varies.
  double width() const { return width_; }
  /// Whether p varies too rapidly to be resolved by a polynomial on a whole quadrant.
  bool is_peaked() const { return width_ < 0.4; }
  /// Least number of nodes on a quadrant that resolves the lobes of p; 0 if p is peaked.
  int least_order() const { return least_order_; }

 private:
  void tabulate(const Scene& scene);
  std::vector<double> first_moments(int count) const;

  std::function<double(double)> density_;  ///< p at an angle in [0, pi]; empty if A is tabulated
  /// A at equal steps over [0, pi], for scatterers given by a T-matrix.
  std::vector<Complex> table_;
  std::optional<double> g_;  ///< set if p is the Henyey-Greenstein function
  PhaseMoments moments_;
  double delay_, width_ = 0;
  int least_order_ = 0;
};

/// Contribution of paths with two scatterings, for one pair of illuminations and one pair of views.
/// Light is scattered into the direction theta at one depth, and into the directions of the views
/// at another. The integrals over the depths have a closed form, so that only the integral over
/// theta is numerical. This is accurate also in cases that require many ordinates: forward peaks,
/// and large transverse momenta, for which the phase varies rapidly with theta.
template <typename Number>
class DoubleScatteringOf {
 public:
  using C = ComplexOf<Number>;
  using Law = std::conditional_t<std::is_same_v<Number, Dual<double>>, DerivativeOf<ScatteringLaw>,
                                 ScatteringLaw>;

  /// A pair of illuminations or of views in the layer, with its wave.
  struct Endpoint {
    Pair pair;
    PairWaveOf<Number> wave;
  };
  /// k, q: wavenumber and transverse momentum in units of mu_t.
  DoubleScatteringOf(RealOf<Number> optical_depth, double k, double q, const Endpoint& lights,
                     const Endpoint& views, const Departure<Number>& departure);

  /// Returns the contribution, per unit angle, of light that travels in the direction theta between
  /// the two scatterings, if all scattering amplitudes are 1. It includes the factor 1/cos(theta).
  /// sine, cosine: sin(theta), |cos(theta)|. down: whether the light travels towards larger z.
  C along(double sine, double cosine, bool down) const;

  /// Returns the integral over all theta of the contribution with the scattering amplitudes of both
  /// pairs, by adaptive quadrature to an absolute tolerance.
  C total(const Law& law, double tolerance) const;

 private:
  C integral(const Law& law, double from, double to, double tolerance, C estimate, int depth) const;
  C gauss(const Law& law, double from, double to) const;

  RealOf<Number> optical_depth_, q_;
  Number extinction_;
  Pair lights_, views_;
  PairWaveOf<Number> light_, view_;
};

template <typename Geometry, typename Real>
class OrdinatesOf;

/// Parts of the solution that are specific to slabs in the plane (slab.h). Directions are angles;
/// functions of direction are even or odd in the angle.
struct PlaneGeometry {
  using Direction = double;
  using Law = ScatteringLaw;
  using Momentum = double;  ///< transverse momentum in units of mu_t

  static Direction direction(double angle, double) { return angle; }
  /// Returns the direction of the second view for which the views have the same transverse momentum
  /// as the lights (C39).
  static Direction matched(const Pair& lights, const Pair& views, double shift);
  /// Returns the transverse momentum of a pair of illuminations (C35). shift: Departure::shift.
  static Momentum momentum(const Pair& lights, double k, double mu_t, double shift);
  static double size(Momentum momentum, double) { return momentum; }

  static Law law(const Scene& scene, double delay = 0) { return ScatteringLaw(scene, delay); }
  /// Returns the scene with other scatterers at the same density.
  static Scene with_scatterer(Scene scene, const Scatterer& scatterer);
  /// Returns Law::pair() for a single scattering from the illuminations to the views.
  template <typename L>
  static auto turned(const L& law, const Pair& lights, const Pair& views) {
    return law.pair(lights.first - views.first, lights.second - views.second, 0.0);
  }

  /// Foci of pairs of illuminations. Illuminations closer to each other than half the width of the
  /// phase function share one focus, so that their pairs share an angular grid.
  class Foci {
   public:
    Foci(const std::vector<Pair>& lights, double optical_depth, double width);
    std::vector<Focus> of(const Pair& lights, Momentum q) const;

   private:
    double optical_depth_, width_;
    std::vector<double> centres_;
  };

  /// Returns the factor of pairs of lights and of pairs of views in a layer (C47). index: its
  /// refractive index relative to that outside. With this factor, radiance times
  /// OrdinatesOf::root() is transmitted through a face between two layers as the power is (C50).
  static double radiance_scale(double index, Polarisation polarisation) {
    return polarisation == Polarisation::te ? std::pow(index, -1.5) : std::sqrt(index);
  }

  /// Returns the number by which the radiance of power in a layer is divided. Radiance times
  /// OrdinatesOf::root() is then transmitted through a face between two layers as the power is.
  static double power_scale(double index) { return std::sqrt(index); }

  static constexpr int function_kinds = 1;  ///< kinds of functions of direction: cosines only
  static constexpr int first_modes = 1;  ///< highest mode of the solution; higher ones do not exist
  static constexpr bool refines_modes = false;
  static constexpr int flux_modes = 1;  ///< highest mode that slab_flux() requires
  /// Coefficient by which the transverse momentum couples modes m and m + 1.
  static double coupling(int) { return 1; }
  /// Number of unknowns, downward and upward, per ordinate of the grid.
  static int ordinates(std::size_t) { return 2; }

  /// Returns the functions of direction, [angle][l - m], for l = m .. last: cos(l theta) if m = 0,
  /// sin(l theta) if m = 1.
  static Matrix functions(const Eigen::VectorXd& angle, int m, int last);
  /// Factor of moment l of the phase function in its expansion in functions().
  static double weight(int l);
  /// Returns the integrals of the polynomials l_j (AngularGrid) over theta.
  static Eigen::VectorXd weights(const AngularGrid& grid) { return grid.weight(); }
  /// Returns the coefficients of a beam at the angle `light` in functions() of mode m, for the
  /// degrees m .. last (used by OrdinatesOf::of_beam()).
  static std::vector<Complex> beam(double light, int m, int last);
  /// Factor of the radiance of mode 0 in the integral of radiance over all directions.
  static double all_directions() { return std::numbers::sqrt2; }
  /// Returns the radiance that the scattering of pairs of illuminations adds, downwards and
  /// upwards, one row per pair. A row contains the values at all ordinates for the first function
  /// of direction, then those for the next.
  template <typename Number>
  static PairWavesOf<Number> fed(const OrdinatesOf<PlaneGeometry, RealOf<Number>>& ordinates,
                                 Momentum, int highest, const std::vector<Pair>& pairs);

  /// Whether paths with two scatterings can be computed separately (DoubleScatteringOf).
  static constexpr bool has_double_scattering = true;
  /// Returns the approximation of the ordinates to the contribution of paths with two scatterings,
  /// for the pairs of illuminations and views with the indices `light` and `view`. functions:
  /// functions of direction in which the waves of the layer are expanded.
  template <typename Number>
  static ComplexOf<Number> double_scattering(const DoubleScatteringOf<Number>& paths,
                                             const AngularGrid& grid,
                                             const std::vector<int>& functions,
                                             const HomogeneousLayerOf<Number>& layer,
                                             Eigen::Index light, Eigen::Index view);
};

/// Returns foci at the directions of two illuminations, with the width of the phase function; none
/// if this width is so large that no shorter panels are required.
std::vector<Focus> light_foci(const Pair& lights, double width);

}  // namespace flatspeckle::mc

#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/bulk_slope.h"
#include "mc/slab/adding/layer.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/phase_moments.h"

namespace flatspeckle::mc {

/// What a scatterer of a medium does to pairs of directions, without chance: the amplitude A of C14
/// over sqrt(sigma_s), so that |A|^2 is the phase function p, and p by its Fourier moments,
///   p(theta) = (moments[0] + 2 sum_m moments[m] cos(m theta)) / (2 pi).
/// Of fields at two times, between which the scatterers diffuse, the later one is the second of a
/// pair: each turn by theta loses exp(-2 delay (1 - cos theta)) (brownian.h).
class ScatteringLaw {
 public:
  /// The medium scatters.
  explicit ScatteringLaw(const Scene& scene, double delay = 0);

  /// A(theta - a) conj(A(theta - b)) of two lights, or of two views.
  Complex pair(double a, double b, double theta) const {
    return decay(theta - b) *
           (a == b ? Complex(std::norm(amplitude(theta - a)))
                   : product_with_conjugate(amplitude(theta - a), amplitude(theta - b)));
  }
  double decay(double angle) const {
    return delay_ == 0 ? 1 : std::exp(-2 * delay_ * (1 - std::cos(angle)));
  }
  Complex amplitude(double angle) const;

  /// Of Henyey-Greenstein's function without delay: d log pair / d g.
  double pair_slope(double g, double a, double b, double theta) const;

  /// Those that are kept, less the peak of those that are not.
  const std::vector<double>& moments() const { return moments_.kept().list; }
  double peak() const { return moments_.kept().peak; }
  const KeptMoments& kept() const { return moments_.kept(); }
  bool has_sharp_peak() const { return moments_.kept().is_sharp(); }
  /// The law whose first `count` moments are kept, with the width of these.
  ScatteringLaw truncated(int count) const;
  /// The angle within which p changes.
  double width() const { return width_; }
  /// Narrower than what a quadrant's polynomials see.
  bool is_peaked() const { return width_ < 0.4; }
  /// If it is not: nodes on a quadrant that see its lobes.
  int least_order() const { return least_order_; }

 private:
  void tabulate(const Scene& scene);
  std::vector<double> first_moments(int count) const;

  std::function<double(double)> density_;  ///< of a bulk: p of an angle in [0, pi]
  std::vector<Complex> table_;             ///< of scatterers: A at equal steps over [0, pi]
  std::optional<double> g_;                ///< of Henyey-Greenstein's function
  PhaseMoments moments_;
  double delay_, width_ = 0;
  int least_order_ = 0;
};

/// What two scatterings make of a pair of lights in a pair of views: light scatters towards theta
/// at one depth and into the view at another. An integral over theta alone, the rest is in closed
/// form: exact where forward peaks, or the phase of a large transverse momentum, ask for many
/// ordinates.
template <typename Number>
class DoubleScatteringOf {
 public:
  using C = ComplexOf<Number>;
  using Law = std::conditional_t<std::is_same_v<Number, Dual<double>>, SlopeOf<ScatteringLaw>,
                                 ScatteringLaw>;

  /// k, q: per mu_t.
  DoubleScatteringOf(RealOf<Number> optical_depth, double k, double q, Pair lights, Pair views,
                     const Departure<Number>& departure);

  /// Of unit sources and sensitivities along theta, on the way down or up: per cos(theta).
  C along(double sine, double cosine, bool down) const;

  /// Including both pairs' amplitudes, by quadrature refined to a tolerance.
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

/// What slabs in the plane have of their own (slab.h). Directions are angles; functions of
/// direction are even or odd in them.
struct PlaneGeometry {
  using Direction = double;
  using Law = ScatteringLaw;
  using Momentum = double;  ///< per mu_t

  static Direction direction(double angle) { return angle; }
  /// The second view, turned (slab.h).
  static Direction matched(const Pair& lights, const Pair& views, double shift);
  /// Transverse (C35). shift: Departure's.
  static Momentum momentum(const Pair& lights, double k, double mu_t, double shift);
  static double size(Momentum momentum, double) { return momentum; }

  static Law law(const Scene& scene, double delay = 0) { return ScatteringLaw(scene, delay); }
  /// The scene with other scatterers at the same density.
  static Scene with_scatterer(Scene scene, const Scatterer& scatterer);
  /// One scattering from lights to views.
  template <typename L>
  static auto turned(const L& law, const Pair& lights, const Pair& views) {
    return law.pair(lights.first - views.first, lights.second - views.second, 0.0);
  }

  /// Foci of pairs of lights. Lights that are near to each other, in units of what the phase
  /// function resolves, have one, so that their pairs share a grid.
  class Foci {
   public:
    Foci(const std::vector<Pair>& lights, double optical_depth, double width);
    std::vector<Focus> of(const Pair& lights, Momentum q) const;

   private:
    double optical_depth_, width_;
    std::vector<double> centres_;
  };

  static constexpr int families = 1;     ///< cosines alone
  static constexpr int first_modes = 1;  ///< the highest; there are no more
  static constexpr bool refines_modes = false;
  static constexpr int flux_modes = 1;  ///< the highest that carries power
  /// Of the momentum between mode m and the next.
  static double coupling(int) { return 1; }
  /// Ordinates of both ways, per one of the grid.
  static int ordinates(std::size_t) { return 2; }

  /// cos(l theta) of m = 0, sin(l theta) of m = 1, [angle][l - m], l = m .. last.
  static Matrix functions(const Eigen::VectorXd& angle, int m, int last);
  /// Of a moment in the scattering between such functions.
  static double weight(int l);
  static Eigen::VectorXd weights(const AngularGrid& grid) { return grid.weight(); }
  /// A beam's share in mode m of what it scatters, by degrees m .. last (of_beam()).
  static std::vector<Complex> beam(double light, int m, int last);
  /// What radiance in mode 0 weighs in the integral over all directions.
  static double all_directions() { return std::numbers::sqrt2; }
  /// What pairs scatter into directions down and up, a row each, function by function.
  template <typename Number>
  static PairWavesOf<Number> fed(const OrdinatesOf<PlaneGeometry, RealOf<Number>>& ordinates,
                                 Momentum, int highest, const std::vector<Pair>& pairs);

  /// Paths of two scatterings are integrals over one direction, exact where forward peaks, or the
  /// phase of a large transverse momentum, ask for many ordinates.
  static constexpr bool has_double_scattering = true;
  /// What ordinates make of these paths, of one light and one view by number; functions: of waves.
  template <typename Number>
  static ComplexOf<Number> double_scattering(const DoubleScatteringOf<Number>& paths,
                                             const AngularGrid& grid,
                                             const std::vector<int>& functions,
                                             const HomogeneousLayerOf<Number>& layer,
                                             Eigen::Index light, Eigen::Index view);
};

/// Where radiance of two lights changes within a phase function's width; none if that is wide.
std::vector<Focus> light_foci(const Pair& lights, double width);

}  // namespace flatspeckle::mc

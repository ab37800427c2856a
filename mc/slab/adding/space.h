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

/// A slab that has the same keys in space: lights and views lie in the plane of incidence, the
/// medium has a phase function per steradian, and its `dimension` says so. Throws InputError for
/// boxes, and for scatterers of the plane: what may be in space is hg, two_term_hg, phase_table,
/// rayleigh and mie, whose albedo is that of its spheres.
Scene in_space(Scene slab, const ScattererValues& values);

/// A phase function in space, without chance: scalar amplitudes sqrt(p), and its Legendre moments,
///   p = sum_l (2 l + 1) / (4 pi) moments[l] P_l(cos).
/// Of fields at two times, between which the scatterers diffuse, the later one is the second of a
/// pair: each of its turns loses exp(-2 delay (1 - cos)) (brownian.h), and so does p.
class SpaceLaw {
 public:
  /// density: per steradian, by the cosine of the turn, in any unit; normalised where its moments
  /// are known exactly.
  explicit SpaceLaw(std::function<double(double)> density, double delay = 0,
                    FirstMoments moments = {});

  /// A A' of two turns by their cosines.
  double pair(double first, double second) const {
    return amplitude(first) * amplitude(second) * decay(second);
  }
  /// Of Henyey-Greenstein's function without delay: d log pair / d g.
  double pair_slope(double g, double first, double second) const;
  /// Those that are kept, less the peak of those that are not.
  const std::vector<double>& moments() const { return moments_.kept().list; }
  double peak() const { return moments_.kept().peak; }
  const KeptMoments& kept() const { return moments_.kept(); }
  bool has_sharp_peak() const { return moments_.kept().is_sharp(); }
  /// The law whose first `count` moments are kept, with the width of these.
  SpaceLaw truncated(int count) const;
  /// The angle within which p changes.
  double width() const { return width_; }
  int least_order() const { return 0; }  ///< nodes of a panel

 private:
  double amplitude(double cosine) const;
  double decay(double cosine) const;

  std::function<double(double)> density_;
  PhaseMoments moments_;
  double total_ = 1, delay_, width_;
};

template <typename Geometry, typename Real>
class OrdinatesOf;

/// What slabs in space have of their own (slab.h), of scalar waves (C41). Directions are unit
/// vectors, z into the slab; functions of direction are Fourier modes of the azimuth about z,
/// cos(m phi) and sin(m phi), phi from the momentum.
struct SpaceGeometry {
  using Direction = Eigen::Vector3d;
  using Law = SpaceLaw;
  using Momentum = std::array<double, 2>;  ///< in units of k

  static Direction direction(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }
  /// The second view, turned (slab.h).
  static Direction matched(const SpacePair& lights, const SpacePair& views, double shift);
  /// Transverse; shift: Departure's.
  static Momentum momentum(const SpacePair& lights, double, double, double shift);
  static double size(const Momentum& momentum, double k) {
    return k * Eigen::Vector2d(momentum[0], momentum[1]).norm();
  }

  static Law law(const Scene& scene, double delay = 0);
  /// The scene with other spheres at the same extinction.
  static Scene with_scatterer(Scene scene, const Scatterer& scatterer);
  /// One scattering from lights to views.
  template <typename L>
  static auto turned(const L& law, const SpacePair& lights, const SpacePair& views) {
    return law.pair(lights.first.dot(views.first), lights.second.dot(views.second));
  }

  /// Foci of pairs of lights, in steps of half a width, so that lights near to each other have one
  /// grid.
  class Foci {
   public:
    Foci(const std::vector<SpacePair>&, double, double width) : width_(width) {}
    std::vector<Focus> of(const SpacePair& lights, const Momentum&) const;

   private:
    double width_;
  };

  static constexpr int families = 2;     ///< cosines and sines
  static constexpr int first_modes = 2;  ///< the highest; refined as the ordinates are
  static constexpr bool refines_modes = true;
  static constexpr int flux_modes = 0;  ///< the highest that carries power
  /// Of the momentum between mode m and the next.
  static double coupling(int m);
  /// Unknowns of both ways, per ordinate of the grid.
  static int ordinates(std::size_t functions) { return 2 * static_cast<int>(functions); }

  /// Associated Legendre functions of cos(angle), l = m .. last, [angle][l - m], times sin(angle),
  /// with int P_l^m(c)^2 dc = 1 over [-1, 1] and positive in the forward direction.
  static Matrix functions(const Eigen::VectorXd& angle, int m, int last);
  /// Of a moment in the scattering between such functions.
  static double weight(int) { return 2; }
  static Eigen::VectorXd weights(const AngularGrid& grid);
  /// A beam's share in mode m = 0 of what it scatters, by degrees 0 .. last (of_beam()).
  static std::vector<Complex> beam(double light, int m, int last);
  /// What radiance in mode 0 weighs in the integral over all directions.
  static double all_directions() { return std::sqrt(2 * std::numbers::pi); }
  /// What pairs scatter into directions down and up, a row each, function by function.
  template <typename Number>
  static PairWavesOf<Number> fed(const OrdinatesOf<SpaceGeometry, RealOf<Number>>& ordinates,
                                 const Momentum& momentum, int highest,
                                 const std::vector<SpacePair>& pairs);

  static constexpr bool has_double_scattering = false;
};

}  // namespace flatspeckle::mc

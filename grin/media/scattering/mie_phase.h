#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// Scattering of a plane wave by a homogeneous sphere (conventions, C43).
class MieSphere {
 public:
  /// Range of the size parameter size(): 2 pi radius divided by the wavelength in the surroundings
  /// of the sphere.
  static constexpr double smallest = 1e-6, largest = 1e4;

  /// index: index of the sphere divided by the index of the surroundings; must not be 0. A positive
  /// imaginary part absorbs.
  MieSphere(double size, Complex index);

  double size() const { return size_; }
  /// Returns the largest order n whose coefficients a_n and b_n are above rounding.
  int order() const { return static_cast<int>(coefficients_.size()); }

  /// Returns the extinction cross section divided by pi radius^2.
  double extinction() const { return extinction_; }
  /// Returns the scattering cross section divided by pi radius^2.
  double scattering() const { return scattering_; }
  /// Returns the mean cosine of the scattering angle for unpolarized light. Requires that the
  /// sphere scatters.
  double mean_cosine() const { return mean_cosine_; }

  /// Scattering amplitudes for light polarised perpendicular (s1) and parallel (s2) to the
  /// scattering plane.
  struct Amplitudes {
    Complex s1, s2;
  };
  Amplitudes amplitudes(double cosine) const;

 private:
  struct Coefficients {
    Complex a, b;
  };
  std::vector<Coefficients> coefficients() const;
  void sum();

  double size_;
  Complex index_;
  std::vector<Coefficients> coefficients_;  ///< a_n and b_n for n = 1 .. order()
  double extinction_ = 0, scattering_ = 0, mean_cosine_ = 0;
};

/// Phase function of equal spheres for unpolarized light: (|S_1|^2 + |S_2|^2) / 2 of C43,
/// normalised. Sampling is exact, because the phase function and its integral are polynomials of
/// the cosine.
class MiePhase {
 public:
  /// Requires that the sphere scatters.
  explicit MiePhase(const MieSphere& sphere);

  double density(double cosine) const;
  double one_minus_cosine(RandomStream& random) const;
  double mean_cosine() const { return shape_->sphere.mean_cosine(); }

 private:
  struct Shape {
    MieSphere sphere;
    /// Fourier modes of the integral of the phase function from angle 0.
    std::vector<double> integral;
    std::vector<double> so_far;  ///< values of this integral at equal steps from 0 to pi
  };
  static double up_to(const Shape& shape, double angle);

  std::shared_ptr<const Shape> shape_;
};

struct MiePhaseValues {
  static constexpr const char* word = "mie";
  std::optional<double> size_parameter = {};
  std::optional<std::string> sphere_index = {};
};

inline void add_keys(Keys& keys, MiePhaseValues& values, const std::string& prefix) {
  keys.add(prefix + "size_parameter", values.size_parameter,
           "Size parameter: 2 pi radius of the spheres divided by the wavelength around them")
      .from(MieSphere::smallest, MieSphere::largest)
      .only_of(values.word);
  keys.add(prefix + "sphere_index", values.sphere_index,
           "Index of the spheres relative to their surroundings, such as \"1.33+0.1i\"; a positive "
           "imaginary part absorbs")
      .only_of(values.word);
}
/// Makes the phase function from its scene keys. Throws InputError for invalid values.
MiePhase make_phase(const Keys& keys, const MiePhaseValues& values);

}  // namespace flatspeckle::grin

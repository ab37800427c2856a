#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// A homogeneous sphere in a plane wave (conventions, C43).
class MieSphere {
 public:
  /// Of what size() may be: 2 pi radius over the wavelength around it.
  static constexpr double smallest = 1e-6, largest = 1e4;

  /// index: relative, not 0; Im >= 0 absorbs.
  MieSphere(double size, Complex index);

  double size() const { return size_; }
  /// The last order n above rounding.
  int order() const { return static_cast<int>(coefficients_.size()); }

  /// Cross sections over pi radius^2.
  double extinction() const { return extinction_; }
  double scattering() const { return scattering_; }
  /// Of unpolarized light; the sphere scatters.
  double mean_cosine() const { return mean_cosine_; }

  /// Perpendicular and parallel to the plane of scattering, of a turn by its cosine.
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
  std::vector<Coefficients> coefficients_;  ///< of n = 1 .. order()
  double extinction_ = 0, scattering_ = 0, mean_cosine_ = 0;
};

/// Unpolarized light on equal spheres: (|S_1|^2 + |S_2|^2) / 2 of C43, normalised. Turns are drawn
/// from it exactly: it is a polynomial of the cosine, and so is its integral.
class MiePhase {
 public:
  /// The sphere scatters.
  explicit MiePhase(const MieSphere& sphere);

  double density(double cosine) const;
  double one_minus_cosine(RandomStream& random) const;
  double mean_cosine() const { return shape_->sphere.mean_cosine(); }

 private:
  struct Shape {
    MieSphere sphere;
    std::vector<double> integral;  ///< over the sphere up to an angle: its Fourier modes
    std::vector<double> so_far;    ///< the same at equal steps from 0 to pi
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
           "2 pi radius of the spheres over the wavelength around them")
      .from(MieSphere::smallest, MieSphere::largest)
      .only_of(values.word);
  keys.add(prefix + "sphere_index", values.sphere_index,
           "Relative index of the spheres, as \"1.33+0.1i\" (which absorbs)")
      .only_of(values.word);
}
/// Throws InputError.
MiePhase make_phase(const Keys& keys, const MiePhaseValues& values);

}  // namespace flatspeckle::grin

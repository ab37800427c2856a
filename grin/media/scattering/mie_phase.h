#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grin/media/scattering/mie_sphere.h"
#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

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

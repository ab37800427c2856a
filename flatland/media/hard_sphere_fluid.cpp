#include "flatland/media/hard_sphere_fluid.h"

#include <cmath>

#include "core/contract.h"

namespace flatspeckle {

HardSphereFluid::HardSphereFluid(double packing, double diameter)
    : packing_(packing), diameter_(diameter) {
  FS_EXPECT(packing >= 0 && packing <= most_packing && diameter > 0);
  const double free = std::pow(1 - packing, 4);
  constant_ = (1 + 2 * packing) * (1 + 2 * packing) / free;
  linear_ = -6 * packing * (1 + packing / 2) * (1 + packing / 2) / free;
  cubic_ = packing * constant_ / 2;
}

// S = 1 / (1 - rho c(q)), with rho the number density and c(q) the Fourier transform of c(r). With
// x = q diameter,
//   -rho c(q) = 24 eta int_0^1 r^2 (constant + linear r + cubic r^3) sin(x r) / (x r) dr.
// The closed form of this integral loses digits at small x, where its power series is used.
double HardSphereFluid::structure_factor(double q) const {
  constexpr double of_series = 2;
  const double x = q * diameter_, square = x * x;
  double integral = 0;
  if (x < of_series) {
    double factor = 1;  // (-x^2)^j / (2 j + 1)!
    for (int j = 0; j < 14; ++j) {
      integral += factor * (constant_ / (2 * j + 3) + linear_ / (2 * j + 4) + cubic_ / (2 * j + 6));
      factor *= -square / ((2 * j + 2) * (2 * j + 3));
    }
  } else {
    const double s = std::sin(x), c = std::cos(x);
    const double by_cubic =
        (-square * square * c + 4 * ((3 * square - 6) * c + x * (square - 6) * s + 6)) /
        (square * square);
    integral = (constant_ * (s - x * c) + linear_ * (2 * x * s + (2 - square) * c - 2) / x +
                cubic_ * x * by_cubic) /
               (square * x);
  }
  return 1 / (1 + 24 * packing_ * integral);
}

}  // namespace flatspeckle

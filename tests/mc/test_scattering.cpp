#include <cmath>

#include <doctest/doctest.h>

#include "flatland/scatterer.h"
#include "mc/scattering.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

BulkMedium cylinders(Scatterer::Kind kind, double ka, Complex index) {
  Scatterer scatterer;
  scatterer.kind = kind;
  scatterer.radius = ka / k;
  scatterer.index = index;
  return bulk_medium(scatterer, k, 1);
}

/// |A|^2 = p, A depends on the turn alone, and sampled directions have their angle's vector.
template <typename Scattering>
void check_consistency(const Scattering& scattering, double tolerance) {
  double largest = 0;
  for (const double turn : {0.0, 1e-4, 0.3, -0.3, 1.7, 3.1, pi}) {
    for (const double from : {0.0, -2.9, 1.3}) {
      const Direction in(from), out(from + turn);
      const double p = scattering.density(in, out);
      largest = std::max(largest, p);
      CAPTURE(turn);
      CHECK(std::abs(std::norm(scattering.amplitude(in, out)) - p) < tolerance * largest);
      CHECK(std::abs(scattering.density(out, in) - p) < 1e-8 * largest);
      // the way back of C14: A(-w' -> -w) = A(w -> w')
      CHECK(std::abs(scattering.density(out.reversed(), in.reversed()) - p) < 1e-8 * largest);
    }
  }
  for (const double u : {0.001, 0.2, 0.5, 0.9}) {
    const Direction next = scattering.sample(Direction(1.1), u);
    CHECK(length(next.w - direction(next.angle)) < 1e-14);
  }
}

}  // namespace

TEST_CASE("squared amplitude is the phase function") {
  check_consistency(IsotropicScattering{}, 1e-14);
  for (const double g : {-0.5, 0.5, 0.99})
    check_consistency(HenyeyGreensteinScattering{{g}}, 1e-13);
  // between the nodes |linear A|^2 and linear |A|^2 differ by O(step^2)
  for (const double ka : {0.05, 1.0, 5.0, 50.0})
    check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::tm, ka, 1.33), k), 1e-6);
  check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::te, 2, {1.5, 0.1}), k), 1e-6);
  check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::hard, 3, 1), k), 1e-6);
}

TEST_CASE("the tabulated amplitude is that of the T-matrix, phase included") {
  const BulkMedium medium = cylinders(Scatterer::Kind::tm, 5, {1.33, 0.01});
  const TabulatedScattering scattering(medium, k);
  for (const double turn : {0.0, 0.01, -0.37, 1.5, 3.0}) {
    const Complex expected = flatspeckle::amplitude(medium.t_matrix, k, turn) /
                             std::sqrt(medium.cross_sections.scattering);
    CHECK(std::abs(scattering.amplitude(Direction(0.6), Direction(0.6 + turn)) - expected) < 1e-5);
  }
}

TEST_CASE("a thin TM cylinder scatters like a point") {
  const TabulatedScattering thin(cylinders(Scatterer::Kind::tm, 0.05, 1.5), k);
  for (const double turn : {0.0, 1.0, -2.0, pi})
    CHECK(thin.density(Direction(0), Direction(turn)) ==
          doctest::Approx(1 / (2 * pi)).epsilon(2e-3));
}

}  // namespace flatspeckle::mc

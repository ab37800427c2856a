#include <cmath>

#include <doctest/doctest.h>

#include "grin/rays/surfaces/interface.h"

namespace flatspeckle::grin::test_interface {

namespace {

/// Returns the ray vector in index n that ascends at this angle to the z axis.
Vec3 ray_vector(double n, double angle) {
  return n * Vec3(std::sin(angle), 0, std::cos(angle));
}

}  // namespace

TEST_CASE("interface: refraction and reflectance agree with Snell and Fresnel") {
  const double n1 = 1, n2 = 1.5;
  for (const double angle : {0.0, 0.3, 1.0, 1.5}) {
    const Interface jump(ray_vector(n1, angle), -Vec3::UnitZ(), n1 - 1, n2 - 1);
    const double beyond = std::asin(n1 * std::sin(angle) / n2);
    REQUIRE(jump.refracted());
    CHECK((*jump.refracted() - ray_vector(n2, beyond)).norm() < 1e-15);
    CHECK((jump.reflected() - ray_vector(n1, 2 * std::acos(0) - angle)).norm() < 1e-15);
    const double c1 = std::cos(angle), c2 = std::cos(beyond);
    const double s = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    const double p = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
    CHECK(jump.reflectance_s() == doctest::Approx(s * s).epsilon(1e-13));
    CHECK(jump.reflectance_p() == doctest::Approx(p * p).epsilon(1e-13));
    CHECK(jump.reflectance() == doctest::Approx((s * s + p * p) / 2).epsilon(1e-13));
    const Interface back(-*jump.refracted(), Vec3::UnitZ(), n2 - 1, n1 - 1);
    CHECK(back.reflectance_s() == doctest::Approx(jump.reflectance_s()));
    CHECK(back.reflectance_p() == doctest::Approx(jump.reflectance_p()));
  }
}

TEST_CASE("interface: Brewster's angle, the critical angle and total reflection") {
  const double brewster = std::atan(1.5);
  CHECK(Interface(ray_vector(1, brewster), Vec3::UnitZ(), 0, 0.5).reflectance_p() < 1e-30);
  const double critical = std::asin(1 / 1.5);
  const Interface below(ray_vector(1.5, critical - 1e-9), Vec3::UnitZ(), 0.5, 0);
  const Interface above(ray_vector(1.5, critical + 1e-9), Vec3::UnitZ(), 0.5, 0);
  CHECK(!below.is_total());
  CHECK(below.reflectance() < 1);
  CHECK(below.reflectance() > 0.99);
  CHECK(above.is_total());
  CHECK(!above.refracted());
  CHECK(above.reflectance_s() == 1);
  CHECK(above.reflectance_p() == 1);
}

TEST_CASE("interface: a jump of 1e-9 keeps its digits, one of 0 has no effect") {
  const Interface faint(Vec3::UnitZ(), Vec3::UnitZ(), 0, 1e-9);
  CHECK(faint.reflectance() == doctest::Approx(0.25e-18 * (1 - 1e-9)).epsilon(1e-12));
  const Interface nothing(ray_vector(1.3, 0.4), Vec3::UnitZ(), 0.3, 0.3);
  CHECK(nothing.reflectance() == 0);
  CHECK(*nothing.refracted() == ray_vector(1.3, 0.4));
}

}  // namespace flatspeckle::grin::test_interface

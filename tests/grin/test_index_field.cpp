#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/bessel.h"
#include "grin/media/fields/any_index_field.h"
#include "tests/grin/derivatives.h"

namespace flatspeckle::grin::test_index_field {

namespace {

using tests::check_derivatives;

const Vec3 points[] = {{0, 0, 0},         {1e-9, 0, 0},  {0, -1e-5, 0.2}, {0.02, 0.01, -0.3},
                       {0.3, -0.4, 0.25}, {0.1, 0.7, 0}, {-0.5, 0.5, 0.5}};

}  // namespace

TEST_CASE("index fields: derivatives of lenses, guides, ramps and blobs agree with differences") {
  for (const Vec3& x : points) {
    check_derivatives(Homogeneous{0.3}, x, 1, 1);
    check_derivatives(Luneburg(LuneburgProfile{2}), x, 1, 1);
    check_derivatives(Luneburg(LuneburgProfile{1.5}, {0.1, 0.2, 0.3}), x, 0.5, 1);
    check_derivatives(Fisheye(FisheyeProfile{1, 1}), x, 0.3, 1);
    check_derivatives(Fisheye(FisheyeProfile{0.5, 2}, {0, 1, 0}), x, 1, 1);
    check_derivatives(ParabolicGuide(ParabolicProfile{0.5, 0.7}), x, 1, 1);
    check_derivatives(SechGuide(SechProfile{0.5, 1.3}), x, 0.3, 1);
    check_derivatives(SechGuide(SechProfile{0.5, 0.5}), x, 1, 1);
    check_derivatives(LinearRamp{0.5, {0.1, 0.2, -0.3}}, x, 1, 1);
    check_derivatives(TanhRamp{0.1, 0.6, 0.5, Vec3(1, 2, 2) / 3, {0.1, 0, 0}}, x, 0.2, 1);
    check_derivatives(GaussianBlobs({{{0, 0, 0}, 0.2, 0.4}, {{0.3, 0.1, 0}, -0.1, 0.5}}, 0.3), x,
                      0.4, 1);
  }
}

TEST_CASE("index fields: forces in lenses and guides agree with their index") {
  const auto check = [](const auto& field, const Vec3& x) {
    const auto force = field.force(x);
    const auto at = field.hessian(x);
    const Mat3 derivative = at.gradient * at.gradient.transpose() + (1 + at.excess) * at.hessian;
    CHECK(force.excess == at.excess);
    CHECK((force.force - (1 + at.excess) * at.gradient).norm() < 1e-14);
    CHECK((Mat3(force.derivative.asDiagonal()) - derivative).norm() < 1e-14);
  };
  for (const Vec3& x : points) {
    check(Luneburg(LuneburgProfile{1.5}, {0.1, 0.2, 0.3}), x);
    check(ParabolicGuide(ParabolicProfile{0.5, 0.7}, {0.1, 0, 0}), x);
  }
  check(Luneburg(LuneburgProfile{0.5}), {1, 0, 0});
  CHECK(std::isnan(ParabolicGuide(ParabolicProfile{0.5, 0.7}).force({9, 0, 0}).force[0]));
}

TEST_CASE("index fields: weak ones keep their digits, steep ones do not overflow") {
  const double weak = 1e-6;
  for (const Vec3& x : points) {
    check_derivatives(ParabolicGuide(ParabolicProfile{weak, 1e-3}), x, 1, weak);
    check_derivatives(SechGuide(SechProfile{weak, 1.3e-3}), x, 1, weak);
    check_derivatives(TanhRamp{0, weak, 0.5}, x, 0.2, weak);
    check_derivatives(StandingWave(0, weak, 2, 3, 5), x, 0.3, weak);
  }
  const TanhRamp steep{0, 1, 1e-4};
  CHECK(steep.excess({0, 0, 1}) == 1);
  CHECK(steep.excess({0, 0, -1}) == 0);
  CHECK(steep.hessian({0, 0, 10}).hessian.norm() == 0);
  // sech below the limit of its series and above: n = n0 sech(alpha rho)
  for (const double t : {0.0, 0.1, 0.299999, 0.300001, 1.0, 30.0}) {
    const double s = 1 / std::cosh(t), h = std::tanh(t);
    const auto jet = SechProfile{0, 1}.jet(t * t);
    CHECK(jet.excess == doctest::Approx(s - 1).epsilon(1e-14));
    if (t > 0) CHECK(2 * t * jet.first == doctest::Approx(-s * h).epsilon(1e-14));
    // d^2/dt^2 = 2 first + 4 t^2 second
    CHECK(2 * jet.first + 4 * t * t * jet.second ==
          doctest::Approx(s * (2 * h * h - 1)).epsilon(1e-13));
  }
}

TEST_CASE("Luneburg lens: the rim belongs to the lens, points beyond do not") {
  const Luneburg lens(LuneburgProfile{2});
  for (const double r : {2.0, 2 * (1 + 1e-12), 2 * (1 - 1e-12)}) {
    const IndexHessian at = lens.hessian({r, 0, 0});
    CHECK(at.excess == doctest::Approx(0));
    CHECK(at.gradient[0] == doctest::Approx(-0.5));
    CHECK(at.hessian(0, 0) == doctest::Approx(-0.5));
    CHECK(at.hessian(1, 1) == doctest::Approx(-0.25));
  }
  CHECK(lens.gradient({2.001, 0, 0}).gradient.norm() == 0);
  CHECK(lens.excess({2.001, 0, 0}) == 0);
}

TEST_CASE("fisheye: the index keeps its digits far out, where it approaches 0") {
  const Fisheye eye(FisheyeProfile{1, 1});
  for (const double r : {1e1, 1e2, 1e3}) {
    const double n = 2 / (1 + r * r);
    CHECK(index(eye, Vec3(r, 0, 0)) == doctest::Approx(n).epsilon(1e-15 * r * r));
    CHECK(eye.gradient({r, 0, 0}).gradient[0] == doctest::Approx(-r * n * n).epsilon(1e-14));
  }
}

TEST_CASE("Bessel profiles: the table agrees with the series of core/bessel") {
  for (const int m : {0, 1, 2, 7, 30, 64}) {
    const BesselProfile profile(m, 60);
    double worst_value = 0, worst_derivative = 0;
    for (int i = 1; i < 4000; ++i) {
      const double x = i * 0.0171;
      const std::vector<long double> j = bessel_j(m + 1, x);
      const auto jet = profile.jet(x * x);
      const long double power = std::pow(static_cast<long double>(x), m);
      // J_m reaches its envelope at x = m; below, the error is relative to J_m itself.
      const long double envelope = x > m ? std::sqrt(2 / (3.14159L * x)) : j[m];
      const long double derivative_scale = x > m ? envelope : j[m + 1];
      worst_value = std::max(worst_value, double(std::abs(jet.value * power - j[m]) / envelope));
      worst_derivative =
          std::max(worst_derivative,
                   double(std::abs(-2 * x * jet.derivative * power - j[m + 1]) / derivative_scale));
    }
    CAPTURE(m);
    CHECK(worst_value < 2e-14);
    CHECK(worst_derivative < 1e-12);
  }
  CHECK(BesselProfile(0, 1).jet(0).value == doctest::Approx(1).epsilon(1e-15));
  CHECK(BesselProfile(0, 1).jet(0).derivative == doctest::Approx(-0.25).epsilon(1e-14));
  CHECK_THROWS_AS(BesselProfile(0, 0), InputError);
  CHECK_THROWS_AS(BesselProfile(0, std::nan("")), InputError);
}

TEST_CASE(
    "sound waves: derivatives agree with differences and the wave equation, also on the axis") {
  const double k = 7;
  for (const int m : {0, 1, 2, 3, 8}) {
    const StandingWave wave(0.33, 0.02, m, k, 0.6);  // the last points are beyond its table
    for (const Vec3& x : points) {
      CAPTURE(m);
      check_derivatives(wave, x, 1 / k, 1, 1e-11);
      const IndexHessian at = wave.hessian(x);
      CHECK(at.hessian.trace() == doctest::Approx(-k * k * (at.excess - 0.33)).epsilon(1e-10));
      CHECK(wave.frozen(-0.5).excess(x) - 0.33 == doctest::Approx(-0.5 * (at.excess - 0.33)));
    }
  }
  const Vec3 x{0.3, -0.4, 0.25};
  CHECK(StandingWave(0.33, 0.02, 3, k, 1).excess(x) ==
        doctest::Approx(0.33 +
                        0.02 * double(bessel_j(3, 3.5)[3]) * std::cos(3 * std::atan2(-0.4, 0.3)))
            .epsilon(1e-14));
}

TEST_CASE(
    "focused sound: derivatives agree with differences and the wave equation; in phase at the "
    "focus") {
  const double k = 11;
  const Vec3 focus{0.1, 0.2, 0.3};
  for (const auto& directions : {arc_directions(16, 0.7), cap_directions(40, 0.5)}) {
    const FocusedSound sound(0.33, 0.01, k, directions, focus, 0.4);
    for (const Vec3& x : points) {
      check_derivatives(sound, x, 1 / k, 1, 1e-11);
      const IndexHessian at = sound.hessian(x);
      CHECK(at.hessian.trace() == doctest::Approx(-k * k * (at.excess - 0.33)));
    }
    CHECK(sound.frozen(0).excess(focus) == doctest::Approx(0.34));
    CHECK(sound.frozen(0).gradient(focus).gradient.norm() < 0.11);
    CHECK(std::abs(sound.frozen(0).excess(focus + Vec3(2, 0, 0)) - 0.33) < 0.005);
  }
  // A line focus extends along y.
  const FocusedSound line(0, 1, k, arc_directions(16, 0.7), focus);
  CHECK(line.excess(focus + Vec3(0, 5, 0)) == doctest::Approx(1));
}

TEST_CASE("sums of fields: values and derivatives agree with their terms") {
  AnySum sum;
  const GaussianBlobs blobs({{{0, 0, 0}, 0.2, 0.4}});
  const TanhRamp ramp{0.1, 0.2, 0.5};
  sum.add(Homogeneous{0.3}).add(ramp).add(ramp).add(blobs);
  for (const Vec3& x : points) {
    check_derivatives(sum, x, 0.2, 1);
    CHECK(sum.excess(x) == doctest::Approx(0.3 + 2 * ramp.excess(x) + blobs.excess(x)));
  }
}

TEST_CASE("fields chosen at run time: values and derivatives agree with the fields") {
  AnySum sum;
  sum.add(ParabolicGuide(ParabolicProfile{0.5, 0.7})).add(StandingWave(0, 0.02, 1, 7, 1));
  const std::vector<AnyIndexField> fields{Homogeneous{0.2}, SechGuide(SechProfile{0.5, 0.5}), sum};
  for (const AnyIndexField& any : fields)
    std::visit([](const auto& field) { check_derivatives(field, points[4], 0.2, 1); }, any);
  const Vec3 x = points[4];
  CHECK(std::get<AnySum>(fields[2]).excess(x) ==
        doctest::Approx(ParabolicGuide(ParabolicProfile{0.5, 0.7}).excess(x) +
                        StandingWave(0, 0.02, 1, 7, 1).excess(x)));
}

}  // namespace flatspeckle::grin::test_index_field

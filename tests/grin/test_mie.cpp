#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/media/scattering/mie_phase.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_mie {

namespace {

using std::numbers::pi;

/// Returns the power over all directions and its mean cosine, by Fejer's first rule, exact for
/// polynomials of the cosine.
std::array<double, 2> over_all_directions(const MieSphere& sphere) {
  const int n = 2 * sphere.order() + 4;
  double power = 0, cosine = 0;
  for (int i = 0; i < n; ++i) {
    const double angle = pi * (i + 0.5) / n, c = std::cos(angle);
    double weight = 4 * pi / n;
    for (int k = 1; 2 * k < n; ++k)
      weight -= 8 * pi / n * std::cos(2 * k * angle) / (4.0 * k * k - 1);
    const auto [s1, s2] = sphere.amplitudes(c);
    const double share = weight * (std::norm(s1) + std::norm(s2)) / 2;
    power += share;
    cosine += share * c;
  }
  return {power, cosine / power};
}

}  // namespace

TEST_CASE("Mie spheres: efficiencies and mean cosines agree with Wiscombe (1979, MIEV0)") {
  struct Case {
    Complex index;
    double size, extinction, scattering, mean_cosine;
  };
  for (const Case& known : {Case{0.75, 0.101, 0.000008, 0.000008, 0.001507},
                            {0.75, 10, 2.232265, 2.232265, 0.896473},
                            {0.75, 1000, 1.997908, 1.997908, 0.844944},
                            {{1.33, 1e-5}, 1, 0.093952, 0.093923, 0.184517},
                            {{1.33, 1e-5}, 100, 2.101321, 2.096594, 0.868959},
                            {{1.33, 1e-5}, 10000, 2.004089, 1.723857, 0.907840},
                            {1.5, 10, 2.881999, 2.881999, 0.742913},
                            {1.5, 100, 2.094388, 2.094388, 0.818246},
                            {1.5, 1000, 2.013945, 2.013945, 0.827882},
                            {{1.5, 1}, 0.055, 0.101491, 0.000011, 0.000491},
                            {{1.5, 1}, 1, 2.336321, 0.663454, 0.192136},
                            {{1.5, 1}, 100, 2.097502, 1.283697, 0.850252},
                            {{1.5, 1}, 10000, 2.004368, 1.236574, 0.846309},
                            {{10, 10}, 1, 2.532993, 2.049405, -0.110664},
                            {{10, 10}, 100, 2.071124, 1.836785, 0.556215},
                            {{10, 10}, 10000, 2.005914, 1.795393, 0.548194}}) {
    CAPTURE(known.index);
    CAPTURE(known.size);
    const MieSphere sphere(known.size, known.index);
    constexpr double digits = 1e-6;  // the last printed digit is not always rounded
    CHECK(std::abs(sphere.extinction() - known.extinction) < digits);
    CHECK(std::abs(sphere.scattering() - known.scattering) < digits);
    CHECK(std::abs(sphere.mean_cosine() - known.mean_cosine) < digits);
  }
}

TEST_CASE("Mie spheres: efficiencies and mean cosines agree with the series in 60 digits") {
  struct Case {
    Complex index;
    double size, extinction, scattering, mean_cosine;
  };
  for (const Case& known :
       {Case{1.5, 10, 2.8819989520759, 2.8819989520759, 0.742912898568678},
        {0.75, 1000, 1.99790818424538, 1.99790818424538, 0.844944290455993},
        {{10, 10}, 100, 2.07112432672695, 1.83678540431366, 0.556215484111982},
        {{1.33, 1e-5}, 10000, 2.0040889342296, 1.72385721774882, 0.907840366072115},
        {{1.5, 1}, 10000, 2.00436770974528, 1.23657431207215, 0.846309958109464}}) {
    CAPTURE(known.size);
    const MieSphere sphere(known.size, known.index);
    CHECK(sphere.extinction() == doctest::Approx(known.extinction).epsilon(1e-11));
    CHECK(sphere.scattering() == doctest::Approx(known.scattering).epsilon(1e-11));
    CHECK(sphere.mean_cosine() == doctest::Approx(known.mean_cosine).epsilon(1e-11));
  }
}

TEST_CASE("Mie spheres: efficiency and phase function agree with Bohren and Huffman's appendix A") {
  const double x = 2 * pi * 0.525 / 0.6328;
  const MieSphere sphere(x, 1.55);
  CHECK(std::abs(sphere.scattering() - 3.10543) < 0.5e-5);
  CHECK(std::abs(4 * std::norm(sphere.amplitudes(-1).s1) / (x * x) - 2.92534) < 0.5e-5);
  const auto s11 = [&](double degrees) {
    const auto [s1, s2] = sphere.amplitudes(std::cos(degrees * pi / 180));
    return (std::norm(s1) + std::norm(s2)) / 2;
  };
  for (const auto& [degrees, known] : {std::array{9.0, 0.785390},
                                       {18.0, 0.356897},
                                       {27.0, 0.0766119},
                                       {45.0, 0.0701845},
                                       {90.0, 0.0124601}})
    CHECK(s11(degrees) / s11(0) == doctest::Approx(known).epsilon(1e-5));
}

TEST_CASE(
    "Mie spheres: amplitudes agree with the optical theorem and the power in all directions") {
  for (const Complex index : {Complex(1.33), Complex(1.5, 0.01), Complex(0.7), Complex(1.001),
                              Complex(0.2, 3.4), Complex(9, 0.0)})
    for (const double x : {1e-6, 1e-3, 0.3, pi, 8.0, 60.0, 300.0}) {
      CAPTURE(index);
      CAPTURE(x);
      const MieSphere sphere(x, index);
      const auto forward = sphere.amplitudes(1);
      CHECK(std::abs(forward.s1 - forward.s2) <= 1e-12 * std::abs(forward.s1));
      CHECK(4 / (x * x) * forward.s1.real() == doctest::Approx(sphere.extinction()).epsilon(1e-12));
      const auto [power, cosine] = over_all_directions(sphere);
      CHECK(power == doctest::Approx(pi * x * x * sphere.scattering()).epsilon(1e-11));
      CHECK(std::abs(cosine - sphere.mean_cosine()) < 1e-11);
      if (index.imag() == 0 && x > 0.1)
        CHECK(sphere.extinction() == doctest::Approx(sphere.scattering()).epsilon(1e-9));
      if (index.imag() > 0) CHECK(sphere.extinction() > sphere.scattering());
    }
}

TEST_CASE("Mie spheres: small ones agree with Rayleigh, faint ones with Rayleigh and Gans") {
  for (const Complex index : {Complex(1.5), Complex(1.3, 0.5)}) {
    constexpr double x = 1e-4;
    const MieSphere sphere(x, index);
    const Complex m2 = index * index, polarizability = (m2 - 1.0) / (m2 + 2.0);
    CHECK(sphere.scattering() ==
          doctest::Approx(8.0 / 3 * std::pow(x, 4) * std::norm(polarizability)).epsilon(1e-7));
    if (index.imag() > 0)
      CHECK(sphere.extinction() == doctest::Approx(4 * x * polarizability.imag()).epsilon(1e-7));
    const MiePhase phase(sphere);
    for (const double c : {-1.0, -0.3, 0.5, 1.0})
      CHECK(phase.density(c) == doctest::Approx(3 / (16 * pi) * (1 + c * c)).epsilon(1e-6));
  }
  constexpr double x = 5, faint = 1e-6;
  const MieSphere sphere(x, 1 + faint);
  for (const double c : {-0.9, 0.0, 0.6, 1.0}) {
    const double u = x * std::sqrt(2 * (1 - c)),
                 form = u == 0 ? 1 : 3 * (std::sin(u) - u * std::cos(u)) / (u * u * u);
    const double s1 = std::abs(sphere.amplitudes(c).s1);
    CHECK(s1 == doctest::Approx(2.0 / 3 * x * x * x * faint * std::abs(form)).epsilon(1e-5));
  }
}

TEST_CASE("Mie spheres: index 1 does not scatter") {
  const MieSphere sphere(3, 1);
  CHECK(sphere.extinction() == 0);
  CHECK(sphere.scattering() == 0);
}

TEST_CASE("Mie phase function: sampled angles agree with the density") {
  for (const double x : {0.01, 3.0, 40.0}) {
    CAPTURE(x);
    const MiePhase phase{MieSphere(x, 1.33)};
    constexpr int bins = 60, steps = 2000, draws = 100000;  // bins of the angle; steps of each
    std::vector<double> counts(bins), probabilities(bins);
    double whole = 0;
    for (int i = 0; i < bins * steps; ++i) {
      const double angle = pi * (i + 0.5) / (bins * steps), share = 2 * pi * pi / (bins * steps) *
                                                                    std::sin(angle) *
                                                                    phase.density(std::cos(angle));
      probabilities[static_cast<std::size_t>(i / steps)] += share;
      whole += share;
    }
    CHECK(whole == doctest::Approx(1).epsilon(1e-6));
    RandomStream random(1, 1, 1);
    double cosine = 0;
    for (int i = 0; i < draws; ++i) {
      const double turn = phase.one_minus_cosine(random),
                   angle = 2 * std::asin(std::sqrt(turn / 2));
      counts[static_cast<std::size_t>(angle / pi * bins)] += 1;
      cosine += (1 - turn) / draws;
    }
    for (double& probability : probabilities) probability /= whole;
    flatspeckle::tests::check_chi_square(counts, probabilities);
    CHECK(std::abs(cosine - phase.mean_cosine()) < 4 * 0.7 / std::sqrt(draws));
  }
}

}  // namespace flatspeckle::grin::test_mie

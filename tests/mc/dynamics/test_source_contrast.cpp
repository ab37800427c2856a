// Decay curves, and the contrast of sources that are not monochromatic, against closed forms.
#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "core/error.h"
#include "mc/jobs/source_contrast.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_source_contrast {

namespace {

using tests::pi;

using Function = std::function<double(double)>;

std::vector<double> spaced(double first, double last, std::size_t count) {
  std::vector<double> x;
  for (std::size_t i = 0; i < count; ++i)
    x.push_back(first * std::pow(last / first, double(i) / double(count - 1)));
  return x;
}

DecayCurve curve_of(const std::vector<double>& x, const Function& f) {
  std::vector<double> values;
  for (const double at : x) values.push_back(f(at));
  return {x, values};
}

/// C_I over a frequency shift in diffusion theory of a thick slab, with half width near 1.
double diffusive(double shift) {
  const Complex x = std::sqrt(Complex(0, 7.5 * shift));
  return shift == 0 ? 1 : std::norm(x / std::sinh(x));
}

/// Returns the integral of A f from 0 to infinity, where A is `density`.
double integral(const Function& density, const Function& f, double width) {
  oracles::GaussPanels places;
  double from = 0;
  for (double to = 1e-4 * width; to < 1e6 * width; to *= 1.5) {
    places.add(from, to);
    from = to;
  }
  double sum = 0;
  for (std::size_t i = 0; i < places.node.size(); ++i)
    sum += places.weight[i] * density(places.node[i]) * f(places.node[i]);
  return sum;
}

void check(const SourceLine& line, const DecayCurve& curve, double expected, double most) {
  const LineContrast found = line_contrast(line, curve);
  CAPTURE(line.width());
  CAPTURE(found.value);
  CAPTURE(found.error);
  CHECK(std::abs(found.value - expected) <= found.error + 1e-7);
  CHECK(found.error < most);
}

}  // namespace

TEST_CASE("decay curve: crossings of exponential and Gaussian decays, and their bounds") {
  const auto x = spaced(0.01, 10, 20);
  const auto crossing = curve_of(x, [](double t) { return std::exp(-t); }).crossing(0.2);
  CHECK(crossing.censored == Range::Censoring::none);
  CHECK(crossing.value == doctest::Approx(-std::log(0.2)).epsilon(1e-9));
  CHECK(curve_of(x, [](double t) { return std::exp(-t * t); }).crossing(0.5).value ==
        doctest::Approx(std::sqrt(std::log(2))).epsilon(2e-3));
  CHECK(curve_of(x, diffusive).crossing(0.5).value ==
        doctest::Approx(curve_of(spaced(0.01, 10, 200), diffusive).crossing(0.5).value)
            .epsilon(1e-3));
  const auto slow = curve_of(x, [](double t) { return std::exp(-t / 100); }).crossing(0.5),
             fast = curve_of(x, [](double t) { return std::exp(-100 * t); }).crossing(0.5);
  CHECK(slow.censored == Range::Censoring::above_value);
  CHECK(slow.value == doctest::Approx(10));
  CHECK(fast.censored == Range::Censoring::below_value);
  CHECK(fast.value == doctest::Approx(0.01));
  CHECK(DecayCurve({0}, {1}).crossing(0.5).censored == Range::Censoring::above_value);
}

TEST_CASE("source contrast: a Gaussian spectrum over an exponential C_I has its closed form") {
  const DecayCurve curve = curve_of(spaced(0.01, 30, 40), [](double x) { return std::exp(-x); });
  for (const double width : {1e-6, 0.03, 1.0, 30.0}) {
    const double s = width / 2 / std::sqrt(std::log(2));  // deviation of A
    const double closed = s < 20 ? std::exp(s * s / 2) * std::erfc(s / std::sqrt(2))
                                 : std::sqrt(2 / pi) / s * (1 - 1 / (s * s));
    check(SourceLine::gaussian(width), curve, closed, 1e-3);
  }
  CHECK(line_contrast(SourceLine::gaussian(1e-6), curve).value == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("source contrast: agrees with quadrature for diffusive light") {
  const DecayCurve curve = curve_of(spaced(0.02, 60, 30), diffusive);
  for (const double width : {0.1, 1.0, 10.0}) {
    const double s = width / 2 / std::sqrt(std::log(2));
    const auto gaussian = [&](double x) {
      return 2 / (s * std::sqrt(2 * pi)) * std::exp(-x * x / (2 * s * s));
    };
    const auto lorentzian = [&](double x) { return 2 / pi * width / (width * width + x * x); };
    check(SourceLine::gaussian(width), curve, integral(gaussian, diffusive, width), 3e-3);
    check(SourceLine::lorentzian(width), curve, integral(lorentzian, diffusive, width), 3e-3);
  }
}

TEST_CASE("source contrast: a table of a Gaussian has the contrast and width of the Gaussian") {
  const DecayCurve curve = curve_of(spaced(0.02, 60, 30), diffusive);
  const double width = 1.5;
  std::vector<double> place, power;
  for (int i = -400; i <= 400; ++i) {
    place.push_back(3 + 0.01 * i);
    power.push_back(7 * std::exp(-4 * std::log(2) * std::pow(0.01 * i / width, 2)));
  }
  const SourceLine table = SourceLine::table(place, power), line = SourceLine::gaussian(width);
  CHECK(table.width() == doctest::Approx(width).epsilon(1e-3));
  CHECK(table(0.7) == doctest::Approx(line(0.7)).epsilon(1e-3));
  CHECK(line_contrast(table, curve).value ==
        doctest::Approx(line_contrast(line, curve).value).epsilon(1e-3));
}

TEST_CASE("source contrast: a curve that ends early adds half of what it leaves open") {
  const auto x = spaced(0.01, 1, 15);
  const DecayCurve curve = curve_of(x, [](double at) { return std::exp(-at); });
  const LineContrast found = line_contrast(SourceLine::lorentzian(2), curve);
  const double beyond = 1 - 2 / pi * std::atan(0.5);
  CHECK(found.truncation == doctest::Approx(beyond * std::exp(-1) / 2).epsilon(1e-4));
  const double closed = integral([](double at) { return 4 / pi / (4 + at * at); },
                                 [](double at) { return std::exp(-at); }, 2);
  CHECK(std::abs(found.value - closed) <= found.error);
}

TEST_CASE("relative frequencies: of frequencies, wavelengths and wavenumbers") {
  SceneSpec spec;
  spec.wavelength = 0.6;
  CHECK_FALSE(optical_frequency(spec, 1e-6).has_value());
  spec.medium_index = 1.33;
  CHECK_FALSE(optical_frequency(spec, std::nullopt).has_value());
  const auto optical = optical_frequency(spec, 1e-6);
  REQUIRE(optical.value() == doctest::Approx(299'792'458 / 0.6e-6).epsilon(1e-12));
  const auto shifts = [&](const std::string& text, FrequencyKind kind = FrequencyKind::shift) {
    return relative_frequencies("key", {text}, optical, kind);
  };
  CHECK(shifts("1e-5") == std::vector<double>{1e-5});
  CHECK(shifts("0:50GHz:3")[1] == doctest::Approx(25e9 / *optical).epsilon(1e-12));
  CHECK(shifts("1nm")[0] == doctest::Approx(600.0 / 601 - 1).epsilon(1e-9));
  CHECK(shifts("1nm", FrequencyKind::width)[0] == doctest::Approx(1.0 / 600).epsilon(1e-12));
  CHECK(shifts("2/cm")[0] == doctest::Approx(2 * 0.6e-4).epsilon(1e-12));
  for (const char* const text : {"1:50GHz:3", "1, 2GHz", "1s", "nonsense", "1GHz, 1nm"})
    CHECK_THROWS_AS(shifts(text), InputError);
  CHECK_THROWS_AS(relative_frequencies("key", {"1GHz"}, std::nullopt, FrequencyKind::shift),
                  InputError);
}

}  // namespace flatspeckle::mc::test_source_contrast

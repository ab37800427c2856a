#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "mc/slab/slab_covariance.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_memory_effect {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

std::vector<double> evenly(double from, double to, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(from + (to - from) * i / (count - 1));
  return values;
}

Range range_of(const std::vector<double>& q, const std::function<double(double)>& field) {
  std::vector<Complex> correlation;
  for (double value : q) correlation.emplace_back(field(value));
  return memory_effect_range(q, correlation);
}

double sinc(double a) {
  return a == 0 ? 1 : std::sin(a) / a;
}
double gaussian(double q) {
  return std::exp(-q * q);
}

BulkMedium bulk(double mu_t, double g, double albedo) {
  Scatterer scatterer;
  scatterer.kind = Scatterer::Kind::hg;
  scatterer.g = g;
  scatterer.albedo = albedo;
  return bulk_medium(scatterer, {.density = {}, .g = g, .text = {}}, mu_t);
}

}  // namespace

TEST_CASE("memory-effect range: accurate to 1e-3 for known curves at 33 tilts") {
  const auto q = evenly(0, 8, 33), finer = evenly(0, 4, 33);
  const double half_gaussian = std::sqrt(std::log(2.0) / 2);
  CHECK(range_of(finer, gaussian).value == doctest::Approx(half_gaussian).epsilon(1e-3));
  CHECK(range_of(q, [](double x) { return sinc(x); }).value ==
        doctest::Approx(1.391557378).epsilon(1e-3));  // sinc^2 = 1/2
  CHECK(range_of(finer, gaussian).censored == Range::Censoring::none);
  // scaled: a range in the middle, and one close to the last tilt
  for (const double scale : {2.0, 4.0, 5.7}) {
    const auto wide = [&](double x) { return sinc(x / scale); };
    CHECK(range_of(q, wide).value == doctest::Approx(1.391557378 * scale).epsilon(1e-3));
  }
}

TEST_CASE("memory-effect range: independent of the order of tilts and of the zero tilt") {
  const auto q = evenly(0, 3, 13);
  const double expected = range_of(q, gaussian).value;
  CHECK(range_of({q.rbegin(), q.rend()}, gaussian).value == expected);
  CHECK(range_of({q.begin() + 1, q.end()}, gaussian).value == doctest::Approx(expected));
}

TEST_CASE("memory-effect range: unaffected by a repeated tilt") {
  auto q = evenly(0, 3, 13);
  const double expected = range_of(q, gaussian).value;
  q.insert(q.begin() + 3, q[2]);
  CHECK(range_of(q, gaussian).value == doctest::Approx(expected));
}

TEST_CASE("memory-effect range: of positive tilts, or of negative ones if there are no others") {
  const auto lopsided = [](double x) { return x > 0 ? gaussian(x) : gaussian(x / 2); };
  const double half = std::sqrt(std::log(2.0) / 2);
  CHECK(range_of(evenly(-3, 3, 61), lopsided).value == doctest::Approx(half).epsilon(1e-3));
  CHECK(range_of(evenly(-3, 0, 31), lopsided).value == doctest::Approx(2 * half).epsilon(1e-3));
}

TEST_CASE("memory-effect range: censored at the last tilt of a curve above 1/2") {
  const auto range = range_of(evenly(0, 0.3, 5), gaussian);
  CHECK(range.censored == Range::Censoring::above_value);
  CHECK(range.value == doctest::Approx(0.3));
  // a revival beyond the first crossing does not count
  const auto revival = range_of(evenly(0, 8, 81), [](double x) { return std::cos(x); });
  CHECK(revival.value == doctest::Approx(pi / 4).epsilon(1e-3));
  CHECK(range_of({0.0}, gaussian).censored == Range::Censoring::above_value);
}

TEST_CASE("memory-effect range: censored at the first tilt if the curve is below 1/2 there") {
  const auto range = range_of({0.0, 1.5, 3.0}, gaussian);
  CHECK(range.censored == Range::Censoring::below_value);
  CHECK(range.value == 1.5);
}

TEST_CASE("field correlation: powers are summed over views before the ratio") {
  const auto request = memory_effect_request(k, 0, {0.1, 0.4}, {0.0, 0.02});
  std::vector<Complex> entries(request.entries.size());
  entries[request.tilted_entry(0, 0)] = 4;
  entries[request.tilted_entry(0, 1)] = 5;
  entries[request.tilted_entry(1, 0)] = {1, 2};
  entries[request.tilted_entry(1, 1)] = {2, 2};
  entries[request.reference_intensity(0)] = 4;
  entries[request.reference_intensity(1)] = 5;
  entries[request.tilted_intensity(0, 0)] = 4;
  entries[request.tilted_intensity(0, 1)] = 5;
  entries[request.tilted_intensity(1, 0)] = 10;
  entries[request.tilted_intensity(1, 1)] = 6;
  const auto correlation = field_correlation(request, entries);
  REQUIRE(correlation.size() == 2);
  CHECK(correlation[0].real() == doctest::Approx(1).epsilon(1e-14));
  CHECK(correlation[1].real() == doctest::Approx(std::sqrt(13.0 / 70)).epsilon(1e-14));
}

TEST_CASE("field correlation: separate for transmitted and reflected views") {
  const auto both = memory_effect_request(k, 0, {0.1, 3.0, -0.2}, {0.0, 0.02});
  const auto groups = view_groups(both);
  REQUIRE(groups.size() == 2);
  CHECK(groups[0] == std::vector<std::size_t>{0, 2});
  CHECK(groups[1] == std::vector<std::size_t>{1});
  std::vector<Complex> entries(both.entries.size(), 1);
  entries[both.tilted_entry(1, 0)] = 0.5;
  entries[both.tilted_entry(1, 1)] = 0.1;
  entries[both.tilted_entry(1, 2)] = 0.7;
  CHECK(field_correlation(both, entries)[1].real() ==
        doctest::Approx(std::sqrt(0.37)).epsilon(1e-14));
  CHECK(field_correlation(both, entries, groups[1])[1].real() ==
        doctest::Approx(0.1).epsilon(1e-14));
}

TEST_CASE("field correlation of near sensors: averages power, as covariances differ in phase") {
  const auto request = translation_request(point_source({0, -3}),
                                           {near_sensor({0, 9}), near_sensor({2, 9})}, {0, 1});
  REQUIRE(view_groups(request).size() == 1);
  std::vector<Complex> entries(request.entries.size(), 1);
  entries[request.tilted_entry(1, 0)] = {0, 0.6};
  entries[request.tilted_entry(1, 1)] = {-0.8, 0};
  CHECK(field_correlation(request, entries)[1].real() ==
        doctest::Approx(std::sqrt(0.5)).epsilon(1e-14));
}

TEST_CASE("field correlation: of many views between those of single views, transport") {
  const std::vector<double> views{-0.8, -0.3, 0, 0.4, 0.9}, tilts{0.0, 0.012};
  const auto at = [&](const std::vector<double>& chosen) {
    const auto slab = tests::hg_slab(20, {2}, memory_effect_request(k, 0, chosen, tilts));
    return field_correlation(slab.request, slab_covariance(slab, false, {1e-6}).value)[1].real();
  };
  double least = 1, most = 0;
  for (const double view : views) {
    least = std::min(least, at({view}));
    most = std::max(most, at({view}));
  }
  const double all = at(views);
  CHECK(all > least);
  CHECK(all < most);
  CHECK(least > 0.3);
  CHECK(most < 0.9);
}

TEST_CASE("correlations: errors of many dim views include the excess of noise") {
  // 64 views whose covariances are noise alone: C_E is the noise, not 0
  const std::vector<double> tilts{0.0, 0.02};
  std::vector<double> views;
  for (int v = 0; v < 64; ++v) views.push_back(-0.3 + 0.01 * v);
  const auto request = memory_effect_request(k, 0, views, tilts);
  GroupedSums sums(request.entries.size());
  RandomStream random(1, 0, 0);
  for (int batch = 0; batch < 256; ++batch) {
    std::vector<Complex> entries(request.entries.size(), 1);
    for (std::size_t v = 0; v < views.size(); ++v)
      entries[request.tilted_entry(1, v)] =
          std::polar(1.0, 6.283185307179586 * random.uniform());
    sums.add(1, entries);
  }
  const auto found = correlations(request, sums, sample_mean, view_groups(request).front());
  CHECK(found.moves.value[1].real() == doctest::Approx(1.0 / 16).epsilon(0.2));
  CHECK(found.moves.error[1] > 0.8 * found.moves.value[1].real());
  CHECK(found.moves.error[0] < 1e-12);
}

TEST_CASE("field correlation: 0 without light") {
  const auto request = memory_effect_request(k, 0, {0.1}, {0.0, 0.02});
  const std::vector<Complex> dark(request.entries.size());
  for (const Complex c : field_correlation(request, dark)) CHECK(c == 0.0);
}

TEST_CASE("memory effect: correlation 1 with error 0 at zero tilt") {
  const auto request = memory_effect_request(k, 0.2, {0.1, 0.5}, {0.0, 0.01});
  const auto result =
      tests::run(tests::hg_slab(10, {5}, request), ReversedPaths::automatic, 32000, 1);
  const auto effect = memory_effect(request, result.sums, result.job.covariance);
  CHECK(effect.correlation[0] == doctest::Approx(1).epsilon(1e-12));
  CHECK(effect.correlation_error[0] < 1e-12);
  CHECK(effect.correlation_error[1] > 0);
  CHECK(std::isfinite(effect.range.error));
}

TEST_CASE("diffusion theory: 1 at q = 0, agrees with the textbook curve of thick slabs") {
  const BulkMedium medium = bulk(1, 0, 1);
  CHECK(diffusion_field_correlation({medium, 10}, 0) == 1);
  CHECK(diffusion_field_correlation({bulk(1, 0.5, 0.9), 10}, 0) == 1);
  for (const double ql : {0.3, 1.5, 4.0}) {
    CHECK(diffusion_field_correlation({medium, 1e5}, ql / 1e5) ==
          doctest::Approx(ql / std::sinh(ql)).epsilon(1e-3));
  }
}

TEST_CASE("diffusion theory: agrees with C20") {
  const double mu_t = 2, g = 0.6, albedo = 0.95, depth = 10;
  const double mu_s = albedo * mu_t, mu_a = mu_t - mu_s;
  const double transport = 1 / (mu_a + mu_s * (1 - g)), z0 = 0.818 * transport;
  const double kappa2 = 2 * mu_a / transport;
  const auto f = [&](double q) {
    return std::sinh(q * z0) * std::sinh(q * (transport + z0)) /
           (q * std::sinh(q * (depth + 2 * z0)));
  };
  for (const double q : {0.05, 0.4, 1.0}) {
    const double expected = f(std::sqrt(q * q + kappa2)) / f(std::sqrt(kappa2));
    CHECK(diffusion_field_correlation({bulk(mu_t, g, albedo), depth}, q) ==
          doctest::Approx(expected).epsilon(1e-10));
  }
}

TEST_CASE("diffusion theory: finite at large q, strong absorption and small depth") {
  for (const double depth : {0.01, 10.0, 1e4}) {
    for (const double albedo : {0.0, 0.01, 0.9, 1 - 1e-9, 1.0}) {
      for (const double q : {0.0, 1e-9, 1.0, 1e4 / depth}) {
        const double value = diffusion_field_correlation({bulk(1, 0.9, albedo), depth}, q);
        CAPTURE(depth);
        CAPTURE(albedo);
        CAPTURE(q);
        CHECK(value >= 0);
        CHECK(value <= 1 + 1e-9);
      }
    }
  }
}

}  // namespace flatspeckle::mc::test_memory_effect

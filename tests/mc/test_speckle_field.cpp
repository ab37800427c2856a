// Speckle fields: covariance, distribution, dependence on seed and number.
#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/speckle/field_plan.h"
#include "mc/paths/speckle/field_statistics.h"
#include "mc/paths/speckle/speckle_field.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_speckle_field {

namespace {

using flatspeckle::tests::check_chi_square;
using tests::is_night;
using tests::pi;

const std::uint64_t fields_drawn = is_night ? 10000 : 3000;
constexpr std::uint64_t seed = 3;

/// Lower triangle, row by row.
using Triangle = std::vector<Complex>;

Triangle full(const Triangle& lower, std::size_t n) {
  Triangle matrix(n * n);
  for (std::size_t a = 0, e = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b, ++e) {
      matrix[a * n + b] = lower[e];
      matrix[b * n + a] = std::conj(lower[e]);
    }
  return matrix;
}

/// Sums of u_a conj(u_b) over the lower triangle, then of u_a u_b, over fields 0, 1, ...
struct Ensemble {
  GroupedSums sums;
  std::size_t entries;
  std::vector<double> intensity;  ///< mean of the intensities used to draw the fields
  std::vector<std::vector<Complex>> fields;

  Ensemble(const FieldDraw& draw, std::size_t n, std::uint64_t count = fields_drawn)
      : sums(n * (n + 1)), entries(n * (n + 1) / 2), intensity(n) {
    std::vector<double> drawn_with(n);
    for (std::uint64_t number = 0; number < count; ++number) {
      std::vector<Complex> u(n), products;
      draw(number, u, drawn_with);
      for (std::size_t c = 0; c < n; ++c)
        intensity[c] += drawn_with[c] / static_cast<double>(count);
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b <= a; ++b) products.push_back(u[a] * std::conj(u[b]));
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b <= a; ++b) products.push_back(u[a] * u[b]);
      sums.add(1, products);
      fields.push_back(std::move(u));
    }
  }

  void check(const Estimate& expected) const {
    const Estimate found = jackknife(sums, sample_mean);
    REQUIRE(expected.value.size() == entries);
    for (std::size_t e = 0; e < entries; ++e) {
      CAPTURE(e);
      CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                           expected.value[e], 0);
      CHECK_WITHIN_4_SIGMA(found.value[entries + e], found.error[entries + e], 0.0, 0);
    }
  }
  void check(const Triangle& expected) const {
    check(Estimate{expected, std::vector<double>(expected.size())});
  }

  FieldStatistics statistics(std::size_t views = 0) const {
    FieldStatistics result(intensity, views, views > 0);
    for (const auto& u : fields) result.add(u);
    return result;
  }

  /// Checks one channel's intensities, which are independent as a chi-square test requires.
  void check_exponential(std::size_t channel) const {
    FieldStatistics one({intensity[channel]}, 0, false);
    for (const auto& u : fields) one.add(std::vector<Complex>{u[channel]});
    std::vector<double> counts;
    for (const Complex share : one.histogram().value)
      counts.push_back(share.real() * static_cast<double>(fields.size()));
    check_chi_square(counts, FieldStatistics::exponential_law());
  }

  /// Checks that the contrast is 1 apart from the remaining excess kurtosis.
  void check_contrast(double excess) const {
    const Estimate contrast = statistics().mean_contrast();
    CHECK_WITHIN_4_SIGMA(contrast.value[0].real(), contrast.error[0], std::sqrt(1 + excess), 0);
    CHECK(contrast.error[0] < 0.01);
  }
};

Scene points_in_box(double count = 60) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = static_cast<std::int64_t>(count);
  Scene scene = make_scene(spec);
  scene.request = field_request({0, 0.02}, tests::far_views({0.1, 0.13, pi, pi - 0.02}));
  return scene;
}

PathSurvey survey(const Scene& scene, const Plan& plan, std::uint64_t paths = survey_paths) {
  RunOptions options;
  options.stop.samples = paths;
  options.threads = 2;
  RunState state;
  run_batches(survey_job(scene, plan, seed), options, state);
  return read_survey(state.sums);
}

/// Returns a positive definite matrix with complex off-diagonal elements.
Triangle some_covariance(std::size_t n) {
  RandomStream random(11, 0, 0);
  Triangle factor(n * n);
  for (Complex& value : factor) value = {random.uniform() - 0.3, random.uniform() - 0.6};
  Triangle lower;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      Complex sum = 0;
      for (std::size_t k = 0; k < n; ++k) sum += factor[a * n + k] * std::conj(factor[b * n + k]);
      lower.push_back(sum);
    }
  return lower;
}

/// Returns the lower triangle of F F^H.
Triangle product_of(const CovarianceFactor& factor) {
  const std::size_t n = factor.channels(), r = factor.rank();
  std::vector<std::vector<Complex>> columns(r, std::vector<Complex>(n));
  for (std::size_t k = 0; k < r; ++k) {
    std::vector<Complex> unit(r);
    unit[k] = 1;
    factor.apply(unit, columns[k]);
  }
  Triangle lower;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      Complex sum = 0;
      for (const auto& column : columns) sum += column[a] * std::conj(column[b]);
      lower.push_back(sum);
    }
  return lower;
}

void check_factor(const Triangle& lower, std::size_t n, std::size_t rank) {
  const CovarianceFactor factor(n, lower);
  CHECK(factor.rank() == rank);
  const Triangle found = product_of(factor);
  const Triangle matrix = full(lower, n);
  for (std::size_t a = 0, e = 0; a < n; ++a) {
    CHECK(factor.variance(a) == doctest::Approx(lower[a * (a + 3) / 2].real()).epsilon(1e-14));
    for (std::size_t b = 0; b <= a; ++b, ++e) {
      const double unit = std::sqrt(matrix[a * n + a].real() * matrix[b * n + b].real());
      CHECK(std::abs(found[e] - lower[e]) <= 1e-13 * unit);
    }
  }
}

}  // namespace

TEST_CASE("fields by paths: covariance agrees with the estimator, pseudo-covariance is 0") {
  Scene scene = points_in_box();
  const Plan plan = make_plan(scene, ReversedPaths::yes);
  const Ensemble ensemble(fields_by_paths(scene, plan, seed, 100), scene.request.channels.size());
  scene.request = full_request(scene.request.lights, scene.request.views);
  ensemble.check(tests::run(scene, ReversedPaths::yes, 400000, 1).entries());
}

TEST_CASE("fields by paths of a thin dark box: covariance agrees with the closed form") {
  // One scatterer, no attenuation: mu_s / 2 pi times the integral of exp(i q.x) over the box.
  const double width = 6, depth = 4, mean_free_path = 1e5, albedo = 1e-3, k = 2 * pi;
  Scene scene =
      tests::hg_box(width, depth, {mean_free_path, 0, albedo},
                    field_request({0, 0.05, -0.02}, tests::far_views({0, 0.7, 0.74, 2.5, -1.2})));
  const auto& request = scene.request;
  const auto momentum = [&](const Channel& c) {
    return k * (direction(request.lights[c.light].angle) - direction(request.views[c.view].angle));
  };
  const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(x) / x; };
  Triangle expected;
  for (std::size_t a = 0; a < request.channels.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const Vec q = momentum(request.channels[a]) - momentum(request.channels[b]);
      const double size = albedo / mean_free_path / (2 * pi) * width * depth *
                          sinc(q.x * width / 2) * sinc(q.z * depth / 2);
      expected.push_back(std::polar(1.0, q.z * depth / 2) * size);
    }
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  Ensemble(fields_by_paths(scene, plan, seed, 50), request.channels.size()).check(expected);
  // Only the phase of the field of one path is random: |u|^4 = (|u|^2)^2.
  for (const double excess : survey(scene, plan).excess)
    CHECK(excess == doctest::Approx(-1).epsilon(0.01));
}

TEST_CASE("fields from a covariance: covariance, contrast and circularity agree") {
  const std::size_t n = 7;
  const Triangle lower = some_covariance(n);
  const Ensemble ensemble(fields_from_covariance(CovarianceFactor(n, lower), seed), n);
  ensemble.check(lower);
  ensemble.check_contrast(0);
  for (const std::size_t channel : {0, 3, 6}) ensemble.check_exponential(channel);
  const Estimate circularity = ensemble.statistics().circularity();
  CHECK_WITHIN_4_SIGMA(circularity.value[0], circularity.error[0], 0.0, 0);
}

TEST_CASE("covariance factor: has the rank of the matrix at any scale") {
  const Triangle lower = some_covariance(5);
  check_factor(lower, 5, 5);
  SUBCASE("channels without light, and channels 1e-15 as bright") {
    const std::size_t n = 7;
    const double scale[n] = {1, 0, 1e-15, 1, 1e10, 0, 1};
    const std::size_t source[n] = {0, 0, 1, 2, 3, 0, 4};
    const Triangle matrix = full(lower, 5);
    Triangle scaled;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        scaled.push_back(scale[a] * scale[b] * matrix[source[a] * 5 + source[b]]);
    check_factor(scaled, n, 5);
  }
  SUBCASE("identical channels") {
    const std::size_t n = 10;
    const Triangle matrix = full(lower, 5);
    Triangle twice;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b <= a; ++b) twice.push_back(matrix[a % 5 * 5 + b % 5]);
    check_factor(twice, n, 5);
  }
  SUBCASE("no light") {
    check_factor(Triangle(6), 3, 0);
  }
}

TEST_CASE("fields by paths: Gaussian at the default number of paths") {
  const Scene scene = points_in_box();
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  const auto chosen = make_field_plan(scene, survey(scene, plan),
                                      {.method = FieldMethod::paths, .fields = fields_drawn});
  CHECK(chosen.excess <= 0.01);
  CHECK(chosen.paths_per_field < 3000);
  const Ensemble ensemble(fields_by_paths(scene, plan, seed, chosen.paths_per_field),
                          scene.request.channels.size(), 4000);
  ensemble.check_contrast(chosen.excess);
  for (const std::size_t channel : {0, 5}) ensemble.check_exponential(channel);
}

TEST_CASE("fields of few paths: excess kurtosis agrees with the survey") {
  const Scene scene =
      tests::hg_box(20, 10, {1, 0, 1}, field_request({0}, tests::far_views({0.3, pi - 0.5})));
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  const auto surveyed = survey(scene, plan, 200000);
  CHECK(surveyed.excess[0] > 10);
  CHECK(surveyed.excess[1] > 1);
  for (const std::uint64_t paths : {16, 64}) {
    if (!is_night && paths != 16) continue;
    const Ensemble ensemble(fields_by_paths(scene, plan, seed, paths), 2, 2 * fields_drawn);
    for (std::size_t channel = 0; channel < 2; ++channel) {
      GroupedSums squares(1);
      for (const auto& u : ensemble.fields)
        squares.add(1, std::vector<Complex>{std::pow(std::norm(u[channel]), 2)});
      const Estimate fourth = jackknife(squares, sample_mean);
      const double unit = std::pow(surveyed.intensity[channel], 2);
      const double expected = surveyed.excess[channel] / static_cast<double>(paths);
      CAPTURE(paths);
      CAPTURE(channel);
      CHECK_WITHIN_4_SIGMA(fourth.value[0].real() / unit - 2, fourth.error[0] / unit, expected,
                           0.05 * expected);  // the survey's own error
    }
  }
}

TEST_CASE("fields: depend only on scene, seed and number") {
  const Scene scene = points_in_box();
  Plan plan = make_plan(scene, ReversedPaths::automatic);
  const std::size_t n = scene.request.channels.size();
  const auto field = [&](const FieldDraw& draw, std::uint64_t number) {
    std::vector<Complex> u(n, 7);
    std::vector<double> intensity(n, 7);
    draw(number, u, intensity);
    return u;
  };
  const auto all_fields = [&](const FieldDraw& draw, int threads) {
    BatchJob job{.size = n, .samples_per_batch = 1, .run = {}, .relative_error = {}};
    job.run = [&](std::uint64_t number, std::span<Complex> sums) {
      const auto u = field(draw, number);
      std::copy(u.begin(), u.end(), sums.begin());
    };
    job.relative_error = [](const GroupedSums&) { return 1.0; };
    RunOptions options;
    options.stop.samples = 200;  // fewer than groups: each holds one field
    options.threads = threads;
    RunState state;
    run_batches(job, options, state);
    return state.sums.state().sums;
  };
  const Triangle lower = some_covariance(n);
  const auto check = [&](const auto& make) {
    const FieldDraw draw = make(seed);
    const auto fields = all_fields(draw, 1);
    CHECK(fields == all_fields(draw, 4));
    for (const std::uint64_t number : {150, 3, 0}) {  // alone, and in another order
      const auto first = fields.begin() + static_cast<std::ptrdiff_t>(number * n);
      CHECK(field(make(seed), number) ==
            std::vector<Complex>(first, first + static_cast<std::ptrdiff_t>(n)));
    }
    CHECK(field(draw, 0) != field(draw, 1));
    CHECK(field(draw, 0) != field(make(seed + 1), 0));
  };
  check([&](std::uint64_t s) {
    plan.paths_per_batch += 17;  // affects the covariance, not fields
    return fields_by_paths(scene, plan, s, 50);
  });
  check([&](std::uint64_t s) { return fields_from_covariance(CovarianceFactor(n, lower), s); });
}

TEST_CASE("fields by paths: intensity used to draw them agrees with the covariance") {
  Scene scene = points_in_box();
  const Plan plan = make_plan(scene, ReversedPaths::yes);
  const std::size_t n = scene.request.channels.size();
  GroupedSums sums(n);
  const FieldDraw draw = fields_by_paths(scene, plan, seed, 100);
  for (std::uint64_t number = 0; number < 500; ++number) {
    std::vector<Complex> u(n);
    std::vector<double> intensity(n);
    draw(number, u, intensity);
    sums.add(1, std::vector<Complex>(intensity.begin(), intensity.end()));
  }
  const Estimate found = jackknife(sums, sample_mean);
  scene.request = intensity_request(scene.request.lights, scene.request.views);
  const Estimate expected = tests::run(scene, ReversedPaths::yes, 200000, 5).entries();
  for (std::size_t c = 0; c < n; ++c)
    CHECK_WITHIN_4_SIGMA(found.value[c], std::hypot(found.error[c], expected.error[c]),
                         expected.value[c], 0);
}

TEST_CASE("field plan: paths for many channels, covariance for many fields") {
  Scene scene = points_in_box();
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  const auto method = [&](std::uint64_t fields) {
    return make_field_plan(scene, survey(scene, plan, 4096), {.fields = fields}).method;
  };
  CHECK(method(8) == FieldMethod::paths);
  CHECK(method(100000) == FieldMethod::covariance);
  std::vector<double> views;
  for (int v = 0; v < 2000; ++v) views.push_back(1e-3 * v - 1);
  scene.request = field_request({0}, tests::far_views(views));
  CHECK(method(100) == FieldMethod::paths);
}

TEST_CASE("field plan: number of covariance paths meets the requested error") {
  Scene scene = points_in_box();
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  const auto chosen =
      make_field_plan(scene, survey(scene, plan), {.fields = 10, .covariance_error = 0.02});
  scene.request = full_request(scene.request.lights, scene.request.views);
  const Estimate covariance =
      tests::run(scene, ReversedPaths::automatic, chosen.covariance_paths, 1).entries();
  double sum = 0;
  for (std::size_t a = 0; a < 8; ++a) {
    const std::size_t e = a * (a + 3) / 2;
    sum += std::pow(covariance.error[e] / covariance.value[e].real(), 2) / 8;
  }
  CHECK(std::sqrt(sum) == doctest::Approx(0.02).epsilon(0.25));
}

TEST_CASE("autocorrelation by FFT: agrees with the direct sum") {
  const std::size_t n = 13;
  RandomStream random(1, 0, 0);
  std::vector<double> x(n);
  for (double& value : x) value = random.uniform() - 0.5;
  const auto found = Autocorrelation(n)(x);
  REQUIRE(found.size() == n);
  for (std::size_t d = 0; d < n; ++d) {
    double sum = 0;
    for (std::size_t v = 0; v + d < n; ++v) sum += x[v] * x[v + d];
    CHECK(found[d] == doctest::Approx(sum / static_cast<double>(n - d)).epsilon(1e-12));
  }
}

TEST_CASE("autocorrelation of Gaussian intensities: agrees with Siegert's relation") {
  const std::size_t n = 40, views = 32;  // the rest belongs to another light
  Triangle lower;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const double d = static_cast<double>(a - b), bright = 0.1 + static_cast<double>(a * b);
      const double amplitude =
          std::sqrt((0.1 + static_cast<double>(a * a)) * (0.1 + static_cast<double>(b * b)));
      CHECK(bright <= amplitude * (1 + 1e-12));
      lower.push_back(
          std::polar(amplitude * std::exp(-d * d / 8), 0.02 * static_cast<double>(a * a - b * b)));
    }
  const Ensemble ensemble(fields_from_covariance(CovarianceFactor(n, lower), seed), n, 2000);
  const Estimate found = ensemble.statistics(views).autocorrelation();
  REQUIRE(found.value.size() == views);
  for (std::size_t d = 0; d < views; ++d) {
    const double expected = std::exp(-static_cast<double>(d * d) / 4);
    CHECK_WITHIN_4_SIGMA(found.value[d], found.error[d], expected, 0);
  }
  // Straight lines between exp(-1/4) and exp(-1) cross 1/2 at lag 1.6785.
  const Estimate width = ensemble.statistics(views).grain_width().value();
  CHECK_WITHIN_4_SIGMA(width.value[0], width.error[0], 2 * 1.6785, 0);
  CHECK(width.error[0] < 0.1);
  GroupedSums exact(lower.size());
  for (int batch = 0; batch < 2; ++batch) exact.add(1, lower);
  const Estimate relation = siegert_relation(exact, sample_mean, views);
  for (std::size_t d = 0; d < views; ++d) {
    CHECK(relation.value[d].real() ==
          doctest::Approx(std::exp(-static_cast<double>(d * d) / 4)).epsilon(1e-12));
    CHECK(relation.error[d] < 1e-12);
  }
}

TEST_CASE("field statistics: leave out dark channels, finite without any light") {
  for (const bool dark : {true, false}) {
    FieldStatistics statistics({0, dark ? 0.0 : 2.0}, 2, true);
    for (int field = 0; field < 4; ++field)
      statistics.add(std::vector<Complex>{0, dark ? 0 : Complex(0, field)});
    CHECK(statistics.values() == (dark ? 0 : 4));
    for (const Estimate& estimate :
         {statistics.contrast(), statistics.mean_contrast(), statistics.circularity(),
          statistics.histogram(), statistics.autocorrelation()})
      for (std::size_t i = 0; i < estimate.value.size(); ++i)
        CHECK(std::isfinite(std::abs(estimate.value[i]) + estimate.error[i]));
  }
}

TEST_CASE("equal step: of views equally spaced in sine or along a line only") {
  std::vector<double> angles;
  for (int v = 0; v < 9; ++v) angles.push_back(std::asin(0.1 * v - 0.5));
  CHECK(equal_step(tests::far_views(angles)).value() == doctest::Approx(0.1));
  angles[3] += 1e-3;
  CHECK_FALSE(equal_step(tests::far_views(angles)));
  CHECK_FALSE(equal_step(tests::far_views({0, 0.1, 0.2})));
  CHECK_FALSE(equal_step(tests::far_views(std::vector<double>(9, 0.3))));
  std::vector<double> behind = angles;
  behind[8] = pi - behind[8];
  CHECK_FALSE(equal_step(tests::far_views(behind)));
  std::vector<View> line;
  for (int v = 0; v < 9; ++v) line.push_back(near_sensor({0.3 * v, 20 + 0.4 * v}));
  CHECK(equal_step(line).value() == doctest::Approx(0.5));
  line[8].point.x += 0.1;
  CHECK_FALSE(equal_step(line));
}

}  // namespace flatspeckle::mc::test_speckle_field

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/render/pictures/render_datasets.h"
#include "grin/render/transport/tagging_sound.h"
#include "grin/render/values/render_values.h"
#include "tests/grin/render_tests.h"

// Light whose frequency sound shifts: against closed forms in space, and against exact waves in the
// plane, whose scatterers the sound displaces.

namespace flatspeckle::grin::tests::test_tagged_light {

namespace {

using std::numbers::pi;
using Cx = std::complex<double>;

constexpr double wave_number = 10, light_number = 2 * pi / 5e-4;

/// A plane sound wave along z in a slab of isotropic scatterers. Its mean free path is 1.
/// compression: change of the index times the vacuum wavenumber of light. displacement: of the
/// scatterers, times the wavenumber of light in the medium.
struct TaggedSlab {
  double depth, compression, displacement;

  RenderScene scene() const {
    RenderValues values;
    const double half = 40 * depth;
    values.stage.stage_box = {-half, -half, 0, half, half, depth};
    values.stage.medium.mu_s = 1;
    values.field.field = {"transducers"};
    auto& sound = values.field.of<TransducersValues>();
    sound.index = 1.33;
    sound.transducer = {compression / light_number, wave_number, 0, 0, 0, 0, 0, 0, 1, 0};
    values.tagging.tag_wavelength = 2 * pi / light_number;
    // the gradient of the index moves scatterers by gradient / (strain_optic k^2)
    values.tagging.strain_optic = 1.33 * compression / (wave_number * displacement);
    values.lights.beam_light = {0, 0, 0, 0, 0, 1, 0.1, 1};
    values.sensors.sensor = {"area"};
    values.sensors.of<AreaValues>().sensor_at = {0, 0, depth};
    values.sensors.of<AreaValues>().sensor_size = {2 * half, 2 * half};
    values.sensors.pixels = {1, 1};
    return make_render_scene(values);
  }
  SensorResult rendered(double samples) const {
    const RenderJob job = render_job(scene(), {RenderMethod::forward}, 1);
    return std::move(render_result(scene(), job, run_render(job, samples).sums)[0]);
  }

  /// Returns the mean of |m|^2 for each flight (conventions, C66).
  double modulation_per_flight() const {
    constexpr int points = 100000;
    const double x = wave_number, a = std::atan(x) / x;
    // index: compression / mu, displacement: displacement * mu
    const double index = compression / x;
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double mu = (i + 0.5) / points, along = displacement * mu - index / mu;
      sum += along * along * mu * mu / (1 + x * x * mu * mu) / points;
    }
    const double crossed = displacement * (1 - a) / x - index * x * a;
    return 2 * x * x * sum + 2 * crossed * crossed / (1 - a);
  }
  /// Returns the power in a sideband by diffusion, as a fraction: G(tau) is the transmittance of an
  /// absorber, relative to that without absorption (Wang 2001, with the extrapolated boundary).
  double sideband(int number) const {
    constexpr int points = 2000;
    constexpr double beyond = 0.7104;
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double psi = 2 * pi * (i + 0.5) / points;
      const double rate = std::sqrt(1.5 * modulation_per_flight_ * (1 - std::cos(psi)));
      const double whole = depth + 2 * beyond, first = 1 + beyond;
      sum += std::sinh(rate * first) / first * whole / std::sinh(rate * whole) *
             std::cos(number * psi) / points;
    }
    return number > 0 ? 2 * sum : sum;
  }
  double modulation_per_flight_ = modulation_per_flight();
};

/// Checks the sidebands against diffusion. bias: relative error of diffusion.
void check_slab(const TaggedSlab& slab, double samples, double bias) {
  const SensorResult found = slab.rendered(samples);
  REQUIRE(found.sidebands);
  const Estimate& bands = found.sidebands->mean;
  for (std::size_t n = 0; n < 3; ++n) {
    CAPTURE(n);
    const double value = bands.value[n].real(), expected = slab.sideband(static_cast<int>(n));
    CAPTURE(value);
    CAPTURE(bands.error[n]);
    CAPTURE(expected);
    CHECK(std::abs(value - expected) < 4 * bands.error[n] + bias * expected);
  }
}

// Points in a box of the plane, one of which scatters with tau = 4 i (conventions, C8). The sound
// displaces them along its direction.
constexpr double k = 2 * pi, width = 20, depth = 10, swing = 1 / k;
const Vec3 axis(0.6, 0, 0.8), sound = 2 * pi / 3 * axis;
constexpr int phases = 8;

double extinction_of(double mean_count) {
  return mean_count / (width * depth) * 4 / k;
}

Vec3 direction_at(double angle) {
  return {std::sin(angle), 0, std::cos(angle)};
}

/// Returns the amplitudes that points send into directions, lit along z.
std::vector<Cx> exact_amplitudes(const std::vector<Vec3>& points, const std::vector<Vec3>& views) {
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Identity(count, count);
  Eigen::VectorXcd waves(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    waves[i] = std::polar(1.0, k * points[i][2]);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double distance = k * (points[i] - points[j]).norm();
      // - tau i/4 H_0
      matrix(i, j) = matrix(j, i) = Cx(j0(distance), y0(distance));
    }
  }
  waves = matrix.partialPivLu().solve(waves).eval();
  std::vector<Cx> amplitudes;
  for (const Vec3& view : views) {
    Cx sum = 0;
    for (Eigen::Index i = 0; i < count; ++i)
      sum += waves[i] * std::polar(1.0, -k * view.dot(points[i]));
    amplitudes.push_back(sum);
  }
  return amplitudes;
}

/// Powers of the unshifted light and of the first sidebands, as sums over samples in groups.
struct TaggedPowers {
  static constexpr std::size_t groups = 16;
  std::array<double, groups> all{}, unshifted{}, first{};

  struct Share {
    double value, error;
  };
  Share share(const std::array<double, groups>& part) const {
    const auto sum = [](const auto& list) {
      return std::accumulate(list.begin(), list.end(), 0.0);
    };
    const double total = sum(all), value = sum(part) / total;
    double square = 0;
    for (std::size_t g = 0; g < groups; ++g) {
      const double off = (part[g] - value * all[g]) / total;
      square += off * off * groups / (groups - 1);
    }
    return {value, std::sqrt(square)};
  }
};

/// Solves for many placements at several phases of the sound. The mean field is left out.
std::vector<TaggedPowers> exact_powers(double mean_count, int placements,
                                       const std::vector<Vec3>& views) {
  std::vector<std::vector<std::array<Cx, phases>>> fields(views.size());
  RandomStream random(1, 0, 0);
  for (int placement = 0; placement < placements; ++placement) {
    std::vector<Vec3> rest;  // a Poisson process
    for (double z = 0;;) {
      z -= depth / mean_count * std::log(1 - random.uniform());
      if (z > depth) break;
      rest.emplace_back(width * (random.uniform() - 0.5), 0, z);
    }
    std::vector<std::array<Cx, phases>> found(views.size());
    for (int phase = 0; phase < phases; ++phase) {
      std::vector<Vec3> points;
      for (const Vec3& x : rest)
        points.push_back(x - swing * std::sin(sound.dot(x) - 2 * pi * phase / phases) * axis);
      const auto amplitudes = exact_amplitudes(points, views);
      for (std::size_t v = 0; v < views.size(); ++v) found[v][phase] = amplitudes[v];
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      std::array<Cx, phases> bands{};
      for (int n = 0; n < phases; ++n)
        for (int phase = 0; phase < phases; ++phase)
          bands[n] += found[v][phase] * std::polar(1.0 / phases, 2 * pi * n * phase / phases);
      fields[v].push_back(bands);
    }
  }
  std::vector<TaggedPowers> powers(views.size());
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int n = 0; n < phases; ++n) {
      Cx mean = 0;
      for (const auto& bands : fields[v]) mean += bands[n] / static_cast<double>(placements);
      for (std::size_t i = 0; i < fields[v].size(); ++i) {
        const double power = std::norm(fields[v][i][n] - mean);
        const std::size_t group = i % TaggedPowers::groups;
        powers[v].all[group] += power;
        if (n == 0) powers[v].unshifted[group] += power;
        if (n == 1 || n == phases - 1) powers[v].first[group] += power;
      }
    }
  return powers;
}

/// Estimates the same powers from paths in the plane, each of whose collisions is connected to the
/// views.
std::vector<TaggedPowers> powers_of_paths(double extinction, int paths,
                                          const std::vector<Vec3>& views) {
  const Box box{{-width / 2, -1, 0}, {width / 2, 1, depth}};
  // the index is not changed: only the motion of scatterers is used
  const TaggingSound motion{{{sound, 1, k * swing / sound.norm()}}};
  std::vector<TaggedPowers> powers(views.size());
  RandomStream random(2, 0, 0);
  for (int path = 0; path < paths; ++path) {
    Vec3 x(width * (random.uniform() - 0.5), 0, 0), w = Vec3::UnitZ();
    Cx modulation = 0;
    for (;;) {
      x += -std::log(1 - random.uniform()) / extinction * w;
      if (!(distance(box, x) < 0)) break;
      for (std::size_t v = 0; v < views.size(); ++v) {
        const double left = std::exp(-extinction * exit_distance(box, x, views[v]));
        const double swing_of_path = std::abs(modulation + motion.turned(x, w, views[v]));
        const double zeroth = j0(swing_of_path), first = j1(swing_of_path);
        const auto group = static_cast<std::size_t>(path) % TaggedPowers::groups;
        powers[v].all[group] += left;
        powers[v].unshifted[group] += left * zeroth * zeroth;
        powers[v].first[group] += 2 * left * first * first;
      }
      const Vec3 next = direction_at(2 * pi * random.uniform());
      modulation += motion.turned(x, w, next);
      w = next;
    }
  }
  return powers;
}

/// Differences between exact waves and paths: of the shares of unshifted light and of the first
/// sidebands, in three directions. Paths neglect terms of order 1/(k mean free path).
std::vector<TaggedPowers::Share> differences(double mean_count, int placements, int paths) {
  const std::vector<Vec3> views{direction_at(0.5), direction_at(-0.9), direction_at(pi - 1)};
  const auto exact = exact_powers(mean_count, placements, views),
             walked = powers_of_paths(extinction_of(mean_count), paths, views);
  std::vector<TaggedPowers::Share> found;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const auto part : {&TaggedPowers::unshifted, &TaggedPowers::first}) {
      const auto a = exact[v].share(exact[v].*part), b = walked[v].share(walked[v].*part);
      found.push_back({a.value - b.value, std::hypot(a.error, b.error)});
    }
  return found;
}

}  // namespace

TEST_CASE("tagged light: the modulation of a segment is the integral of the index") {
  const TaggingSound sound{{{{3, -2, 5}, {0.3, -0.4}, 0.2}, {{1, 1, 0}, {-0.1, 0.7}, 0.1}}};
  const Vec3 from(0.2, -0.1, 0.4), direction = Vec3(1, 2, -2) / 3;
  Cx sum = 0;
  constexpr int points = 4000;
  constexpr double length = 1.7;
  for (int i = 0; i < points; ++i)
    for (const auto& wave : sound.waves)
      sum += wave.at(from + (i + 0.5) / points * length * direction) * length / Cx(points);
  CHECK(std::abs(sum - sound.flown(from, direction, length)) < 1e-6);
  // across the sound, the phase is constant
  CHECK(std::abs(TaggingSound{{{{0, 0, 5}, 2, 0}}}.flown(Vec3::Zero(), Vec3::UnitX(), 3) - 6.0) <
        1e-12);
}

TEST_CASE("tagged light: sidebands behind a slab agree with diffusion") {
  check_slab({20, 1e-6, 0.1}, 40'000, 0.03);
  check_slab({20, 0.15, 1e-6}, 40'000, 0.03);
}

TEST_CASE("nightly: tagged light: sidebands behind a deep slab agree with diffusion to 1 %") {
  check_slab({60, 1e-6, 0.035}, 2'000'000, 0.01);
  check_slab({60, 0.05, 1e-6}, 2'000'000, 0.01);
  check_slab({60, 0.05, 0.015}, 2'000'000, 0.01);
}

TEST_CASE("tagged light: displaced scatterers in exact waves agree with paths") {
  for (const auto& [value, error] : differences(12, 2000, 30'000)) {
    CAPTURE(value);
    CAPTURE(error);
    CHECK(std::abs(value) < 4 * error + 1.5 * extinction_of(12) / k);
  }
}

TEST_CASE("nightly: tagged light: in the limit of low density exact waves agree with paths") {
  const auto dense = differences(12, 60'000, 1'000'000), thin = differences(6, 100'000, 1'000'000);
  for (std::size_t i = 0; i < dense.size(); ++i) {
    CAPTURE(i);
    CAPTURE(dense[i].value);
    CAPTURE(thin[i].value);
    const double limit = 2 * thin[i].value - dense[i].value,
                 error = std::hypot(2 * thin[i].error, dense[i].error);
    CAPTURE(error);
    CHECK(std::abs(limit) < 4 * error);
    MESSAGE(i, ": ", dense[i].value, " ", thin[i].value, " ", limit, " +- ", error);
  }
}

}  // namespace flatspeckle::grin::tests::test_tagged_light

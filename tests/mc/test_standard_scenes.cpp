#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/slab_theory.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_standard_scenes {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

struct KnownRange {
  double optical_depth, g, albedo, range, error;  ///< q L at C_I = 1/2
};

constexpr double depth = 1000;

/// Requests light and view along the normal at tilts up to 1.6 times the range.
CovarianceRequest tilted(double range) {
  std::vector<double> tilts;
  for (const double share : {0.25, 0.5, 0.75, 0.9, 1.0, 1.1, 1.3, 1.6})
    tilts.push_back(std::asin(share * range / (k * depth)));
  return memory_effect_request(k, 0, {0}, tilts);
}

double theoretical_range(const KnownRange& known) {
  const auto request = tilted(known.range);
  const oracles::IsotropicSlab slab(k, depth, known.optical_depth / depth, known.albedo, 800);
  std::vector<Complex> entries;
  for (const auto& entry : request.entries) {
    const auto channel = [&](std::uint32_t number) {
      const auto c = request.channels[number];
      return oracles::IsotropicSlab::Channel{request.lights[c.light].angle,
                                             request.views[c.view].angle};
    };
    entries.push_back(slab.without_reversed(channel(entry.a), channel(entry.b)));
  }
  return depth * memory_effect_range(request.tilt_q, field_correlation(request, entries)).value;
}

struct FoundRange {
  double value, error;
};

FoundRange estimated_range(const KnownRange& known, std::uint64_t paths, std::uint64_t seed) {
  const auto request = tilted(known.range);
  const Scene scene =
      tests::hg_slab(depth, {depth / known.optical_depth, known.g, known.albedo}, request);
  const auto result = tests::run(scene, ReversedPaths::automatic, paths, seed);
  const auto effect = memory_effect(request, result.sums, result.job.covariance);
  CHECK(effect.range.range.censored == Range::Censoring::none);
  return {effect.range.range.value * depth, effect.range.error * depth};
}

Scene box_points(double albedo, int count, const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.albedo = albedo;
  spec.count = count;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

AnglePair tilted_pair(double view, double q) {
  const double forward = std::asin(std::sin(view) + q);
  const double matched = q == 0 ? view : std::cos(view) > 0 ? forward : pi - forward;
  return {0, view, std::asin(q), matched};
}

struct KnownEntry {
  double view, q;
  Complex covariance;
};

void check_entries(double albedo, int count, const std::vector<KnownEntry>& known,
                   double known_error, ReversedPaths reversed, std::uint64_t seed) {
  std::vector<AnglePair> pairs;
  for (const auto& entry : known) pairs.push_back(tilted_pair(entry.view, entry.q));
  const Scene scene = box_points(albedo, count, pairs_request(pairs));
  const auto found = tests::run(scene, reversed, 1000000, seed).entries();
  for (std::size_t e = 0; e < known.size(); ++e) {
    CAPTURE(known[e].view);
    CAPTURE(known[e].q);
    CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], known_error),
                         known[e].covariance, 0);
    CHECK(found.error[e] < 5e-3 * tests::effort().errors);
  }
}

}  // namespace

TEST_CASE("slab_hg: ranges of the integral equation agree with known values for g = 0") {
  std::vector<KnownRange> all{{10, 0, 0.8, 2.700, 0.004}, {40, 0, 1, 1.446, 0.006}};
  if (tests::is_night)
    all.insert(all.end(), {{10, 0, 1, 1.360, 0.003},
                           {10, 0, 0.99, 1.480, 0.003},
                           {10, 0, 0.95, 1.833, 0.002},
                           {10, 0, 0.9, 2.156, 0.002},
                           {20, 0, 1, 1.406, 0.006}});
  for (const KnownRange& known : all) {
    CAPTURE(known.optical_depth);
    CAPTURE(known.albedo);
    CHECK(std::abs(theoretical_range(known) - known.range) < 4 * known.error);
  }
}

TEST_CASE("slab_hg: memory-effect ranges at optical depth 10 agree with known values") {
  std::uint64_t seed = 0;
  for (const auto& known : {KnownRange{10, 0, 1, 1.360, 0.003},
                            {10, 0.5, 1, 1.294, 0.002},
                            {10, 0, 0.9, 2.156, 0.002},
                            {10, 0.8, 1, 1.383, 0.003}}) {
    CAPTURE(known.g);
    CAPTURE(known.albedo);
    const auto found = estimated_range(known, 150000, ++seed);
    CHECK_WITHIN_4_SIGMA(found.value, std::hypot(found.error, known.error), known.range, 0);
    CHECK(found.error < 0.015 * known.range);
    if (known.g == 0)
      CHECK_WITHIN_4_SIGMA(found.value, found.error, theoretical_range(known), 1e-3);
  }
}

TEST_CASE("box_points: covariances agree with measures, table A") {
  // light 0 and view v against sin(light) = q and sin(view) + q; errors about 1e-3
  check_entries(1, 31,
                {{0.1, 0, 2.1113},
                 {0.1, 0.04, {1.6794, -0.2163}},
                 {0.1, 0.16, {1.0990, -0.6222}},
                 {0.5, 0.04, {1.1670, -0.9874}},
                 {0.8, 0, 1.9586},
                 {pi, 0, 3.3039},
                 {pi, 0.04, {2.4577, 0.0918}},
                 {pi - 0.3, 0, 2.4131},
                 {0, 0, 2.099}},
                1e-3, ReversedPaths::yes, 11);
  check_entries(1, 31, {{pi, 0, 2.3372}}, 1e-3, ReversedPaths::no, 12);
}

TEST_CASE("box_points_absorbing: intensities agree with known values") {
  check_entries(0.8, 39, {{0.1, 0, 1.465}, {pi, 0, 2.18}}, 3e-3, ReversedPaths::yes, 13);
  check_entries(0.8, 39, {{pi, 0, 1.64}}, 3e-3, ReversedPaths::no, 14);
}

}  // namespace flatspeckle::mc::test_standard_scenes

// Light at distances from a beam, by harmonics: against doubling, diffusion theory and photon
// walks.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "bench/oracles/layered_walk.h"
#include "mc/distance/distance_job.h"
#include "mc/distance/layered_radiance.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_flux.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_distance {

namespace {

using oracles::LayeredWalk;
using oracles::WalkLayer;
using tests::is_night;
using tests::pi;

const std::vector<WalkLayer> tissue = {{0.02, 10, 0.9, 1000}};
/// Scalp, skull, cerebrospinal fluid, grey and white matter; blood flows in the first and fourth.
const std::vector<WalkLayer> head = {{0.018, 19, 0.9, 3, 0.1},
                                     {0.016, 16, 0.9, 5, 0},
                                     {0.004, 2.4, 0.9, 2, 0},
                                     {0.036, 22, 0.9, 4, 1},
                                     {0.014, 60, 0.9, 1000, 1}};

/// Writes the file of layers and makes the scene of a slab in space under air.
Scene layered_tissue(const std::vector<WalkLayer>& layers, double index = 1.37) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("flatspeckle_distance_" + std::to_string(std::rand()) + ".csv");
  std::ofstream file(path);
  file << "thickness,mu_s,mu_a,g,diffusion\n";
  for (const WalkLayer& layer : layers)
    file << layer.thickness << ',' << layer.mu_s << ',' << layer.mu_a << ',' << layer.g << ','
         << layer.diffusion << '\n';
  file.close();
  SceneSpec spec;
  spec.dimension = 3;
  spec.domain = "slab";
  spec.scatterer = "hg";
  spec.layers = path;
  if (index != 1) {
    spec.medium_index = index;
    spec.polarisation = "unpolarised";
  }
  const Scene scene = in_space(make_scene(spec), spec);
  std::filesystem::remove(path);
  return scene;
}

DistanceRequest rings(const std::vector<double>& distances, double width,
                      const std::vector<double>& delays = {}) {
  DistanceRequest request;
  for (const double distance : distances)
    request.detectors.push_back({DistanceDetector::Kind::ring, distance, width});
  request.dynamics.delays = delays;
  return request;
}

double entering(double index) {
  return 1 - std::pow((index - 1) / (index + 1), 2);
}

/// Compares powers and correlations on rings with a walk. bias: numerical error, relative.
void check_walk(const std::vector<WalkLayer>& layers, const LayeredWalk& walk, int batches,
                double bias) {
  const auto expected = walk.trace(batches, 1);
  const auto found = distance_solution(layered_tissue(layers),
                                       rings(walk.distances, walk.width, walk.delays), 2e-3);
  for (std::size_t d = 0; d < walk.distances.size(); ++d)
    for (std::size_t t = 0; t <= walk.delays.size(); ++t) {
      CAPTURE(walk.distances[d]);
      CAPTURE(t);
      const double light = expected[d].value[t] * entering(walk.index);
      CHECK_WITHIN_4_SIGMA(found.value[t * walk.distances.size() + d], expected[d].error[t], light,
                           bias * light);
      CHECK(expected[d].error[t] < (is_night ? 0.006 : 0.2) * expected[d].value[t]);
    }
}

/// Power on a ring, without delay and after the delay 0.01, as fractions of the light that entered,
/// and the relative errors of both.
struct WalkedRing {
  double distance, power, power_error, decayed, decayed_error;
};

/// Compares with rings of width 3 mm of a long walk. bias: numerical error, relative.
void check_rings(const std::vector<WalkLayer>& layers, const std::vector<WalkedRing>& walked,
                 double bias) {
  std::vector<double> distances;
  for (const WalkedRing& ring : walked) distances.push_back(ring.distance);
  const auto found =
      distance_solution(layered_tissue(layers), rings(distances, 3, {0.01}), 2e-3).value;
  for (std::size_t d = 0; d < walked.size(); ++d) {
    CAPTURE(walked[d].distance);
    const auto check = [&](Complex value, double expected, double error) {
      CHECK_WITHIN_4_SIGMA(value / entering(1.37), error * expected, expected, bias * expected);
    };
    check(found[d], walked[d].power, walked[d].power_error);
    check(found[walked.size() + d], walked[d].decayed, walked[d].decayed_error);
  }
}

}  // namespace

TEST_CASE("distance: reflectance at transverse frequency 0 agrees with doubling") {
  for (const double index : {1.0, 1.37}) {
    CAPTURE(index);
    const int order = 11;
    const RadianceHarmonics harmonics(order);
    const HarmonicRotation rotation(harmonics);
    LayerLosses layer{{}, 0, 4};
    for (int l = 0; l <= order; ++l) layer.loss.push_back(0.02 + 10 * (1 - std::pow(0.9, l)));
    layer.beam = 0.02 + 10 * (1 - std::pow(0.9, order + 1));
    const FaceConditions face = harmonics.face({index, 1, Polarisation::unpolarised});
    const std::vector<LayerLosses> layers{layer};
    std::vector<LayerModes> modes;
    modes.emplace_back(rotation, harmonics, axial_modes(layer, order), 1e-6);
    const double found = LayeredRadiance(harmonics, layers, std::move(modes), face, face)
                             .reflected(false)
                             .power.real();
    const Scene scene = layered_tissue({{0.02, 10, 0.9, 4}}, index);
    const double expected = slab_flux(scene, 1, {1e-4}).value[reflected].real() / entering(index);
    CHECK(found == doctest::Approx(expected).epsilon(1e-3));
  }
}

TEST_CASE("distance: layers of one medium equal the undivided medium") {
  const auto request = rings({5, 20}, 1, {0.01});
  const auto whole = distance_solution(layered_tissue(tissue), request, 0.02).value;
  const auto cut =
      distance_solution(layered_tissue({{0.02, 10, 0.9, 0.5}, {0.02, 10, 0.9, 3}, tissue[0]}),
                        request, 0.02)
          .value;
  for (std::size_t n = 0; n < whole.size(); ++n)
    CHECK(cut[n].real() == doctest::Approx(whole[n].real()).epsilon(1e-6));
}

TEST_CASE("distance: many delays agree with each of them alone") {
  // Corrections by higher degrees are interpolated between some of the many delays.
  const double tolerance = 2e-3;
  std::vector<double> delays;
  for (double delay = 1e-4; delay < 0.03; delay *= 1.6) delays.push_back(delay);
  const std::vector<double> distances{5, 20, 40};
  const Scene scene = layered_tissue(tissue);
  const Refined many = distance_solution(scene, rings(distances, 1, delays), tolerance);
  for (std::size_t k = 0; k < delays.size(); k += 3) {
    const auto alone = distance_solution(scene, rings(distances, 1, {delays[k]}), tolerance / 2);
    for (std::size_t d = 0; d < distances.size(); ++d) {
      CAPTURE(delays[k]);
      CAPTURE(distances[d]);
      const std::size_t n = (k + 1) * distances.size() + d;
      const double expected = alone.value[distances.size() + d].real(),
                   least = 0.01 * alone.value[d].real();
      CHECK(std::abs(many.value[n].real() - expected) <
            tolerance / 4 * std::max(expected, least) + std::abs(many.error[n]));
    }
  }
}

TEST_CASE("distance: derivatives agree with differences") {
  auto layers = head;
  auto request = rings({10, 30}, 3, {0.003});
  request.gradient = true;
  const auto found = distance_solution(layered_tissue(layers), request, 1).value;
  request.gradient = false;
  const std::size_t block = 4;
  for (const std::size_t k : {0u, 3u})
    for (std::size_t coefficient = 0; coefficient < layer_coefficients; ++coefficient) {
      const double step = coefficient == 0 ? 1e-4 : 1e-3;
      const auto moved = [&](double by) {
        layers = head;
        WalkLayer& own = layers[k];
        (coefficient == 0 ? own.mu_a : coefficient == 1 ? own.mu_s : own.diffusion) += by;
        return distance_solution(layered_tissue(layers), request, 1).value;
      };
      const auto above = moved(step), below = moved(-step);
      for (std::size_t n = 0; n < block; ++n) {
        CAPTURE(k);
        CAPTURE(coefficient);
        CAPTURE(n);
        const double derivative =
            found[(1 + k * layer_coefficients + coefficient) * block + n].real();
        const double difference = ((above[n] - below[n]) / (2 * step)).real();
        CHECK(derivative == doctest::Approx(difference).epsilon(1e-3));
      }
    }
}

TEST_CASE("distance: derivatives near the source are as accurate at high degree") {
  // At the frequencies that matter here, modes of high degree are nearly dependent.
  const auto medium = [](double mu_a) { return layered_tissue({{mu_a, 4.47, 0.9, 1000}}, 1.4); };
  DistanceRequest request;
  request.detectors = {{DistanceDetector::Kind::disk, 5, 0.5}};
  for (const int degree : {9, 13, 15}) {
    CAPTURE(degree);
    request.gradient = true;
    const double derivative = distance_values(medium(0.0316), request, degree)[1].real();
    request.gradient = false;
    const auto power = [&](double mu_a) {
      return distance_values(medium(mu_a), request, degree)[0].real();
    };
    CHECK(derivative == doctest::Approx((power(0.0317) - power(0.0315)) / 2e-4).epsilon(1e-4));
  }
}

TEST_CASE("distance: disks, rings and beams of finite size agree with each other") {
  // A ring is a mean over disks around it, and small disks of light are a mean over small disks of
  // detection, by reciprocity of the lateral shift.
  DistanceRequest request;
  request.detectors = {{DistanceDetector::Kind::disk, 10, 0.5},
                       {DistanceDetector::Kind::disk, 10, 1e-3},
                       {DistanceDetector::Kind::ring, 10, 1e-3}};
  const auto found = distance_solution(layered_tissue(tissue), request, 0.02).value;
  DistanceRequest wide = request;
  wide.source_radius = 0.5;
  const auto by_source = distance_solution(layered_tissue(tissue), wide, 0.02).value;
  const auto per_area = [&](const std::vector<Complex>& values, std::size_t d) {
    return values[d].real() / request.detectors[d].area();
  };
  CHECK(per_area(found, 1) == doctest::Approx(per_area(found, 2)).epsilon(1e-6));
  CHECK(per_area(by_source, 1) == doctest::Approx(per_area(found, 0)).epsilon(1e-5));
}

TEST_CASE("distance: field correlation at 30 mm agrees with diffusion theory at short delays") {
  // Semi-infinite medium with extrapolated boundary [boas2016]: g1 is the ratio of the fluences of
  // a point source at depth l* and its image.
  const double mu_s = 1, mu_a = 0.02, index = 1.37, distance = 30;
  const std::vector<double> delays{1e-4, 3e-4, 1e-3};
  auto request = rings({distance}, 0.1, delays);
  const auto found = distance_solution(layered_tissue(tissue, index), request, 2e-3).value;
  // Mean reflectances of the surface for fluence and current [haskell1994].
  double fluence = 0, current = 0;
  constexpr int nodes = 20000;
  for (int n = 0; n < nodes; ++n) {
    const double cosine = (n + 0.5) / nodes,
                 r = Face{index, 1, Polarisation::unpolarised}.reflectance(cosine);
    fluence += 2 * cosine * r / nodes;
    current += 3 * cosine * cosine * r / nodes;
  }
  const double mean = (fluence + current) / (2 - fluence + current), source = 1 / (mu_a + mu_s),
               extrapolated = 2.0 / 3 * source * (1 + mean) / (1 - mean);
  const auto light = [&](double delay) {
    const double decay = std::sqrt(3 * (mu_a + mu_s) * (mu_a + 2 * mu_s * delay));
    const auto from = [&](double depth) {
      const double away = std::hypot(distance, depth);
      return std::exp(-decay * away) / away;
    };
    return from(source) - from(source + 2 * extrapolated);
  };
  for (std::size_t t = 0; t < delays.size(); ++t)
    CHECK((found[t + 1] / found[0]).real() ==
          doctest::Approx(light(delays[t]) / light(0)).epsilon(0.015));
}

TEST_CASE("distance: tissue and a head agree with long photon walks at 5 to 40 mm") {
  // 8 million and 1.7 million photons of a program of its own, which like LayeredWalk splits them
  // by distance.
  check_rings(tissue,
              {{5, 0.110534, 8e-4, 7.6552e-2, 9e-4},
               {10, 1.86411e-2, 1.3e-3, 8.43319e-3, 1.5e-3},
               {15, 3.69231e-3, 1.8e-3, 1.04887e-3, 2.1e-3},
               {20, 8.10093e-4, 2.3e-3, 1.42621e-4, 3.0e-3},
               {30, 4.54482e-5, 3.2e-3, 2.99556e-6, 4.6e-3},
               {40, 2.87250e-6, 4.1e-3, 6.99303e-8, 6.8e-3}},
              1e-3);
  check_rings(head,
              {{5, 7.55728e-2, 2.0e-3, 6.93306e-2, 2.0e-3},
               {10, 7.48088e-3, 5.0e-3, 6.28023e-3, 5.1e-3},
               {15, 1.19350e-3, 7.9e-3, 9.04293e-4, 8.4e-3},
               {20, 2.75484e-4, 1.0e-2, 1.80371e-4, 1.1e-2},
               {30, 2.65694e-5, 1.3e-2, 1.28075e-5, 1.5e-2},
               {40, 3.17901e-6, 1.6e-2, 1.16315e-6, 1.9e-2}},
              2e-3);
}

TEST_CASE("distance: tissue and a head agree with photon walks") {
  const int batches = is_night ? 8000 : 16;
  check_walk(tissue, {tissue, 1.37, {5, 10}, 3, {1e-2}}, batches, 0.002);
  check_walk(head, {head, 1.37, {5, 10}, 3, {1e-2}}, batches, 0.003);
}

}  // namespace flatspeckle::mc::test_distance

#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/oracles/peierls_slab.h"
#include "tests/oracles/photon_walk.h"

// The photon walk, an oracle, and its references, against published values and closed forms.

namespace flatspeckle::grin::test_photon_walk {

using namespace oracles;

namespace {

constexpr double pi = std::numbers::pi;

WalkScene slab(double thickness, double half_width, const WalkMedium& medium) {
  return {.boundary = {{-half_width, -half_width, 0}, {half_width, half_width, thickness}},
          .medium = medium};
}

/// Returns the numbers of reflected (bin 0) and transmitted (bin 1) photons.
PhotonTally slab_counts(const WalkScene& scene, std::uint64_t photons) {
  PhotonTally counts(2, photons);
  walk_photons(scene, beam_source({0, 0, 0}, {0, 0, 1}, 0), photons, 7, [&](const Photon& p) {
    if (p.x.z() < 1e-9) counts.add(0);
    if (p.x.z() > scene.boundary.high.z() - 1e-9) counts.add(1);
  });
  return counts;
}

void check_share(const PhotonTally& counts, std::size_t bin, double expected) {
  CAPTURE(counts.mean(bin));
  CAPTURE(counts.error(bin));
  CHECK(std::abs(counts.mean(bin) - expected) < 4 * counts.error(bin));
}

}  // namespace

TEST_CASE("Peierls' equation: critical thicknesses agree with published ones") {
  // Sood, Forster and Parsons 2003, problems PUa-1-0-SL, PUb-1-0-SL, Ua-1-0-SL: half thicknesses.
  CHECK(critical_ratio(2 * 0.605055) == doctest::Approx(1.50).epsilon(2e-6));
  CHECK(critical_ratio(2 * 0.73660355) == doctest::Approx(1.40).epsilon(2e-6));
  CHECK(critical_ratio(2 * 0.93772556) == doctest::Approx(1.30).epsilon(2e-6));
}

TEST_CASE("Peierls' equation: thick slabs agree with Chandrasekhar's half-space") {
  for (double albedo : {0.5, 0.9})
    CHECK(isotropic_slab(30, albedo).reflected ==
          doctest::Approx(isotropic_half_space(albedo)).epsilon(2e-5));
  const SlabShares lossless = isotropic_slab(2, 1);
  CHECK(lossless.reflected + lossless.transmitted == doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("analog photons in a slab: agree with van de Hulst and Peierls") {
  const WalkScene hulst =
      slab(0.02, 3, {.mu_s = 90, .mu_a = 10, .law = WalkMedium::Law::henyey_greenstein, .g = 0.75});
  const PhotonTally counts = slab_counts(hulst, 1000000);
  check_share(counts, 0, 0.09739);
  check_share(counts, 1, 0.66096);
  for (double albedo : {0.6, 0.95}) {
    const PhotonTally shares =
        slab_counts(slab(2, 200, {.mu_s = albedo, .mu_a = 1 - albedo}), 300000);
    const SlabShares exact = isotropic_slab(2, albedo);
    check_share(shares, 0, exact.reflected);
    check_share(shares, 1, exact.transmitted);
  }
}

TEST_CASE("analog photons on curved rays: agree with Luneburg's focus and optical paths") {
  WalkScene scene{{{-1.5, -1.5, -1}, {1.5, 1.5, 1.5}}};
  scene.balls = {{Vec3::Zero(), 1}};
  scene.curved =
      WalkIndex{[](const Vec3& x) { return std::sqrt(2 - x.squaredNorm()); },
                [](const Vec3& x) { return Vec3(-x / std::sqrt(2 - x.squaredNorm())); }, 0.02};
  int left = 0;
  walk_photons(scene, beam_source({0, 0, -1}, {0, 0, 1}, 0.9), 200, 3, [&](const Photon& p) {
    // Behind the focus (0, 0, 1) rays are straight again.
    const double beyond = (p.x - Vec3(0, 0, 1)).norm();
    CHECK((p.x - beyond * p.direction - Vec3(0, 0, 1)).norm() < 1e-5);
    CHECK(p.optical_path == doctest::Approx(pi / 2 + 1 + beyond).epsilon(1e-6));
    ++left;
  });
  CHECK(left == 200);
}

TEST_CASE("analog photons in a varying index: reciprocal with n^2 of the endpoints as weights") {
  WalkScene scene{.boundary = {{-1, -1, -1}, {1, 1, 1}},
                  .medium = {.mu_s = 1, .law = WalkMedium::Law::rayleigh}};
  scene.curved = WalkIndex{[](const Vec3& x) { return 1.25 + 0.25 * x.z(); },
                           [](const Vec3&) { return Vec3(0, 0, 0.25); }, 0.02};
  const std::uint64_t photons = 40000;
  // Lambertian light from a disk on top to one at the bottom and back: n_top^2 share(top -> bottom)
  // = n_bottom^2 share(bottom -> top).
  PhotonTally down(1, photons), up(1, photons);
  walk_photons(scene, lambertian_source({0, 0, 1}, {0, 0, -1}, 1), photons, 5,
               [&](const Photon& p) {
                 if (p.x.z() < -1 + 1e-9 && p.x.head<2>().norm() < 1) down.add(0);
               });
  walk_photons(scene, lambertian_source({0, 0, -1}, {0, 0, 1}, 1), photons, 6,
               [&](const Photon& p) {
                 if (p.x.z() > 1 - 1e-9 && p.x.head<2>().norm() < 1) up.add(0);
               });
  const double top = 1.5 * 1.5, bottom = 1;
  const double error = std::hypot(top * down.error(0), bottom * up.error(0));
  CAPTURE(top * down.mean(0));
  CAPTURE(bottom * up.mean(0));
  CHECK(std::abs(top * down.mean(0) - bottom * up.mean(0)) < 4 * error);
  CHECK(std::abs(down.mean(0) - up.mean(0)) > 10 * error);
}

}  // namespace flatspeckle::grin::test_photon_walk

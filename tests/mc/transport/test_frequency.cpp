#include <cmath>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/jobs/changed_fields.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_jobs.h"
#include "tests/mc/transport/slabs.h"

namespace flatspeckle::mc::test_frequency {

namespace {

using tests::hg_slab;
using tests::pi;
using tests::wavenumber;

Complex shifted(const Scene& scene, double shift, bool reversed = false) {
  return slab_covariance(scene, reversed, {1e-7}, {.shift = shift}).value[0];
}

Scene seen(double depth, const tests::HgBulk& bulk, double light, double view) {
  return hg_slab(depth, bulk, intensity_request({light}, {far_view(view)}));
}

/// Photon walks with two fields, isotropic scattering: C14 scored at collisions, mean free path 1.
class PhotonWalks {
 public:
  PhotonWalks(double depth, double albedo, double light, double view, double k, double shift)
      : depth_(depth),
        albedo_(albedo),
        light_(direction(light)),
        difference_(-k * shift),
        along_exit_(std::asin(std::sin(light) - (std::sin(light) - std::sin(view)) / (1 + shift))) {
    const Vec first = direction(view), second = direction(along_exit_);
    exit_ = k * first - k * (1 + shift) * second;
    loss_ = (1 / first.z + 1 / second.z) / 2;
  }

  /// Returns mean and standard error, per illuminated length.
  std::pair<Complex, double> mean(int walks) {
    Complex sum = 0;
    double squares = 0;
    for (int i = 0; i < walks; ++i) {
      const Complex one = walk();
      sum += one;
      squares += std::norm(one);
    }
    return {sum / double(walks), std::sqrt(squares) / walks};
  }

 private:
  double free_flight() { return std::exponential_distribution(1.0)(random_); }

  Complex walk() {
    Vec x{0, free_flight() * light_.z};  // origin moved so that the phase is 0 at the entry
    double weight = light_.z, phase = difference_ * light_.z * x.z;
    Complex sum = 0;
    while (x.z > 0 && x.z < depth_) {
      weight *= albedo_;
      sum += weight / (2 * pi) * std::exp(-loss_ * (depth_ - x.z)) *
             std::polar(1.0, phase - exit_.x * x.x - exit_.z * x.z);
      const double s = free_flight();
      x = x + s * direction(std::uniform_real_distribution(-pi, pi)(random_));
      phase += difference_ * s;
    }
    return sum;
  }

  double depth_, albedo_;
  Vec light_;
  double difference_, along_exit_;
  Vec exit_{};
  double loss_ = 0;
  std::mt19937_64 random_{7};
};

}  // namespace

TEST_CASE("frequency correlation of slabs: transport agrees with photon walks") {
  constexpr double free_path = 30, k = wavenumber * free_path;
  for (const double light : {0.0, 0.3}) {
    for (const double shift : {0.3 / k, -2 / k}) {
      CAPTURE(light);
      CAPTURE(shift * k);
      const double view = -0.2;
      Complex expected;
      double error = 0;
      std::tie(expected, error) = PhotonWalks(3, 0.95, light, view, k, shift).mean(200000);
      const Complex found = shifted(seen(3 * free_path, {free_path, 0, 0.95}, light, view), shift);
      CHECK_WITHIN_4_SIGMA(found, error, expected, 0);
      CHECK(error <
            0.01 * shifted(seen(3 * free_path, {free_path, 0, 0.95}, light, view), 0).real());
    }
  }
}

TEST_CASE("frequency correlation: phase derivative agrees with the mean path by absorption") {
  constexpr double depth = 60, mu_t = 0.05, albedo = 0.9;
  for (const double view : {0.0, pi}) {  // backscattering with reversed paths
    const bool reversed = view > 1;
    const Scene scene = seen(depth, {1 / mu_t, 0.6, albedo}, 0, view);
    const auto by_mu_t = slab_derivatives(scene, reversed, {1e-8}, BulkParameter::mu_t).value,
               by_albedo = slab_derivatives(scene, reversed, {1e-8}, BulkParameter::albedo).value;
    const double intensity = by_mu_t[0].real(),
                 lengths = -(by_mu_t[1] - albedo / mu_t * by_albedo[1]).real(),
                 beyond = lengths - (reversed ? 0 : depth) * intensity;
    const double step = 1e-3 / (wavenumber * depth);
    const Complex derivative =
        (shifted(scene, step, reversed) - shifted(scene, -step, reversed)) / (2 * step);
    CHECK(std::abs(derivative - Complex(0, -wavenumber * beyond)) < 1e-4 * std::abs(derivative));
  }
}

TEST_CASE("frequency correlation of a thin slab: agrees with single scattering") {
  constexpr double depth = 50, light = 0.4, view = -0.3, optical_depth = 1e-5;
  const Scene scene = seen(depth, {depth / optical_depth, 0.5}, light, view);
  for (const double shift : {1e-3, 0.02}) {
    const double k2 = wavenumber * (1 + shift),
                 view2 =
                     std::asin(std::sin(light) - (std::sin(light) - std::sin(view)) / (1 + shift)),
                 rate = wavenumber * (std::cos(light) - std::cos(view)) -
                        k2 * (std::cos(light) - std::cos(view2));
    const auto p = [](double angle) { return 0.75 / (2 * pi * (1.25 - std::cos(angle))); };
    const Complex expected = optical_depth * std::sqrt(p(view - light) * p(view2 - light)) *
                             (std::polar(1.0, rate * depth) - 1.0) / Complex(0, rate * depth);
    CHECK(std::abs(shifted(scene, shift) - expected) < 1e-3 * std::abs(expected));
  }
}

TEST_CASE("frequency correlation of a thick slab: agrees with diffusion theory") {
  constexpr double depth = 1000;  // mean free paths
  const Scene scene = seen(depth, {1, 0}, 0, 0);
  const double intensity = shifted(scene, 0).real();
  for (const double turns : {1.0, 10.0}) {
    const double difference = turns / (depth * depth), shift = -difference / wavenumber;
    // kappa^2 = 2 mu_a / l* (C20), mu_a = -i (k1 - k2); phases are relative to the straight path
    const auto f = [&](Complex q) {
      return std::sinh(0.818 * q) * std::sinh(1.818 * q) / (q * std::sinh((depth + 1.636) * q));
    };
    const Complex expected =
        f(std::sqrt(Complex(0, -2 * difference))) / f(1e-6) * std::polar(1.0, -difference * depth);
    CHECK(std::abs(shifted(scene, shift) / intensity - expected) < 3e-3);
    CHECK(std::abs(expected) < 0.99);
  }
}

TEST_CASE(
    "frequency shifts: the second view keeps transverse momenta, impossible ones are rejected") {
  const Scene scene = seen(100, {20}, 0.9, -1.5);
  CHECK_THROWS_AS(check_frequency_shifts(scene.request, {-0.05}), InputError);
  CHECK_THROWS_AS(check_frequency_shifts(scene.request, {0.2}), InputError);
  check_frequency_shifts(scene.request, {0.05});
  const auto job = slab_change_job(scene, true, {}, {{.shift = 1e-4}});
  const auto found = change_estimates(scene.request, job, tests::summed(job.field.batches, 2));
  const Complex covariance = shifted(scene, 1e-4, true);
  CHECK(std::abs(found.covariance.value[0] - covariance) < 1e-5 * std::abs(covariance));
}

}  // namespace flatspeckle::mc::test_frequency

// Noise of cameras and of photon counters, against simulated speckle that is counted.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mc/theory/detector_noise.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_detector_noise {

namespace {

using tests::pi;
using Random = std::mt19937_64;

/// Light of independent modes whose fields have the correlation `step` between two times.
class FluctuatingLight {
 public:
  FluctuatingLight(int modes, double step, Random& random)
      : step_(step), fields_(2 * static_cast<std::size_t>(modes)), random_(random) {
    for (double& field : fields_) field = normal_(random_);
  }
  /// Returns the intensity, whose mean is 1, and goes on to the next time.
  double next() {
    double sum = 0;
    for (double& field : fields_) {
      sum += field * field;
      field = step_ * field + std::sqrt(1 - step_ * step_) * normal_(random_);
    }
    return sum / static_cast<double>(fields_.size());
  }

 private:
  double step_;
  std::vector<double> fields_;
  std::normal_distribution<double> normal_;
  Random& random_;
};

/// Mean and variance of repeated measurements, with the error of the standard deviation.
struct Repeated {
  std::vector<double> values;

  double mean() const {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double deviation() const {
    double sum = 0;
    for (const double value : values) sum += std::pow(value - mean(), 2);
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
  }
  double count() const { return static_cast<double>(values.size()); }

  /// Compares the mean, within a relative bias, and the standard deviation.
  void check(double expected, double expected_deviation, double bias, double deviation_bias) const {
    CHECK_WITHIN_4_SIGMA(mean(), deviation() / std::sqrt(count()), expected, bias * expected);
    CHECK_WITHIN_4_SIGMA(deviation(), deviation() / std::sqrt(2 * count()), expected_deviation,
                         deviation_bias * expected_deviation);
  }
};

/// Counts of pixels.
struct Counts {
  double number = 0, sum = 0, square = 0;

  void add(double count) {
    ++number;
    sum += count;
    square += count * count;
  }
  double mean() const { return sum / number; }
  double contrast() const {
    return (square / number / (mean() * mean()) - 1) * number / (number - 1);
  }
};

double exponential(double delay) {
  return std::exp(-delay);
}

/// Returns K^2 of |g1|^2 = exp(-x) after an exposure x [bandyopadhyay2005].
double exponential_contrast(double x) {
  return 2 * (std::expm1(-x) + x) / (x * x);
}

double counted(double expected, double read_noise, Random& random) {
  return static_cast<double>(std::poisson_distribution<int>(expected)(random)) +
         std::normal_distribution<double>(0, read_noise)(random);
}

}  // namespace

TEST_CASE("detector noise: K^2 of exposures agrees with simulated counts") {
  struct Camera {
    double photons, read_noise, exposure;  // exposure: in decay times of |g1|^2
    int steps, repeats;
  };
  for (const Camera& camera : {Camera{3, 1.5, 2, 12, 400}, Camera{0.4, 0.2, 0.5, 4, 1000},
                               Camera{20, 1, 0.3, 4, 1500}, Camera{30, 3, 8, 24, 200}}) {
    CAPTURE(camera.photons);
    constexpr int pixels = 60, frames = 8;
    const int steps = camera.steps, repeats = camera.repeats * (tests::is_night ? 10 : 1);
    Random random(7);
    Repeated contrasts, raw;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      Counts counts;
      for (int pixel = 0; pixel < pixels; ++pixel) {
        FluctuatingLight light(2, std::exp(-camera.exposure / steps / 2), random);
        for (int frame = 0; frame < frames; ++frame) {
          double mean = 0;
          for (int step = 0; step < steps; ++step) mean += light.next() / steps;
          counts.add(counted(mean * camera.photons, camera.read_noise, random));
        }
      }
      const double noise = noise_variance({counts.mean(), camera.read_noise});
      raw.values.push_back(counts.contrast());
      contrasts.values.push_back(counts.contrast() - noise);
    }
    const double unit = exponential_contrast(camera.exposure), square = 0.5 * unit;
    const CountedSpeckle light{camera.photons, square, camera.read_noise,
                               successive_exposures(exponential, camera.exposure, unit, frames)};
    const double variance = contrast_variance(light) / (pixels * frames);
    // The mean of the counts has an error, and the distribution is only about that of gamma.
    const double noise = noise_variance({camera.photons, camera.read_noise});
    contrasts.check(square, std::sqrt(variance), 0.02 + 4 * variance / square, 0.03);
    CHECK(std::abs(raw.mean() / (square + noise) - 1) < 0.03);
  }
}

TEST_CASE("detector noise: the variance of K^2 is that from the cumulants of counts") {
  // Counts of a Poisson distribution whose mean has a gamma distribution, plus read noise
  for (const double photons : {0.1, 1.0, 20.0})
    for (const double contrast : {0.01, 0.5})
      for (const double read_noise : {0.0, 2.0}) {
        const double c2 = contrast * photons * photons, c3 = 2 * contrast * photons * c2,
                     c4 = 3 * contrast * photons * c3, dark = read_noise * read_noise,
                     second = photons + c2 + dark, third = photons + 3 * c2 + c3,
                     fourth = photons + 7 * c2 + 6 * c3 + c4 + 2 * second * second,
                     by_variance = 1 / (photons * photons),
                     by_mean = -2 * c2 / std::pow(photons, 3) - by_variance;
        CHECK(contrast_variance({photons, contrast, read_noise}) ==
              doctest::Approx(by_variance * by_variance * fourth +
                              2 * by_variance * by_mean * third + by_mean * by_mean * second));
      }
}

TEST_CASE("detector noise: pixels of a size near that of a speckle agree with simulated frames") {
  constexpr int pixels = 10, fine = 6, side = pixels * fine, reach = 16;
  const int repeats = tests::is_night ? 3000 : 300;
  for (const double area : {0.4, 1.2}) {
    CAPTURE(area);
    std::vector<double> kernel;
    double norm = 0;
    for (int x = -reach; x <= reach; ++x) {
      kernel.push_back(std::exp(-pi * area * x * x / (fine * fine)));
      norm += kernel.back() * kernel.back();
    }
    Random random(11);
    std::normal_distribution<double> normal;
    const auto smooth = [&](const std::vector<double>& from, int along, int across) {
      std::vector<double> to(from.size());
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          for (int k = -reach; k <= reach; ++k)
            to[static_cast<std::size_t>(y * across + x * along)] +=
                kernel[static_cast<std::size_t>(k + reach)] / std::sqrt(norm) *
                from[static_cast<std::size_t>(y * across + (x + k + side) % side * along)];
      return to;
    };
    Repeated contrasts;
    const double photons = 5;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      std::vector<double> frame(pixels * pixels);
      for (int part = 0; part < 2; ++part) {
        std::vector<double> field(side * side);
        for (double& value : field) value = normal(random);
        field = smooth(smooth(field, 1, side), side, 1);
        for (int y = 0; y < side; ++y)
          for (int x = 0; x < side; ++x)
            frame[static_cast<std::size_t>(y / fine * pixels + x / fine)] +=
                std::pow(field[static_cast<std::size_t>(y * side + x)], 2) / (2 * fine * fine);
      }
      Counts counts;
      for (const double value : frame) counts.add(counted(photons * value, 1, random));
      contrasts.values.push_back(counts.contrast() - noise_variance({counts.mean(), 1}));
    }
    const PixelSpeckle speckle = pixel_speckle(area);
    const double square = 1 / speckle.modes,
                 variance =
                     contrast_variance({photons, square, 1, speckle.squares}) / (pixels * pixels);
    contrasts.check(square, std::sqrt(variance),
                    0.01 + 2 * speckle.modes / area / (pixels * pixels), 0.08);
  }
}

TEST_CASE("detector noise: g2 for small beta agrees with Koppel's formula") {
  const double rate = 30, beta = 1e-4, bin = 0.001;
  const CorrelationNoise noise(rate, beta, exponential, 0.01, 20);
  for (const double delay : {0.01, 0.3, 2.0}) {
    CAPTURE(delay);
    const double steps = delay / bin, once = std::exp(-4 * bin), n = rate * bin,
                 at = std::exp(-2 * delay);
    const double koppel =
        bin * (beta * beta * ((1 + once) * (1 + at * at) + 2 * steps * (1 - once) * at * at) /
                   (1 - once) +
               2 * beta / n * (1 + at * at) + (1 + beta * at) / (n * n));
    const double found = noise.covariance(delay, delay) + noise.pair_noise(delay, bin);
    CHECK(found == doctest::Approx(koppel).epsilon(1e-3));
    // The part of waves, without the large one of pairs of photons
    const CorrelationNoise bright(1e12, beta, exponential, 0.01, 20);
    const double waves = beta * beta * ((1 + at * at) / 2 + 2 * delay * at * at);
    CHECK(bright.covariance(delay, delay) == doctest::Approx(waves).epsilon(2e-3));
  }
}

TEST_CASE("detector noise: g2 and its covariances agree with simulated photons") {
  constexpr int bins = 3000;
  constexpr double decay = 20;  // of |g1|, in bins
  const std::vector<std::size_t> lags{3, 12};
  const int repeats = tests::is_night ? 6000 : 700;
  for (const double per_bin : {0.2, 3.0}) {
    CAPTURE(per_bin);
    Random random(5);
    std::vector<Repeated> found(lags.size());
    Repeated difference;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      FluctuatingLight light(2, std::exp(-1 / decay), random);
      std::vector<double> counts;
      double mean = 0;
      for (int bin = 0; bin < bins; ++bin) {
        counts.push_back(
            static_cast<double>(std::poisson_distribution<int>(per_bin * light.next())(random)));
        mean += counts.back() / bins;
      }
      for (std::size_t i = 0; i < lags.size(); ++i) {
        double sum = 0;
        for (std::size_t bin = 0; bin < bins; ++bin)
          sum += counts[bin] * counts[(bin + lags[i]) % bins];
        found[i].values.push_back(sum / (bins * mean * mean));
      }
      difference.values.push_back(found[0].values.back() - found[1].values.back());
    }
    const CorrelationNoise noise(
        per_bin / 1, 0.5, [](double t) { return std::exp(-t / decay); }, 1, 20 * decay);
    std::vector<double> variances;
    for (std::size_t i = 0; i < lags.size(); ++i) {
      const auto lag = static_cast<double>(lags[i]);
      variances.push_back((noise.covariance(lag, lag) + noise.pair_noise(lag, 1)) / bins);
      // over a finite time g2 is too small by about the variance of the mean
      found[i].check(1 + 0.5 * std::exp(-2 * lag / decay), std::sqrt(variances[i]), 0.01, 0.03);
    }
    const double covariance = noise.covariance(3, 12) / bins,
                 expected = std::sqrt(variances[0] + variances[1] - 2 * covariance);
    CHECK_WITHIN_4_SIGMA(difference.deviation(), expected / std::sqrt(2 * difference.count()),
                         expected, 0.03 * expected);
  }
}

TEST_CASE("detector noise: limits of no and of very many photons are finite") {
  for (const double photons : {1e-20, 1.0, 1e12})
    for (const double read_noise : {0.0, 1e6})
      for (const double contrast : {1e-12, 1.0}) {
        const double variance = contrast_variance({photons, contrast, read_noise});
        CAPTURE(photons);
        CHECK((std::isfinite(variance) && variance > 0));
      }
  // Shot noise alone: the variance of the index of dispersion
  CHECK(contrast_variance({4, 0, 0}) == doctest::Approx(2.0 / 16));
}

}  // namespace flatspeckle::mc::test_detector_noise

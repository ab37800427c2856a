#pragma once

#include <cmath>
#include <vector>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// Sound that consists of plane waves, at a fixed time: n = 1 + background + sum of amplitude
/// cos(k.x - phase). It solves the wave equation exactly if all |k| are equal.
class SoundWaves {
 public:
  struct Wave {
    Vec3 k;
    double amplitude, phase;  ///< phase: phase of the wave at the origin
    double rate;              ///< frequency of this wave relative to the highest frequency
  };
  const std::vector<Wave>& waves() const { return waves_; }
  double background() const { return background_; }
  /// Returns an upper bound of the change of the index by the sound, |excess - background|.
  double largest() const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::abs(wave.amplitude);
    return sum;
  }

  double excess(const Vec3& x) const { return gradient(x).excess; }
  IndexGradient gradient(const Vec3& x) const {
    IndexGradient sum{background_, Vec3::Zero()};
    for (const auto& [k, amplitude, phase, rate] : waves_) {
      const double at = k.dot(x) - phase;
      sum.excess += amplitude * std::cos(at);
      sum.gradient -= amplitude * std::sin(at) * k;
    }
    return sum;
  }
  IndexHessian hessian(const Vec3& x) const {
    IndexHessian sum{background_, Vec3::Zero(), Mat3::Zero()};
    for (const auto& [k, amplitude, phase, rate] : waves_) {
      const double at = k.dot(x) - phase, value = amplitude * std::cos(at);
      sum.excess += value;
      sum.gradient -= amplitude * std::sin(at) * k;
      sum.hessian -= value * k * k.transpose();
    }
    return sum;
  }
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    LaneGradients sum{};
    for (const Wave& wave : waves_) {
      const double kx = wave.k[0], ky = wave.k[1], kz = wave.k[2], phase = wave.phase;
      const double amplitude = wave.amplitude;
#pragma omp simd
      for (int i = 0; i < lanes; ++i) {
        const auto at = wide_sine_cosine(kx * x.x[i] + ky * x.y[i] + kz * x.z[i] - phase);
        const double amplitude_sine = amplitude * at.sine;
        sum.excess[i] += amplitude * at.cosine;
        sum.gradient.x[i] -= amplitude_sine * kx;
        sum.gradient.y[i] -= amplitude_sine * ky;
        sum.gradient.z[i] -= amplitude_sine * kz;
      }
    }
    const double background = background_;
#pragma omp simd
    for (int i = 0; i < lanes; ++i) sum.excess[i] += background;
    found = sum;
  }

 protected:
  explicit SoundWaves(double background) : background_(background) {}

  double background_;
  std::vector<Wave> waves_;
};

}  // namespace flatspeckle::grin

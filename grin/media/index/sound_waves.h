#pragma once

#include <cmath>
#include <vector>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// Sound of plane waves, frozen: n = 1 + background + sum of amplitude cos(k.x - phase). An exact
/// solution of the wave equation where all |k| are the same.
class SoundWaves {
 public:
  double background() const { return background_; }
  /// No place has more.
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
        const double slope = amplitude * at.sine;
        sum.excess[i] += amplitude * at.cosine;
        sum.gradient.x[i] -= slope * kx;
        sum.gradient.y[i] -= slope * ky;
        sum.gradient.z[i] -= slope * kz;
      }
    }
    const double background = background_;
#pragma omp simd
    for (int i = 0; i < lanes; ++i) sum.excess[i] += background;
    found = sum;
  }

 protected:
  explicit SoundWaves(double background) : background_(background) {}

  struct Wave {
    Vec3 k;
    double amplitude, phase;  ///< phase: at the origin
    double rate;              ///< of its frequency, to the largest
  };
  double background_;
  std::vector<Wave> waves_;
};

}  // namespace flatspeckle::grin

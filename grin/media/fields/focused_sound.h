#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/lanes.h"
#include "grin/media/index/sound.h"

namespace flatspeckle::grin {

/// Sound focused by an array in its far field: plane waves of equal strength, all in phase at the
/// focus, frozen at the sound's phase psi,
///   n = 1 + background + amplitude / N sum_j cos(k d_j.(x - focus) - psi).
/// An exact solution of the wave equation for any directions d_j. Directions in one plane focus on
/// the line through the focus across that plane, a cone of them on a point.
class FocusedSound {
 public:
  /// One direction at least, of any lengths but 0; k > 0. Throws InputError.
  FocusedSound(double background, double amplitude, double k, const std::vector<Vec3>& directions,
               const Vec3& focus, double psi = 0);

  /// The wave that a ray meets at another phase of the sound.
  FocusedSound frozen(double psi) const {
    FocusedSound sound = *this;
    sound.psi_ = psi;
    return sound;
  }

  double background() const { return background_; }
  double amplitude() const { return amplitude_; }
  /// At the focus.
  double largest() const { return amplitude_ * static_cast<double>(waves_.size()); }
  double wavenumber() const { return k_; }

  double excess(const Vec3& x) const {
    double sum = 0;
    for (const Vec3& wave : waves_) sum += std::cos(phase(wave, x));
    return background_ + amplitude_ * sum;
  }
  IndexGradient gradient(const Vec3& x) const {
    double cosines = 0;
    Vec3 slope = Vec3::Zero();
    for (const Vec3& wave : waves_) {
      const double at = phase(wave, x);
      cosines += std::cos(at);
      slope -= std::sin(at) * wave;
    }
    return {background_ + amplitude_ * cosines, amplitude_ * slope};
  }
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    const double background = background_, amplitude = amplitude_;
    LaneGradients sum{};
    for (const Vec3& wave : waves_) {
      const double wx = wave[0], wy = wave[1], wz = wave[2], at_origin = phase(wave, Vec3::Zero());
#pragma omp simd
      for (int k = 0; k < lanes; ++k) {
        const auto at = wide_sine_cosine(wx * x.x[k] + wy * x.y[k] + wz * x.z[k] + at_origin);
        sum.excess[k] += at.cosine;
        sum.gradient.x[k] -= at.sine * wx;
        sum.gradient.y[k] -= at.sine * wy;
        sum.gradient.z[k] -= at.sine * wz;
      }
    }
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      found.excess[k] = background + amplitude * sum.excess[k];
      found.gradient.x[k] = amplitude * sum.gradient.x[k];
      found.gradient.y[k] = amplitude * sum.gradient.y[k];
      found.gradient.z[k] = amplitude * sum.gradient.z[k];
    }
  }
  IndexHessian hessian(const Vec3& x) const {
    double cosines = 0;
    Vec3 slope = Vec3::Zero();
    Mat3 bend = Mat3::Zero();
    for (const Vec3& wave : waves_) {
      const double at = phase(wave, x), cosine = std::cos(at);
      cosines += cosine;
      slope -= std::sin(at) * wave;
      bend -= cosine * wave * wave.transpose();
    }
    return {background_ + amplitude_ * cosines, amplitude_ * slope, amplitude_ * bend};
  }

 private:
  double phase(const Vec3& wave, const Vec3& x) const {
    return wave.dot(x - focus_) - psi_;
  }

  double background_, amplitude_;  ///< of one wave
  double k_;
  std::vector<Vec3> waves_;  ///< k d_j
  Vec3 focus_;
  double psi_;
};

/// `count` directions in the x-z plane, evenly over the angles from -aperture to aperture to the z
/// axis: a line focus along y.
std::vector<Vec3> arc_directions(int count, double aperture);

/// `count` directions spread evenly over the cap of that half-angle about the z axis: a point
/// focus.
std::vector<Vec3> cap_directions(int count, double aperture);

/// As light meets it at this phase of the sound.
inline FocusedSound at_phase(const FocusedSound& field, double phase) {
  return field.frozen(phase);
}

inline FieldFacts facts(const FocusedSound& field) {
  return {.scale = 1 / field.wavenumber(), .strength = std::abs(field.largest())};
}

struct FocusedSoundValues : SoundValues {
  using Field = FocusedSound;
  static constexpr const char* word = "focused_sound";
  std::int64_t emitters = 16;
  double aperture = 0.5;
  std::string focusing = "cone";
  std::vector<double> centre{0, 0, 0};
};

void add_keys(Keys& keys, FocusedSoundValues& values);
FocusedSound make_field(const Keys& keys, const FocusedSoundValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin

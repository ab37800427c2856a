#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::grin {

/// What becomes of the power of light. All but `emitted` add up to that.
enum class Fate {
  emitted,
  absorbed_stage,  ///< in the stage, but for bodies
  absorbed_body,   ///< in bodies
  unscattered,     ///< left the stage without a scattering
  specular,        ///< the same, reflected at the surface of a body without having entered
  scattered,       ///< left the stage after one or more
  lost,            ///< in flights that led nowhere (Flight::End::lost)
  cut              ///< of paths that reached max_scatterings
};
inline constexpr std::size_t fates = 8;
inline constexpr std::array<const char*, fates> fate_words{
    "emitted", "absorbed", "absorbed in bodies", "unscattered", "reflected by bodies", "scattered",
    "lost",    "cut"};

/// Power by Fate, summed over light paths. A path keeps its own until it has ended, so that sums
/// round little.
class EnergyBalance {
 public:
  static constexpr std::size_t size = fates;

  void add(Fate fate, double power) { power_[static_cast<std::size_t>(fate)] += power; }
  double of(Fate fate) const { return power_[static_cast<std::size_t>(fate)]; }

  EnergyBalance& operator+=(const EnergyBalance& other) {
    for (std::size_t i = 0; i < size; ++i) power_[i] += other.power_[i];
    return *this;
  }
  /// sums: [fate].
  void add_to(std::span<Complex> sums) const {
    for (std::size_t i = 0; i < size; ++i) sums[i] += power_[i];
  }

 private:
  std::array<double, size> power_{};
};

/// What is kept of a pixel's light: by optical path, in equal bins, beside them what is before the
/// first and beyond the last, so that the sum of all is the steady picture; moments of it; and
/// derivatives by parameters of the medium (path_score.h) and of the field (moving_paths.h).
struct TimeBins {
  double first = 0, last = 0;  ///< edges
  int count = 1;               ///< 1: steady state
  bool moments = false;        ///< also value times path, and times its square
  int derivatives = 0;         ///< by so many parameters of the medium
  int by_field = 0;            ///< and so many sums of those by parameters of the field

  bool keeps_paths() const { return count > 1 || moments; }
  /// Sums of a pixel: [before, bins, beyond] or one, then the moments.
  int parts() const { return count > 1 ? count + 2 : 1; }
  int first_derivative() const { return parts() + (moments ? 2 : 0); }
  int first_by_field() const { return first_derivative() + derivatives; }
  int sums() const { return first_by_field() + by_field; }
};

/// The sensor of a pixel, and the share of its area that the pixel has.
struct PixelShare {
  std::size_t sensor;
  double share;
};

/// Sums of a batch: [pixel][TimeBins::sums].
class Film {
 public:
  Film([[maybe_unused]] int pixels, const TimeBins& bins, std::span<Complex> sums)
      : sums_(sums),
        bins_(bins),
        per_pixel_(bins.sums()),
        bins_per_length_(bins.count > 1 ? bins.count / (bins.last - bins.first) : 0) {
    assert(sums.size() == static_cast<std::size_t>(pixels) * bins.sums());
  }

  void add(int pixel, double value, double optical_path) {
    Complex* const own = sums_.data() + static_cast<std::size_t>(pixel) * per_pixel_;
    if (bins_.count > 1)
      add_to_bins(own, value, optical_path);
    else
      own[0] += value;
    if (!bins_.moments) return;
    own[bins_.parts()] += value * optical_path;
    own[bins_.parts() + 1] += value * optical_path * optical_path;
  }

  /// Counts light that hit a pixel by itself, whatever weight it has among the strategies that find
  /// such light. Nothing is counted where `hits` is empty.
  void add_hit(int pixel, double value) {
    if (hits.empty() || pixel < 0 || !std::isfinite(value)) return;
    const PixelShare& of = shares[static_cast<std::size_t>(pixel)];
    hits[of.sensor] += of.share * value;
  }
  /// The steady light of all pixels so far, to be added to means over the pixels of each sensor.
  void add_means(std::span<double> means) const {
    for (std::size_t pixel = 0; pixel < shares.size(); ++pixel)
      for (int part = 0; part < bins_.parts(); ++part)
        means[shares[pixel].sensor] +=
            shares[pixel].share *
            sums_[pixel * static_cast<std::size_t>(per_pixel_) + static_cast<std::size_t>(part)]
                .real();
  }

  std::span<const PixelShare> shares;  ///< of all pixels
  std::vector<double> hits;            ///< of each sensor

  bool has_derivatives() const { return bins_.derivatives > 0; }
  void add_derivative(int pixel, int parameter, double value) {
    Complex* const own = sums_.data() + static_cast<std::size_t>(pixel) * per_pixel_;
    own[bins_.first_derivative() + parameter] += value;
  }
  void add_by_field(int pixel, int number, double value) {
    Complex* const own = sums_.data() + static_cast<std::size_t>(pixel) * per_pixel_;
    own[bins_.first_by_field() + number] += value;
  }

  EnergyBalance energy;  ///< of light paths that are walked to their ends
  double drift = 0;      ///< of the same (DepthImportance::Drift)

 private:
  /// A contribution within the edges is shared between the two bins whose centres are next to it
  /// (linear splat), which keeps its optical path between the first and the last centre.
  void add_to_bins(Complex* own, double value, double optical_path) const {
    // bin centres are the whole numbers
    const double at = (optical_path - bins_.first) * bins_per_length_ + 0.5;
    if (!(optical_path >= bins_.first)) {
      own[0] += value;
    } else if (!(optical_path <= bins_.last)) {
      own[bins_.count + 1] += value;
    } else if (!(at > 1)) {
      own[1] += value;
    } else if (at >= bins_.count) {
      own[bins_.count] += value;
    } else {
      const int before = static_cast<int>(at);
      const double later = value * (at - before);
      own[before] += value - later;
      own[before + 1] += later;
    }
  }

  std::span<Complex> sums_;
  TimeBins bins_;
  int per_pixel_;
  double bins_per_length_;
};

}  // namespace flatspeckle::grin

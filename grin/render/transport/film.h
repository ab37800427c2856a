#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "grin/media/scattering/case_modes.h"
#include "grin/render/transport/field_decay.h"
#include "grin/render/transport/tagging_sound.h"

namespace flatspeckle::grin {

/// Ways in which the power of light paths ends. All other entries sum to `emitted`.
enum class Termination {
  emitted,
  absorbed_stage,  ///< absorbed in the stage outside of bodies
  absorbed_body,   ///< absorbed in bodies
  unscattered,     ///< left the stage without a scattering
  specular,        ///< left the stage unscattered, after reflection by a body without entering it
  scattered,       ///< left the stage after one or more scatterings
  lost,            ///< carried by lost flights (Flight::End::lost)
  cut              ///< carried by paths that reached max_scatterings
};
inline constexpr std::size_t termination_count = 8;
inline constexpr std::array<const char*, termination_count> termination_names{
    "emitted", "absorbed", "absorbed in bodies", "unscattered", "reflected by bodies", "scattered",
    "lost",    "cut"};

/// Power by Termination, summed over light paths. Each path accumulates its own balance until it
/// ends, which limits rounding errors.
class EnergyBalance {
 public:
  static constexpr std::size_t size = termination_count;

  void add(Termination termination, double power) {
    power_[static_cast<std::size_t>(termination)] += power;
  }
  double of(Termination termination) const { return power_[static_cast<std::size_t>(termination)]; }

  EnergyBalance& operator+=(const EnergyBalance& other) {
    for (std::size_t i = 0; i < size; ++i) power_[i] += other.power_[i];
    return *this;
  }
  /// Adds the powers to `sums`, which are indexed by Termination.
  void add_to(std::span<Complex> sums) const {
    for (std::size_t i = 0; i < size; ++i) sums[i] += power_[i];
  }

 private:
  std::array<double, size> power_{};
};

/// Layout of a pixel's sums: equal bins of optical path, with one more bin below the first and one
/// above the last, so that the sum of all bins is the steady picture; moments of the optical path;
/// derivatives with respect to parameters of the medium (path_score.h) and of the field
/// (moving_paths.h); and the field correlation after delays (FieldDecay).
struct TimeBins {
  double first = 0,
         last = 0;  ///< lower edge of the first bin and upper edge of the last, in optical path
  int count = 1;    ///< number of bins; 1: steady state
  bool moments = false;  ///< whether value times optical path, and times its square, are summed too
  int derivatives = 0;   ///< number of parameters of the medium
  int by_field = 0;      ///< number of sums for derivatives by parameters of the field
  /// If set, the sums end with those of the field correlation: for each delay the intensity sums,
  /// times the decay of each path; the momentum transfer in each part, times the light; and the
  /// derivatives after each delay by the diffusion in each part, [part][delay].
  std::shared_ptr<const FieldDecay> decay = {};
  /// If set, the sums of the sidebands follow (sideband_sums).
  std::shared_ptr<const TaggingSound> sound = {};

  bool keeps_paths() const { return count > 1 || moments; }
  /// Number of intensity sums of a pixel: one before the bins, the bins, and one after them; or 1
  /// in the steady state. The moments follow.
  int parts() const { return count > 1 ? count + 2 : 1; }
  int first_derivative() const { return parts() + (moments ? 2 : 0); }
  int first_by_field() const { return first_derivative() + derivatives; }
  int first_decay() const { return first_by_field() + by_field; }
  int delays() const { return decay ? static_cast<int>(decay->delays.size()) : 0; }
  int decay_parts() const { return decay ? static_cast<int>(decay->parts()) : 0; }
  int first_transfer() const { return first_decay() + delays() * parts(); }
  int first_decay_derivative() const { return first_transfer() + decay_parts(); }
  int first_sideband() const { return first_decay_derivative() + decay_parts() * delays(); }
  int sums() const { return first_sideband() + (sound ? sideband_sums : 0); }
};

/// The sensor of a pixel, and the pixel's share of the sensor area.
struct PixelShare {
  std::size_t sensor;
  double share;
};

/// Number of control variates of light paths: modes, and light that leaves (control_variates.h).
inline constexpr std::size_t control_variate_count = 2 * CaseModes::most_pairs + 3;

/// Accumulators of a batch: for each pixel, the sums laid out by TimeBins.
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
    Complex* const own = sums_of(pixel);
    add_light(own, value, optical_path);
    if (!bins_.moments) return;
    own[bins_.parts()] += value * optical_path;
    own[bins_.parts() + 1] += value * optical_path * optical_path;
  }

  /// Tallies light that hit a pixel without a connection, without its MIS weight. Does nothing if
  /// `hits` is empty.
  void add_hit(int pixel, double value) {
    if (hits.empty() || pixel < 0 || !std::isfinite(value)) return;
    const PixelShare& of = shares[static_cast<std::size_t>(pixel)];
    hits[of.sensor] += of.share * value;
  }
  /// Adds the light of all pixels to the mean of each sensor.
  void add_means(std::span<double> means) const {
    for (std::size_t pixel = 0; pixel < shares.size(); ++pixel)
      means[shares[pixel].sensor] += shares[pixel].share * steady(pixel);
  }
  /// Returns the light of a pixel, summed over the bins.
  double steady(std::size_t pixel) const {
    double light = 0;
    for (int part = 0; part < bins_.parts(); ++part)
      light += sums_of(static_cast<int>(pixel))[part].real();
    return light;
  }

  std::span<const PixelShare> shares;  ///< sensor and share of its area, for each pixel
  std::vector<double> hits;            ///< light that hit each sensor; empty if not tallied

  bool has_derivatives() const { return bins_.derivatives > 0; }
  void add_derivative(int pixel, int parameter, double value) {
    Complex* const own = sums_.data() + static_cast<std::size_t>(pixel) * per_pixel_;
    own[bins_.first_derivative() + parameter] += value;
  }
  void add_by_field(int pixel, int number, double value) {
    Complex* const own = sums_.data() + static_cast<std::size_t>(pixel) * per_pixel_;
    own[bins_.first_by_field() + number] += value;
  }

  bool has_decay() const { return bins_.decay != nullptr; }
  /// Requires has_decay().
  const FieldDecay& decay() const { return *bins_.decay; }
  /// Adds a contribution to the field correlation.
  void add_decay(int pixel, double value, double optical_path, const MomentumTransfer& transfer) {
    const FieldDecay& decay = *bins_.decay;
    Complex* const own = sums_of(pixel);
    Complex* const derivatives = own + bins_.first_decay_derivative();
    for (std::size_t part = 0; part < decay.parts(); ++part)
      own[bins_.first_transfer() + static_cast<int>(part)] += value * transfer.in(part);
    for (std::size_t t = 0; t < decay.delays.size(); ++t) {
      const double left = value * decay.factor(t, transfer);
      add_light(own + bins_.first_decay() + static_cast<int>(t) * bins_.parts(), left,
                optical_path);
      for (std::size_t part = 0; part < decay.parts(); ++part)
        derivatives[part * decay.delays.size() + t] -= 2 * decay.delays[t] * transfer.in(part)*left;
    }
  }

  const TaggingSound* sound() const { return bins_.sound.get(); }
  /// Adds a contribution of a path with the modulation m to the sidebands. The power in sideband n
  /// is the square of the Bessel function J_n(|m|), on both sides of the unshifted light.
  void add_sidebands(int pixel, double value, std::complex<double> m) {
    if (pixel < 0 || !std::isfinite(value)) return;
    Complex* const own = sums_of(pixel) + bins_.first_sideband();
    const double depth = std::abs(m);
    for (int n = 0; n < sidebands; ++n) {
      const double bessel = ::jn(n, depth);
      own[n] += value * bessel * bessel * (n > 0 ? 2 : 1);
    }
    own[sidebands] += value * depth * depth;
  }

  EnergyBalance energy;  ///< power of light paths that are traced to their ends
  /// Sums of the control variates over the light paths that are traced to their ends.
  std::array<double, control_variate_count> control_variates{};

 private:
  Complex* sums_of(int pixel) const {
    return sums_.data() + static_cast<std::size_t>(pixel) * static_cast<std::size_t>(per_pixel_);
  }
  /// Adds a contribution to the intensity sums that begin at `own`.
  void add_light(Complex* own, double value, double optical_path) const {
    if (bins_.count > 1)
      add_to_bins(own, value, optical_path);
    else
      own[0] += value;
  }
  /// Splits a contribution between the two bins with the nearest centres (linear splat), which
  /// preserves the mean optical path of light between the first and the last centre.
  void add_to_bins(Complex* own, double value, double optical_path) const {
    // in these units bin centres are at integers
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

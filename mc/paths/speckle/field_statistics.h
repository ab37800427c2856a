#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/statistics.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// Returns the step from one view to the next, as a difference of sines of angles (far views) or as
/// a length (near sensors). Returns nullopt if the steps differ or there are fewer than eight
/// views.
std::optional<double> equal_step(const std::vector<View>& views);

/// Computes (sum over v of x_v x_{v+d}) / (views - d) for d = 0 .. views - 1, by FFTW. Several
/// threads may call the same object at once.
class Autocorrelation {
 public:
  explicit Autocorrelation(std::size_t views);
  std::vector<double> operator()(std::span<const double> x) const;

 private:
  struct Plans;
  std::size_t views_;
  std::shared_ptr<const Plans> plans_;
};

/// Statistics of the normalised intensity x = |u|^2 / E|u|^2 over fields and channels, each with
/// its jackknife error over groups of fields. Channels with E|u|^2 = 0 are left out. For Gaussian
/// fields the contrast is 1, the histogram is exp(-x), the circularity is 0, and the
/// autocorrelation is siegert_relation().
class FieldStatistics {
 public:
  /// intensity: E|u|^2 of the channels [light][view]. autocorrelated: whether to compute the
  /// autocorrelation over the views of the first light. squares: factor of the mean of x^2 in the
  /// contrast; (N + 1)/N if the intensity is the mean of |u|^2 over the same N fields, whose mean
  /// of x^2 is then 2 N/(N + 1) for Gaussian fields. is_camera: whether the views are the pixels of
  /// a square camera. The autocorrelation is then the mean over its rows and columns, of |u|^2 -
  /// E|u|^2 relative to the mean over the camera: if E|u|^2 is the mean over few fields, its shape
  /// remains that of many fields.
  FieldStatistics(std::vector<double> intensity, std::size_t views, bool autocorrelated,
                  double squares = 1, bool is_camera = false);

  void add(std::span<const Complex> field);

  Estimate mean_contrast() const;  ///< std / mean of x over all channels and fields
  Estimate contrast() const;       ///< std / mean of x per channel, over all fields
  Estimate circularity() const;    ///< mean of u^2 / E|u|^2
  /// Returns the fraction of the values x in each bin i, from i bin_width to (i + 1) bin_width. The
  /// last bin has no upper edge.
  Estimate histogram() const;
  Estimate autocorrelation() const;  ///< mean over v of (x_v - 1)(x_{v+d} - 1), for each lag d

  /// Returns the full width at half maximum of the autocorrelation, in steps between views,
  /// interpolated linearly between lags. Returns nullopt if the views do not resolve this width: if
  /// the autocorrelation does not fall to half its maximum, or does so before lag 1.
  std::optional<Estimate> grain_width() const;

  double values() const;  ///< number of normalised intensities x in the histogram
  static constexpr std::size_t bins = 33;
  static constexpr double bin_width = 0.25;
  /// Returns the fraction of values in each bin that is expected for the density exp(-x).
  static std::vector<double> exponential_law();

 private:
  void add_lags(std::span<const double> fluctuation, std::span<Complex> sums) const;

  std::vector<double> intensity_;
  std::size_t line_;  ///< number of views in a line of the autocorrelation; 0 without it
  double squares_;
  bool is_camera_;
  std::optional<Autocorrelation> autocorrelation_;
  GroupedSums sums_;
};

/// Returns the autocorrelation of the intensity by Siegert's relation: for each lag d, the mean
/// over v of |C(v, v+d)|^2 / (C(v,v) C(v+d,v+d)). C is the covariance of the first `views`
/// channels, which are the views of the first light. sums and covariance: sums and estimator of a
/// run for a full covariance.
Estimate siegert_relation(const GroupedSums& sums, const Estimator& covariance, std::size_t views);

}  // namespace flatspeckle::mc

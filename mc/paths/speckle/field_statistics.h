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

/// Sine of the angle (far views) or place along the line (near sensors) from one view to the next,
/// where that is the same for all of at least eight views.
std::optional<double> equal_step(const std::vector<View>& views);

/// (sum over v of x_v x_{v+d}) / (views - d) for d = 0 .. views - 1, by FFTW. One thread makes it,
/// several may use it.
class Autocorrelation {
 public:
  explicit Autocorrelation(std::size_t views);
  std::vector<double> operator()(std::span<const double> x) const;

 private:
  struct Plans;
  std::size_t views_;
  std::shared_ptr<const Plans> plans_;
};

/// Statistics of x = |u|^2 / E|u|^2 over fields and channels, each with its error from leaving out
/// groups of fields; channels without light are left out. Gaussian fields have contrast 1,
/// histogram exp(-x), circularity 0, and the autocorrelation of Siegert's relation (below).
class FieldStatistics {
 public:
  /// intensity: E|u|^2 of the channels [light][view]; autocorrelated: of the first light's views.
  FieldStatistics(std::vector<double> intensity, std::size_t views, bool autocorrelated);

  void add(std::span<const Complex> field);

  Estimate mean_contrast() const;  ///< std / mean of x, pooled
  Estimate contrast() const;       ///< std / mean per channel, of as many fields as there are
  Estimate circularity() const;    ///< mean of u^2 / E|u|^2
  /// Share of x in [i, i + 1) histogram_step; the last bin is open.
  Estimate histogram() const;
  Estimate autocorrelation() const;  ///< mean of (x_v - 1)(x_{v+d} - 1), per d

  /// Full width at half maximum of that, in steps between views, by straight lines between lags;
  /// nothing where it does not fall so far, or before its second lag, for lack of views.
  std::optional<Estimate> grain_width() const;

  double values() const;  ///< how many x there are
  static constexpr std::size_t bins = 33;
  static constexpr double bin_width = 0.25;
  static std::vector<double> exponential_law();  ///< expected shares of the bins

 private:
  std::vector<double> intensity_;
  std::size_t views_;
  std::optional<Autocorrelation> autocorrelation_;
  GroupedSums sums_;
};

/// What Siegert's relation makes of the covariance of the first `views` channels (the first
/// light's): mean over v of |C(v, v+d)|^2 / (C(v,v) C(v+d,v+d)), per d. `sums`: those of a full
/// covariance.
Estimate siegert_relation(const GroupedSums& sums, const Estimator& covariance, std::size_t views);

}  // namespace flatspeckle::mc

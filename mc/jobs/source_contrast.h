#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/scene/optical_frequency.h"
#include "mc/jobs/crossings.h"

namespace flatspeckle::mc {

/// Autocorrelation A of the spectrum s of a source, A(x) = 2 int s(y) s(y + x) dy for x > 0, where
/// s and A have the integral 1. Frequencies are relative to the optical frequency.
class SourceLine {
 public:
  /// width: full width at half maximum.
  static SourceLine gaussian(double width);
  static SourceLine lorentzian(double width);
  /// s: piecewise linear between the given frequencies, which must ascend, and 0 outside.
  static SourceLine table(const std::vector<double>& frequencies, const std::vector<double>& power);

  /// Returns the full width at half maximum; of a table, between the outermost points at half of
  /// the maximum.
  double width() const { return width_; }
  double operator()(double x) const;
  /// Returns a frequency below which A changes little.
  double scale() const { return scale_; }

 private:
  enum class Shape { gaussian, lorentzian, table };
  SourceLine(Shape shape, double width) : shape_(shape), width_(width), scale_(width) {}

  Shape shape_;
  double width_, scale_;
  std::vector<double> frequency_, power_;  ///< of a table; the integral of the power is 1
};

/// Squared contrast C^2 of the speckle of a source: the integral of its A (SourceLine) times C_I,
/// the intensity correlation over frequencies.
struct LineContrast {
  double value, error;
  /// Part of the error that is due to frequencies beyond those of the curve: half of what they can
  /// contribute at most, if C_I does not increase there.
  double truncation;
};
/// The error also contains that of the interpolation of the curve.
LineContrast line_contrast(const SourceLine& line, const DecayCurve& curve);

/// Values of the keys of sources that are not monochromatic.
struct LineValues {
  std::vector<std::string> linewidths{};
  std::string line_shape = "gaussian", line_table{};
};
void add_keys(Keys& keys, LineValues& values);
/// Reads the keys. optical: optical_frequency() of the scene. Throws InputError.
std::vector<SourceLine> source_lines(const Keys& keys, const LineValues& values,
                                     const std::optional<double>& optical);

/// Estimates of C^2, [line][channel], for an intensity request.
struct SourceContrast {
  Estimate squares;
  double truncation = 0;  ///< largest relative truncation error of C^2
};
SourceContrast source_contrast(const CovarianceRequest& request, const PathJob& job,
                               const GroupedSums& sums, const std::vector<double>& shifts,
                               const std::vector<SourceLine>& lines);

}  // namespace flatspeckle::mc

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/fourier.h"

namespace flatspeckle::mc {

/// Fourier transforms of real lines, padded with zeros to `size`.
class LineSpectrum {
 public:
  explicit LineSpectrum(std::size_t size)
      : size_(size),
        forward_(size, LineTransform::Direction::forward),
        backward_(size, LineTransform::Direction::backward) {}

  std::size_t size() const { return size_; }
  /// Returns the absolute value of the frequency of element m, in cycles per pixel.
  double frequency(std::size_t m) const {
    return static_cast<double>(m < size_ - m ? m : size_ - m) / static_cast<double>(size_);
  }

  std::vector<Complex> of(std::span<const double> line) const;
  /// Returns the line of size() values with this spectrum.
  std::vector<double> line(std::vector<Complex> spectrum) const;

 private:
  std::size_t size_;
  LineTransform forward_, backward_;
};

/// Returns the values of a periodic line at positions -(lags - 1) to lags - 1.
std::vector<double> about_zero(std::span<const double> line, std::size_t lags);

/// Returns the Fourier transform, at a frequency, of the Gaussian exp(-x^2 / (2 width^2)) divided
/// by its integral.
double gaussian_spectrum(double frequency, double width);

}  // namespace flatspeckle::mc

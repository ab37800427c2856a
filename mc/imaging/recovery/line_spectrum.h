#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/fourier.h"

namespace flatspeckle::mc {

/// Fourier transforms of real lines that zeros make as long as `size`.
class LineSpectrum {
 public:
  explicit LineSpectrum(std::size_t size)
      : size_(size),
        forward_(size, LineTransform::Direction::forward),
        backward_(size, LineTransform::Direction::backward) {}

  std::size_t size() const { return size_; }
  /// Cycles per pixel of element m, without its sign.
  double frequency(std::size_t m) const {
    return static_cast<double>(m < size_ - m ? m : size_ - m) / static_cast<double>(size_);
  }

  std::vector<Complex> of(std::span<const double> line) const;
  /// The line of a spectrum, size() values.
  std::vector<double> line(std::vector<Complex> spectrum) const;

 private:
  std::size_t size_;
  LineTransform forward_, backward_;
};

/// Values -(lags - 1) to lags - 1 of a periodic line.
std::vector<double> about_zero(std::span<const double> line, std::size_t lags);

/// exp(-x^2 / (2 width^2)) over its integral, as its spectrum has it at a frequency.
double gaussian_spectrum(double frequency, double width);

}  // namespace flatspeckle::mc

#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Returns the mutex to hold while FFTW creates or destroys a plan, which is not thread-safe.
std::mutex& fourier_planning();

/// In-place Fourier transform of a contiguous array x of `size` numbers: X_m = sum_j x_j exp(-+ 2
/// pi i j m / size), with - for forward, without a normalising factor. FFTW chooses the algorithm
/// by estimates, not by timing, so that results are reproducible. Construction and use are
/// thread-safe.
class LineTransform {
 public:
  enum class Direction { forward, backward };
  LineTransform(std::size_t size, Direction direction);
  void operator()(Complex* line) const;

 private:
  struct Plan;
  std::shared_ptr<const Plan> plan_;
};

/// Fourier transforms of real pictures of rows x columns numbers, row by row, without a normalising
/// factor. The spectrum has rows x (columns / 2 + 1) numbers; the others follow from symmetry.
/// Construction and use are thread-safe.
class PlaneTransform {
 public:
  PlaneTransform(std::size_t rows, std::size_t columns);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::size_t spectrum_columns() const { return columns_ / 2 + 1; }
  std::size_t spectrum_size() const { return rows_ * spectrum_columns(); }

  /// picture: rows() x columns() numbers; spectrum: spectrum_size() numbers.
  void forward(const double* picture, Complex* spectrum) const;
  /// Computes the picture times rows() x columns(). Overwrites the spectrum.
  void backward(Complex* spectrum, double* picture) const;

 private:
  struct Plans;
  std::size_t rows_, columns_;
  std::shared_ptr<const Plans> plans_;
};

/// Computes the Fourier transform of a function on a periodic grid with two or three axes of the
/// given sizes, row by row, that is even in all coordinates. Function and transform are stored on
/// the first size / 2 + 1 points of each axis.
void transform_even(std::vector<Complex>& values, const std::vector<std::size_t>& sizes);

/// Returns the smallest even number of the form 2^a 3^b 5^c that is at least `least`: a fast
/// transform size.
std::size_t transform_size(double least);

}  // namespace flatspeckle

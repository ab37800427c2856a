#include "mc/imaging/recovery/line_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flatspeckle::mc {

std::vector<Complex> LineSpectrum::of(std::span<const double> line) const {
  std::vector<Complex> spectrum(size_);
  std::copy(line.begin(), line.end(), spectrum.begin());
  forward_(spectrum.data());
  return spectrum;
}

std::vector<double> LineSpectrum::line(std::vector<Complex> spectrum) const {
  backward_(spectrum.data());
  std::vector<double> line(size_);
  for (std::size_t p = 0; p < size_; ++p) line[p] = spectrum[p].real() / static_cast<double>(size_);
  return line;
}

std::vector<double> about_zero(std::span<const double> line, std::size_t lags) {
  std::vector<double> part(line.end() - static_cast<long>(lags - 1), line.end());
  part.insert(part.end(), line.begin(), line.begin() + static_cast<long>(lags));
  return part;
}

double gaussian_spectrum(double frequency, double width) {
  const double turns = 2 * std::numbers::pi * frequency * width;
  return std::exp(-turns * turns / 2);
}

}  // namespace flatspeckle::mc
